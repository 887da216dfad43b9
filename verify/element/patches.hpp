#pragma once
/// @file
/// Small meshes, laws and force sums for the verification of elements, bending and dynamics.

#include "crossbeam/crossbeam.hpp"
#include "crossbeam/verification/patch.hpp"
#include "support/random.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace patches {

using namespace crossbeam;
using std::numbers::pi;
using verification::areal_mass;
using verification::border;
using verification::border_forces;
using verification::cells;
using verification::direction;
using verification::eigen;
using verification::energy;
using verification::gradient;
using verification::grid;
using verification::largest;
using verification::LinearLaw;
using verification::map;
using verification::mesh;
using verification::Points;
using verification::random_matrix;
using verification::state_at;
using verification::vec3;

/// The width every test uses that does not vary it.
using Lane = Pack<double, 1>;

/// Distorted inside, straight along the border.
inline Points inner_distortion(int nx, int ny, double edge, double distortion,
                               verify::Random& random) {
  Points X = grid(nx, ny, edge, distortion, random);
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j) {
      Eigen::Vector3d& p = X[static_cast<std::size_t>(i * (ny + 1) + j)];
      if (i == 0 || i == nx) p.x() = edge * i;
      if (j == 0 || j == ny) p.y() = edge * j;
    }
  return X;
}

using Cell = CrossedBeamCell<double>;
template <class Shear>
using Woven = WovenMembrane<Cell, Shear>;

/// Table 1 with a constant shear modulus that is of no special size [kN/mm].
inline Woven<ConstantShear<double>> fabric(double fibre_angle, double shear_modulus = 0.02,
                                           const CellParameters<double>& cell = {}) {
  const FibreAngle<double> angle(fibre_angle);
  return {Cell(cell), ConstantShear<double>(shear_modulus), angle};
}

inline bool is_rotation(const Eigen::Matrix3d& Q) {
  return (Q.transpose() * Q - Eigen::Matrix3d::Identity()).norm() < 1e-14 &&
         std::abs(Q.determinant() - 1) < 1e-14;
}

/// What the membrane claims are made about.
struct TriangleKind {
  using Element = Triangle;
  static constexpr const char* name = "triangle";
};
struct OnePointKind {
  using Element = Quadrilateral<1>;
  static constexpr const char* name = "quadrilateral, 1 point";
};
struct FourPointKind {
  using Element = Quadrilateral<4>;
  static constexpr const char* name = "quadrilateral, 2x2 points";
};

template <class Action>
void for_each_kind(Action action) {
  action(TriangleKind{});
  action(OnePointKind{});
  action(FourPointKind{});
}

}  // namespace patches
