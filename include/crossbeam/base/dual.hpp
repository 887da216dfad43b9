#pragma once
/// @file
/// Dual numbers: a value and N derivatives. They can be nested for second derivatives. The kernels
/// of cell, law and element do not know them; the contact takes its tangent from them. A user's own
/// cell or law gets its exact tangent when it is evaluated on Dual<double, N>.

#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace crossbeam {

template <class T>
CROSSBEAM_INLINE T arcsine(const T& x);  // of kinematics/fibre_frame.hpp

template <class T, int N>
struct Dual {
  T value{};
  std::array<T, N> d{};

  Dual() = default;
  CROSSBEAM_INLINE Dual(const T& v) : value(v) {}
  template <class A>
    requires(std::is_arithmetic_v<A> && !std::is_same_v<A, T>)
  CROSSBEAM_INLINE Dual(A v) : value(T(v)) {}

  /// The variable number `index` with value v.
  static Dual variable(const T& v, int index) {
    Dual x(v);
    x.d[index] = T(1);
    return x;
  }

  /// Function with value f and derivative f' at x.
  CROSSBEAM_INLINE static Dual chain(const Dual& x, const T& f, const T& slope) {
    Dual r(f);
    for (int i = 0; i < N; ++i) r.d[i] = slope * x.d[i];
    return r;
  }

  CROSSBEAM_INLINE friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r(a.value + b.value);
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] + b.d[i];
    return r;
  }
  CROSSBEAM_INLINE friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r(a.value - b.value);
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] - b.d[i];
    return r;
  }
  CROSSBEAM_INLINE friend Dual operator-(const Dual& a) { return chain(a, -a.value, T(-1)); }
  CROSSBEAM_INLINE friend Dual operator+(const Dual& a) { return a; }
  CROSSBEAM_INLINE friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r(a.value * b.value);
    for (int i = 0; i < N; ++i) r.d[i] = a.d[i] * b.value + a.value * b.d[i];
    return r;
  }
  CROSSBEAM_INLINE friend Dual operator/(const Dual& a, const Dual& b) {
    const T inv = T(1) / b.value;
    Dual r(a.value * inv);
    for (int i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.value * b.d[i]) * inv;
    return r;
  }
  CROSSBEAM_INLINE Dual& operator+=(const Dual& b) { return *this = *this + b; }
  CROSSBEAM_INLINE Dual& operator-=(const Dual& b) { return *this = *this - b; }
  CROSSBEAM_INLINE Dual& operator*=(const Dual& b) { return *this = *this * b; }
  CROSSBEAM_INLINE Dual& operator/=(const Dual& b) { return *this = *this / b; }

  CROSSBEAM_INLINE friend auto operator<(const Dual& a, const Dual& b) { return a.value < b.value; }
  CROSSBEAM_INLINE friend auto operator>(const Dual& a, const Dual& b) { return a.value > b.value; }
  CROSSBEAM_INLINE friend auto operator<=(const Dual& a, const Dual& b) {
    return a.value <= b.value;
  }
  CROSSBEAM_INLINE friend auto operator>=(const Dual& a, const Dual& b) {
    return a.value >= b.value;
  }
  CROSSBEAM_INLINE friend auto operator==(const Dual& a, const Dual& b) {
    return a.value == b.value;
  }

  /// For lane masks; a plain bool selects the whole number (base/scalar.hpp).
  template <class Mask>
    requires(!std::is_same_v<Mask, bool>)
  CROSSBEAM_INLINE friend Dual select(const Mask& m, const Dual& a, const Dual& b) {
    using crossbeam::select;
    Dual r(select(m, a.value, b.value));
    for (int i = 0; i < N; ++i) r.d[i] = select(m, a.d[i], b.d[i]);
    return r;
  }

  CROSSBEAM_INLINE friend Dual sqrt(const Dual& x) {
    using std::sqrt;
    const T root = sqrt(x.value);
    return chain(x, root, T(0.5) / root);
  }
  CROSSBEAM_INLINE friend Dual sin(const Dual& x) {
    using std::cos;
    using std::sin;
    return chain(x, sin(x.value), cos(x.value));
  }
  CROSSBEAM_INLINE friend Dual cos(const Dual& x) {
    using std::cos;
    using std::sin;
    return chain(x, cos(x.value), -sin(x.value));
  }
  CROSSBEAM_INLINE friend Dual exp(const Dual& x) {
    using std::exp;
    const T e = exp(x.value);
    return chain(x, e, e);
  }
  CROSSBEAM_INLINE friend Dual log(const Dual& x) {
    using std::log;
    return chain(x, log(x.value), T(1) / x.value);
  }
  CROSSBEAM_INLINE friend Dual arcsine(const Dual& x) {
    using crossbeam::arcsine;
    using std::sqrt;
    return chain(x, arcsine(x.value), T(1) / sqrt(T(1) - x.value * x.value));
  }
  CROSSBEAM_INLINE friend auto passive(const Dual& x) { return passive(x.value); }
};

template <class T, int N>
struct ScalarTraits<Dual<T, N>> {
  using Real = real_t<T>;
  using Passive = passive_t<T>;
  static constexpr int lanes = ScalarTraits<T>::lanes;
  static constexpr int derivative_order = ScalarTraits<T>::derivative_order + 1;
};

}  // namespace crossbeam

/// Lets Eigen's fixed-size matrices hold dual numbers.
template <class T, int N>
struct Eigen::NumTraits<crossbeam::Dual<T, N>> : Eigen::NumTraits<double> {
  using Real = crossbeam::Dual<T, N>;
  using NonInteger = crossbeam::Dual<T, N>;
  using Nested = crossbeam::Dual<T, N>;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1,
    AddCost = N + 1,
    MulCost = 2 * N + 1
  };
};
