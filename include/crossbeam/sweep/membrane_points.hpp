#pragma once
/// @file
/// Elements of a mesh with their law: what the membrane sweep runs over, and one loop over the
/// Gauss points for all that is asked beside the forces (energy, samples, heights, tangent).
/// Theory: docs/theory/sweep.md.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/sweep/membrane_constants.hpp"

#include <utility>

namespace crossbeam {

/// A law with a potential. A law without one has its yarns' work summed along the path instead.
template <class Law, class T>
concept MembraneLawWithEnergy =
    requires(const Law& law, const FibreStrain<T>& beta) { law.yarn_energy(law.evaluate(beta)); };

/// A law that keeps the heights of its cells from step to step, tag [C-14].
template <class Law, class T>
concept FollowingLaw = requires {
  requires Law::follows_heights;
  typename Law::template CellSolution<T>;
};

/// @tparam T pack; @tparam Element Triangle or Quadrilateral<1 or 4>
template <class T, class Element, class Law>
  requires MembraneLaw<Law, T>
class MembranePoints {
 public:
  using R = real_t<T>;
  static constexpr int M = Element::membrane_vectors, K = Element::vectors;
  static constexpr int corners = Element::corners;
  using Batches = IndexBatches<corners, T>;
  using Kinematics = PointKinematics<T, M, K>;
  using State = decltype(std::declval<const Law&>().evaluate(std::declval<FibreStrain<T>>()));

  /// One Gauss point of the elements of a batch.
  struct Point {
    int b, p;  ///< numbers of the batch and of the point
    const typename Batches::Batch& batch;
    const Vec3<T> (&D)[K];  ///< relative vectors
    typename MembraneConstants<T, Element>::AtPoint constants;
    Kinematics kinematics;
    State state;  ///< of the law, without strain in lanes that hold no element
  };

  /// @throws InputError when the fibre angle of an element differs from the law's.
  MembranePoints(const Mesh<corners>& mesh, Law law_of_all, double areal_mass,
                 const MembraneOptions& options)
      : law(std::move(law_of_all)),
        batches(mesh.elements),
        constants(mesh, batches, static_cast<double>(law.reference().delta),
                  static_cast<double>(law.stiffness_bound()), areal_mass, options),
        element_count(mesh.element_count()) {}

  /// Law and constants at every point of every batch.
  /// @param visit(point)
  template <class Visit>
  void for_each_point(const NodeVectors<double>& x, const Visit& visit) const {
    for (int b = 0; b < batches.size(); ++b) {
      Vec3<T> D[K];
      relative_vectors(x, b, D);
      for (int p = 0; p < Element::points; ++p) {
        const auto at = constants.at_point(b, p);
        const Kinematics kinematics(D, at.point());
        visit(Point{b, p, batches[b], D, at, kinematics, evaluate(kinematics, b)});
      }
    }
  }

  /// Of positions more precise than the run: differences first, then rounded [D-6].
  void relative_vectors(const NodeVectors<double>& x, int b, Vec3<T> (&D)[K]) const {
    using U = double_lanes_t<T>;
    Vec3<U> corner[corners], difference[K];
    for (int a = 0; a < corners; ++a) corner[a] = batches.template gather<U>(x, batches[b], a);
    Element::relative_vectors(corner, difference);
    for (int k = 0; k < K; ++k) D[k] = convert<T>(difference[k]);
  }

  Law law;
  Batches batches;
  MembraneConstants<T, Element> constants;
  int element_count;

 private:
  /// Not inlined: all that is asked shares one body of the law.
  State evaluate(const Kinematics& kinematics, int b) const {
    FibreStrain<T> beta = kinematics.strain(law.reference().cosine);
    const auto active = batches.active(batches[b]);
    const T zero(R(0));
    beta = {select(active, beta.b11, zero), select(active, beta.b22, zero),
            select(active, beta.b12, zero)};
    return law.evaluate(beta);
  }
};

}  // namespace crossbeam
