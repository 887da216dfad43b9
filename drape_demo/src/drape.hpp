#pragma once
/// @file
/// The explicit double-dome drape: from a case to its result.

#include "case.hpp"
#include "progress.hpp"
#include "result.hpp"

namespace crossbeam::drape {

/// Runs a case to its end.
/// @throws InputError for a field out of range; RunError when an element, the cell or the energy
///   ledger goes wrong on the way.
DrapeResult run(const DrapeCase& drape_case, const Progress& progress);

}  // namespace crossbeam::drape
