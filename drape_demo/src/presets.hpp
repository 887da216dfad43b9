#pragma once
/// @file
/// Settings of the drape that are worth their time, with the error that was measured for each.

#include "case.hpp"

#include <array>
#include <optional>
#include <string>

namespace crossbeam::drape {

struct Preset {
  const char* name;
  double element_size;  ///< [mm]
  double speed;         ///< mean punch speed [m/s]
  Precision precision;
  double axial_scaling;  ///< of the yarns [-]
  /// Of the contacts, which else limits the longer step [kN/mm^3]; the scene's without one.
  std::optional<double> penalty;
  /// Of the scene `realistic` at the end, against 2.5 mm, 0.5 m/s in double: what 2.5 mm are
  /// themselves away from finer meshes is not in it. Measured by `./run bench precision`,
  /// 2026-11-28.
  struct Error {
    double position;            ///< L2 norm over that of the displacement [-]
    double shear_rms_deg;       ///< over the area [deg]
    double shear_quantile_deg;  ///< 99 % of the area is below [deg]
    double outline_mm;          ///< largest distance [mm]
  } error;
  double processor_s;  ///< of one core of a Xeon with AVX-512, beside another run [s]
};

inline constexpr std::array<Preset, 3> presets{{
    {"fast", 5, 2, Precision::float_, 25, 0.005, {4.5e-3, 0.32, 0.89, 0.30}, 0.34},
    {"standard", 5, 1, Precision::float_, 1, {}, {2.4e-3, 0.13, 0.44, 0.13}, 3.4},
    {"accurate", 2.5, 1, Precision::double_, 1, {}, {6.8e-4, 0.052, 0.16, 0.047}, 37},
}};

/// "fast, standard or accurate"
[[nodiscard]] std::string preset_names();
/// Every preset with its settings, error and cost: for the help.
[[nodiscard]] std::string preset_table();

/// Sets mesh, speed, arithmetic and axial scaling of a case.
/// @throws InputError for a name that is none
void apply_preset(DrapeCase& drape_case, const std::string& name);

/// The preset that the case was given, if its settings are still the preset's; else nullptr.
[[nodiscard]] const Preset* preset_of(const DrapeCase& drape_case);

}  // namespace crossbeam::drape
