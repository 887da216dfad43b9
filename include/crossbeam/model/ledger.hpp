#pragma once
/// @file
/// The energy ledger: what was put into a model, what it stores and what was dissipated, term by
/// term. Every force books its own terms, so that a force of one's own counts like any other.
/// Theory: docs/theory/dynamics.md, [D-4].

#include "crossbeam/base/error.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace crossbeam {

/// What a term of the ledger does in the balance supplied = stored + dissipated + residual.
enum class EnergyKind { supplied, stored, dissipated };

[[nodiscard]] inline std::string_view to_string(EnergyKind kind) {
  switch (kind) {
    case EnergyKind::supplied: return "supplied";
    case EnergyKind::stored: return "stored";
    case EnergyKind::dissipated: return "dissipated";
  }
  return "";
}

struct LedgerTerm {
  std::string name;
  EnergyKind kind;
  double value;  ///< [kN mm]
};

/// Energies and works at one instant t_n. Stored energies come from the energy functions, not from
/// summed work: the residual therefore sees a force that is not the gradient of its energy.
///
/// crossbeam's own terms: stored are "yarn", "shear", "bending", "hourglass", "contact" and
/// "kinetic" (nodes and free tools); dissipated are "bulk_viscosity", "friction",
/// "contact_damping" and "mass_damping"; supplied are "tools" (work of prescribed tools and of the
/// forces on free ones) and "initial" (all that was stored at the start). A term is there when a
/// part of the model can have it.
class EnergyLedger {
 public:
  double time = 0;  ///< [ms]

  /// Adds to the term of that name, which is begun where there is none.
  /// @throws InputError where a term of that name is of another kind
  void add(std::string_view name, EnergyKind kind, double value) {
    for (LedgerTerm& term : terms_)
      if (term.name == name) {
        if (term.kind != kind)
          throw InputError(
              "ledger term '" + term.name + "'", std::string(to_string(kind)), "",
              "of the kind that it was begun with, " + std::string(to_string(term.kind)));
        term.value += value;
        return;
      }
    terms_.push_back({std::string(name), kind, value});
  }

  /// @throws InputError where there is no term of that name, with the names that there are
  [[nodiscard]] double value(std::string_view name) const {
    for (const LedgerTerm& term : terms_)
      if (term.name == name) return term.value;
    std::string names;
    for (const LedgerTerm& term : terms_) names += (names.empty() ? "" : ", ") + term.name;
    throw InputError("ledger term", std::string(name), "", "one of " + names);
  }
  [[nodiscard]] bool has(std::string_view name) const {
    for (const LedgerTerm& term : terms_)
      if (term.name == name) return true;
    return false;
  }

  [[nodiscard]] double total(EnergyKind kind) const {
    double sum = 0;
    for (const LedgerTerm& term : terms_)
      if (term.kind == kind) sum += term.value;
    return sum;
  }
  [[nodiscard]] double stored() const { return total(EnergyKind::stored); }

  /// What was put in minus what is accounted for.
  [[nodiscard]] double residual() const {
    return total(EnergyKind::supplied) - stored() - total(EnergyKind::dissipated);
  }

  [[nodiscard]] const std::vector<LedgerTerm>& terms() const { return terms_; }

 private:
  std::vector<LedgerTerm> terms_;
};

}  // namespace crossbeam
