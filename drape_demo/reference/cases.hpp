#pragma once
/// @file
/// The cases of the reference drape, and how they are run.

#include "formed_state.hpp"
#include "quarter_model.hpp"
#include "scene.hpp"
#include "sphere_sheet.hpp"
#include "text_file.hpp"

#include "crossbeam/adapters/sundials.hpp"

#include <nlohmann/json.hpp>

#include <ctime>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace crossbeam::drape {

/// Processor time of this thread [s].
inline double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// A model with its mesh and the duration of its run.
template <class R>
struct Case {
  Model<R> model;
  Mesh<4> mesh;
  int nx, ny;
  double duration;  ///< stroke and hold [ms]

  [[nodiscard]] FormedState formed() const { return formed_state(model, mesh, nx, ny); }
};

/// The cases and their runs are compiled once, in cases.cpp: R is double or float, the integrators
/// are those of SUNDIALS that the programs compare.
template <class R>
Case<R> sphere_case(const SphereSheet& sheet);

template <class R>
Case<R> dome_case(const DrapeCase& c);

/// The scene `realistic` with contact and friction in rate form: a penalty that sets in over
/// 0.05 mm, friction that is full from a tenth of the punch's speed on.
inline DrapeCase smooth_dome() {
  DrapeCase c = load_scene(scene_path("realistic"));
  c.contact.friction_model = Friction::smooth;
  c.contact.viscous_slip = 0.1;
  c.contact.smoothing = 0.05;
  c.fabric.cell_solve = CellSolve::sweeps;
  c.fabric.cell_sweeps = 5;
  return c;
}

/// A run's states at ten even times, and its cost.
struct Frames {
  std::vector<FormedState> at;
  double processor_s = 0;
  long long steps = 0, evaluations = 0;
};

template <class Integrator>
Frames integrate(Case<double> c, const reference::Tolerances& tolerances);

/// @param step_factor of the proven critical step; made a little shorter to hit the ten times
template <class R>
Frames explicit_run(Case<R> c, double step_factor);

/// The worst of each measure over the ten times.
inline Errors compare(const Frames& a, const Frames& b) {
  Errors out;
  for (std::size_t k = 0; k < a.at.size(); ++k) {
    const Errors e = compare(a.at[k], b.at[k]);
    out.position = std::max(out.position, e.position);
    out.largest = std::max(out.largest, e.largest);
    out.shear_rms = std::max(out.shear_rms, e.shear_rms);
    out.shear_quantile = std::max(out.shear_quantile, e.shear_quantile);
    out.outline = std::max(out.outline, e.outline);
  }
  return out;
}

/// Written beside and renamed: an earlier result stays whole whatever happens.
inline void write_json(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  std::filesystem::create_directories(file.parent_path());
  const std::filesystem::path partial = file.string() + ".partial";
  write_file(partial, json.dump(1) + "\n");
  std::filesystem::rename(partial, file);
}

}  // namespace crossbeam::drape
