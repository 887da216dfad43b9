/// @file
/// The unit cell alone: elongations of the two yarns -> energy, forces, condensed tangent.
///
///   cell/<what>/<cell>/<iterated how>/<number>
///
/// `paper_*` are the yardstick: Eq. 24-25 in plain Eigen (support/paper_baseline.hpp).

#include "support/fabric.hpp"
#include "support/lanes.hpp"
#include "support/paper_baseline.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"
#include "support/work.hpp"

#include "crossbeam/base/dual.hpp"

#include <cmath>
#include <string>

namespace bench {
namespace {

using crossbeam::CrossedBeamCell;
using crossbeam::Dual;
using crossbeam::real_t;
using crossbeam::SecondOrderCell;
using crossbeam::SolverControl;

/// Runs `kernel(u1, u2)` over the ring.
template <class T, class Kernel>
void time_cells(benchmark::State& state, const Kernel& kernel) {
  const Ring<real_t<T>> ring;
  for (auto _ : state)
    for (int k = 0; k < ring_size; k += crossbeam::lanes_v<T>) {
      if constexpr (crossbeam::ScalarTraits<T>::derivative_order == 0)
        benchmark::DoNotOptimize(kernel(load<T>(ring.u1, k), load<T>(ring.u2, k)));
      else
        benchmark::DoNotOptimize(
            kernel(load_variable<T>(ring.u1, k, 0), load_variable<T>(ring.u2, k, 1)));
    }
  report(state, ring_size, "time_per_cell");
  if constexpr (crossbeam::ScalarTraits<T>::derivative_order == 0) {
    using R = real_t<T>;
    using Counted = crossbeam::Counting<R>;
    const double flops = counted_flops(
        [&](int k) { return kernel(load<Counted>(ring.u1, k), load<Counted>(ring.u2, k)); });
    using Answer = decltype(kernel(load<R>(ring.u1, 0), load<R>(ring.u2, 0)));
    report_work<R>(state, ring_size, {flops, 2.0 * sizeof(R) + sizeof(Answer)});
  }
}

template <class T>
struct ForcesAndTangent {
  crossbeam::CellForces<T> forces;
  crossbeam::CellTangent<T> tangent;
};

template <class T>
void register_energy_cell(const std::string& iterated, SolverControl control) {
  using R = real_t<T>;
  const CrossedBeamCell<R> cell(cell_parameters<R>());
  const auto name = [&](const char* what) {
    return std::string("cell/") + what + "/energy_cell/" + iterated + "/" + number_name<T>();
  };
  const auto add = [&](const char* what, auto kernel) {
    benchmark::RegisterBenchmark(
        name(what).c_str(), [kernel](benchmark::State& state) { time_cells<T>(state, kernel); });
  };
  add("energy", [=]<class S>(const S& u1, const S& u2) {
    return cell.energy(u1, u2, cell.solve(u1, u2, control));
  });
  add("forces",
      [=]<class S>(const S& u1, const S& u2) { return cell.solve(u1, u2, control).forces; });
  add("forces_and_tangent", [=]<class S>(const S& u1, const S& u2) {
    const auto solution = cell.solve(u1, u2, control);
    return ForcesAndTangent<S>{solution.forces, cell.tangent(u1, u2, solution)};
  });
  using D = Dual<T, 2>;
  benchmark::RegisterBenchmark(name("forces_and_tangent_autodiff").c_str(),
                               [=](benchmark::State& state) {
                                 time_cells<D>(state, [&](const D& u1, const D& u2) {
                                   const auto forces = cell.solve(u1, u2, control).forces;
                                   return crossbeam::Vector2<D>(forces.F1, forces.F2);
                                 });
                               });
}

template <class T>
void register_second_order_cell() {
  using R = real_t<T>;
  const SecondOrderCell<R> cell(cell_parameters<R>());
  benchmark::RegisterBenchmark(
      ("cell/forces/second_order_cell/converged/" + number_name<T>()).c_str(),
      [=](benchmark::State& state) {
        time_cells<T>(state,
                      [&]<class S>(const S& u1, const S& u2) { return cell.solve(u1, u2).forces; });
      });
}

/// The yardstick, after a check that it answers as the library's second-order cell does.
template <paper::Solver solver>
void paper_cell(benchmark::State& state) {
  const paper::Cell cell(cell_parameters<double>());
  const SecondOrderCell<double> same(cell_parameters<double>());
  const Ring<double> ring;
  for (std::size_t k = 0; k < ring_size; ++k) {
    const Eigen::Vector2d F = cell.forces<solver>({ring.u1[k], ring.u2[k]});
    const auto expected = same.solve(ring.u1[k], ring.u2[k]);
    if (expected.fallback == 0 && !(std::abs(F(0) - expected.forces.F1) < 1e-10 &&
                                    std::abs(F(1) - expected.forces.F2) < 1e-10))
      return state.SkipWithError("the yardstick differs from the second-order cell");
  }
  for (auto _ : state)
    for (std::size_t k = 0; k < ring_size; ++k)
      benchmark::DoNotOptimize(cell.forces<solver>({ring.u1[k], ring.u2[k]}));
  report(state, ring_size, "time_per_cell");
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  benchmark::RegisterBenchmark("cell/forces/paper_lu_4x4/converged/double",
                               paper_cell<paper::Solver::lu_4x4>);
  benchmark::RegisterBenchmark("cell/forces/paper_inverse_2x2/converged/double",
                               paper_cell<paper::Solver::inverse_2x2>);
  for_each_number([]<class T>() {
    register_second_order_cell<T>();
    register_energy_cell<T>("converged", SolverControl::converged());
    register_energy_cell<T>("3_sweeps", SolverControl::fixed(3));
    register_energy_cell<T>("2_sweeps", SolverControl::fixed(2));
  });
  return true;
}();

}  // namespace
}  // namespace bench
