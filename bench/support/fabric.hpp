#pragma once
/// @file
/// The one fabric that every benchmark here runs: the paper's Table 1 with the picture-frame shear
/// curve of the scene `realistic`, and the paper's constant shear modulus beside it.

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/cell/second_order.hpp"
#include "crossbeam/law/shear.hpp"
#include "crossbeam/law/woven_membrane.hpp"

namespace bench {

inline constexpr double areal_mass = 0.743e-6;       ///< [kg/mm^2]
inline constexpr double bending_stiffness = 1.4e-3;  ///< warp and weft [kN mm]
inline constexpr double hourglass_modulus = 1e-4;    ///< [kN/mm]
inline constexpr double bulk_viscosity = 0.06;       ///< [-]
inline constexpr double shear_modulus = 0.001;       ///< G12 of Eq. 26 [kN/mm]

/// Table 1.
template <class R>
crossbeam::CellParameters<R> cell_parameters() {
  return crossbeam::CellParameters<double>{}.cast<R>();
}

template <class R>
crossbeam::ConstantShear<R> constant_shear() {
  return crossbeam::ConstantShear<R>(R(shear_modulus));
}

/// G(|gamma|) of the scene `realistic` [kN/mm].
template <class R>
crossbeam::PolynomialShear<R> measured_shear() {
  return crossbeam::PolynomialShear<R>(crossbeam::PolynomialCurve<R>(
      {R(0.051e-3), R(-0.83e-3), R(6.1275e-3), R(-12.0972e-3), R(8.48e-3)}));
}

template <class Cell, class Shear>
crossbeam::WovenMembrane<Cell, Shear> membrane(const Cell& cell, const Shear& shear,
                                               crossbeam::SolverControl control) {
  using R = typename Cell::Real;
  return {cell, shear, crossbeam::FibreAngle<R>::right(), crossbeam::YarnWidth::corrected, control};
}

}  // namespace bench
