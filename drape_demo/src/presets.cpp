#include "presets.hpp"

#include "spelling.hpp"

#include "crossbeam/base/error.hpp"

#include <fmt/format.h>

#include <vector>

namespace crossbeam::drape {

std::string preset_names() {
  std::vector<std::string> names;
  for (const Preset& p : presets) names.emplace_back(p.name);
  return alternatives(names);
}

std::string preset_table() {
  std::string text;
  for (const Preset& p : presets)
    text += fmt::format(
        "  {:9} {:3g} mm, {:g} m/s, {:6} {}  positions {:.2f} %, shear rms {:.2f} deg (99 % of the "
        "area "
        "{:.1f}), outline {:.2f} mm; {:.2g} s\n",
        p.name, p.element_size, p.speed, p.precision == Precision::float_ ? "float" : "double",
        p.axial_scaling > 1 ? fmt::format("scaled {:g}", p.axial_scaling) : "         ",
        100 * p.error.position, p.error.shear_rms_deg, p.error.shear_quantile_deg,
        p.error.outline_mm, p.processor_s);
  return text;
}

void apply_preset(DrapeCase& drape_case, const std::string& name) {
  for (const Preset& p : presets) {
    if (name != p.name) continue;
    drape_case.preset = name;
    drape_case.blank.element_size = p.element_size;
    drape_case.process.speed = p.speed;
    drape_case.integration.precision = p.precision;
    drape_case.integration.axial_scaling = p.axial_scaling;
    if (p.penalty) drape_case.contact.penalty = *p.penalty;
    return;
  }
  throw InputError("--preset", name, "", preset_names());
}

const Preset* preset_of(const DrapeCase& drape_case) {
  for (const Preset& p : presets)
    if (drape_case.preset == p.name && drape_case.blank.element_size == p.element_size &&
        drape_case.process.speed == p.speed && drape_case.integration.precision == p.precision &&
        drape_case.integration.axial_scaling == p.axial_scaling &&
        (!p.penalty || drape_case.contact.penalty == *p.penalty))
      return &p;
  return nullptr;
}

}  // namespace crossbeam::drape
