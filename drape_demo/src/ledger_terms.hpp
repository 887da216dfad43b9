#pragma once
/// @file
/// The terms of the energy ledger with their names, in the order in which they are shown.

#include "result.hpp"

#include <array>

namespace crossbeam::drape {

enum class LedgerKind { supplied, stored, dissipated };

struct LedgerTerm {
  const char* name;          ///< in files
  const char* label;         ///< for people
  double LedgerRow::*value;  ///< [kN mm]
  LedgerKind kind;
};

/// Supplied = stored + dissipated + residual.
inline constexpr std::array<LedgerTerm, 12> ledger_terms{{
    {"punch_work", "punch", &LedgerRow::punch_work, LedgerKind::supplied},
    {"holder_work", "holder", &LedgerRow::holder_work, LedgerKind::supplied},
    {"yarn", "yarns", &LedgerRow::yarn, LedgerKind::stored},
    {"shear", "shear", &LedgerRow::shear, LedgerKind::stored},
    {"bending", "bending", &LedgerRow::bending, LedgerKind::stored},
    {"hourglass", "hourglass", &LedgerRow::hourglass, LedgerKind::stored},
    {"contact", "contact", &LedgerRow::contact, LedgerKind::stored},
    {"kinetic", "kinetic", &LedgerRow::kinetic, LedgerKind::stored},
    {"friction", "friction", &LedgerRow::friction, LedgerKind::dissipated},
    {"contact_damping", "contact damping", &LedgerRow::contact_damping, LedgerKind::dissipated},
    {"mass_damping", "mass damping", &LedgerRow::mass_damping, LedgerKind::dissipated},
    {"bulk_viscosity", "bulk viscosity", &LedgerRow::bulk_viscosity, LedgerKind::dissipated},
}};

}  // namespace crossbeam::drape
