#pragma once
/// @file
/// Random numbers that are the same on every machine: a fixed seed and a uniform distribution of
/// our own (the standard one may differ between libraries). CROSSBEAM_SEED=<number> in the
/// environment shifts all seeds, to try other states.

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <random>

namespace crossbeam::verification {

class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed + shift()), engine_(seed_) {}

  [[nodiscard]] std::uint64_t seed() const { return seed_; }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  /// Uniform in the exponent.
  double log_uniform(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  /// Vector with components in [-size, size].
  Eigen::Vector3d vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return {x, y, z};
  }
  /// Uniformly distributed rotation (a random unit quaternion).
  Eigen::Matrix3d rotation() {
    using std::numbers::pi;
    const double a = uniform(0, 1), b = 2 * pi * uniform(0, 1), c = 2 * pi * uniform(0, 1);
    const double w = std::sqrt(1 - a) * std::sin(b), x = std::sqrt(1 - a) * std::cos(b),
                 y = std::sqrt(a) * std::sin(c), z = std::sqrt(a) * std::cos(c);
    Eigen::Matrix3d Q;
    Q << 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),  //
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),   //
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y);
    return Q;
  }

 private:
  static std::uint64_t shift() {
    const char* text = std::getenv("CROSSBEAM_SEED");
    return text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
  }

  std::uint64_t seed_;
  std::mt19937_64 engine_;
};

}  // namespace crossbeam::verification
