/// @file
/// The Gauss point: fibre strain -> cell -> energy, stress, tangent; and with the element around
/// it, corner positions -> corner forces.
///
///   gauss_point/<what>/<law>/<iterated how>/<number>
///
/// Laws: `measured_shear`, the energy cell with the shear curve of the scene `realistic`;
/// `constant_shear`, the energy cell with Eq. 26; `second_order`, the paper's cell with Eq. 26.
/// Followed cells (`followed`) and the warm yardstick move by one time step between two visits.
/// `paper_*` are the yardstick: Eq. 1-20 and 24-27 in plain Eigen (support/paper_element.hpp).
///
/// With --scene=FILE instead the fabric and the strain history of that file, law `scene`
/// (support/scene_file.hpp).

#include "support/element_forces.hpp"
#include "support/fabric.hpp"
#include "support/followed.hpp"
#include "support/lanes.hpp"
#include "support/paper_element.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"
#include "support/scene_file.hpp"
#include "support/work.hpp"

#include "crossbeam/base/dual.hpp"

#include <cstdio>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

namespace bench {
namespace {

using crossbeam::Counting;
using crossbeam::CrossedBeamCell;
using crossbeam::Dual;
using crossbeam::FibreStrain;
using crossbeam::FibreStress;
using crossbeam::real_t;
using crossbeam::SecondOrderCell;
using crossbeam::SolverControl;
using Quad = crossbeam::Quadrilateral<1>;

/// What the points go through.
RingStates& ring_states() {
  static RingStates states = random_states();
  return states;
}

template <class T>
CROSSBEAM_INLINE FibreStrain<T> strain(const Ring<real_t<T>>& ring, int k) {
  return {load<T>(ring.b11, k), load<T>(ring.b22, k), load<T>(ring.b12, k)};
}

/// Runs `kernel(strain)` over the ring. What it returns is what goes out.
template <class T, class Kernel>
void time_points(benchmark::State& state, const Kernel& kernel) {
  using R = real_t<T>;
  const Ring<R> ring(ring_states());
  for (auto _ : state)
    for (int k = 0; k < ring_size; k += crossbeam::lanes_v<T>) {
      if constexpr (crossbeam::ScalarTraits<T>::derivative_order == 0)
        benchmark::DoNotOptimize(kernel(strain<T>(ring, k)));
      else
        benchmark::DoNotOptimize(kernel(FibreStrain<T>{load_variable<T>(ring.b11, k, 0),
                                                       load_variable<T>(ring.b22, k, 1),
                                                       load_variable<T>(ring.b12, k, 2)}));
    }
  report(state, ring_size, "time_per_point");
  if constexpr (crossbeam::ScalarTraits<T>::derivative_order == 0) {
    using Counted = Counting<R>;
    const double flops = counted_flops([&](int k) { return kernel(strain<Counted>(ring, k)); });
    using Answer = decltype(kernel(strain<R>(ring, 0)));
    report_work<R>(state, ring_size, {flops, 3.0 * sizeof(R) + sizeof(Answer)});
  }
}

template <class T>
struct StressAndTangent {
  FibreStress<T> stress;
  crossbeam::StrainHessian<T> tangent;
};

/// Name of a benchmark of one law in one number type.
template <class T>
auto namer(std::string law, std::string iterated) {
  return [law = std::move(law), iterated = std::move(iterated)](const char* what) {
    return std::string("gauss_point/") + what + "/" + law + "/" + iterated + "/" + number_name<T>();
  };
}

/// What every law has.
template <class T, class Law>
void register_forces(const std::string& law_name, const std::string& iterated, const Law& law) {
  const auto name = namer<T>(law_name, iterated);
  benchmark::RegisterBenchmark(name("forces").c_str(), [law](benchmark::State& state) {
    time_points<T>(state, [&](const auto& beta) { return law.stress(law.evaluate(beta)); });
  });
  benchmark::RegisterBenchmark(name("corner_forces").c_str(), [law](benchmark::State& state) {
    time_corner_forces<T, Quad>(state, law, ring_states(), "time_per_point");
  });
}

/// The point whose cell is followed from step to step.
template <class T, class Law>
void register_followed(const std::string& law_name, const Law& law) {
  const auto name = namer<T>(law_name, "followed");
  const crossbeam::WovenMembrane<std::decay_t<decltype(law.cell())>,
                                 std::decay_t<decltype(law.shear())>,
                                 crossbeam::CellPrice::followed>
      followed(law.cell(), law.shear());
  benchmark::RegisterBenchmark(name("forces").c_str(), [followed](benchmark::State& state) {
    time_followed<T, Chain::strain_to_stress>(state, followed, ring_states());
  });
  benchmark::RegisterBenchmark(name("corner_forces").c_str(), [followed](benchmark::State& state) {
    time_followed<T, Chain::corners_to_forces>(state, followed, ring_states());
  });
}

/// What needs a potential; the derivatives once by hand and once by dual numbers.
template <class T, class Law>
void register_derivatives(const std::string& law_name, const std::string& iterated,
                          const Law& law) {
  const auto name = namer<T>(law_name, iterated);
  using D = Dual<T, 3>;
  const auto energy = [law](const auto& beta) {
    const auto at = law.evaluate(beta);
    return law.yarn_energy(at) + law.shear_energy(at);
  };
  benchmark::RegisterBenchmark(
      name("energy").c_str(), [energy](benchmark::State& state) { time_points<T>(state, energy); });
  benchmark::RegisterBenchmark(name("forces_autodiff").c_str(), [energy](benchmark::State& state) {
    time_points<D>(state, energy);
  });
  benchmark::RegisterBenchmark(name("forces_and_tangent").c_str(), [law](benchmark::State& state) {
    time_points<T>(state, [&]<class S>(const FibreStrain<S>& beta) {
      const auto at = law.evaluate(beta);
      return StressAndTangent<S>{law.stress(at), law.hessian(at)};
    });
  });
  benchmark::RegisterBenchmark(
      name("forces_and_tangent_autodiff").c_str(), [law](benchmark::State& state) {
        time_points<D>(state,
                       [&](const FibreStrain<D>& beta) { return law.stress(law.evaluate(beta)); });
      });
}

template <paper::Solver solver, Start start = Start::cold>
void register_paper(const std::string& name) {
  benchmark::RegisterBenchmark(("gauss_point/forces/" + name + "/converged/double").c_str(),
                               paper_point<solver, start>);
  benchmark::RegisterBenchmark(
      ("gauss_point/corner_forces/" + name + "/converged/double").c_str(),
      [](benchmark::State& state) { paper_corner_forces<solver, start>(state); });
}

/// What the loop costs itself: strains in, strains out.
template <class T>
void register_nothing() {
  benchmark::RegisterBenchmark(("gauss_point/nothing/" + number_name<T>()).c_str(),
                               [](benchmark::State& state) {
                                 time_points<T>(state, [](const auto& beta) { return beta; });
                               });
}

void register_fabric() {
  register_paper<paper::Solver::lu_4x4>("paper_lu_4x4");
  register_paper<paper::Solver::inverse_2x2>("paper_inverse_2x2");
  register_paper<paper::Solver::inverse_2x2, Start::warm>("paper_inverse_2x2_warm");
  for_each_number([]<class T>() {
    using R = real_t<T>;
    const CrossedBeamCell<R> cell(cell_parameters<R>());
    const auto converged = SolverControl::converged();
    register_nothing<T>();
    register_forces<T>(
        "second_order", "converged",
        membrane(SecondOrderCell<R>(cell_parameters<R>()), constant_shear<R>(), converged));
    const auto constant = membrane(cell, constant_shear<R>(), SolverControl::fixed(3));
    register_forces<T>("constant_shear", "3_sweeps", constant);
    register_followed<T>("constant_shear", constant);
    register_followed<T>("measured_shear", membrane(cell, measured_shear<R>(), converged));
    const auto add = [&](const char* iterated, SolverControl control) {
      const auto law = membrane(cell, measured_shear<R>(), control);
      register_forces<T>("measured_shear", iterated, law);
      register_derivatives<T>("measured_shear", iterated, law);
    };
    add("converged", converged);
    add("3_sweeps", SolverControl::fixed(3));
    add("2_sweeps", SolverControl::fixed(2));
  });
}

/// The fabric of a scene with as many sweeps as it says.
void register_scene(const SceneFile& scene) {
  ring_states() = scene.states;
  for_each_number([&]<class T>() {
    using R = real_t<T>;
    register_nothing<T>();
    scene.with_law<R>([&](const auto& law, const std::string& iterated) {
      register_forces<T>("scene", iterated, law);
      if constexpr (requires(const FibreStrain<R>& beta) { law.hessian(law.evaluate(beta)); }) {
        register_derivatives<T>("scene", iterated, law);
        if (scene.follows()) register_followed<T>("scene", law);
      }
    });
  });
}

/// Takes the argument --scene=FILE out of the list; empty if there is none.
std::string take_scene(int& argc, char** argv) {
  const std::string option = "--scene=";
  std::string file;
  int kept = 0;
  for (int k = 0; k < argc; ++k)
    if (k > 0 && std::strncmp(argv[k], option.c_str(), option.size()) == 0)
      file = argv[k] + option.size();
    else
      argv[kept++] = argv[k];
  argc = kept;
  argv[argc] = nullptr;
  return file;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  try {
    const std::string file = take_scene(argc, argv);
    if (file.empty())
      register_fabric();
    else
      register_scene(SceneFile(file));
  } catch (const crossbeam::InputError& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
  record_build();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
