#pragma once
/// @file
/// Small meshes and force sums for verifying elements: distorted patches with fibres skew to their
/// edges, a quadratic law without a cell, and the border tractions of a homogeneous stress.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/model/nodal_state.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"
#include "crossbeam/verification/random.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <set>
#include <vector>

namespace crossbeam::verification {

using Points = std::vector<Eigen::Vector3d>;

inline Eigen::Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
inline Vec3<double> vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Rows and columns of nodes in the plane z = 0, the inner ones and those of the border moved at
/// random by up to `distortion` of an edge.
inline Points grid(int nx, int ny, double edge, double distortion, Random& random) {
  Points X;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      const double dx = random.uniform(-1, 1), dy = random.uniform(-1, 1);
      X.push_back({edge * (i + distortion * dx), edge * (j + distortion * dy), 0});
    }
  return X;
}

/// Quadrilaterals of the grid, or each of them cut along one diagonal, in alternating directions.
template <int Corners>
std::vector<std::array<int, Corners>> cells(int nx, int ny) {
  std::vector<std::array<int, Corners>> out;
  const int pitch = ny + 1;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      const int a = i * pitch + j, b = a + pitch, c = b + 1, d = a + 1;
      if constexpr (Corners == 4) {
        out.push_back({a, b, c, d});
      } else if ((i + j) % 2 == 0) {
        out.push_back({a, b, c});
        out.push_back({a, c, d});
      } else {
        out.push_back({a, b, d});
        out.push_back({b, c, d});
      }
    }
  return out;
}

inline Eigen::Vector3d direction(double angle) { return {std::cos(angle), std::sin(angle), 0}; }

/// Mesh over a grid that lay in z = 0 before Q turned it; straight fibres.
template <int Corners>
Mesh<Corners> mesh(const Points& X, const std::vector<std::array<int, Corners>>& elements,
                   double warp_angle, double fibre_angle,
                   const Eigen::Matrix3d& Q = Eigen::Matrix3d::Identity()) {
  std::vector<Vec3<double>> positions;
  for (const auto& p : X) positions.push_back(vec3(Q * p));
  const FibreDirections<double> f{vec3(Q * direction(warp_angle)),
                                  vec3(Q * direction(warp_angle + fibre_angle))};
  return {positions, elements, std::vector<FibreDirections<double>>(elements.size(), f)};
}

/// A law of one's own, without a cell: a quadratic energy in the fibre strains, per unit area
/// C/2 (b11^2 + b22^2) + 2 G b12^2.
template <class R>
struct LinearLaw {
  using Real = R;
  R C = R(14), G = R(1);
  FibreAngle<R> angle = FibreAngle<R>::right();

  template <class T>
  struct State {
    FibreState<T> fibres;
  };
  template <class T>
  State<T> evaluate(const FibreStrain<T>& b) const {
    return {{b, stretch(b.b11), stretch(b.b22)}};
  }
  template <class T>
  FibreStress<T> stress(const State<T>& s) const {
    const auto& b = s.fibres.beta;
    return {T(C) * b.b11, T(C) * b.b22, T(R(2) * G) * b.b12};
  }
  template <class T>
  T yarn_energy(const State<T>& s) const {
    const auto& b = s.fibres.beta;
    return T(R(0.5) * C) * (b.b11 * b.b11 + b.b22 * b.b22);
  }
  template <class T>
  T shear_energy(const State<T>& s) const {
    return T(R(2) * G) * s.fibres.beta.b12 * s.fibres.beta.b12;
  }
  template <class T>
  Vector2<T> yarn_tension(const State<T>& s) const {
    return {T(C) * s.fibres.beta.b11 * s.fibres.lambda1,
            T(C) * s.fibres.beta.b22 * s.fibres.lambda2};
  }
  const FibreAngle<R>& reference() const { return angle; }
  /// Up to strains of a fifth: 3 beta of geometric stiffness on top of C.
  R stiffness_bound() const { return R(1.6) * C + R(4) * G; }
};

inline constexpr double areal_mass = 0.743e-6;  // [kg/mm^2]

template <int Corners>
NodalState<double> state_at(const Mesh<Corners>& m, const Points& x) {
  NodalState<double> state(m, areal_mass);
  for (int n = 0; n < m.node_count; ++n) state.x.set(n, vec3(x[n]));
  return state;
}

/// Derivatives of a block's energy with respect to the node positions: minus its forces.
inline Points gradient(ForceBlock<double>& block, NodalState<double>& state) {
  for (int n = 0; n < state.node_count; ++n) state.f.set(n, {0, 0, 0});
  block.add_forces(state, 1.0);
  Points out;
  for (int n = 0; n < state.node_count; ++n) out.push_back(-eigen(state.f.get(n)));
  return out;
}
inline double energy(const ForceBlock<double>& block, const NodalState<double>& state) {
  EnergyLedger e;
  block.add_energy(state, e);
  return e.stored();
}

inline Points map(const Points& X, const Eigen::Matrix3d& A,
                  const Eigen::Vector3d& b = Eigen::Vector3d::Zero()) {
  Points out;
  for (const auto& p : X) out.push_back(A * p + b);
  return out;
}

inline double largest(const Points& v) {
  double out = 0;
  for (const auto& p : v) out = maximum(out, p.norm());
  return out;
}

/// Matrix with entries in [-size, size].
inline Eigen::Matrix3d random_matrix(Random& random, double size) {
  Eigen::Matrix3d A;
  for (int c = 0; c < 3; ++c) A.col(c) = random.vector(size);
  return A;
}

/// Edges that belong to one element only, as (tail, head) with the element on their left.
template <int Corners>
std::vector<std::array<int, 2>> border(const std::vector<std::array<int, Corners>>& elements) {
  std::set<std::array<int, 2>> edges;
  for (const auto& e : elements)
    for (int a = 0; a < Corners; ++a) edges.insert({e[a], e[(a + 1) % Corners]});
  std::vector<std::array<int, 2>> out;
  for (const auto& e : edges)
    if (!edges.count({e[1], e[0]})) out.push_back(e);
  return out;
}

/// Nodal gradient of the energy under a homogeneous first Piola-Kirchhoff stress P, from the border
/// alone: P N per length, without shape functions.
/// @param axes two orthonormal vectors in the plane of the mesh, the columns of P's second index
template <int Corners>
Points border_forces(const Mesh<Corners>& m, const Eigen::Matrix<double, 3, 2>& P,
                     const Base<double>& axes) {
  Points out(m.node_count, Eigen::Vector3d::Zero());
  const Eigen::Vector3d normal = axes.col(0).cross(axes.col(1));
  for (const auto& [tail, head] : border<Corners>(m.elements)) {
    const Eigen::Vector3d side = eigen(m.nodes.get(head)) - eigen(m.nodes.get(tail));
    const Eigen::Vector3d force = P * (axes.transpose() * side.cross(normal)) / 2;
    out[tail] += force;
    out[head] += force;
  }
  return out;
}

}  // namespace crossbeam::verification
