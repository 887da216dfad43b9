// The yarn of toe_yarn.cpp with a deliberate error, a lost factor in the modulus: what the battery
// finds. (A program that verifies a law for real ends with `return battery.finish();`.)

#include <crossbeam/verification/law_battery.hpp>

struct WrongToeYarn {
  double toe = 0.004;

  template <class T>
  T energy(const T& e, const T& l0) const {
    const T x = crossbeam::maximum(e, T(0)), s = x + T(toe) * l0;
    return x * x * x / (T(2) * s);
  }
  template <class T>
  T tension(const T& e, const T& l0) const {
    const T x = crossbeam::maximum(e, T(0)), a = T(toe) * l0, s = x + a;
    return x * x * (T(2) * x + T(3) * a) / (T(2) * s * s);
  }
  template <class T>
  T modulus(const T& e, const T& l0) const {
    const T x = crossbeam::maximum(e, T(0)), a = T(toe) * l0, s = x + a;
    return x * (x * x + a * s) / (s * s * s);  // 3 a s, as it should be, lost its 3
  }
  [[nodiscard]] static double modulus_bound() { return 1; }
};

int main(int count, char** arguments) {
  crossbeam::verification::Battery battery("Yarn with an error", count > 1 ? arguments[1] : "");
  crossbeam::verification::verify_yarn(battery, WrongToeYarn{});
  std::printf("These claims do not hold:");
  for (const auto& id : battery.failed()) std::printf(" %s", id.c_str());
  std::printf("\n");
  return battery.failed().empty() ? 1 : 0;
}
