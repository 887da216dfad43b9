#pragma once
/// @file
/// What a membrane element asks of its constitutive law. WovenMembrane is one such law; a law of
/// one's own needs no cell.

#include "crossbeam/law/woven_membrane.hpp"

#include <concepts>

namespace crossbeam {

/// With a member `yarn_energy` like shear_energy the law has a potential, which the energy ledger
/// then reads; without one the ledger sums the yarns' work along the path. With a member `hessian`
/// it has a consistent tangent.
template <class Law, class T>
concept MembraneLaw = requires(const Law& law, const FibreStrain<T>& beta) {
  typename Law::Real;
  { law.reference() } -> std::convertible_to<FibreAngle<typename Law::Real>>;
  { law.evaluate(beta).fibres } -> std::convertible_to<FibreState<T>>;
  { law.stress(law.evaluate(beta)) } -> std::same_as<FibreStress<T>>;
  { law.shear_energy(law.evaluate(beta)) } -> std::same_as<T>;
  { law.yarn_tension(law.evaluate(beta)) } -> std::same_as<Vector2<T>>;
  { law.stiffness_bound() } -> std::convertible_to<typename Law::Real>;
};

}  // namespace crossbeam
