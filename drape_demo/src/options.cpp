#include "options.hpp"

#include "fields.hpp"
#include "presets.hpp"
#include "scene.hpp"
#include "spelling.hpp"
#include "supplied.hpp"

#include "crossbeam/base/version.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>

namespace crossbeam::drape {
namespace {

/// An option that sets one field of the case.
struct Override {
  const char* option;
  const char* field;
  const char* type;  ///< shown in the help after the option
  const char* help;
  std::string text{};  ///< as given; empty when the option is absent
};

std::vector<Override> overrides() {
  return {
      {"--layout", "blank.layout", "DEG", "warp direction from the x axis"},
      {"--mesh", "blank.element_size", "MM", "element size"},
      {"--speed", "process.speed", "M/S", "mean punch speed"},
      {"--friction", "contact.friction", "MU", "Coulomb friction, fabric on tool"},
      {"--precision", "integration.precision", "NAME", "arithmetic"},
      {"--threads", "integration.threads", "N", "threads that share a step"},
      {"--perturb", "blank.perturbation", "MM", "random start perturbation"},
      {"--seed", "blank.seed", "N", "seed of that perturbation"},
      {"--points", "blank.gauss_points", "N", "integration points of an element"},
      {"--cell", "fabric.formulation", "NAME", "cell formulation"},
  };
}

constexpr const char* footer = R"(
The scene file sets every option that is not given. Of an earlier result in the output folder the
files that this program has written are replaced, and no others; a folder with other files only is
refused.

Exit code: 0 done, 1 results not written, 2 bad input, 3 the run failed, 128 + n signal n.

Examples:
  crossbeam-drape                                      the realistic fabric, 5 mm, 2 m/s
  crossbeam-drape --preset accurate                    the smallest error, the longest run
  crossbeam-drape --mesh 2.5 --speed 1 --out fine      twice as fine, half as fast
  crossbeam-drape --case paper --layout 45             constant shear modulus, +-45 deg
  crossbeam-drape --case paper-literal --perturb 1e-9  a membrane, slightly disturbed
  crossbeam-drape --case my_fabric.toml --holder 50    your own scene, 50 N on the holder)";

void set_holder_force(DrapeCase& c, const std::string& newton) {
  constexpr double newton_per_kilonewton = 1000;
  const InputError refused("--holder", newton, "N", "a number >= 0 and <= 10000");
  try {
    set_field(c, "process.holder_force", newton, "--holder");
  } catch (const InputError&) {
    throw refused;
  }
  c.process.holder_force /= newton_per_kilonewton;
  if (!from_to(0, 10).contains(c.process.holder_force)) throw refused;
}

void set_bending(DrapeCase& c, const std::string& text) {
  double& warp = c.fabric.warp_bending_stiffness;
  double& weft = c.fabric.weft_bending_stiffness;
  if (text == "off") {
    warp = weft = 0;
  } else if (text == "on") {
    if (warp != 0 || weft != 0) return;
    warp = FabricInput{}.warp_bending_stiffness;
    weft = FabricInput{}.weft_bending_stiffness;
  } else {
    throw InputError("--bending", text, "", "on or off");
  }
}

[[noreturn]] void refuse_command_line(const CLI::App& app, const CLI::ParseError& error,
                                      const std::vector<std::string>& arguments) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) known.push_back(option->get_name());
  for (const auto& argument : arguments) {
    const std::string name = argument.substr(0, argument.find('='));
    if (name.rfind("--", 0) != 0 || std::find(known.begin(), known.end(), name) != known.end())
      continue;
    const std::string nearest = nearest_name(name, known);
    throw InputError("command line", argument, "",
                     (nearest.empty() ? "" : "did you mean " + nearest + "? ") +
                         std::string("--help lists the options"));
  }
  throw InputError("command line", fmt::format("\"{}\"", fmt::join(arguments, " ")), "",
                   std::string(error.what()) + "; --help lists the options");
}

}  // namespace

Options parse_options(const std::vector<std::string>& arguments) {
  Options options;
  auto list = overrides();
  std::string case_name = "realistic", preset, holder, bending, out;

  CLI::App app("Drapes a quarter of the double dome with a dry woven fabric.", "crossbeam-drape");
  app.get_formatter()->column_width(28);
  app.footer(
      "\nPresets set --mesh, --speed and --precision; \"scaled\" also integration.axial_scaling "
      "and a "
      "softer contact,\nwhose yarn tensions are less exact. Measured for the scene realistic, all "
      "errors together,\nagainst 2.5 mm, 0.5 m/s in double (whose own error of mesh is not in it), "
      "and "
      "seconds of one core\n(./run bench precision):\n" +
      preset_table() + footer);
  app.set_version_flag("--version", std::string("crossbeam ") + CROSSBEAM_VERSION);
  app.add_option("--case", case_name, "realistic (default), paper, paper-literal, or a path *.toml")
      ->option_text("NAME");
  app.add_option("--preset", preset, preset_names() + ": mesh, speed, arithmetic; see below")
      ->option_text("NAME");
  for (auto& o : list)
    app.add_option(o.option, o.text, fmt::format("{}: {}", o.help, field_range(o.field)))
        ->option_text(o.type);
  app.add_option("--holder", holder, "holder force, full part: [N] a number >= 0 and <= 10000")
      ->option_text("N");
  app.add_option("--bending", bending, "bending stiffness; on: the scene's, else 1.4e-3 kN mm")
      ->option_text("on|off");
  app.add_option("--out", out, "folder of the results; default out/CASE-LAYOUT")
      ->option_text("DIR");
  app.add_flag("--quiet", options.quiet, "neither progress nor table");

  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(std::move(reversed));
  } catch (const CLI::CallForHelp&) {
    options.message = app.help();
    return options;
  } catch (const CLI::CallForVersion& version) {
    options.message = std::string(version.what()) + "\n";
    return options;
  } catch (const CLI::ParseError& error) {
    refuse_command_line(app, error, arguments);
  }

  DrapeCase& c = options.drape_case =
      is_supplied_case(case_name)
          ? parse_scene(supplied_text(case_name + ".toml"), case_name + ".toml")
          : load_scene(scene_path(case_name));
  if (app.count("--preset") > 0) apply_preset(c, preset);
  for (const auto& o : list)
    if (app.count(o.option) > 0) set_field(c, o.field, o.text, o.option);
  if (app.count("--holder") > 0) set_holder_force(c, holder);
  if (app.count("--bending") > 0) set_bending(c, bending);

  try {
    validate(c);
  } catch (const InputError& error) {
    for (const auto& o : list)
      if (app.count(o.option) > 0 && error.field() == o.field)
        throw InputError(o.option, o.text, field_unit(o.field), admissible_part(error));
    throw;
  }

  options.out = out.empty()
                    ? fmt::format("out/{}-{:g}", c.name.empty() ? "drape" : c.name, c.blank.layout)
                    : out;
  return options;
}

}  // namespace crossbeam::drape
