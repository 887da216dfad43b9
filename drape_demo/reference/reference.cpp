/// @file
/// crossbeam-reference: the reference drape. Two independent integrators of SUNDIALS on the same
/// semi-discrete model; the gap between them is the reference's uncertainty. Then the equilibrium of
/// the formed part. Theory: docs/theory/reference.md.

#include "cases.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <thread>

namespace {

using namespace crossbeam;
using namespace crossbeam::drape;
using Json = nlohmann::ordered_json;

struct Options {
  double tolerance = 1e-9;
  std::string which = "all";
  std::string out = "out/reference";
};

/// Both integrators side by side, with their gap at ten times.
Json reference_of(const std::string& name, const std::function<Case<double>()>& make,
                  double tolerance) {
  Frames erk, adams;
  std::thread other([&] { adams = integrate<reference::Adams>(make(), {tolerance, tolerance}); });
  erk = integrate<reference::RungeKutta5>(make(), {tolerance, tolerance});
  other.join();
  const Case<double> start = make();
  const FormedState flat = start.formed();
  Json out;
  out["case"] = name;
  out["tolerance"] = tolerance;
  out["elements"] = start.mesh.element_count();
  fmt::print("\n{}, tolerance {:g}\n", name, tolerance);
  fmt::print(
      "  Runge-Kutta 5: {} steps, {} evaluations, {:.1f} s;  Adams: {} steps, {} evaluations, "
      "{:.1f} s\n",
      erk.steps, erk.evaluations, erk.processor_s, adams.steps, adams.evaluations,
      adams.processor_s);
  fmt::print(
      "  time [ms]   displacement [mm]   gap, largest [mm]   gap, L2 [-]   gap, shear rms [deg]\n");
  double worst = 0, displacement = 0;
  for (std::size_t k = 0; k < erk.at.size(); ++k) {
    const Errors gap = compare(adams.at[k], erk.at[k]), moved = compare(flat, erk.at[k]);
    const double t = start.duration * static_cast<double>(k + 1) / 10;
    fmt::print("  {:9.3f}   {:17.3f}   {:17.2e}   {:11.2e}   {:20.2e}\n", t, moved.largest,
               gap.largest, gap.position, gap.shear_rms);
    displacement = std::max(displacement, moved.largest);
    worst = std::max(worst, gap.largest);
    Json row;
    row["time_ms"] = t;
    row["displacement_mm"] = moved.largest;
    row["gap_mm"] = gap.largest;
    row["gap_relative"] = gap.position;
    row["gap_shear_deg"] = gap.shear_rms;
    Json points = Json::array();
    for (const Vec3<double>& p : erk.at[k].points) {
      points.push_back(p.x);
      points.push_back(p.y);
      points.push_back(p.z);
    }
    row["points_mm"] = std::move(points);
    out["times"].push_back(std::move(row));
  }
  for (const auto& [key, run] :
       {std::pair<const char*, const Frames*>{"runge_kutta_5", &erk}, {"adams", &adams}})
    out[key] = {{"steps", run->steps},
                {"evaluations", run->evaluations},
                {"processor_s", run->processor_s}};
  out["gap_over_displacement"] = worst / displacement;
  fmt::print("  largest gap over largest displacement: {:.1e}\n", worst / displacement);
  return out;
}

/// The formed part from the explicit run's end, and how far away its equilibrium is.
Json formed_equilibrium() {
  DrapeCase c = load_scene(scene_path("realistic"));
  c.fabric.cell_solve = CellSolve::sweeps;
  c.fabric.cell_sweeps = 8;
  c.process.hold = 1;
  Case<double> start = dome_case<double>(c);
  CentralDifference<NativePack<double>> run(std::move(start.model), TimeStep::fraction(0.9));
  while (run.time() < start.duration) run.step();
  const FormedState before = formed_state(run.model(), start.mesh, start.nx, start.ny);
  StaticProblem problem(run.model(), run.time());
  const double begin = processor_seconds();
  const reference::StaticResult r = reference::find_equilibrium(problem);
  const double seconds = processor_seconds() - begin;
  const Errors moved = compare(before, formed_state(run.model(), start.mesh, start.nx, start.ny));
  fmt::print(
      "\nEquilibrium of the formed double dome, 5 mm: {} after {} iterations and {} "
      "backtracks in {:.1f} s\n  unbalanced force {:.1e} of the internal forces; the explicit "
      "end state is {:.3f} mm and {:.3f} deg (rms) away\n  unbalanced force [kN]:",
      r.converged ? "found" : "NOT found", r.iterations, r.backtracks, seconds, r.residual,
      moved.largest, moved.shear_rms);
  for (double f : r.history) fmt::print(" {:.1e}", f);
  fmt::print("\n");
  return {{"case", "double dome, formed"},
          {"converged", r.converged},
          {"iterations", r.iterations},
          {"backtracks", r.backtracks},
          {"relative_residual", r.residual},
          {"history_kN", r.history},
          {"explicit_state_off_mm", moved.largest},
          {"explicit_state_off_relative", moved.position},
          {"explicit_state_off_shear_deg", moved.shear_rms},
          {"processor_s", seconds}};
}

int run(const Options& o) {
  require_between("--tolerance", o.tolerance, "-", 1e-14, 1e-2);
  Json all;
  const auto wanted = [&](const char* name) { return o.which == "all" || o.which == name; };
  if (wanted("sphere")) {
    SphereSheet sheet;
    sheet.elements = 12;
    all["sphere"] = reference_of(
        "sheet over a sphere, 5 mm", [sheet] { return sphere_case<double>(sheet); }, o.tolerance);
    // What has no reference: without bending a membrane buckles at the size of its elements, and
    // rounding chooses the pattern.
    sheet.bending = 0;
    sheet.mass_damping = 0.02;
    all["sphere_without_bending"] = reference_of(
        "the same without bending and hardly damped: chaotic",
        [sheet] { return sphere_case<double>(sheet); }, o.tolerance);
  }
  if (wanted("dome"))
    all["dome"] = reference_of(
        "double dome `realistic`, 5 mm, 2 m/s, contact in rate form",
        [c = smooth_dome()] { return dome_case<double>(c); }, o.tolerance);
  if (wanted("statics")) all["statics"] = formed_equilibrium();
  const std::filesystem::path file = std::filesystem::path(o.out) / "reference.json";
  write_json(file, all);
  fmt::print("\nresults in {}\n", file.string());
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  Options o;
  CLI::App app(
      "Reference drapes by two integrators of SUNDIALS, and the formed part's equilibrium.",
      "crossbeam-reference");
  app.add_option("--tolerance", o.tolerance, "relative and absolute [mm, mm/ms], 1e-14 to 1e-2");
  app.add_option("--case", o.which, "all (default), sphere, dome or statics")
      ->check(CLI::IsMember({"all", "sphere", "dome", "statics"}));
  app.add_option("--out", o.out, "folder of reference.json; default out/reference");
  CLI11_PARSE(app, count, arguments);
  try {
    return run(o);
  } catch (const InputError& error) {
    fmt::print(stderr, "crossbeam-reference: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "crossbeam-reference: {}\n", error.what());
    return 3;
  }
}
