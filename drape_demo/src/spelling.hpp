#pragma once
/// @file
/// Helpers for messages about misspelt names.

#include <string>
#include <string_view>
#include <vector>

namespace crossbeam::drape {

/// The name nearest to `wrong` by edits of single letters, or "" when none is near.
[[nodiscard]] std::string nearest_name(std::string_view wrong,
                                       const std::vector<std::string>& names);

/// "a, b or c".
[[nodiscard]] std::string alternatives(const std::vector<std::string>& names);

}  // namespace crossbeam::drape
