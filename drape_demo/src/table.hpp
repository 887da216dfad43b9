#pragma once
/// @file
/// The table on the terminal at the end of a run.

#include "case.hpp"
#include "references.hpp"
#include "result.hpp"

#include <string>

namespace crossbeam::drape {

/// At most 100 columns and about 40 lines of ASCII.
[[nodiscard]] std::string result_table(const DrapeCase& drape_case, const DrapeResult& result,
                                       const References& references);

}  // namespace crossbeam::drape
