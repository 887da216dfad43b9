#pragma once
/// @file
/// The yardstick timed over the ring, each time after a check that it answers as the library's
/// second-order law does.
///
/// Warm: every entry of the ring remembers its answer, and its strain moves by one time step
/// between two visits, to and fro. (Without that movement there would be nothing left to iterate.)

#include "support/element_forces.hpp"
#include "support/fabric.hpp"
#include "support/paper_baseline.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace bench {

enum class Start { cold, warm };

namespace detail {

/// The yardstick's law, the library's with the same answers, and the rings before and after a step.
struct PaperCase {
  paper::Membrane law{cell_parameters<double>(), shear_modulus, 0, std::numbers::pi / 2};
  decltype(membrane(crossbeam::SecondOrderCell<double>(cell_parameters<double>()),
                    constant_shear<double>(), {})) same =
      membrane(crossbeam::SecondOrderCell<double>(cell_parameters<double>()),
               constant_shear<double>(), crossbeam::SolverControl::converged());
  std::array<Ring<double>, 2> rings{Ring<double>(random_states()),
                                    Ring<double>(one_step_later(random_states()))};
  std::vector<Eigen::Vector2d> previous{ring_size, Eigen::Vector2d::Zero()};

  [[nodiscard]] Eigen::Matrix2d strain(std::size_t ring, int k) const {
    const auto& r = rings[ring];
    const auto i = static_cast<std::size_t>(k);
    Eigen::Matrix2d E;
    E << r.b11[i], r.b12[i], r.b12[i], r.b22[i];
    return E;
  }
  [[nodiscard]] paper::Corners corners(std::size_t ring, int k) const {
    paper::Corners x;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto p = rings[ring].corner[a].get(k);
      x.col(static_cast<Eigen::Index>(a)) << p.x, p.y, p.z;
    }
    return x;
  }
  template <Start start>
  Eigen::Vector2d* memory(int k) {
    return start == Start::warm ? &previous[static_cast<std::size_t>(k)] : nullptr;
  }

  /// Whether `right(ring, k)` holds all over both rings, there and back.
  template <class Right>
  [[nodiscard]] static bool holds(const Right& right) {
    for (const std::size_t ring : {0U, 1U, 0U, 1U})
      for (int k = 0; k < ring_size; ++k)
        if (!right(ring, k)) return false;
    return true;
  }
};

/// Times `run(ring, k)` over the ring, the warm one on both rings by turns.
template <Start start, class Run>
void time_paper(benchmark::State& state, const Run& run, const char* time_per_item) {
  std::size_t ring = 0;
  for (auto _ : state) {
    for (int k = 0; k < ring_size; ++k) benchmark::DoNotOptimize(run(ring, k));
    if (start == Start::warm) ring = 1 - ring;
  }
  report(state, ring_size, time_per_item);
}

}  // namespace detail

/// Strain to stress.
template <paper::Solver solver, Start start = Start::cold>
void paper_point(benchmark::State& state) {
  detail::PaperCase paper;
  const auto stress = [&](std::size_t ring, int k) {
    return paper.law.stress<solver>(paper.strain(ring, k), paper.memory<start>(k));
  };
  const bool right = paper.holds([&](std::size_t ring, int k) {
    const Eigen::Matrix2d E = paper.strain(ring, k), S = stress(ring, k);
    const auto at = paper.same.evaluate(crossbeam::FibreStrain<double>{E(0, 0), E(1, 1), E(0, 1)});
    const auto m = paper.same.stress(at);
    return at.cell.fallback != 0 ||
           (std::abs(S(0, 0) - m.m11) < 1e-10 && std::abs(S(1, 1) - m.m22) < 1e-10 &&
            std::abs(S(0, 1) - m.m12) < 1e-10);
  });
  if (!right) return state.SkipWithError("the yardstick differs from the second-order law");
  detail::time_paper<start>(state, stress, "time_per_point");
}

/// Corner positions to corner forces.
template <paper::Solver solver, Start start = Start::cold>
void paper_corner_forces(benchmark::State& state, const char* time_per_item = "time_per_point") {
  detail::PaperCase paper;
  const UnitElement<double, crossbeam::Quadrilateral<1>> element;
  paper::Corners X;
  X << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  const auto forces = [&](std::size_t ring, int k) {
    return paper.law.corner_forces<solver>(X, paper.corners(ring, k), paper.memory<start>(k));
  };
  const bool right = paper.holds([&](std::size_t ring, int k) {
    const paper::Corners f = forces(ring, k);
    const auto expected = corner_forces<double>(paper.same, element, paper.rings[ring], k);
    for (int a = 0; a < 4; ++a) {
      const auto& e = expected.corner[a];
      if (!((f.col(a) - Eigen::Vector3d(e.x, e.y, e.z)).norm() < 1e-10)) return false;
    }
    return true;
  });
  if (!right) return state.SkipWithError("the yardstick differs from the second-order law");
  detail::time_paper<start>(state, forces, time_per_item);
}

}  // namespace bench
