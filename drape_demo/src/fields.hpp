#pragma once
/// @file
/// The one list of the fields of a DrapeCase: name, unit and admissible range. Reading a scene
/// file, checking a case, overriding a field from the command line and writing summary.json all
/// walk over this list, so that none of them can forget a field.
///
/// A visitor has the members
///   enter(name), leave()                       a table begins, ends
///   real(name, value, unit, range)             a number
///   integer(name, value, unit, range)          a whole number
///   choice(name, value)                        an enumeration, by the names of names_of
///   flag(name, value)                          true or false
///   text(name, value)                          any text
///   list(name, value, unit)                    numbers

#include "case.hpp"

#include "crossbeam/dynamics/thread_team.hpp"

#include <array>
#include <limits>
#include <string>

namespace crossbeam::drape {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Admissible numbers: an interval with open or closed ends, or two single values.
struct Range {
  enum class Kind { closed, low_open, open, one_of_two, finite };
  Kind kind = Kind::closed;
  double low = -unbounded, high = unbounded;

  [[nodiscard]] constexpr bool contains(double value) const {
    switch (kind) {
      case Kind::closed: return value >= low && value <= high;
      case Kind::low_open: return value > low && value <= high;
      case Kind::open: return value > low && value < high;
      case Kind::one_of_two: return value == low || value == high;
      case Kind::finite: return true;
    }
    return false;
  }

  /// For instance "a number > 0 and <= 100", "0 or 45".
  [[nodiscard]] std::string text(bool whole = false) const;
};

constexpr Range at_least(double low) { return {Range::Kind::closed, low, unbounded}; }
constexpr Range above(double low) { return {Range::Kind::low_open, low, unbounded}; }
constexpr Range from_to(double low, double high) { return {Range::Kind::closed, low, high}; }
constexpr Range above_to(double low, double high) { return {Range::Kind::low_open, low, high}; }
constexpr Range between(double low, double high) { return {Range::Kind::open, low, high}; }
/// Any finite number here; the library knows what is admissible.
inline constexpr Range checked_by_the_library{Range::Kind::finite};
constexpr Range either(double a, double b) { return {Range::Kind::one_of_two, a, b}; }

template <class E>
struct NamedValue {
  E value;
  const char* name;
};

/// The names of an enumeration's values in scene files and on the command line.
/// @{
constexpr auto names_of(CellFormulation) {
  using E = CellFormulation;
  return std::array<NamedValue<E>, 2>{{{E::energy, "energy"}, {E::second_order, "second_order"}}};
}
constexpr auto names_of(ShearLawKind) {
  using E = ShearLawKind;
  return std::array<NamedValue<E>, 3>{
      {{E::constant, "constant"}, {E::polynomial, "polynomial"}, {E::tabulated, "tabulated"}}};
}
constexpr auto names_of(ShearMeasure) {
  using E = ShearMeasure;
  return std::array<NamedValue<E>, 2>{{{E::tensor, "tensor"}, {E::engineering, "engineering"}}};
}
constexpr auto names_of(Friction) {
  using E = Friction;
  return std::array<NamedValue<E>, 3>{
      {{E::elastic_stick, "elastic_stick"}, {E::viscous, "viscous"}, {E::smooth, "smooth"}}};
}
constexpr auto names_of(Precision) {
  using E = Precision;
  return std::array<NamedValue<E>, 2>{{{E::double_, "double"}, {E::float_, "float"}}};
}
constexpr auto names_of(CellSolve) {
  using E = CellSolve;
  return std::array<NamedValue<E>, 3>{
      {{E::follow, "follow"}, {E::converge, "converge"}, {E::sweeps, "sweeps"}}};
}
/// @}

template <class E>
[[nodiscard]] const char* name_of(E value) {
  for (const auto& named : names_of(E{}))
    if (named.value == value) return named.name;
  return "unknown";
}

/// Calls the visitor for every field; Case is DrapeCase or const DrapeCase.
template <class Case, class Visitor>
void visit_fields(Case& c, Visitor& v) {
  // The tools: blocks of 270 x 470 mm, 60 mm deep; closed, they leave 5/3 mm of normal play.
  constexpr double block_half_width = 135, block_half_length = 235, depth = 60, play = 5.0 / 3.0;

  v.text("name", c.name);
  v.text("description", c.description);

  v.enter("fabric");
  v.choice("formulation", c.fabric.formulation);
  v.choice("cell_solve", c.fabric.cell_solve);
  v.integer("cell_sweeps", c.fabric.cell_sweeps, "-", from_to(1, 20));
  v.real("warp_bending_stiffness", c.fabric.warp_bending_stiffness, "kN mm", from_to(0, 1));
  v.real("weft_bending_stiffness", c.fabric.weft_bending_stiffness, "kN mm", from_to(0, 1));
  v.real("areal_mass", c.fabric.areal_mass, "kg/mm^2", above_to(0, 1e-3));
  v.real("thickness", c.fabric.thickness, "mm", between(0, play));

  v.enter("cell");
  const auto yarn = [&v](auto& y, const char* name) {
    v.enter(name);
    v.real("youngs_modulus", y.youngs_modulus, "kN/mm^2", checked_by_the_library);
    v.real("cross_section", y.cross_section, "mm^2", checked_by_the_library);
    v.real("second_moment_of_area", y.second_moment_of_area, "mm^4", checked_by_the_library);
    v.real("length", y.length, "mm", checked_by_the_library);
    v.leave();
  };
  v.real("contact_modulus", c.fabric.cell.contact_modulus, "kN/mm^2", checked_by_the_library);
  v.real("contact_area", c.fabric.cell.contact_area, "mm^2", checked_by_the_library);
  v.real("contact_length", c.fabric.cell.contact_length, "mm", checked_by_the_library);
  v.real("warp_height_fraction", c.fabric.cell.warp_height_fraction, "-", checked_by_the_library);
  v.real("bending_boundary_factor", c.fabric.cell.bending_boundary_factor, "-",
         checked_by_the_library);
  v.real("residual_compression_stiffness", c.fabric.cell.residual_compression_stiffness, "kN/mm",
         checked_by_the_library);
  v.integer("symmetry", c.fabric.cell.symmetry, "-", checked_by_the_library);
  yarn(c.fabric.cell.warp, "warp");
  yarn(c.fabric.cell.weft, "weft");
  v.leave();

  v.enter("shear");
  v.choice("kind", c.fabric.shear.kind);
  v.real("modulus", c.fabric.shear.modulus, "kN/mm", at_least(0));
  v.choice("measure", c.fabric.shear.measure);
  v.list("coefficients", c.fabric.shear.coefficients, "kN/mm");
  v.list("angle", c.fabric.shear.angle, "rad");
  v.list("traction", c.fabric.shear.traction, "kN/mm");
  v.leave();
  v.leave();

  v.enter("blank");
  v.real("half_width", c.blank.half_width, "mm", above_to(0, block_half_width));
  v.real("half_length", c.blank.half_length, "mm", above_to(0, block_half_length));
  v.real("element_size", c.blank.element_size, "mm", from_to(0.1, 100));
  v.real("layout", c.blank.layout, "deg", either(0, 45));
  v.integer("gauss_points", c.blank.gauss_points, "-", either(1, 4));
  v.real("hourglass_stiffness", c.blank.hourglass_stiffness, "kN/mm", from_to(0, 1));
  v.real("perturbation", c.blank.perturbation, "mm", from_to(0, 10));
  v.integer("seed", c.blank.seed, "-", at_least(0));
  v.leave();

  v.enter("process");
  v.real("stroke", c.process.stroke, "mm", above_to(0, depth));
  v.real("speed", c.process.speed, "m/s", above_to(0, 100));
  v.real("hold", c.process.hold, "-", from_to(0, 10));
  v.real("holder_force", c.process.holder_force, "kN", from_to(0, 10));
  v.real("holder_ramp", c.process.holder_ramp, "-", above_to(0, 1));
  v.real("holder_mass", c.process.holder_mass, "kg", above_to(0, 100));
  v.real("holder_damping_ratio", c.process.holder_damping_ratio, "-", from_to(0, 2));
  v.leave();

  v.enter("contact");
  v.real("penalty", c.contact.penalty, "kN/mm^3", above_to(0, 10));
  v.real("damping_ratio", c.contact.damping_ratio, "-", from_to(0, 1));
  v.real("friction", c.contact.friction, "-", from_to(0, 1));
  v.choice("friction_model", c.contact.friction_model);
  v.real("viscous_slip", c.contact.viscous_slip, "-", above_to(0, 1));
  v.real("smoothing", c.contact.smoothing, "mm", from_to(0, 1));
  v.real("table_spacing", c.contact.table_spacing, "mm", from_to(0.05, 5));
  v.flag("culling", c.contact.culling);
  v.leave();

  v.enter("integration");
  v.real("step_factor", c.integration.step_factor, "-", above_to(0, 2));
  v.real("axial_scaling", c.integration.axial_scaling, "-", from_to(1, 100));
  v.real("mass_damping", c.integration.mass_damping, "1/ms", from_to(0, 10));
  v.real("bulk_viscosity", c.integration.bulk_viscosity, "-", from_to(0, 1));
  v.choice("precision", c.integration.precision);
  v.integer("threads", c.integration.threads, "-", from_to(1, ThreadTeam::most_threads));
  v.integer("step_limit", c.integration.step_limit, "-", from_to(1, 1e12));
  v.leave();

  v.enter("output");
  v.integer("frames", c.output.frames, "-", from_to(1, 10000));
  v.integer("ledger_samples", c.output.ledger_samples, "-", from_to(2, 1000000));
  v.leave();
}

/// Keeps the dotted name of the table a visitor is in: "fabric.cell.warp.".
class FieldPath {
 public:
  void enter(const char* name) { prefix_ += std::string(name) + '.'; }
  void leave() {
    prefix_.pop_back();
    const auto dot = prefix_.rfind('.');
    prefix_.erase(dot == std::string::npos ? 0 : dot + 1);
  }
  [[nodiscard]] std::string name(const std::string& field) const { return prefix_ + field; }

 private:
  std::string prefix_;
};

}  // namespace crossbeam::drape
