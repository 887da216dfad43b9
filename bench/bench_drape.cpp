/// @file
/// The double dome, scene `realistic` from its file, start to end but for the output files: every
/// step with contact, friction, holder and all.
///
///   step/double_dome/<element size>/<number>

#include "support/report.hpp"

#include "drape.hpp"
#include "scene.hpp"

#include <string>
#include <tuple>

namespace bench {
namespace {

namespace drape = crossbeam::drape;

/// What of the contact's skipping is left out.
enum class Skipping { all, no_culling };

void double_dome(benchmark::State& state, double element_size, double speed,
                 drape::Precision precision, Skipping skipping = Skipping::all,
                 double axial_scaling = 1) {
  drape::DrapeCase scene = drape::load_scene(drape::scene_path("realistic"));
  scene.blank.element_size = element_size;
  scene.process.speed = speed;
  scene.integration.precision = precision;
  scene.output.frames = 1;
  scene.contact.culling = skipping != Skipping::no_culling;
  if (axial_scaling > 1) {
    scene.integration.axial_scaling = axial_scaling;
    scene.contact.penalty = 0.005;  // else the contact's own step is the shorter one
  }
  double element_steps = 0;
  for (auto _ : state) {
    const drape::DrapeResult result = drape::run(scene, drape::Progress());
    benchmark::DoNotOptimize(result.shear_points.data());
    element_steps = static_cast<double>(result.cost.element_steps);
  }
  report(state, element_steps, "time_per_element_step");
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  for (const auto& [size, speed, name] : {std::tuple{10.0, 8.0, "10_mm"}, {5.0, 2.0, "5_mm"}})
    for (const auto precision : {drape::Precision::double_, drape::Precision::float_}) {
      const bool is_float = precision == drape::Precision::float_;
      const std::string full_name =
          std::string("step/double_dome/") + name + (is_float ? "/pack_float" : "/pack_double");
      benchmark::RegisterBenchmark(full_name.c_str(), double_dome, size, speed, precision,
                                   Skipping::all, 1.0)
          ->Unit(benchmark::kMillisecond);
    }
  const auto double_ = drape::Precision::double_;
  // Long enough to be measured once.
  benchmark::RegisterBenchmark("step/double_dome/2.5_mm/axial_scaling_25/pack_double", double_dome,
                               2.5, 1.0, double_, Skipping::all, 25.0)
      ->Unit(benchmark::kMillisecond)
      ->Repetitions(1);
  benchmark::RegisterBenchmark("step/double_dome/10_mm/no_culling/pack_double", double_dome, 10.0,
                               8.0, double_, Skipping::no_culling, 1.0)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("step/double_dome/5_mm/axial_scaling_25/pack_double", double_dome,
                               5.0, 2.0, double_, Skipping::all, 25.0)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark("step/double_dome/5_mm/axial_scaling_25/pack_float", double_dome,
                               5.0, 2.0, drape::Precision::float_, Skipping::all, 25.0)
      ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
}  // namespace bench
