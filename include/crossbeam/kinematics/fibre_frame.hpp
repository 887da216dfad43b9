#pragma once
/// @file
/// The fibre frame F1 (warp), F2 (weft): strains, stretches, yarn elongations and the signed shear
/// angle (paper, Eq. 8-14). Theory: docs/theory/kinematics.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/linalg.hpp"
#include "crossbeam/base/scalar.hpp"

#include <cmath>
#include <numbers>

namespace crossbeam {

namespace detail {

/// pi/2 in the precision of R.
template <class R>
CROSSBEAM_HOST_DEVICE R half_pi() {
  if constexpr (std::is_floating_point_v<R>) {
    return std::numbers::pi_v<R> / 2;
  } else {
    using std::atan;
    return 2 * atan(R(1));
  }
}

/// arcsin from square roots and polynomials only, so that packs need no library call: the
/// polynomial [K-4] for |x| <= 1/2, the half-angle formula above. Arguments beyond +-1 are clamped.
template <class T>
CROSSBEAM_INLINE T pack_asin(const T& x) {
  using std::sqrt;
  using R = real_t<T>;
  constexpr double coefficients[] = {
      0.028757851367421566, -0.014851887071247204, 0.01740087944269402,  0.005457506718640358,
      0.01032281435018578,  0.011479177415184906,  0.013971212973552933, 0.017352392720869973,
      0.02237217294214989,  0.030381944138531247,  0.04464285714635543,  0.07499999999998433,
      0.16666666666666669};
  const T a = minimum(magnitude(x), T(1));
  const auto large = a > T(0.5);
  const T z = select(large, (T(1) - a) * T(0.5), a * a);
  const T s = select(large, sqrt(z), a);
  T p = T(R(coefficients[0]));
  for (int k = 1; k < 13; ++k) p = p * z + T(R(coefficients[k]));
  const T small_angle = s + s * z * p;
  const T angle = select(large, T(half_pi<R>()) - T(2) * small_angle, small_angle);
  return times_sign(angle, x);
}

/// P(z), z = s^2, of [K-5], as two chains that run side by side.
template <class T, std::size_t Terms>
CROSSBEAM_INLINE T octant_polynomial(const T& z, const double (&coefficients)[Terms]) {
  static_assert(Terms % 2 == 0);
  using R = real_t<T>;
  const T y = z * z;
  T odd = T(R(coefficients[0])), even = T(R(coefficients[1]));
  for (std::size_t k = 2; k < Terms; k += 2) {
    odd = odd * y + T(R(coefficients[k]));
    even = even * y + T(R(coefficients[k + 1]));
  }
  return even + z * odd;
}

/// arcsin x with root = sqrt(1 - x^2) > 0 given, tag [K-5]: the angle is turned by 0, 45 or 90 deg
/// into the octant about zero.
template <class T>
CROSSBEAM_INLINE T pack_asin(const T& x, const T& root) {
  using R = real_t<T>;
  constexpr double sine_of_octant = 0.38268343236508977173;  // sin(pi/8)
  const T a = magnitude(x);
  const auto middle = a > T(R(sine_of_octant)), large = root < T(R(sine_of_octant));
  const T s = select(large, -root, select(middle, (a - root) * T(R(1 / std::numbers::sqrt2)), a));
  const T turned = select(large, T(half_pi<R>()), select(middle, T(half_pi<R>() / R(2)), T(0)));
  const T z = s * s;
  T p;
  if constexpr (std::is_same_v<R, float>) {
    p = octant_polynomial(z, {0.04014926694, 0.04335775787, 0.0750646503, 0.1666656663});
  } else {
    p = octant_polynomial(
        z, {0.016704469823119172097, 0.0067766208113588982398, 0.012108832256164656683,
            0.013903570830247274449, 0.017356883357138812016, 0.022371991792930005289,
            0.030381948327824196116, 0.044642857097249666853, 0.075000000000207138572,
            0.16666666666666651186});
  }
  return times_sign(turned + (s + s * z * p), x);
}

}  // namespace detail

/// Covariant Green-Lagrange strains in the fibre frame (Eq. 10): beta_ab = (f_a.f_b - F_a.F_b)/2
/// [-]. It is the one strain measure that the laws take; components may be SIMD packs.
template <class T>
struct FibreStrain {
  T b11{}, b22{}, b12{};
};

/// Least angle between warp and weft, and between weft and reversed warp, that a law takes [rad].
/// The law divides by its sine, so that stresses lose as many digits as the angle has zeros: four
/// here.
inline constexpr double least_fibre_angle = 1e-4;

/// The angle between warp and weft in the reference state.
template <class R>
struct FibreAngle {
  R delta;  ///< delta_bar [rad]; in (least_fibre_angle, pi - least_fibre_angle)
  R cosine, sine;

  /// @throws InputError for an angle of 0 or 180 deg, nearly so or beyond: with parallel yarns the
  /// law would divide by a sine of zero.
  explicit FibreAngle(R delta_bar)
      : delta(require_between("delta_bar", delta_bar, "rad", least_fibre_angle,
                              std::numbers::pi - least_fibre_angle)) {
    using std::cos;
    using std::sin;
    cosine = cos(delta_bar);
    sine = sin(delta_bar);
  }

  /// A right angle, with a cosine of exactly zero.
  static FibreAngle right() { return FibreAngle(); }

 private:
  FibreAngle() : delta(detail::half_pi<R>()), cosine(0), sine(1) {}
};

/// Coefficients c of F_a = c_a^b Y_b (Eq. 9): rows are F1, F2 in the Cartesian axes.
template <class R>
Matrix2<R> fibre_from_cartesian(const FibreAngle<R>& angle) {
  Matrix2<R> c;
  c << R(1), R(0), angle.cosine, angle.sine;
  return c;
}

/// beta = c E c^T (Eq. 10).
template <class T>
FibreStrain<T> fibre_strain(const Matrix2<T>& cartesian_strain, const Matrix2<T>& c) {
  const Matrix2<T> beta = c * cartesian_strain * c.transpose();
  return {beta(0, 0), beta(1, 1), beta(0, 1)};
}

/// Fibre strain from the current fibre vectors f_a = F F_a: exact to the rounding of f, which is
/// enough for a drape in double precision.
template <class T, class R>
CROSSBEAM_INLINE FibreStrain<T> fibre_strain(const Vec3<T>& f1, const Vec3<T>& f2, R cosine) {
  return {T(0.5) * (dot(f1, f1) - T(1)), T(0.5) * (dot(f2, f2) - T(1)),
          T(0.5) * (dot(f1, f2) - T(cosine))};
}

/// The same from the increments g_a = f_a - F_a: no cancellation, tag [K-1].
template <class T>
CROSSBEAM_INLINE FibreStrain<T> fibre_strain_from_increment(const Vec3<T>& g1, const Vec3<T>& g2,
                                                            const Vec3<T>& F1, const Vec3<T>& F2) {
  return {dot(F1, g1) + T(0.5) * dot(g1, g1), dot(F2, g2) + T(0.5) * dot(g2, g2),
          T(0.5) * (dot(F1, g2) + dot(F2, g1) + dot(g1, g2))};
}

/// Stretch lambda = l / L (Eq. 13, 17).
template <class T>
CROSSBEAM_INLINE T stretch(const T& beta) {
  using std::sqrt;
  return sqrt(T(1) + beta + beta);
}

/// Elongation lambda - 1 per unit length (Eq. 14) in the form that does not cancel, tag [K-2].
template <class T>
CROSSBEAM_INLINE T relative_elongation(const T& beta, const T& lambda) {
  return (beta + beta) / (T(1) + lambda);
}

/// 1/lambda1, 1/lambda2 and their product, computed with one division.
template <class T>
struct InverseStretches {
  T first, second, product;
  CROSSBEAM_INLINE InverseStretches(const T& lambda1, const T& lambda2)
      : product(T(1) / (lambda1 * lambda2)) {
    first = product * lambda2;
    second = product * lambda1;
  }
};

/// Cosine of the current angle between the yarns.
template <class T, class R>
CROSSBEAM_INLINE T fibre_cosine(const FibreStrain<T>& b, const T& lambda1, const T& lambda2,
                                R reference_cosine) {
  return (b.b12 + b.b12 + T(reference_cosine)) * InverseStretches<T>(lambda1, lambda2).product;
}

/// arcsin of any scalar. Float, double and packs of them share one formula, so that lanes equal
/// scalars; wider types take the standard library's asin; dual numbers bring their own overload.
template <class T>
CROSSBEAM_INLINE T arcsine(const T& x) {
  using R = real_t<T>;
  if constexpr (std::is_same_v<R, float> || std::is_same_v<R, double>) {
    return detail::pack_asin(x);
  } else {
    using std::asin;
    return asin(x);
  }
}

/// The same where the cosine of the answer, root = sqrt(1 - x^2), is known already: it needs no
/// further root and a shorter polynomial, tag [K-5].
template <class T>
CROSSBEAM_INLINE T arcsine(const T& x, const T& root) {
  using R = real_t<T>;
  if constexpr (ScalarTraits<T>::derivative_order == 0 &&
                (std::is_same_v<R, float> || std::is_same_v<R, double>)) {
    return detail::pack_asin(x, root);
  } else {
    return arcsine(x);
  }
}

/// Signed shear angle gamma = delta_bar - delta [rad], positive when warp and weft close up. The
/// form by the sine is accurate at small angles, tag [K-3].
template <class T, class R>
CROSSBEAM_INLINE T shear_angle(const T& cosine, const FibreAngle<R>& reference) {
  return arcsine(cosine) - T(detail::half_pi<R>() - reference.delta);
}
/// @param sine sqrt(1 - cosine^2)
template <class T, class R>
CROSSBEAM_INLINE T shear_angle(const T& cosine, const T& sine, const FibreAngle<R>& reference) {
  return arcsine(cosine, sine) - T(detail::half_pi<R>() - reference.delta);
}

}  // namespace crossbeam
