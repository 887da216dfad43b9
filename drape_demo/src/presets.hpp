#pragma once
/// @file
/// Settings of the drape that are worth their time, with the error that was measured for each.

#include "case.hpp"

#include <array>
#include <string>

namespace crossbeam::drape {

struct Preset {
  const char* name;
  double element_size;  ///< [mm]
  double speed;         ///< mean punch speed [m/s]
  Precision precision;
  /// Of the scene `realistic` at the end, against 2.5 mm, 0.5 m/s in double: what 2.5 mm are
  /// themselves away from finer meshes is not in it. Measured by `./run bench precision`,
  /// 2026-11-26.
  struct Error {
    double position;            ///< L2 norm over that of the displacement [-]
    double shear_rms_deg;       ///< over the area [deg]
    double shear_quantile_deg;  ///< 99 % of the area is below [deg]
    double outline_mm;          ///< largest distance [mm]
  } error;
  double processor_s;  ///< of one core of an AMD EPYC, beside another run [s]
};

inline constexpr std::array<Preset, 3> presets{{
    {"fast", 5, 4, Precision::float_, {1.84e-2, 1.12, 3.38, 1.11}, 1.7},
    {"standard", 5, 1, Precision::float_, {2.3e-3, 0.13, 0.41, 0.13}, 6.9},
    {"accurate", 2.5, 1, Precision::double_, {6.8e-4, 0.052, 0.16, 0.047}, 99},
}};

/// "fast, standard or accurate"
[[nodiscard]] std::string preset_names();
/// Every preset with its settings, error and cost: for the help.
[[nodiscard]] std::string preset_table();

/// Sets mesh, speed and arithmetic of a case.
/// @throws InputError for a name that is none
void apply_preset(DrapeCase& drape_case, const std::string& name);

/// The preset that the case was given, if its settings are still the preset's; else nullptr.
[[nodiscard]] const Preset* preset_of(const DrapeCase& drape_case);

}  // namespace crossbeam::drape
