/// @file
/// crossbeam-precision: run time against error. Every setting of the explicit drape and the
/// integrators of SUNDIALS on the same two cases; two kinds of error:
///   of time    against Runge-Kutta 5 at a tight tolerance on the same mesh at the same speed
///   of all     against the finest and slowest explicit run: mesh, speed and arithmetic together
/// Theory: docs/theory/reference.md.

#include "cases.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>

namespace {

using namespace crossbeam;
using namespace crossbeam::drape;
using Json = nlohmann::ordered_json;

struct Options {
  bool brief = false;
  int jobs = 2;
  std::string which = "all";
  std::string out = "out/precision";
};

/// One setting that was run.
struct Run {
  std::string family, setting;  ///< what varies, and its value
  std::function<Frames()> go;
  bool smooth = true;      ///< part of the comparison in time
  long long elements = 0;  ///< of its mesh
  Frames frames{};
};

/// Runs everything on `jobs` threads, in the order given.
void run_all(std::vector<Run>& runs, int jobs) {
  std::atomic<std::size_t> next{0};
  std::mutex screen;
  std::exception_ptr failed;
  std::vector<std::thread> threads;
  for (int j = 0; j < jobs; ++j)
    threads.emplace_back([&] {
      for (std::size_t k = next++; k < runs.size(); k = next++) {
        try {
          runs[k].frames = runs[k].go();
        } catch (...) {
          const std::lock_guard lock(screen);
          failed = std::current_exception();
          return;
        }
        const std::lock_guard lock(screen);
        fmt::print("  {:24} {:28} {:8.2f} s\n", runs[k].family, runs[k].setting,
                   runs[k].frames.processor_s);
        std::fflush(stdout);
      }
    });
  for (auto& t : threads) t.join();
  if (failed) std::rethrow_exception(failed);
}

/// What one case needs to be compared.
struct Comparison {
  std::string name;
  std::vector<Run> runs{};
  std::size_t time_reference = 0, second_opinion = 0, best = 0;
  std::vector<std::size_t> perturbed{};  ///< eight starts that differ by 1e-9 mm
  std::size_t unperturbed = 0;
};

template <class Make>
void add_references(Comparison& c, const Make& make, double tolerance) {
  c.time_reference = c.runs.size();
  c.runs.push_back({"reference", fmt::format("Runge-Kutta 5, {:g}", tolerance), [=] {
                      return integrate<reference::RungeKutta5>(make(), {tolerance, tolerance});
                    }});
  c.second_opinion = c.runs.size();
  c.runs.push_back({"second opinion", fmt::format("Adams, {:g}", tolerance), [=] {
                      return integrate<reference::Adams>(make(), {tolerance, tolerance});
                    }});
}

template <class Make>
void add_integrators(Comparison& c, const Make& make, const std::vector<double>& tolerances,
                     const std::vector<double>& implicit) {
  for (double t : tolerances) {
    c.runs.push_back({"ARKODE Runge-Kutta 5", fmt::format("tolerance {:g}", t), [=] {
                        return integrate<reference::RungeKutta5>(make(), {t, t});
                      }});
    c.runs.push_back({"CVODE Adams", fmt::format("tolerance {:g}", t), [=] {
                        return integrate<reference::Adams>(make(), {t, t});
                      }});
  }
  for (double t : implicit)
    c.runs.push_back({"CVODE BDF, KLU", fmt::format("tolerance {:g}", t), [=] {
                        return integrate<reference::BackwardDifferences>(make(), {t, t});
                      }});
}

Comparison sphere(bool brief) {
  Comparison c{"sheet over a sphere", {}};
  SphereSheet base;
  base.elements = brief ? 6 : 12;
  const int finest = brief ? 12 : 48;
  const auto make = [base] { return sphere_case<double>(base); };
  const double tight = brief ? 1e-9 : 1e-11;
  add_references(c, make, tight);
  add_integrators(c, make, brief ? std::vector{1e-5} : std::vector{1e-4, 1e-6, 1e-8},
                  brief ? std::vector<double>{} : std::vector{1e-4, 1e-6});
  c.unperturbed = c.runs.size();
  for (double f : {0.9, 0.45, 0.225, 0.1125})
    c.runs.push_back({"time step", fmt::format("{:g} of the critical one", f),
                      [=] { return explicit_run(make(), f); }});
  for (int sweeps : {1, 2, 3, 4}) {
    SphereSheet s = base;
    s.cell_sweeps = sweeps;
    c.runs.push_back({"sweeps of the cell", fmt::format("{} (0.9 critical)", sweeps),
                      [=] { return explicit_run(sphere_case<double>(s), 0.9); }});
  }
  c.runs.push_back({"arithmetic", "float (0.9 critical)",
                    [=] { return explicit_run(sphere_case<float>(base), 0.9); }});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SphereSheet s = base;
    s.perturbation = 1e-9;
    s.seed = seed;
    c.perturbed.push_back(c.runs.size());
    c.runs.push_back({"perturbed", fmt::format("seed {}", seed),
                      [=] { return explicit_run(sphere_case<double>(s), 0.9); }});
  }
  for (int n = brief ? 6 : 12; n <= finest; n *= 2)
    for (double V : {8.0, 4.0, 2.0, 1.0, 0.5}) {
      SphereSheet s = base;
      s.elements = n;
      s.duration = s.stroke / V;
      s.cell_sweeps = 3;
      Run run{"mesh and speed", fmt::format("{:g} mm, {:g} m/s", SphereSheet::side / n, V),
              [=] { return explicit_run(sphere_case<double>(s), 0.9); }};
      run.smooth = false;
      c.best = c.runs.size();
      c.runs.push_back(std::move(run));
    }
  SphereSheet four = base;
  four.gauss_points = 4;
  four.cell_sweeps = 3;
  Run points{"2x2 points", fmt::format("{:g} mm, 2 m/s", SphereSheet::side / four.elements),
             [=] { return explicit_run(sphere_case<double>(four), 0.9); }};
  points.smooth = false;
  c.runs.push_back(std::move(points));
  return c;
}

Comparison dome(bool brief) {
  Comparison c{"double dome `realistic`", {}};
  DrapeCase smooth = smooth_dome();
  if (brief) smooth.blank.element_size = 20;
  const auto make = [smooth] { return dome_case<double>(smooth); };
  const double tight = brief ? 1e-7 : 1e-9;
  add_references(c, make, tight);
  add_integrators(c, make, brief ? std::vector<double>{} : std::vector{1e-4, 1e-6}, {});
  c.unperturbed = c.runs.size();
  for (double f : {0.9, 0.45, 0.225})
    c.runs.push_back({"time step", fmt::format("{:g} of the critical one", f),
                      [=] { return explicit_run(make(), f); }});
  for (int sweeps : {1, 2, 3}) {
    DrapeCase s = smooth;
    s.fabric.cell_sweeps = sweeps;
    c.runs.push_back({"sweeps of the cell", fmt::format("{} (0.9 critical)", sweeps),
                      [=] { return explicit_run(dome_case<double>(s), 0.9); }});
  }
  c.runs.push_back({"arithmetic", "float (0.9 critical)",
                    [=] { return explicit_run(dome_case<float>(smooth), 0.9); }});
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    DrapeCase s = smooth;
    s.blank.perturbation = 1e-9;
    s.blank.seed = seed;
    c.perturbed.push_back(c.runs.size());
    c.runs.push_back({"perturbed", fmt::format("seed {}", seed),
                      [=] { return explicit_run(dome_case<double>(s), 0.9); }});
  }
  const DrapeCase realistic = load_scene(scene_path("realistic"));
  const auto scene = [&](const std::string& family, double mesh, double V, int points,
                         bool is_float, double axial_scaling = 1) {
    DrapeCase s = realistic;
    s.integration.axial_scaling = axial_scaling;
    if (axial_scaling > 1)
      s.contact.penalty = 0.005;  // else the contact's own step is the shorter one
    s.blank.element_size = mesh;
    s.process.speed = V;
    s.blank.gauss_points = points;
    Run run{family, fmt::format("{:g} mm, {:g} m/s", mesh, V), [=] {
              return is_float ? explicit_run(dome_case<float>(s), s.integration.step_factor)
                              : explicit_run(dome_case<double>(s), s.integration.step_factor);
            }};
    run.smooth = false;
    c.runs.push_back(std::move(run));
  };
  const double fine = brief ? 20 : 2.5, slow = brief ? 4 : 0.5;
  for (double mesh = brief ? 20 : 5; mesh >= fine; mesh /= 2)
    for (double V = 8; V >= slow; V /= 2) {
      if (mesh < 5 && V > 4) continue;
      scene("float", mesh, V, 1, true);
      if (mesh >= 5) scene("2x2 points", mesh, V, 4, false);
      if (mesh >= 5) scene("float, axial scaling 25", mesh, V, 1, true, 25);
      c.best = c.runs.size();
      scene("mesh and speed", mesh, V, 1, false);
    }
  return c;
}

Json json_of(const Errors& e) {
  return {{"position", e.position},
          {"largest_mm", e.largest},
          {"shear_rms_deg", e.shear_rms},
          {"shear_quantile_deg", e.shear_quantile},
          {"outline_mm", e.outline}};
}

Json measure(Comparison& c) {
  const Frames& reference = c.runs[c.time_reference].frames;
  const Frames& best = c.runs[c.best].frames;
  Json out;
  out["case"] = c.name;
  out["time_reference"] = c.runs[c.time_reference].setting;
  out["overall_reference"] = c.runs[c.best].setting;
  out["uncertainty_of_the_time_reference"] =
      json_of(compare(c.runs[c.second_opinion].frames, reference));
  Errors floor;
  for (std::size_t k : c.perturbed) {
    const Errors e = compare(c.runs[k].frames, c.runs[c.unperturbed].frames);
    floor.position = std::max(floor.position, e.position);
    floor.largest = std::max(floor.largest, e.largest);
    floor.shear_rms = std::max(floor.shear_rms, e.shear_rms);
    floor.shear_quantile = std::max(floor.shear_quantile, e.shear_quantile);
    floor.outline = std::max(floor.outline, e.outline);
  }
  out["chaos_floor"] = json_of(floor);
  for (std::size_t k = 0; k < c.runs.size(); ++k) {
    const Run& run = c.runs[k];
    if (run.family == "perturbed") continue;
    const FormedState& end = run.frames.at.back();
    const long long elements = static_cast<long long>(end.nx) * end.ny;
    Json row{{"family", run.family},
             {"setting", run.setting},
             {"processor_s", run.frames.processor_s},
             {"steps", run.frames.steps},
             {"element_evaluations", run.frames.evaluations * elements}};
    // The last of the ten times, and for the comparison in time the worst of all ten.
    if (run.smooth && k != c.time_reference) {
      row["time_error"] = json_of(compare(run.frames, reference));
      row["time_error_at_the_end"] = json_of(compare(end, reference.at.back()));
    }
    if (!run.smooth && k != c.best) row["error"] = json_of(compare(end, best.at.back()));
    out["runs"].push_back(std::move(row));
  }
  return out;
}

int run(const Options& o) {
  require_between("--jobs", static_cast<double>(o.jobs), "-", 0, 257);
  Json all;
  all["brief"] = o.brief;
  for (auto make : {sphere, dome}) {
    Comparison c = make(o.brief);
    const std::string key = make == sphere ? "sphere" : "dome";
    if (o.which != "all" && o.which != key) continue;
    fmt::print("{}: {} runs\n", c.name, c.runs.size());
    run_all(c.runs, o.jobs);
    all["cases"][key] = measure(c);
  }
  const std::filesystem::path file = std::filesystem::path(o.out) / "precision.json";
  write_json(file, all);
  fmt::print("results in {}\n", file.string());
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  Options o;
  CLI::App app("Run time against error of the drape, and of SUNDIALS' integrators.",
               "crossbeam-precision");
  app.add_flag("--short", o.brief, "coarse meshes and few runs: that it works, not what it costs");
  app.add_option("--jobs", o.jobs, "runs side by side, 1 to 256; default 2");
  app.add_option("--case", o.which, "all (default), sphere or dome")
      ->check(CLI::IsMember({"all", "sphere", "dome"}));
  app.add_option("--out", o.out, "folder of precision.json; default out/precision");
  CLI11_PARSE(app, count, arguments);
  try {
    return run(o);
  } catch (const InputError& error) {
    fmt::print(stderr, "crossbeam-precision: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "crossbeam-precision: {}\n", error.what());
    return 3;
  }
}
