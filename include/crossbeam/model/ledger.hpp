#pragma once
/// @file
/// The energy ledger of an explicit run: every force's work is booked once. Theory:
/// docs/theory/dynamics.md, [D-4].

#include "crossbeam/model/force_block.hpp"

#include <cmath>

namespace crossbeam {

/// Energies and works at one instant t_n [kN mm]. Stored energies come from the energy functions,
/// not from summed work: the residual therefore sees a force that is not the gradient of its
/// energy.
struct EnergyLedger {
  double time = 0;            ///< [ms]
  InternalEnergy internal{};  ///< yarn, shear, bending, hourglass; bulk viscosity's share
  double contact = 0;         ///< stored in the penalties
  double kinetic = 0;         ///< nodes and free tools
  double friction = 0, contact_damping = 0, mass_damping = 0;
  double external = 0;  ///< work of prescribed tools and of forces on free tools
  double initial = 0;   ///< total energy at the start

  /// What was put in minus what is accounted for.
  [[nodiscard]] double residual() const {
    return external + initial - internal.stored() - internal.bulk_viscosity - contact - kinetic -
           friction - contact_damping - mass_damping;
  }
};

}  // namespace crossbeam
