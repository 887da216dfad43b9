#pragma once
/// @file
/// Derivatives by the complex step: f(x + i h) = f(x) + i h f'(x) + O(h^2), and no subtraction, so
/// that h may be 1e-30 and f' has all its digits. The differentiating is done by the arithmetic of
/// std::complex, which knows no chain rule of ours.

#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>

#include <cmath>
#include <complex>
#include <type_traits>

namespace verify {

/// A complex number that is ordered by its real part, as a kernel's comparisons expect. It is a
/// plain scalar to the kernel: iterations run in it, and nothing is made of derivatives ([C-7]).
struct ComplexStep {
  static constexpr double h = 1e-30;
  std::complex<double> z{};

  ComplexStep() = default;
  ComplexStep(const std::complex<double>& value) : z(value) {}
  template <class A>
    requires std::is_arithmetic_v<A>
  ComplexStep(A value) : z(static_cast<double>(value)) {}

  /// The variable that is differentiated by.
  static ComplexStep variable(double x) { return std::complex<double>(x, h); }
  [[nodiscard]] double value() const { return z.real(); }
  [[nodiscard]] double derivative() const { return z.imag() / h; }

  friend ComplexStep operator+(const ComplexStep& a, const ComplexStep& b) { return a.z + b.z; }
  friend ComplexStep operator-(const ComplexStep& a, const ComplexStep& b) { return a.z - b.z; }
  friend ComplexStep operator*(const ComplexStep& a, const ComplexStep& b) { return a.z * b.z; }
  friend ComplexStep operator/(const ComplexStep& a, const ComplexStep& b) { return a.z / b.z; }
  friend ComplexStep operator-(const ComplexStep& a) { return -a.z; }
  ComplexStep& operator+=(const ComplexStep& b) { return *this = *this + b; }
  ComplexStep& operator-=(const ComplexStep& b) { return *this = *this - b; }
  ComplexStep& operator*=(const ComplexStep& b) { return *this = *this * b; }
  ComplexStep& operator/=(const ComplexStep& b) { return *this = *this / b; }

  friend bool operator<(const ComplexStep& a, const ComplexStep& b) {
    return a.value() < b.value();
  }
  friend bool operator>(const ComplexStep& a, const ComplexStep& b) { return b < a; }
  friend bool operator<=(const ComplexStep& a, const ComplexStep& b) { return !(b < a); }
  friend bool operator>=(const ComplexStep& a, const ComplexStep& b) { return !(a < b); }
  friend ComplexStep sqrt(const ComplexStep& a) { return std::sqrt(a.z); }
  friend bool isfinite(const ComplexStep& a) { return std::isfinite(a.value()); }
};

}  // namespace verify

template <>
struct crossbeam::ScalarTraits<verify::ComplexStep> {
  using Real = double;
  using Passive = verify::ComplexStep;
  static constexpr int lanes = 1;
  static constexpr int derivative_order = 0;
};

/// Lets Eigen's fixed-size matrices hold it, as a real number.
template <>
struct Eigen::NumTraits<verify::ComplexStep> : Eigen::NumTraits<double> {
  using Real = verify::ComplexStep;
  using NonInteger = verify::ComplexStep;
  using Nested = verify::ComplexStep;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = 2,
    MulCost = 4
  };
};
