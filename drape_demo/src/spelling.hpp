#pragma once
/// @file
/// Helpers for messages about what a user has written.

#include <string>
#include <string_view>
#include <vector>

namespace crossbeam::drape {

/// The name nearest to `wrong` by edits of single letters, or "" when none is near.
[[nodiscard]] std::string nearest_name(std::string_view wrong,
                                       const std::vector<std::string>& names);

/// The text with control characters of ASCII and Latin-1 spelled out, \x1b for instance: what a
/// file or a command line says must not steer the terminal.
/// @param ends_of_line whether they stay
[[nodiscard]] std::string printable(std::string_view text, bool ends_of_line = false);

/// "a, b or c".
[[nodiscard]] std::string alternatives(const std::vector<std::string>& names);

}  // namespace crossbeam::drape
