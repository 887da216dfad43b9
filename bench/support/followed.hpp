#pragma once
/// @file
/// Gauss points whose cells are followed from step to step, in the short loops of the law that the
/// sweep calls: strain to stress, or corner positions to corner forces of the one-point
/// quadrilateral without hourglass control.
///
/// Every entry of the ring remembers its heights, and its strain moves by one time step between two
/// visits, to and fro, as the warm yardstick's does.

#include "support/element_forces.hpp"
#include "support/lanes.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"
#include "support/work.hpp"

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/sweep/index_batches.hpp"
#include "crossbeam/sweep/point_rows.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace bench {

/// What a visit begins with, and what it ends with.
enum class Chain { strain_to_stress, corners_to_forces };

/// @tparam Law WovenMembrane with CellPrice::followed, in the numbers of T
template <class T, class Law, Chain chain>
class FollowedPoints {
 public:
  using R = crossbeam::real_t<T>;
  using Quad = crossbeam::Quadrilateral<1>;
  static constexpr int lanes = crossbeam::lanes_v<T>;
  /// Points from loop to loop, as many as in the sweep.
  static constexpr int block = crossbeam::IndexBatches<Quad::corners, T>::run_capacity;
  static_assert(ring_size % block == 0);

  FollowedPoints(const Law& law, const RingStates& states)
      : law_(law),
        rings_{Ring<R>(states), Ring<R>(one_step_later(states))},
        heights_(2 * ring_size) {
    for (std::size_t k = 0; k < ring_size; ++k) {
      const auto at = law_.cell().solve(rings_[0].u1[k], rings_[0].u2[k]);
      const std::size_t pack = k / lanes * 2 * lanes, lane = k % lanes;
      heights_[pack + lane] = at.forces.w1;
      heights_[pack + lanes + lane] = at.forces.w2;
    }
  }

  struct Block : crossbeam::PointRows<T, block> {
    typename Block::VectorRow corner[Quad::corners];
  };

  /// All points at the strains of one ring. `use(first, block)` looks at the answers of every
  /// block.
  template <class Use>
  CROSSBEAM_INLINE void visit(std::size_t ring, const Use& use) {
    const Law law = law_;  // a copy that no store can change
    Block at;
    for (int first = 0; first < ring_size; first += block) {
      evaluate(law, rings_[ring], first, at);
      use(first, at);
    }
  }

  [[nodiscard]] const Ring<R>& ring(std::size_t number) const { return rings_[number]; }

 private:
  CROSSBEAM_INLINE void evaluate(const Law& law, const Ring<R>& ring, int first, Block& at) {
    for (int i = 0; i < block; i += lanes) strain_point(law, ring, first + i, i, at);
    law.stresses(at, block, heights_.data() + 2 * first, 2 * lanes);
    if constexpr (chain == Chain::corners_to_forces)
      for (int i = 0; i < block; i += lanes) collect_point(i, at);
  }

  CROSSBEAM_INLINE void strain_point(const Law& law, const Ring<R>& ring, int k, int i, Block& at) {
    crossbeam::FibreStrain<T> beta;
    if constexpr (chain == Chain::corners_to_forces) {
      crossbeam::Vec3<T> x[Quad::corners], D[Quad::vectors];
      for (std::size_t a = 0; a < Quad::corners; ++a)
        x[a] = {load<T>(ring.corner[a].x, k), load<T>(ring.corner[a].y, k),
                load<T>(ring.corner[a].z, k)};
      Quad::relative_vectors(x, D);
      const Kinematics kinematics(D, element_.point[0]);
      beta = kinematics.strain(law.reference().cosine);
      at.f1.store(i, kinematics.f1);
      at.f2.store(i, kinematics.f2);
    } else {
      beta = {load<T>(ring.b11, k), load<T>(ring.b22, k), load<T>(ring.b12, k)};
    }
    at.store_strain(i, beta);
  }

  CROSSBEAM_INLINE void collect_point(int i, Block& at) {
    crossbeam::Vec3<T> force[Quad::vectors]{}, corner[Quad::corners];
    add_point_forces(Kinematics(at.f1.load(i), at.f2.load(i)), at.stress(i), element_.point[0],
                     force);
    Quad::corner_forces(force, corner);
    for (std::size_t a = 0; a < Quad::corners; ++a) at.corner[a].store(i, corner[a]);
  }

  using Kinematics = crossbeam::PointKinematics<T, Quad::membrane_vectors, Quad::vectors>;

  Law law_;
  UnitElement<T, Quad> element_;
  std::array<Ring<R>, 2> rings_;
  crossbeam::AlignedArray<R> heights_;  // of a pack: warp, weft
};

namespace detail {

/// Largest difference of the followed stresses from those of the converged law over both rings,
/// there and back, over the yarns' stiffness: an error as a strain of the yarn, tag [C-14]. With
/// corners, of their forces; the element has 1 mm edges.
template <class T, class Law, Chain chain>
double following_error(FollowedPoints<T, Law, chain>& points, const Law& law) {
  using R = crossbeam::real_t<T>;
  using Quad = crossbeam::Quadrilateral<1>;
  const auto converged = membrane(law.cell(), law.shear(), crossbeam::SolverControl::converged());
  const UnitElement<R, Quad> element;
  double worst = 0;
  const auto compare = [&](R a, R b) {
    const double off = std::abs(static_cast<double>(a) - static_cast<double>(b));
    worst = off <= worst ? worst : off;  // no number is the worst of all
  };
  for (const std::size_t number : {1U, 0U, 1U, 0U}) {
    const auto& ring = points.ring(number);
    points.visit(number, [&](int first, const auto& at) {
      for (int i = 0; i < points.block; ++i) {
        const auto k = static_cast<std::size_t>(first + i);
        if constexpr (chain == Chain::corners_to_forces) {
          const auto expected = corner_forces<R>(converged, element, ring, first + i);
          for (std::size_t a = 0; a < Quad::corners; ++a) {
            compare(at.corner[a].x.number[i], expected.corner[a].x);
            compare(at.corner[a].y.number[i], expected.corner[a].y);
            compare(at.corner[a].z.number[i], expected.corner[a].z);
          }
        } else {
          const auto m = converged.stress(
              converged.evaluate(crossbeam::FibreStrain<R>{ring.b11[k], ring.b22[k], ring.b12[k]}));
          compare(at.m11.number[i], m.m11);
          compare(at.m22.number[i], m.m22);
          compare(at.m12.number[i], m.m12);
        }
      }
    });
  }
  return worst / static_cast<double>(law.stiffness_bound());
}

}  // namespace detail

/// Times the points over both rings by turns, once their answers are those of the converged law to
/// 1e-7 as a strain of the yarn, the error of [C-14].
template <class Number, Chain chain, class Law>
void time_followed(benchmark::State& state, const Law& law, const RingStates& states) {
  using R = crossbeam::real_t<Number>;
  using T = std::conditional_t<std::is_same_v<Number, R>, crossbeam::Pack<R, 1>, Number>;
  FollowedPoints<T, Law, chain> points(law, states);
  if (!(detail::following_error(points, law) <= 1e-7))
    return state.SkipWithError("the followed cells differ from the converged ones");
  std::size_t ring = 1;
  for (auto _ : state) {
    points.visit(ring, [](int, auto& at) {
      auto* answers = &at;
      benchmark::DoNotOptimize(answers);
      benchmark::ClobberMemory();
    });
    ring = 1 - ring;
  }
  report(state, ring_size, "time_per_point");
  using Counted = crossbeam::Counting<R>;
  FollowedPoints<Counted, Law, chain> counted(law, states);
  crossbeam::reset_operation_count();
  counted.visit(1, [](int, const auto&) {});
  const double flops = static_cast<double>(crossbeam::operation_count().flops()) / ring_size;
  constexpr double numbers = chain == Chain::corners_to_forces ? 2 * 3 * 4 : 6;
  report_work<R>(state, ring_size,
                 {flops, (numbers + 4) * sizeof(R)});  // and the heights to and fro
}

}  // namespace bench
