#pragma once
/// @file
/// Rotation-free bending along the fibre lines: the curvature of a yarn through a node is a second
/// difference kappa = sum_k w_k x_k of the nodes around it, with constant weights, so that the
/// energy 1/2 D A |kappa|^2 is quadratic and never negative. Theory: docs/theory/bending.md, [B-1].

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
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

/// Largest sum of |w| times the ring's radius squared that a stencil may have. Three equidistant
/// points have 4, good rings below 20; beyond, the ring extrapolates.
inline constexpr double stencil_limit = 64;

namespace detail {

/// Radius of a ring; 0 when a neighbour is not finite or the radius cannot be squared.
inline double ring_radius(const std::vector<StencilNeighbour>& ring) {
  using Limits = std::numeric_limits<double>;
  double size = 0;
  for (const auto& n : ring) {
    const double distance = std::hypot(n.along, n.across);
    if (!is_finite(distance)) return 0;
    size = maximum(size, distance);
  }
  const double squared = size * size;
  return squared >= (Limits::min)() / Limits::epsilon() &&
                 squared <= (Limits::max)() * Limits::epsilon()
             ? size
             : 0;
}

/// P A Q = L U of a 5 x 5 matrix with complete pivoting.
class FullPivoting {
 public:
  static constexpr int size = 5;
  using Vector = std::array<double, size>;

  explicit FullPivoting(const std::array<Vector, size>& matrix) : a_(matrix) {
    double largest = 0;
    for (int k = 0; k < size; ++k) {
      int row = k, column = k;
      for (int i = k; i < size; ++i)
        for (int j = k; j < size; ++j)
          if (std::abs(a_[i][j]) > std::abs(a_[row][column])) row = i, column = j;
      row_[k] = row;
      column_[k] = column;
      std::swap(a_[k], a_[row]);
      for (auto& r : a_) std::swap(r[k], r[column]);
      largest = std::max(largest, std::abs(a_[k][k]));
      is_regular_ = is_regular_ &&
                    std::abs(a_[k][k]) > size * std::numeric_limits<double>::epsilon() * largest;
      if (!is_regular_) return;
      for (int i = k + 1; i < size; ++i) {
        a_[i][k] /= a_[k][k];
        for (int j = k + 1; j < size; ++j) a_[i][j] -= a_[i][k] * a_[k][j];
      }
    }
  }
  /// Whether every pivot is above the rounding of the largest.
  [[nodiscard]] bool is_regular() const { return is_regular_; }

  [[nodiscard]] Vector solve(Vector b) const {
    for (int k = 0; k < size; ++k) std::swap(b[k], b[row_[k]]);
    for (int k = 0; k < size; ++k)
      for (int i = k + 1; i < size; ++i) b[i] -= a_[i][k] * b[k];
    for (int k = size - 1; k >= 0; --k) {
      for (int j = k + 1; j < size; ++j) b[k] -= a_[k][j] * b[j];
      b[k] /= a_[k][k];
    }
    for (int k = size - 1; k >= 0; --k) std::swap(b[k], b[column_[k]]);
    return b;
  }

 private:
  std::array<Vector, size> a_;
  std::array<int, size> row_{}, column_{};
  bool is_regular_ = true;
};

}  // namespace detail

/// Second derivative along the fibre at the centre node (label `centre`) from the nearest node on
/// the fibre line itself, on each side, tag [B-2]; empty when there is none on one side, or when a
/// distance in the ring is not finite or cannot be squared.
inline std::vector<StencilWeight> three_point_difference(
    int centre, const std::vector<StencilNeighbour>& ring) {
  const double size = detail::ring_radius(ring);
  if (!(size > 0)) return {};
  const StencilNeighbour *ahead = nullptr, *behind = nullptr;
  for (const auto& n : ring) {
    // On the line up to rounding of the mesh coordinates.
    if (std::abs(n.across) > 1e-9 * size) continue;
    if (n.along > 0 && (!ahead || n.along < ahead->along)) ahead = &n;
    if (n.along < 0 && (!behind || n.along > behind->along)) behind = &n;
  }
  if (!ahead || !behind) return {};
  const double a = ahead->along, b = -behind->along;
  const double wa = 2 / (a * (a + b)), wb = 2 / (b * (a + b));
  if (!is_finite(wa + wb)) return {};
  return {{behind->id, wb}, {centre, -(wa + wb)}, {ahead->id, wa}};
}

/// The same from any ring of five nodes or more around the centre: of all weights that are exact
/// for every quadratic field, those closest to the fibre line, tag [B-3]. Empty when the ring does
/// not determine them well.
inline std::vector<StencilWeight> quadratic_difference(int centre,
                                                       const std::vector<StencilNeighbour>& ring) {
  const double size = detail::ring_radius(ring);
  if (ring.size() < 5 || !(size > 0)) return {};

  // Minimise sum w^2 / v subject to exactness for 1 (through the centre weight), s, n, s^2, sn,
  // n^2.
  using Monomials = detail::FullPivoting::Vector;
  constexpr int size_of_basis = detail::FullPivoting::size;
  std::vector<Monomials> p(ring.size());
  std::vector<double> v(ring.size()), w(ring.size(), 0.0);
  std::array<Monomials, size_of_basis> gram{};
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double s = ring[k].along / size, n = ring[k].across / size;
    p[k] = {s, n, s * s, s * n, n * n};
    v[k] = 1 / ((n * n + 1e-3) * (n * n + 1e-3));
    for (int i = 0; i < size_of_basis; ++i)
      for (int j = 0; j < size_of_basis; ++j) gram[i][j] += v[k] * p[k][i] * p[k][j];
  }
  const detail::FullPivoting lu(gram);
  if (!lu.is_regular()) return {};
  // A second pass takes out what the condition of the matrix, 1e6 by the weights v, has left over.
  Monomials missing{0, 0, 2, 0, 0};
  for (int pass = 0; pass < 2; ++pass) {
    const Monomials multiplier = lu.solve(missing);
    for (std::size_t k = 0; k < ring.size(); ++k) {
      double exact = 0;
      for (int i = 0; i < size_of_basis; ++i) exact += p[k][i] * multiplier[i];
      const double dw = v[k] * exact;
      w[k] += dw;
      for (int i = 0; i < size_of_basis; ++i) missing[i] -= dw * p[k][i];
    }
  }
  std::vector<StencilWeight> out{{centre, 0.0}};
  double sum = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const double weight = w[k] / (size * size);
    out[0].weight -= weight;
    out.push_back({ring[k].id, weight});
    sum += std::abs(w[k]);
  }
  if (!(sum <= stencil_limit)) return {};
  return out;
}

}  // namespace crossbeam
