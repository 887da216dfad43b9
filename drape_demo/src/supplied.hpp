#pragma once
/// @file
/// The scene files and references of the folder drape_demo/scene, compiled in: a program that was
/// moved elsewhere needs no folder.

#include "references.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace crossbeam::drape {

struct SuppliedFile {
  std::string_view name;  ///< without a folder
  std::string_view text;
};

/// supplied_files.cpp, written by CMake.
[[nodiscard]] const std::vector<SuppliedFile>& supplied_files();

/// Throws InputError for a name that is none.
[[nodiscard]] std::string_view supplied_text(std::string_view name);

[[nodiscard]] References supplied_references();

}  // namespace crossbeam::drape
