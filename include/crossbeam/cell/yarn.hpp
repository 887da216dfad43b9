#pragma once
/// @file
/// The axial law of a yarn: tension against elongation. Linear is the paper's; any convex law that
/// starts at zero keeps the cell's theorems (docs/theory/cell.md, [C-13]).

#include "crossbeam/base/scalar.hpp"

#include <concepts>

namespace crossbeam {

/// An axial law, as a class of one's own without a base class. All functions take the elongation
/// e = l - l0 and the unstressed length l0 and are relative to the stiffness ka = EA/l0:
///   tension  N / ka [length], zero at e = 0, not decreasing, convex where it is positive;
///   modulus  dN/de / ka [-];
///   energy   integral of the tension over e, / ka [length^2];
///   modulus_bound  the largest modulus, a plain number: EA is best the stiffness of the straight
///                  yarn, with a bound of 1.
/// They are templates that select instead of branching (base/scalar.hpp).
template <class Law, class T>
concept YarnLaw = requires(const Law& law, const T& e) {
  { law.tension(e, e) } -> std::same_as<T>;
  { law.modulus(e, e) } -> std::same_as<T>;
  { law.energy(e, e) } -> std::same_as<T>;
  { law.modulus_bound() } -> std::convertible_to<double>;
};

/// N = ka e, in tension as in compression: the paper's.
struct LinearYarn {
  template <class T>
  CROSSBEAM_INLINE T tension(const T& e, const T&) const {
    return e;
  }
  template <class T>
  CROSSBEAM_INLINE T modulus(const T&, const T&) const {
    return T(1);
  }
  template <class T>
  CROSSBEAM_INLINE T energy(const T& e, const T&) const {
    return T(0.5) * e * e;
  }
  [[nodiscard]] static constexpr double modulus_bound() { return 1; }
};

}  // namespace crossbeam
