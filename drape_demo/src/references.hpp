#pragma once
/// @file
/// The values that a double-dome run is compared with: drape_demo/scene/references.toml.

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace crossbeam::drape {

/// A value with its uncertainty, value +- band.
struct Banded {
  double value = 0, band = 0;
};

/// A pin-jointed net: kinematics only. Angles in deg, lengths in mm.
struct NetReference {
  std::string source;
  std::vector<double> x, y, shear_deg;  ///< points 1..10
  double maximum_shear_deg = 0, draw_in_x = 0, draw_in_y = 0;
  std::vector<std::array<double, 2>> long_edge, short_edge;  ///< formed free edges, (x, y)
};

/// A preceding study of the case "realistic".
struct StudyReference {
  std::string source;
  std::vector<Banded> shear_deg;      ///< points 1..8
  double slack_flange_shear_deg = 0;  ///< bound of the magnitude at points 9 and 10
  Banded maximum_shear_deg, draw_in_x, draw_in_y, shear_energy;  ///< energy in kN mm
  std::array<double, 2> maximum_shear_material{};
  std::array<Banded, 2> corner{};
};

/// A second, independent code on the case "realistic".
struct SecondCodeReference {
  std::string name, source;
  std::vector<double> shear_deg;  ///< points 1..8
  double draw_in_x = 0, draw_in_y = 0;
  std::array<double, 2> corner{};
};

struct References {
  NetReference net;
  StudyReference study;
  SecondCodeReference second_code;
};

/// Throws InputError when the file is missing, is no TOML, or lacks a value.
[[nodiscard]] References load_references(const std::filesystem::path& file);

/// The same from text; `source` stands for the file name in messages.
[[nodiscard]] References parse_references(std::string_view text, const std::string& source);

}  // namespace crossbeam::drape
