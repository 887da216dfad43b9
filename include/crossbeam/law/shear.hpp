#pragma once
/// @file
/// Shear layers: elastic laws in the fibre strains, each one energy per unit reference area with its
/// gradient and Hessian. Sources: paper Eq. 26; docs/theory/law.md.
///
/// Every law answers with g = dW/d(beta11, beta22, beta12) [kN/mm] and, on request, the symmetric
/// Hessian. (The contravariant stress components are m11 = g1, m22 = g2, m12 = g3/2, tag [L-1].)

#include "crossbeam/base/error.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"

#include <cmath>
#include <concepts>
#include <limits>
#include <string>
#include <vector>

namespace crossbeam {

/// Gradient of an energy density with respect to (beta11, beta22, beta12).
template <class T>
struct StrainGradient {
  T g1{}, g2{}, g3{};
};

/// Symmetric second derivative with respect to (beta11, beta22, beta12).
template <class T>
struct StrainHessian {
  T h11{}, h22{}, h33{}, h12{}, h13{}, h23{};
};

/// What every law is handed: the fibre strains and the stretches that were computed from them.
template <class T>
struct FibreState {
  FibreStrain<T> beta;
  T lambda1{}, lambda2{};
};

/// What a shear layer offers. Two members more are used where they are there:
///  - gradient(beta, inv1, inv2), from the strain and the reciprocals of the stretches: explicit
///    dynamics, which has those at hand, then computes no stretch a second time;
///  - set_reference(angle) between the yarns in the reference state: a layer that depends on it is
///    described without one and gets it from its law.
template <class Law, class T>
concept ShearLaw = requires(const Law& law, const FibreState<T>& s) {
  { law.gradient(s) } -> std::same_as<StrainGradient<T>>;
  { law.energy(s) } -> std::same_as<T>;
  { law.hessian(s) } -> std::same_as<StrainHessian<T>>;
  { law.modulus_bound() } -> std::convertible_to<real_t<T>>;
};

/// A layer between yarns at that angle; a law does this with its own.
/// @throws InputError where the layer already has another angle
template <class Shear, class R>
[[nodiscard]] Shear between_yarns(Shear shear, const FibreAngle<R>& reference) {
  if constexpr (requires { shear.set_reference(reference); }) shear.set_reference(reference);
  return shear;
}

/// The reference angle of a shear layer: a right angle until a law has set its own.
template <class R>
class LayerAngle {
 public:
  /// @throws InputError where the layer already has another angle
  void set(const FibreAngle<R>& reference) {
    if (is_set_ && reference.delta != angle_.delta)
      throw InputError("fibre angle of the law",
                       detail::to_text(static_cast<double>(reference.delta)), "rad",
                       "the angle that its shear layer was given before, " +
                           detail::to_text(static_cast<double>(angle_.delta)));
    angle_ = reference;
    is_set_ = true;
  }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE const FibreAngle<R>& get() const { return angle_; }

 private:
  FibreAngle<R> angle_ = FibreAngle<R>::right();
  bool is_set_ = false;
};

/// Whether the modulus multiplies the tensor component E12 (the paper, Eq. 26) or 2 E12.
enum class ShearMeasure { tensor, engineering };
/// Whether E12 is taken in the Cartesian axes Y (the paper) or as beta12 of the fibres. They agree
/// when the yarns are perpendicular in the reference state, tag [L-6].
enum class ShearFrame { cartesian, fibre };

/// Eq. 26: constant shear modulus on second Piola-Kirchhoff stress and Green-Lagrange strain.
template <class R>
class ConstantShear {
 public:
  using Real = R;

  /// @param modulus G12 [kN/mm, t = 1]; >= 0
  explicit ConstantShear(R modulus, ShearMeasure measure = ShearMeasure::tensor,
                         ShearFrame frame = ShearFrame::cartesian)
      : G_(require_non_negative("shear.modulus", modulus, "kN/mm") *
           (measure == ShearMeasure::tensor ? R(1) : R(2))),
        frame_(frame) {}

  void set_reference(const FibreAngle<R>& reference) {
    angle_.set(reference);
    if (frame_ == ShearFrame::cartesian) {
      a_ = -reference.cosine / reference.sine;
      b_ = R(1) / reference.sine;
    }
  }

  /// E12 = a beta11 + b beta12 in the chosen frame.
  template <class T>
  CROSSBEAM_INLINE T strain(const FibreStrain<T>& beta) const {
    return T(a_) * beta.b11 + T(b_) * beta.b12;
  }
  template <class T>
  CROSSBEAM_INLINE T energy(const FibreState<T>& s) const {
    const T E12 = strain(s.beta);
    return T(G_) * E12 * E12;
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreState<T>& s) const {
    return gradient(s.beta, T(0), T(0));
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreStrain<T>& beta, const T&,
                                              const T&) const {
    const T dW = T(R(2) * G_) * strain(beta);
    return {T(a_) * dW, T(0), T(b_) * dW};
  }
  template <class T>
  CROSSBEAM_INLINE StrainHessian<T> hessian(const FibreState<T>&) const {
    const R G2 = R(2) * G_;
    return {T(G2 * a_ * a_), T(0), T(G2 * b_ * b_), T(0), T(G2 * a_ * b_), T(0)};
  }

  /// Upper bound of d tau / d gamma at moderate angles, for the critical time step [kN/mm].
  [[nodiscard]] R modulus_bound() const { return G_ * b_ * b_; }

 private:
  R G_, a_ = R(0), b_ = R(1);
  ShearFrame frame_;
  LayerAngle<R> angle_;
};

/// An energy in the fibre angle: W(gamma), tau = dW/dgamma, both from `Curve`, which maps |gamma| to
/// {W, tau, dtau/dgamma}. The traction is odd in gamma, tag [L-5].
template <class R, class Curve>
class AngleShear {
 public:
  using Real = R;

  explicit AngleShear(Curve curve) : curve_(std::move(curve)) {}

  void set_reference(const FibreAngle<R>& reference) { reference_.set(reference); }

  template <class T>
  CROSSBEAM_INLINE T angle(const FibreState<T>& s) const {
    return shear_angle(fibre_cosine(s.beta, s.lambda1, s.lambda2, reference_.get().cosine),
                       reference_.get());
  }
  template <class T>
  CROSSBEAM_INLINE T energy(const FibreState<T>& s) const {
    return curve_.energy(magnitude(angle(s)));
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreState<T>& s) const {
    const InverseStretches<T> inv(s.lambda1, s.lambda2);
    return gradient(s.beta, inv.first, inv.second);
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreStrain<T>& beta, const T& inv1,
                                              const T& inv2) const {
    const Slope<T> d(beta, inv1, inv2, reference_.get().cosine);
    const T gamma = d.angle(reference_.get());
    const T tau = times_sign(curve_.traction(magnitude(gamma)), gamma);
    return {tau * d.g1, tau * d.g2, tau * d.g3};
  }
  template <class T>
  CROSSBEAM_INLINE StrainHessian<T> hessian(const FibreState<T>& s) const {
    const InverseStretches<T> inverse(s.lambda1, s.lambda2);
    const Slope<T> d(s.beta, inverse.first, inverse.second, reference_.get().cosine);
    const T gamma = d.angle(reference_.get());
    const T t = curve_.traction(magnitude(gamma)), G = curve_.modulus(magnitude(gamma));
    const T tau = select(gamma < T(0), -t, t);
    // d2 gamma = d2 c / k + c dc dc / k^3, with c the fibre cosine and k = sqrt(1 - c^2)  [L-5]
    const T Q1 = s.lambda1 * s.lambda1, Q2 = s.lambda2 * s.lambda2;
    const T inv = inverse.product;
    const T bend = d.c * d.inv_k;  // c dc dc / k^3 = bend g g, because dc = k g
    StrainHessian<T> h;
    h.h11 = T(3) * d.c / (Q1 * Q1) * d.inv_k;
    h.h22 = T(3) * d.c / (Q2 * Q2) * d.inv_k;
    h.h33 = T(0);
    h.h12 = d.c / (Q1 * Q2) * d.inv_k;
    h.h13 = -(T(2) * inv / Q1) * d.inv_k;
    h.h23 = -(T(2) * inv / Q2) * d.inv_k;
    h.h11 = tau * (h.h11 + bend * d.g1 * d.g1) + G * d.g1 * d.g1;
    h.h22 = tau * (h.h22 + bend * d.g2 * d.g2) + G * d.g2 * d.g2;
    h.h33 = tau * (h.h33 + bend * d.g3 * d.g3) + G * d.g3 * d.g3;
    h.h12 = tau * (h.h12 + bend * d.g1 * d.g2) + G * d.g1 * d.g2;
    h.h13 = tau * (h.h13 + bend * d.g1 * d.g3) + G * d.g1 * d.g3;
    h.h23 = tau * (h.h23 + bend * d.g2 * d.g3) + G * d.g2 * d.g3;
    return h;
  }
  [[nodiscard]] R modulus_bound() const {
    R largest(0);
    for (int k = 0; k <= 100; ++k) {  // moderate angles: up to 1 rad
      const R G = curve_.modulus(R(k) / R(100));
      if (largest < G) largest = G;
    }
    return largest;
  }

 private:
  /// Fibre cosine c and the gradient of gamma = asin c - const with respect to beta.
  template <class T>
  struct Slope {
    T c, k, inv_k, g1, g2, g3;
    CROSSBEAM_INLINE Slope(const FibreStrain<T>& beta, const T& inv1, const T& inv2, R cosine) {
      using std::sqrt;
      const T product = inv1 * inv2;
      c = (beta.b12 + beta.b12 + T(cosine)) * product;
      // Yarns that fall together: k stays positive, the caller's element check reports the element.
      k = sqrt(maximum(T(1) - c * c, T(std::numeric_limits<R>::epsilon())));
      inv_k = T(1) / k;
      g1 = -(c * inv_k) * (inv1 * inv1);
      g2 = -(c * inv_k) * (inv2 * inv2);
      g3 = T(2) * product * inv_k;
    }
    CROSSBEAM_INLINE T angle(const FibreAngle<R>& reference) const {
      return shear_angle(c, k, reference);
    }
  };

  Curve curve_;
  LayerAngle<R> reference_;
};

/// Tangent modulus as a polynomial of the angle: G = sum_k a_k |gamma|^k; traction and energy are its
/// integrals.
template <class R>
class PolynomialCurve {
 public:
  static constexpr int max_terms = 8;

  /// @param coefficients a_0, a_1, ... [kN/mm per rad^k]; 1 to 8 finite numbers
  /// @throws InputError also where G becomes negative between 0 and 1.2 rad
  explicit PolynomialCurve(const std::vector<R>& coefficients) {
    if (coefficients.empty() || coefficients.size() > max_terms)
      throw InputError("shear.coefficients", std::to_string(coefficients.size()) + " numbers", "",
                       "1 to 8 numbers");
    for (int k = 0; k < static_cast<int>(coefficients.size()); ++k) {
      modulus_[k] =
          require_finite("shear.coefficients[" + std::to_string(k) + "]", coefficients[k], "kN/mm");
      traction_[k] = modulus_[k] / R(k + 1);
      energy_[k] = traction_[k] / R(k + 2);
    }
    for (int k = 0; k <= 120; ++k) {
      const R G = modulus(R(k) / R(100));
      if (!(G >= R(0) && G <= (std::numeric_limits<R>::max)()))
        throw InputError("shear.coefficients: G(" + detail::to_text(k / 100.0) + " rad)",
                         detail::to_text(G), "kN/mm",
                         "a finite number >= 0 for all angles from 0 to 1.2 rad");
    }
  }

  template <class T>
  CROSSBEAM_INLINE T modulus(const T& g) const {
    return sum(modulus_, g);
  }
  template <class T>
  CROSSBEAM_INLINE T traction(const T& g) const {
    return sum(traction_, g) * g;
  }
  template <class T>
  CROSSBEAM_INLINE T energy(const T& g) const {
    return sum(energy_, g) * g * g;
  }

 private:
  using Coefficients = R[max_terms];

  /// Of all terms, used or not: no loop count keeps a compiler from the vector unit. Even and odd powers
  /// are two chains that run side by side.
  template <class T>
  CROSSBEAM_INLINE T sum(const Coefficients& a, const T& g) const {
    const T y = g * g;
    T odd(a[max_terms - 1]), even(a[max_terms - 2]);
    unrolled<max_terms / 2 - 1>([&](auto k) CROSSBEAM_INLINE_LAMBDA {
      odd = odd * y + T(a[max_terms - 3 - 2 * k]);
      even = even * y + T(a[max_terms - 4 - 2 * k]);
    });
    return even + g * odd;
  }

  Coefficients modulus_{}, traction_{}, energy_{};  // 0 beyond those given
};

/// Traction as a measured curve: straight lines between the given points, the last one continued.
/// Written as a sum of ramps, so that a pack needs no table look-up.
template <class R>
class TabulatedCurve {
 public:
  /// @param angle    [rad], from 0, increasing by at least the cube root of the rounding unit (6e-6 in
  ///                 double: a sum of ramps keeps no digits of a steeper step), 2 numbers or more
  /// @param traction [kN/mm], from 0, not decreasing
  TabulatedCurve(const std::vector<R>& angle, const std::vector<R>& traction) {
    if (angle.size() < 2 || angle.size() != traction.size())
      throw InputError(
          "shear.angle / shear.traction",
          std::to_string(angle.size()) + " / " + std::to_string(traction.size()) + " numbers", "",
          "two lists of the same length, 2 or more");
    require_finite("shear.angle[0]", angle[0], "rad");
    if (angle[0] != R(0) || traction[0] != R(0))
      throw InputError("shear.angle[0], shear.traction[0]",
                       detail::to_text(angle[0]) + ", " + detail::to_text(traction[0]),
                       "rad, kN/mm", "0, 0");
    R slope(0);
    for (std::size_t k = 0; k + 1 < angle.size(); ++k) {
      const std::string next = std::to_string(k + 1);
      require_finite("shear.traction[" + next + "]", traction[k + 1], "kN/mm");
      using std::cbrt;
      const R least = cbrt(epsilon_of<R>()), step = angle[k + 1] - angle[k];
      const std::string name = "shear.angle[" + next + "] - shear.angle[" + std::to_string(k) + "]";
      if (!(require_finite(name, step, "rad") >= least))
        throw InputError(name, detail::to_text(step), "rad",
                         "a finite number >= " + detail::to_text(least));
      const R s = require_non_negative("slope of shear.traction before point " + next,
                                       (traction[k + 1] - traction[k]) / (angle[k + 1] - angle[k]),
                                       "kN/mm/rad");
      knots_.push_back({angle[k], s - slope});
      slope = s;
    }
  }

  template <class T>
  CROSSBEAM_INLINE T modulus(const T& g) const {
    T sum(0);
    for (const Knot& k : knots_) sum = sum + select(g >= T(k.angle), T(k.change), T(0));
    return sum;
  }
  template <class T>
  CROSSBEAM_INLINE T traction(const T& g) const {
    T sum(0);
    for (const Knot& k : knots_) sum = sum + T(k.change) * maximum(g - T(k.angle), T(0));
    return sum;
  }
  template <class T>
  CROSSBEAM_INLINE T energy(const T& g) const {
    T sum(0);
    for (const Knot& k : knots_) {
      const T ramp = maximum(g - T(k.angle), T(0));
      sum = sum + T(R(0.5) * k.change) * ramp * ramp;
    }
    return sum;
  }

 private:
  struct Knot {
    R angle, change;  // of the slope
  };
  std::vector<Knot> knots_;
};

template <class R>
using PolynomialShear = AngleShear<R, PolynomialCurve<R>>;
template <class R>
using TabulatedShear = AngleShear<R, TabulatedCurve<R>>;

/// No shear layer; costs nothing.
template <class R>
struct NoShear {
  using Real = R;
  template <class T>
  CROSSBEAM_INLINE T energy(const FibreState<T>&) const {
    return T(0);
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreState<T>&) const {
    return {T(0), T(0), T(0)};
  }
  template <class T>
  CROSSBEAM_INLINE StrainGradient<T> gradient(const FibreStrain<T>&, const T&, const T&) const {
    return {T(0), T(0), T(0)};
  }
  template <class T>
  CROSSBEAM_INLINE StrainHessian<T> hessian(const FibreState<T>&) const {
    return {T(0), T(0), T(0), T(0), T(0), T(0)};
  }
  [[nodiscard]] R modulus_bound() const { return R(0); }
};

}  // namespace crossbeam
