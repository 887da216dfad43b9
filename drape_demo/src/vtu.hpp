#pragma once
/// @file
/// Frames as VTK XML files for ParaView: one .vtu per frame, and a .pvd that lists them over time.

#include "result.hpp"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace crossbeam::drape {

/// UnstructuredGrid of quadrilaterals; fields as Float64, all arrays appended raw behind UInt64
/// lengths. A field of the wrong size is a contract violation; a failing file system throws
/// std::runtime_error.
void write_vtu(const std::filesystem::path& file, const std::vector<std::array<int, 4>>& quads,
               const Frame& frame);

struct FrameFile {
  double time = 0;   ///< [ms]
  std::string name;  ///< relative to the .pvd
};

void write_pvd(const std::filesystem::path& file, const std::vector<FrameFile>& frames);

}  // namespace crossbeam::drape
