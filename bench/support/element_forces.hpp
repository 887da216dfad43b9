#pragma once
/// @file
/// A membrane element alone: positions of its corners in the ring to its corner forces, without
/// hourglass control.

#include "support/lanes.hpp"
#include "support/report.hpp"
#include "support/ring.hpp"
#include "support/work.hpp"

#include "crossbeam/base/counting.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/element/triangle.hpp"

#include <array>
#include <cstddef>

namespace bench {

/// An element of edge 1 mm as in Ring, its constants in every lane: the square, or its triangle at
/// the first corner.
template <class T, class Element>
struct UnitElement {
  using R = crossbeam::real_t<T>;
  static constexpr std::size_t corners = Element::corners, points = Element::points,
                               vectors = Element::membrane_vectors;
  /// Of the ring's corners.
  static constexpr std::array<std::size_t, 4> corner_number =
      corners == 3 ? std::array<std::size_t, 4>{0, 1, 3} : std::array<std::size_t, 4>{0, 1, 2, 3};

  crossbeam::PointLanes<T, Element::membrane_vectors> point[points];

  UnitElement() {
    const std::array<crossbeam::Vec3<R>, 4> square{
        {{R(0), R(0), R(0)}, {R(1), R(0), R(0)}, {R(1), R(1), R(0)}, {R(0), R(1), R(0)}}};
    std::array<crossbeam::Vec3<R>, corners> X;
    for (std::size_t a = 0; a < corners; ++a) X[a] = square[corner_number[a]];
    const auto constants =
        Element::template coefficients<R>(X, {{R(1), R(0), R(0)}, {R(0), R(1), R(0)}});
    for (std::size_t p = 0; p < points; ++p) {
      for (std::size_t k = 0; k < vectors; ++k) {
        point[p].t1[k] = T(constants[p].t1[k]);
        point[p].t2[k] = T(constants[p].t2[k]);
      }
      point[p].weight = T(constants[p].weight);
    }
  }
};

template <class T, class Element>
struct CornerForces {
  crossbeam::Vec3<T> corner[Element::corners];
};

/// Positions -> strain -> cell -> stress -> corner forces, of the elements from `first` on.
template <class T, class Element, class Law>
CROSSBEAM_INLINE CornerForces<T, Element> corner_forces(const Law& law,
                                                        const UnitElement<T, Element>& element,
                                                        const Ring<crossbeam::real_t<T>>& ring,
                                                        int first) {
  using crossbeam::Vec3;
  Vec3<T> x[Element::corners], D[Element::vectors], force[Element::vectors]{};
  for (std::size_t a = 0; a < Element::corners; ++a) {
    const auto& from = ring.corner[UnitElement<T, Element>::corner_number[a]];
    x[a] = {load<T>(from.x, first), load<T>(from.y, first), load<T>(from.z, first)};
  }
  Element::relative_vectors(x, D);
  for (const auto& point : element.point) {
    const crossbeam::PointKinematics<T, Element::membrane_vectors, Element::vectors> kinematics(
        D, point);
    const auto at = law.evaluate(kinematics.strain(law.reference().cosine));
    add_point_forces(kinematics, law.stress(at), point, force);
  }
  CornerForces<T, Element> out;
  Element::corner_forces(force, out.corner);
  return out;
}

/// The flops of one element, and its corner positions in and corner forces out.
template <class R, class Element, class Law>
Work corner_forces_work(const Law& law, const Ring<R>& ring) {
  using Counted = crossbeam::Counting<R>;
  const UnitElement<Counted, Element> element;
  const double flops =
      counted_flops([&](int k) { return corner_forces<Counted>(law, element, ring, k); });
  return {flops, 2.0 * 3 * Element::corners * sizeof(R)};
}

/// Times corner_forces over the ring.
template <class T, class Element, class Law>
void time_corner_forces(benchmark::State& state, const Law& law, const RingStates& states,
                        const char* time_per_item) {
  using R = crossbeam::real_t<T>;
  const Ring<R> ring(states);
  const UnitElement<T, Element> element;
  for (auto _ : state)
    for (int k = 0; k < ring_size; k += crossbeam::lanes_v<T>)
      benchmark::DoNotOptimize(corner_forces<T>(law, element, ring, k));
  report(state, ring_size, time_per_item);
  report_work<R>(state, ring_size, corner_forces_work<R, Element>(law, ring));
}

}  // namespace bench
