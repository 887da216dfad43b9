#pragma once
/// @file
/// The command line of the drape.

#include "case.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace crossbeam::drape {

struct Options {
  DrapeCase drape_case;       ///< the scene with the overrides of the command line, checked
  std::filesystem::path out;  ///< folder of the results
  bool quiet = false;         ///< no progress, no table
  std::string message;        ///< if not empty: print it and stop (--help, --version)
};

/// @param arguments without the program's name.
/// Throws InputError naming the option, its value, unit and range.
[[nodiscard]] Options parse_options(const std::vector<std::string>& arguments);

}  // namespace crossbeam::drape
