#pragma once
/// @file
/// Rotation-free bending along the fibre lines: the curvature of a yarn through a node is a second
/// difference kappa = sum_k w_k x_k of the nodes around it, with constant weights, so that the energy
/// 1/2 D A |kappa|^2 is quadratic and never negative. Theory: docs/theory/bending.md, [B-1].

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <vector>

namespace crossbeam {

/// A node around the centre node, in the tangent plane: `along` the fibre and `across` it.
struct StencilNeighbour {
  int id = 0;  ///< the caller's label
  double along = 0, across = 0;
};

struct StencilWeight {
  int id = 0;
  double weight = 0;  ///< [1/length^2]
};

/// Weights of the second derivative along the fibre at the centre node (label `centre`).
///  - Two neighbours on the fibre line itself, one on each side: three-point difference, tag [B-2].
///  - Otherwise, with neighbours enough: the weights that are exact for every quadratic field and,
///    among those, closest to the fibre line, tag [B-3].
///  - Otherwise (a yarn's free end, a free edge it crosses obliquely) nothing: an empty result.
inline std::vector<StencilWeight> second_difference(int centre,
                                                    const std::vector<StencilNeighbour>& ring) {
  double size = 0;
  for (const auto& n : ring) size = std::max(size, std::hypot(n.along, n.across));
  if (!(size > 0)) return {};

  const StencilNeighbour *ahead = nullptr, *behind = nullptr;
  for (const auto& n : ring) {
    // On the line up to rounding of the mesh coordinates.
    if (std::abs(n.across) > 1e-9 * size) continue;
    if (n.along > 0 && (!ahead || n.along < ahead->along)) ahead = &n;
    if (n.along < 0 && (!behind || n.along > behind->along)) behind = &n;
  }
  if (ahead && behind) {
    const double a = ahead->along, b = -behind->along;
    const double wa = 2 / (a * (a + b)), wb = 2 / (b * (a + b));
    return {{behind->id, wb}, {centre, -(wa + wb)}, {ahead->id, wa}};
  }

  // One-sided rings would extrapolate: the centre has to lie between its neighbours on the line.
  double front = 0, back = 0;
  for (const auto& n : ring) {
    front = std::max(front, n.along);
    back = std::min(back, n.along);
  }
  if (ring.size() < 5 || front < 0.3 * size || back > -0.3 * size) return {};
  double left = 0, right = 0;
  for (const auto& n : ring) {
    left = std::max(left, n.across);
    right = std::min(right, n.across);
  }
  if (left < 0.3 * size || right > -0.3 * size) return {};

  // Minimise sum w^2 / v subject to exactness for 1 (through the centre weight), s, n, s^2, sn, n^2.
  using Monomials = Eigen::Matrix<double, 5, 1>;
  std::vector<Monomials> p(ring.size());
  std::vector<double> v(ring.size());
  Eigen::Matrix<double, 5, 5> gram = Eigen::Matrix<double, 5, 5>::Zero();
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double s = ring[k].along / size, n = ring[k].across / size;
    p[k] << s, n, s * s, s * n, n * n;
    v[k] = 1 / ((n * n + 1e-3) * (n * n + 1e-3));
    gram += v[k] * p[k] * p[k].transpose();
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, 5, 5>> lu(gram);
  if (lu.rank() < 5) return {};
  const Monomials multiplier = lu.solve(2 * Monomials::Unit(2)) / (size * size);
  std::vector<StencilWeight> out{{centre, 0.0}};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double w = v[k] * p[k].dot(multiplier);
    out[0].weight -= w;
    out.push_back({ring[k].id, w});
  }
  return out;
}

}  // namespace crossbeam
