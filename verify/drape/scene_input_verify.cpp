// Scenes and command line: what is admissible is read as written, everything else is refused with
// the name of the field, the value, the place and what would be admissible.

#include "options.hpp"
#include "presets.hpp"
#include "references.hpp"
#include "scene.hpp"
#include "spelling.hpp"

#include "crossbeam/base/error.hpp"

#include "drape/scratch_folder.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace {

using namespace crossbeam::drape;
using crossbeam::InputError;

/// The text of the InputError that `action` throws; fails the test when it throws none.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  FAIL_CHECK("no InputError");
  return "";
}

std::string scene_refusal(const std::string& text) {
  return refusal([&text] { static_cast<void>(parse_scene(text, "some/scene.toml")); });
}

std::string options_refusal(const std::vector<std::string>& arguments) {
  return refusal([&arguments] { static_cast<void>(parse_options(arguments)); });
}

void check_contains(const std::string& text, const std::vector<std::string>& parts) {
  for (const auto& part : parts)
    CHECK_MESSAGE(text.find(part) != std::string::npos, "\"", text, "\" lacks \"", part, "\"");
}

/// The smallest admissible scene: the default shear law needs its coefficients.
const std::string base = "fabric.shear.coefficients = [1e-3]\n";

struct OutOfRange {
  std::string field, value, unit, admissible;
};

/// One line per end of every range, written from the field's meaning: lengths, masses and moduli
/// are positive, shares lie in 0..1, and so on.
const std::vector<OutOfRange>& out_of_range() {
  static const std::vector<OutOfRange> cases{
      {"fabric.formulation", "'linear'", "", "energy or second_order"},
      {"fabric.cell_solve", "'newton'", "", "follow, converge or sweeps"},
      {"fabric.cell_sweeps", "0", "", ">= 1"},
      {"fabric.cell_sweeps", "21", "", "<= 20"},
      {"fabric.warp_bending_stiffness", "-1e-9", "kN mm", ">= 0"},
      {"fabric.warp_bending_stiffness", "1.5", "kN mm", "<= 1"},
      {"fabric.weft_bending_stiffness", "-1e-9", "kN mm", ">= 0"},
      {"fabric.areal_mass", "0.0", "kg/mm^2", "> 0"},
      {"fabric.areal_mass", "0.743", "kg/mm^2", "<= 0.001"},
      {"fabric.thickness", "0.0", "mm", "> 0"},
      {"fabric.thickness", "1.7", "mm", "< 1.66667"},
      {"fabric.cell.contact_modulus", "0.0", "kN/mm^2", "> 0"},
      {"fabric.cell.contact_area", "-17.6", "mm^2", "> 0"},
      {"fabric.cell.contact_length", "0.0", "mm", "> 0"},
      {"fabric.cell.warp_height_fraction", "0.0", "", "strictly between 0 and 1"},
      {"fabric.cell.warp_height_fraction", "1.0", "", "strictly between 0 and 1"},
      {"fabric.cell.bending_boundary_factor", "0.0", "", "> 0"},
      {"fabric.cell.residual_compression_stiffness", "-1.0", "kN/mm", ">= 0"},
      {"fabric.cell.symmetry", "3", "", "1 or 2"},
      {"fabric.cell.warp.youngs_modulus", "-35.4", "kN/mm^2", "> 0"},
      {"fabric.cell.warp.cross_section", "0.0", "mm^2", "> 0"},
      {"fabric.cell.warp.second_moment_of_area", "-1e-4", "mm^4", ">= 0"},
      {"fabric.cell.warp.length", "0.0", "mm", "> 0"},
      {"fabric.cell.weft.youngs_modulus", "-35.4", "kN/mm^2", "> 0"},
      {"fabric.cell.weft.cross_section", "0.0", "mm^2", "> 0"},
      {"fabric.cell.weft.second_moment_of_area", "-1e-4", "mm^4", ">= 0"},
      {"fabric.cell.weft.length", "0.0", "mm", "> 0"},
      {"fabric.shear.kind", "'cubic'", "", "constant, polynomial or tabulated"},
      {"fabric.shear.modulus", "-0.001", "kN/mm", ">= 0"},
      {"fabric.shear.measure", "'true'", "", "tensor or engineering"},
      {"fabric.shear.coefficients", "[]", "", "1 to 8 numbers"},
      {"fabric.shear.coefficients", "[1.0, inf]", "kN/mm", "finite"},
      {"fabric.shear.angle", "[0.0, nan]", "rad", "finite"},
      {"fabric.shear.traction", "[0.0, nan]", "kN/mm", "finite"},
      {"blank.half_width", "0.0", "mm", "> 0"},
      {"blank.half_width", "136.0", "mm", "<= 135"},
      {"blank.half_length", "0.0", "mm", "> 0"},
      {"blank.half_length", "236.0", "mm", "<= 235"},
      {"blank.element_size", "0.0", "mm", ">= 0.1"},
      {"blank.element_size", "101.0", "mm", "<= 100"},
      {"blank.layout", "30.0", "deg", "0 or 45"},
      {"blank.gauss_points", "2", "", "1 or 4"},
      {"blank.hourglass_stiffness", "-1e-4", "kN/mm", ">= 0"},
      {"blank.hourglass_stiffness", "2.0", "kN/mm", "<= 1"},
      {"blank.perturbation", "-1e-9", "mm", ">= 0"},
      {"blank.perturbation", "11.0", "mm", "<= 10"},
      {"blank.seed", "-1", "", ">= 0"},
      {"process.stroke", "0.0", "mm", "> 0"},
      {"process.stroke", "61.0", "mm", "<= 60"},
      {"process.speed", "0.0", "m/s", "> 0"},
      {"process.speed", "101.0", "m/s", "<= 100"},
      {"process.hold", "-0.1", "", ">= 0"},
      {"process.hold", "11.0", "", "<= 10"},
      {"process.holder_force", "-0.1", "kN", ">= 0"},
      {"process.holder_force", "100.0", "kN", "<= 10"},
      {"process.holder_ramp", "0.0", "", "> 0"},
      {"process.holder_ramp", "1.1", "", "<= 1"},
      {"process.holder_mass", "0.0", "kg", "> 0"},
      {"process.holder_mass", "101.0", "kg", "<= 100"},
      {"process.holder_damping_ratio", "-0.1", "", ">= 0"},
      {"process.holder_damping_ratio", "2.1", "", "<= 2"},
      {"contact.penalty", "0.0", "kN/mm^3", "> 0"},
      {"contact.penalty", "11.0", "kN/mm^3", "<= 10"},
      {"contact.damping_ratio", "-0.1", "", ">= 0"},
      {"contact.damping_ratio", "1.1", "", "<= 1"},
      {"contact.friction", "-0.1", "", ">= 0"},
      {"contact.friction", "1.1", "", "<= 1"},
      {"contact.friction_model", "'dry'", "", "elastic_stick, viscous or smooth"},
      {"contact.viscous_slip", "0.0", "", "> 0"},
      {"contact.viscous_slip", "1.1", "", "<= 1"},
      {"contact.smoothing", "-0.1", "mm", ">= 0"},
      {"contact.smoothing", "1.1", "mm", "<= 1"},
      {"contact.table_spacing", "0.0", "mm", ">= 0.05"},
      {"contact.table_spacing", "6.0", "mm", "<= 5"},
      {"integration.step_factor", "0.0", "", "> 0"},
      {"integration.step_factor", "2.1", "", "<= 2"},
      {"integration.axial_scaling", "0.5", "", ">= 1"},
      {"integration.axial_scaling", "101.0", "", "<= 100"},
      {"integration.mass_damping", "-0.1", "1/ms", ">= 0"},
      {"integration.mass_damping", "11.0", "1/ms", "<= 10"},
      {"integration.bulk_viscosity", "-0.1", "", ">= 0"},
      {"integration.bulk_viscosity", "1.1", "", "<= 1"},
      {"integration.precision", "'half'", "", "double or float"},
      {"integration.threads", "0", "", ">= 1"},
      {"integration.threads", "257", "", "<= 256"},
      {"integration.step_limit", "0", "", ">= 1"},
      {"integration.step_limit", "2000000000000", "", "<= 1000000000000"},
      {"output.frames", "0", "", ">= 1"},
      {"output.frames", "10001", "", "<= 10000"},
      {"output.ledger_samples", "1", "", ">= 2"},
      {"output.ledger_samples", "1000001", "", "<= 1000000"},
  };
  return cases;
}

}  // namespace

TEST_SUITE_BEGIN("drape");

TEST_CASE("V-IO-01 an unknown key is refused by name, file and line, with the nearest key") {
  check_contains(scene_refusal(base + "\n[process]\nsped = 2.0\n"),
                 {"process.sped = 2", "some/scene.toml:4", "\"speed\"", "holder_force"});
  check_contains(scene_refusal(base + "[fabrik]\nlength = 1\n"),
                 {"fabrik", "some/scene.toml:2", "\"fabric\"", "integration"});
  check_contains(scene_refusal(base + "fabric.cell.warp.lenght = 2.5\n"),
                 {"fabric.cell.warp.lenght = 2.5", "some/scene.toml:2", "\"length\""});
  // A key of another table is unknown here.
  check_contains(scene_refusal(base + "[blank]\nspeed = 2.0\n"),
                 {"blank.speed", "some/scene.toml:3"});
}

TEST_CASE("V-IO-01 a text that is no TOML is refused by file and line") {
  check_contains(scene_refusal("name = \"a\"\n\nblank = [1,\n"), {"some/scene.toml:3", "TOML"});
  check_contains(scene_refusal("name = \"a\"\nname = \"b\"\n"), {"some/scene.toml:2", "TOML"});
}

TEST_CASE("V-IO-02 a value of the wrong type is refused for every field, by name, file and line") {
  const auto fields = field_names();
  REQUIRE(fields.size() > 50);
  for (const auto& field : fields) {
    CAPTURE(field);
    // No field is a date.
    check_contains(scene_refusal("# first line\n" + field + " = 1979-05-27\n"),
                   {field + " = 1979-05-27", "some/scene.toml:2", "is not admissible: "});
  }
  for (const std::string table : {"fabric", "fabric.cell", "fabric.cell.warp", "process"})
    check_contains(scene_refusal(table + " = 3\n"), {table + " = 3", "some/scene.toml:1", "table"});
  check_contains(scene_refusal("output.frames = 2.5\n"), {"output.frames = 2.5", "whole number"});
  check_contains(scene_refusal("output.frames = 99999999999\n"), {"output.frames = 99999999999"});
  check_contains(scene_refusal("contact.culling = 1\n"), {"contact.culling = 1", "true or false"});
}

TEST_CASE("V-IO-03 every field out of its range is refused by name, value, unit, range and line") {
  std::set<std::string> covered{"name", "description", "contact.culling"};  // without a range
  for (const auto& bad : out_of_range()) {
    CAPTURE(bad.field);
    CAPTURE(bad.value);
    covered.insert(bad.field);
    const bool shear = bad.field == "fabric.shear.coefficients";
    const bool sweeps = bad.field == "fabric.cell_sweeps";
    const std::string first = shear ? "\n" : sweeps ? "fabric.cell_solve = 'sweeps'\n" : base;
    std::string message = scene_refusal(first + bad.field + " = " + bad.value);
    check_contains(message, {bad.field, "is not admissible", bad.admissible, "some/scene.toml:2"});
    if (!bad.unit.empty()) check_contains(message, {"[" + bad.unit + "]"});
  }
  for (const auto& field : field_names()) CHECK_MESSAGE(covered.count(field) == 1, field);
}

TEST_CASE("V-IO-03 NaN and infinity are refused in every field that is a number") {
  int numbers = 0;
  for (const auto& field : field_names()) {
    DrapeCase drape_case = parse_scene(base, "base");
    CAPTURE(field);
    bool takes_nan = true;
    try {
      set_field(drape_case, field, "nan", field);
    } catch (const InputError&) {
      takes_nan = false;  // whole numbers and names refuse it at once
    }
    if (!takes_nan || field == "name" || field == "description") continue;
    ++numbers;
    for (const std::string value : {"nan", "inf", "-inf"}) {
      set_field(drape_case, field, value, field);
      const std::string message = refusal([&] { validate(drape_case); });
      check_contains(message, {field, value});
    }
  }
  CHECK(numbers >= 40);
}

TEST_CASE("V-IO-03 a name is that of a folder: it leads nowhere else and steers no terminal") {
  for (const std::string bad :
       {"'../../esc'", "'..'", "'a/b'", "'.hidden'", "' '", "'-rf'",
        R"("two\nlines <&>\u001b[31mred")", R"("a\u0000b")", R"("\u009b31m")", R"("tab\t")"}) {
    CAPTURE(bad);
    const std::string message = scene_refusal("# a scene\nname = " + bad + "\n");
    check_contains(message, {"name = ", "is not admissible", "some/scene.toml:2"});
    CHECK(std::all_of(message.begin(), message.end(),
                      [](char c) { return static_cast<unsigned char>(c) >= 0x20; }));
  }
  check_contains(scene_refusal("name = '" + std::string(101, 'a') + "'\n"), {"at most 100"});
  for (const std::string good : {"", "a", "realistic", "paper-literal", "My fabric (2.5 mm), v1+"})
    CHECK(parse_scene("name = '" + good + "'\n", "x").name == good);
  // Whatever a file says is spelled out.
  check_contains(scene_refusal("description = \"\\u001b[2J\"\n"), {"description = \\x1b[2J"});
  check_contains(scene_refusal("\"\\u001b[31m\" = 1\n"), {"\\x1b[31m = 1", "some/scene.toml:1"});
  check_contains(scene_refusal("fabric.shear.kind = \"\\u0000cubic\"\n"), {"\\u0000cubic"});
  CHECK(printable("a\x1b\n\xc2\x9b\xc3\xa4", true) == "a\\x1b\n\\x9b\xc3\xa4");
}

TEST_CASE("V-IO-03 the number of sweeps belongs to cell_solve = \"sweeps\"") {
  for (const std::string old : {"0", "3"}) {
    const std::string message = scene_refusal(base + "fabric.cell_sweeps = " + old + "\n");
    check_contains(message, {"fabric.cell_sweeps = " + old, "fabric.cell_solve", "\"follow\"",
                             "\"sweeps\"", "some/scene.toml:2"});
  }
  const DrapeCase swept =
      parse_scene(base + "fabric.cell_solve = 'sweeps'\nfabric.cell_sweeps = 5\n", "x");
  CHECK(swept.fabric.cell_solve == CellSolve::sweeps);
  CHECK(swept.fabric.cell_sweeps == 5);
  CHECK(parse_scene(base, "x").fabric.cell_solve == CellSolve::follow);
  CHECK(parse_scene("fabric.cell_solve = 'converge'\n", "x").fabric.cell_solve ==
        CellSolve::converge);
}

TEST_CASE("V-IO-04 rules between fields are checked") {
  SUBCASE("a polynomial shear modulus must not fall below zero up to 1.2 rad") {
    check_contains(scene_refusal("[fabric.shear]\ncoefficients = [1.0, -0.9]\n"),
                   {"fabric.shear.coefficients", "kN/mm", "1.2 rad", "some/scene.toml:2"});
    // Zero at 1.25 rad only.
    CHECK_NOTHROW(parse_scene("[fabric.shear]\ncoefficients = [1.0, -0.8]\n", "x"));
    // A dip between two ends that are fine: (g - 0.6)^2 - 0.0001.
    check_contains(scene_refusal("[fabric.shear]\ncoefficients = [0.3599, -1.2, 1.0]\n"),
                   {"fabric.shear.coefficients"});
  }
  SUBCASE("a shear table starts at (0, 0) and rises") {
    const auto table = [](const std::string& angle, const std::string& traction) {
      return "[fabric.shear]\nkind = \"tabulated\"\nangle = " + angle + "\ntraction = " + traction;
    };
    CHECK_NOTHROW(parse_scene(table("[0, 0.5, 1.0]", "[0, 1e-4, 3e-4]"), "x"));
    check_contains(scene_refusal(table("[0]", "[0]")), {"fabric.shear.angle", "2 or more"});
    check_contains(scene_refusal(table("[0, 1]", "[0, 1, 2]")),
                   {"fabric.shear.traction", "2 / 3 numbers", "some/scene.toml:3"});
    check_contains(scene_refusal(table("[0.1, 1]", "[0, 1]")),
                   {"fabric.shear.angle[0]", "some/scene.toml:3"});
    check_contains(scene_refusal(table("[0, 1]", "[0.1, 1]")),
                   {"fabric.shear.traction[0]", "0, 0"});
    check_contains(
        scene_refusal(table("[0, 1, 1]", "[0, 1, 2]")),
        {"fabric.shear.angle[2] - fabric.shear.angle[1] = 0 [rad]", "some/scene.toml:3"});
    check_contains(scene_refusal(table("[0, 0.5, 1]", "[0, 2, 1]")),
                   {"slope of fabric.shear.traction before point 2", "some/scene.toml:4"});
    check_contains(scene_refusal(table("[0, 1.6]", "[0, 1]")), {"fabric.shear.angle[1] = 1.6"});
  }
  SUBCASE("an element is at most half the blank, a perturbation a tenth of an element") {
    check_contains(scene_refusal(base + "blank.element_size = 68\n"),
                   {"blank.element_size = 68 [mm]", "67.5", "some/scene.toml:2"});
    check_contains(scene_refusal(base + "blank.perturbation = 0.6\n"),
                   {"blank.perturbation = 0.6 [mm]", "0.5", "some/scene.toml:2"});
  }
}

TEST_CASE("V-IO-05 the supplied scenes hold the documented values") {
  const DrapeCase realistic = load_scene(scene_path("realistic"));
  const DrapeCase paper = load_scene(scene_path("paper"));
  const DrapeCase literal = load_scene(scene_path("paper-literal"));

  for (const auto* c : {&realistic, &paper, &literal}) {
    CAPTURE(c->name);
    const auto& cell = c->fabric.cell;
    for (const auto* yarn : {&cell.warp, &cell.weft}) {  // Table 1 of the paper
      CHECK(yarn->youngs_modulus == 35.4);
      CHECK(yarn->cross_section == 1.0);
      CHECK(yarn->second_moment_of_area == 1e-4);
      CHECK(yarn->length == 2.5);
    }
    CHECK(cell.contact_modulus == 1.0);
    CHECK(cell.contact_area == 17.6);
    CHECK(cell.contact_length == 0.8);
    CHECK(cell.warp_height_fraction == 0.5);
    CHECK(cell.bending_boundary_factor == 3);
    CHECK(cell.residual_compression_stiffness == 0);
    CHECK(cell.symmetry == 1);
    CHECK(c->fabric.areal_mass == 0.743e-6);
    CHECK(c->fabric.thickness == 1.0);
    CHECK(c->blank.half_width == 135);
    CHECK(c->blank.half_length == 235);
    CHECK(c->blank.element_size == 5);
    CHECK(c->blank.layout == 0);
    CHECK(c->blank.gauss_points == 1);
    CHECK(c->blank.perturbation == 0);
    CHECK(c->process.stroke == 60);
    CHECK(c->process.speed == 2);
    CHECK(c->process.hold == 0.1);
    CHECK(c->process.holder_force == 0.1);
    CHECK(c->process.holder_ramp == 0.03);
    CHECK(c->contact.friction == 0.2);
    CHECK(c->contact.penalty == 0.05);
    CHECK(c->contact.damping_ratio == 0.2);
    CHECK(c->contact.friction_model == crossbeam::Friction::elastic_stick);
    CHECK(c->integration.step_factor == 0.9);
    CHECK(c->integration.mass_damping == 0.02);
    CHECK(c->integration.bulk_viscosity == 0.06);
    CHECK(c->integration.precision == Precision::double_);
  }

  CHECK(realistic.fabric.shear.kind == ShearLawKind::polynomial);
  REQUIRE(realistic.fabric.shear.coefficients.size() == 5);
  double modulus = 0;  // at 0.5 rad, by Horner; 0.186 N/mm is where two published laws agree
  for (int k = 4; k >= 0; --k) modulus = modulus * 0.5 + realistic.fabric.shear.coefficients[k];
  CHECK(std::abs(modulus - 0.186e-3) < 0.5e-6);
  CHECK(realistic.fabric.shear.coefficients[0] == 0.051e-3);
  CHECK(realistic.fabric.shear.coefficients[4] == 8.48e-3);

  for (const auto* c : {&paper, &literal}) {
    CHECK(c->fabric.shear.kind == ShearLawKind::constant);
    CHECK(c->fabric.shear.modulus == 0.001);
    CHECK(c->fabric.shear.measure == crossbeam::ShearMeasure::tensor);
  }
  // Bending stiffness of a yarn per width: E I / L = 35.4 * 1e-4 / 2.5 = 1.416e-3, to two digits.
  for (const auto* c : {&realistic, &paper}) {
    CHECK(c->fabric.warp_bending_stiffness == 1.4e-3);
    CHECK(c->fabric.weft_bending_stiffness == 1.4e-3);
    CHECK(c->fabric.formulation == CellFormulation::energy);
  }
  CHECK(literal.fabric.warp_bending_stiffness == 0);
  CHECK(literal.fabric.weft_bending_stiffness == 0);
  CHECK(literal.fabric.formulation == CellFormulation::energy);
}

TEST_CASE("V-IO-05 the reference data are complete and consistent") {
  const References r = load_references(scene_folder() / "references.toml");
  for (const auto* values : {&r.net.x, &r.net.y, &r.net.shear_deg}) REQUIRE(values->size() == 10);
  REQUIRE(r.study.shear_deg.size() == 8);
  REQUIRE(r.second_code.shear_deg.size() == 8);
  // The net's points lie on the line (0, 235)-(135, 0) in equal steps, to their printed digits.
  for (std::size_t i = 0; i < 10; ++i) {
    CAPTURE(i);
    CHECK(std::abs(r.net.x[i] / 135 + r.net.y[i] / 235 - 1) < 1e-3);
    CHECK(std::abs(r.net.x[i] - r.net.x[0] -
                   static_cast<double>(i) * (r.net.x[9] - r.net.x[0]) / 9) < 0.11);
  }
  // Its outline ends where its draw-in says.
  CHECK(std::abs(135 - r.net.long_edge.front()[0] - r.net.draw_in_x) < 0.051);
  CHECK(std::abs(235 - r.net.short_edge.front()[1] - r.net.draw_in_y) < 0.051);
  // Study and second code agree within a degree at all points.
  for (std::size_t i = 0; i < 8; ++i)
    CHECK(std::abs(r.study.shear_deg[i].value - r.second_code.shear_deg[i]) < 1.2);
  CHECK(r.study.shear_energy.value == 42.8e-3);
  check_contains(r.study.source, {"preceding study with a throw-away code"});

  const verify::ScratchFolder scratch;
  const std::string text = verify::file_content(scene_folder() / "references.toml");
  std::string lacking = text;
  lacking.replace(lacking.find("draw_in_y"), 9, "draw_in_z");
  std::ofstream(scratch / "references.toml") << lacking;
  check_contains(refusal([&] { static_cast<void>(load_references(scratch / "references.toml")); }),
                 {"net.draw_in_y", "missing", "references.toml"});
}

TEST_CASE("V-IO-06 a scene overrides the defaults that it names and no other") {
  const DrapeCase c =
      parse_scene(base + "[process]\nspeed = 1\n[blank]\nseed = 12345678901\n", "x");
  CHECK(c.process.speed == 1);
  CHECK(c.blank.seed == 12345678901u);
  CHECK(c.process.stroke == ProcessInput{}.stroke);
  CHECK(c.contact.friction == ContactInput{}.friction);
  CHECK(c.fabric.cell.contact_area == 17.6);
}

TEST_CASE("V-IO-07 command-line options set the fields they name, over the scene") {
  const Options defaults = parse_options({});
  CHECK(defaults.drape_case.name == "realistic");
  CHECK(defaults.drape_case.process.speed == 2);
  CHECK(defaults.drape_case.integration.threads == 1);
  CHECK(defaults.out == "out/realistic-0");
  CHECK_FALSE(defaults.quiet);

  const DrapeCase c =
      parse_options({"--case",       "paper",       "--layout",   "45",        "--mesh=2.5",
                     "--speed",      "1",           "--friction", "0.3",       "--holder",
                     "200",          "--precision", "float",      "--perturb", "1e-9",
                     "--seed",       "7",           "--points",   "4",         "--cell",
                     "second_order", "--bending",   "off",        "--out",     "somewhere",
                     "--threads",    "2",           "--quiet"})
          .drape_case;
  CHECK(c.name == "paper");
  CHECK(c.blank.layout == 45);
  CHECK(c.blank.element_size == 2.5);
  CHECK(c.process.speed == 1);
  CHECK(c.contact.friction == 0.3);
  CHECK(c.process.holder_force == 0.2);  // given in N, kept in kN
  CHECK(c.integration.precision == Precision::float_);
  CHECK(c.integration.threads == 2);
  CHECK(c.blank.perturbation == 1e-9);
  CHECK(c.blank.seed == 7);
  CHECK(c.blank.gauss_points == 4);
  CHECK(c.fabric.formulation == CellFormulation::second_order);
  CHECK(c.fabric.warp_bending_stiffness == 0);
  CHECK(c.fabric.weft_bending_stiffness == 0);

  const DrapeCase stiff = parse_options({"--case", "paper-literal", "--bending", "on"}).drape_case;
  CHECK(stiff.fabric.warp_bending_stiffness == 1.4e-3);
  CHECK(parse_options({"--holder", "0"}).drape_case.process.holder_force == 0);

  // A preset sets mesh, speed and arithmetic; an option beside it wins, and then it is no preset.
  for (const Preset& preset : presets) {
    const DrapeCase chosen = parse_options({"--preset", preset.name}).drape_case;
    CHECK(chosen.blank.element_size == preset.element_size);
    CHECK(chosen.process.speed == preset.speed);
    CHECK(chosen.integration.precision == preset.precision);
    CHECK(chosen.integration.axial_scaling == preset.axial_scaling);
    CHECK(chosen.contact.penalty == preset.penalty.value_or(ContactInput{}.penalty));
    CHECK(preset_of(chosen) == &preset);
    CHECK(preset.error.position > 0);
    CHECK(preset.processor_s > 0);
    check_contains(parse_options({"--help"}).message,
                   {preset.name, fmt::format("{:.2f} %", 100 * preset.error.position)});
  }
  const DrapeCase changed = parse_options({"--preset", "fast", "--speed", "3"}).drape_case;
  CHECK(changed.process.speed == 3);
  CHECK(preset_of(changed) == nullptr);
  DrapeCase stiffer = parse_options({"--preset", "fast"}).drape_case;
  stiffer.contact.penalty = ContactInput{}.penalty;
  CHECK(preset_of(stiffer) == nullptr);
  CHECK(preset_of(parse_options({}).drape_case) == nullptr);

  check_contains(parse_options({"--help"}).message, {"--case", "[m/s]", "0 or 45", "Examples"});
  check_contains(parse_options({"--version"}).message, {"crossbeam 0."});

  const verify::ScratchFolder scratch;
  std::ofstream(scratch / "mine.toml") << "name = \"mine\"\n" << base;
  CHECK(parse_options({"--case", (scratch / "mine.toml").string()}).drape_case.name == "mine");
}

TEST_CASE("V-IO-07 a bad option is refused by its name, value and range") {
  check_contains(options_refusal({"--speed", "-3"}), {"--speed = -3 [m/s]", "> 0 and <= 100"});
  check_contains(options_refusal({"--speed", "fast"}), {"--speed = fast [m/s]", "> 0 and <= 100"});
  check_contains(options_refusal({"--speed", "nan"}), {"--speed = nan [m/s]", "> 0 and <= 100"});
  check_contains(options_refusal({"--preset", "best"}),
                 {"--preset = best", "fast, standard or accurate"});
  check_contains(options_refusal({"--layout", "30"}), {"--layout = 30 [deg]", "0 or 45"});
  check_contains(options_refusal({"--points", "2"}), {"--points = 2", "1 or 4"});
  check_contains(options_refusal({"--threads", "0"}), {"--threads = 0", ">= 1 and <= 256"});
  check_contains(options_refusal({"--threads", "two"}), {"--threads = two", ">= 1 and <= 256"});
  check_contains(options_refusal({"--mesh", "100"}), {"--mesh = 100 [mm]", "67.5"});
  check_contains(options_refusal({"--holder", "1e5"}), {"--holder = 1e5 [N]", "<= 10000"});
  check_contains(options_refusal({"--holder", "x"}), {"--holder = x [N]", "<= 10000"});
  check_contains(options_refusal({"--bending", "0"}), {"--bending = 0", "on or off"});
  check_contains(options_refusal({"--cell", "enrgy"}), {"--cell = enrgy", "\"energy\""});
  check_contains(options_refusal({"--case", "papr"}), {"--case = papr", "\"paper\"", "realistic"});
  check_contains(options_refusal({"--case", "none.toml"}), {"--case = none.toml", "existing"});
  check_contains(options_refusal({"--sped", "1"}), {"--sped", "--speed"});
  check_contains(options_refusal({"--speed"}), {"--speed"});
  check_contains(options_refusal({"realistic"}), {"realistic"});
}

TEST_SUITE_END();
