#pragma once
/// @file
/// The moving part of a model: positions, velocities, forces and masses of the nodes.

#include "crossbeam/mesh/arrays.hpp"
#include "crossbeam/mesh/mesh.hpp"

#include <limits>
#include <string>
#include <vector>

namespace crossbeam {

/// Which components of a node may move; a fixed node has none.
struct NodeConstraint {
  int node = 0;
  bool fix_x = false, fix_y = false, fix_z = false;
};

/// State of the leap-frog scheme at step n. R is float or double.
template <class R>
struct NodalState {
  int node_count = 0;
  double areal_mass = 0;      ///< that the masses were made of [kg/mm^2]
  double widest_element = 0;  ///< longest distance between two nodes of one element [mm]
  NodeVectors<double> x;      ///< positions x_n [mm]; kernels get their differences, tag [D-6]
  NodeVectors<R> v;           ///< velocities v_{n-1/2} [mm/ms]
  /// Velocities predicted for t_n from v_{n-1/2} and the last acceleration, of second order,
  /// 2 v_{n-1/2} - v_{n-1}, tag [D-2] [mm/ms]
  NodeVectors<R> v_predicted;
  NodeVectors<R> f;              ///< forces f_n [kN]
  NodeVectors<R> free;           ///< 1 where a component may move, 0 where it is fixed
  AlignedArray<R> mass;          ///< [kg]; 0 in the padding
  AlignedArray<R> inverse_mass;  ///< [1/kg]; 0 in the padding
  AlignedArray<R> area;          ///< tributary reference area [mm^2]; 0 in the padding

  NodalState() = default;

  /// @param mass_per_area [kg/mm^2]; > 0
  template <int Corners>
  NodalState(const Mesh<Corners>& mesh, double mass_per_area,
             const std::vector<NodeConstraint>& constraints = {})
      : node_count(mesh.node_count),
        areal_mass(mass_per_area),
        widest_element(crossbeam::widest_element(mesh)),
        x(node_count),
        v(node_count),
        v_predicted(node_count),
        f(node_count),
        free(node_count),
        mass(padded(node_count)),
        inverse_mass(padded(node_count)),
        area(padded(node_count)) {
    require_positive("areal_mass", areal_mass, "kg/mm^2");
    const std::vector<double> A = mesh.tributary_areas();
    for (int n = 0; n < node_count; ++n) {
      if (!(A[n] > 0))
        throw InputError("mesh.nodes[" + std::to_string(n) + "]", "no element", "",
                         "every node belongs to an element");
      x.set(n, mesh.nodes.get(n));
      free.set(n, {R(1), R(1), R(1)});
      area[n] = R(A[n]);
      mass[n] = R(A[n] * areal_mass);
      inverse_mass[n] = R(1 / (A[n] * areal_mass));
      // In float a mass may vanish that is one in double.
      const R most = (std::numeric_limits<R>::max)();
      if (!(mass[n] > R(0) && mass[n] <= most && inverse_mass[n] > R(0) && inverse_mass[n] <= most))
        throw InputError("mass of mesh.nodes[" + std::to_string(n) + "]",
                         detail::to_text(A[n] * areal_mass), "kg",
                         "> 0 and finite in the run's precision, with its reciprocal");
    }
    for (const NodeConstraint& c : constraints) {
      if (c.node < 0 || c.node >= node_count)
        throw InputError("constraint.node", std::to_string(c.node), "",
                         "0 to " + std::to_string(node_count - 1));
      if (c.fix_x) free.x[c.node] = R(0);
      if (c.fix_y) free.y[c.node] = R(0);
      if (c.fix_z) free.z[c.node] = R(0);
    }
  }
};

/// Constraints of the nodes on the mirror planes: those closer to a plane than a thousandth of the
/// mesh's shortest edge. A mesh that comes with rounded coordinates keeps all of them.
/// @throws InputError for a plane without a node on it
template <int Corners>
std::vector<NodeConstraint> symmetry_constraints(const Mesh<Corners>& mesh,
                                                 const SymmetryPlanes& planes) {
  const double tolerance = plane_tolerance(mesh);
  std::vector<NodeConstraint> out;
  bool found_x = false, found_y = false;
  for (int n = 0; n < mesh.node_count; ++n) {
    const Vec3<double> X = mesh.nodes.get(n);
    const bool on_x = planes.x && std::abs(X.x) <= tolerance;
    const bool on_y = planes.y && std::abs(X.y) <= tolerance;
    found_x = found_x || on_x;
    found_y = found_y || on_y;
    if (on_x || on_y) out.push_back({n, on_x, on_y, false});
  }
  const auto require = [&](bool wanted, bool found, const char* name) {
    if (wanted && !found)
      throw InputError(name, "no node within " + detail::to_text(tolerance) + " of it", "mm",
                       "a mirror plane with nodes on it, for the mesh ends there");
  };
  require(planes.x, found_x, "symmetry plane x = 0");
  require(planes.y, found_y, "symmetry plane y = 0");
  return out;
}

}  // namespace crossbeam
