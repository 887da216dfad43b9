#pragma once
/// @file
/// The numbers of a run as files: summary.json, shear_points.csv, outline.csv, energy.csv, and the
/// frames for ParaView.

#include "case.hpp"
#include "references.hpp"
#include "result.hpp"
#include "vtu.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace crossbeam::drape {

/// summary.json carries this under "program"; it marks a folder as a result of this program.
inline constexpr const char* summary_program = "crossbeam drape";

/// All parameters of the case, by the names of the scene files.
[[nodiscard]] nlohmann::ordered_json case_json(const DrapeCase& drape_case);

[[nodiscard]] nlohmann::ordered_json summary_json(const DrapeCase& drape_case,
                                                  const DrapeResult& result,
                                                  const References& references);

[[nodiscard]] std::string shear_points_csv(const DrapeResult& result);
[[nodiscard]] std::string outline_csv(const DrapeResult& result);
[[nodiscard]] std::string energy_csv(const DrapeResult& result);

/// Writes frames into a folder as they come, and keeps none of them: a FrameSink.
class FrameWriter {
 public:
  explicit FrameWriter(const std::filesystem::path& folder);

  /// Throws std::runtime_error naming file and reason.
  void write(const std::vector<std::array<int, 4>>& quads, const Frame& frame);

  /// Names and times of the frames, for write_result.
  [[nodiscard]] const std::vector<FrameFile>& files() const { return files_; }

 private:
  std::filesystem::path folder_;
  std::vector<FrameFile> files_;
};

/// Writes everything but the frames; summary.json last. Throws std::runtime_error naming file and
/// reason.
void write_result(const std::filesystem::path& folder, const DrapeCase& drape_case,
                  const DrapeResult& result, const std::vector<FrameFile>& frames,
                  const References& references);

}  // namespace crossbeam::drape
