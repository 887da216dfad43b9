#pragma once
/// @file
/// The numbers of a run as files: summary.json, shear_points.csv, outline.csv, energy.csv, and the
/// frames for ParaView.

#include "case.hpp"
#include "references.hpp"
#include "result.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

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

/// Writes everything; summary.json last. Throws std::runtime_error naming file and reason, and
/// Interrupted.
void write_result(const std::filesystem::path& folder, const DrapeCase& drape_case,
                  const DrapeResult& result, const References& references);

}  // namespace crossbeam::drape
