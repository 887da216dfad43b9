#pragma once
/// @file
/// Kinematics of a membrane in convected coordinates, from any pair of element base vectors in
/// space (paper, Eq. 1-7). Theory: docs/theory/kinematics.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/linalg.hpp"
#include "crossbeam/base/scalar.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace crossbeam {

/// Metric A_ab = A_a . A_b of a base (Eq. 1, 2) [length^2].
template <class T>
Matrix2<T> metric(const Base<T>& base) {
  Matrix2<T> A;
  A(0, 0) = base.col(0).dot(base.col(0));
  A(1, 1) = base.col(1).dot(base.col(1));
  A(0, 1) = A(1, 0) = base.col(0).dot(base.col(1));
  return A;
}

/// Determinant of the metric (Eq. 7), as |A1 x A2|^2: this form does not cancel for skew bases.
template <class T>
T metric_determinant(const Base<T>& base) {
  const auto column = [&](int k) { return Vec3<T>{base(0, k), base(1, k), base(2, k)}; };
  const Vec3<T> n = cross(column(0), column(1));
  return dot(n, n);
}

/// Covariant Green-Lagrange strain (Eq. 3) from the current and the reference base [length^2].
/// Loses digits when the strain is small; prefer convected_strain_from_increment.
template <class T>
Matrix2<T> convected_strain(const Base<T>& current, const Base<T>& reference) {
  return (metric(current) - metric(reference)) / T(2);
}

/// The same strain from the reference base and the increment d_a = a_a - A_a, which is the gradient
/// of the displacement; nothing cancels, tag [K-1].
template <class T>
Matrix2<T> convected_strain_from_increment(const Base<T>& increment, const Base<T>& reference) {
  const Matrix2<T> Ad = reference.transpose() * increment;
  return (Ad + Ad.transpose() + increment.transpose() * increment) / T(2);
}

namespace detail {

/// Least sine of the angle between two base vectors, in roundings of the number type [-]. The area
/// of vectors that are more nearly parallel is rounding alone, and so would be everything divided
/// by it.
inline constexpr int least_sine_in_roundings = 1024;

/// |A1 x A2| of an element base [mm^2]. It checks that squares of its lengths and of the area keep
/// their digits and that the vectors are not parallel up to `least_sine_in_roundings`.
/// @throws InputError otherwise
template <class T>
T checked_area(const std::string& name, const Base<T>& base) {
  using std::sqrt;
  using R = real_t<T>;
  const T det = metric_determinant(base);
  const T A11 = base.col(0).dot(base.col(0)), A22 = base.col(1).dot(base.col(1));
  const R eps = epsilon_of<T>(), least = (std::numeric_limits<R>::min)() / (eps * eps);
  if (!(det >= T(least) && A11 >= T(least) && A22 >= T(least) &&
        A11 * A22 <= T((std::numeric_limits<R>::max)()) &&
        det > T(R(least_sine_in_roundings) * R(least_sine_in_roundings) * eps * eps) * A11 * A22))
    throw InputError(name, "area " + detail::to_text(passive(det)) + "^(1/2)", "mm^2",
                     "two finite base vectors that span an area > 0");
  return sqrt(det);
}

}  // namespace detail

/// Coefficients d of Y_a = d_a^b A_b (Eq. 5): rows are the in-plane Cartesian axes Y1, Y2 in the
/// element base. Y1 is A1 turned by alpha_bar towards A2.
/// @throws InputError when the base is degenerate or alpha_bar is not finite.
template <class T>
Matrix2<T> cartesian_from_convected(const Base<T>& reference, const T& alpha_bar) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Matrix2<T> A = metric(reference);
  const T area = detail::checked_area("element base", reference);
  require_finite("alpha_bar", alpha_bar, "rad");
  const T c = cos(alpha_bar), s = sin(alpha_bar);
  const T length = sqrt(A(0, 0));
  const T inv_sqrt_A11 = T(1) / length;
  const T skew = A(0, 1) / (area * length);
  const T across = length / area;
  Matrix2<T> d;
  d << inv_sqrt_A11 * c - skew * s, across * s,  //
      -inv_sqrt_A11 * s - skew * c, across * c;
  return d;
}

/// The axes Y1, Y2 in space, as columns (Eq. 4).
template <class T>
Base<T> cartesian_axes(const Base<T>& reference, const Matrix2<T>& d) {
  return reference * d.transpose();
}

/// Cartesian components of the strain (Eq. 6).
template <class T>
Matrix2<T> to_cartesian(const Matrix2<T>& convected, const Matrix2<T>& d) {
  return d * convected * d.transpose();
}

/// Surface deformation gradient (Eq. 22) as the 3x2 matrix that maps Y components to space:
/// columns are F Y1 and F Y2.
template <class T>
Base<T> surface_gradient(const Base<T>& current, const Matrix2<T>& d) {
  return current * d.transpose();
}

/// Area ratio sqrt(det a / det A), the surface reading of Eq. 23, tag [L-4]; 0 for a current base
/// that has collapsed.
/// @throws InputError when the reference base is degenerate or the current one is not finite.
template <class T>
T area_ratio(const Base<T>& current, const Base<T>& reference) {
  using std::sqrt;
  const T area = detail::checked_area("element base", reference);
  const T det = metric_determinant(current);
  require_finite("current element base: area squared", passive(det), "mm^4");
  return sqrt(det) / area;
}

}  // namespace crossbeam
