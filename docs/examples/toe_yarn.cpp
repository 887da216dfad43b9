// A yarn law of one's own - its fibres straighten before they carry - put through the battery. With
// `toe_yarn <log>` the evidence goes to a file, from which `./run report` makes the page.

// [begin:law]
#include <crossbeam/verification/law_battery.hpp>

/// W = ka x^3 / (2 (x + a)) with x = max(e, 0): no stiffness at first, that of EA far beyond a.
struct ToeYarn {
  double toe = 0.004;  // a / l0

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
    return x * (x * x + T(3) * a * s) / (s * s * s);
  }
  [[nodiscard]] static double modulus_bound() { return 1; }
};
// [end:law]

int main(int count, char** arguments) {
  const char* log = count > 1 ? arguments[1] : "";
  // [begin:battery]
  using namespace crossbeam::verification;
  Battery battery("Yarn with a toe", log);
  verify_yarn(battery, ToeYarn{});
  return battery.finish();
  // [end:battery]
}
