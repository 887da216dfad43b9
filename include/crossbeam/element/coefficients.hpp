#pragma once
/// @file
/// What every membrane element here shares: its current shape enters through a few relative
/// vectors D_k = sum_a c_ka x_a with constant integers c, and each Gauss point has the fibre
/// vectors f_i = F F_i = sum_k t_ik D_k with constant t. Theory: docs/theory/element.md, [E-1].

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <array>
#include <cmath>
#include <string>

namespace crossbeam {

/// One Gauss point of one element, constant in time. K relative vectors.
template <class R, int K>
struct PointCoefficients {
  std::array<R, K> t1{}, t2{};  ///< f_i = sum_k t_ik D_k [1/length]
  R weight{};                   ///< reference area of the point [length^2]
};

/// Reference fibre directions of an element, unit vectors in space.
template <class R>
struct FibreDirections {
  Vec3<R> warp, weft;
};

namespace detail {

template <class R>
R norm(const Vec3<R>& v) {
  using std::sqrt;
  return sqrt(dot(v, v));
}

/// In-plane axes of an element with normal along n, and the fibres in them.
template <class R>
struct ElementAxes {
  Vec3<R> e1, e2, n;

  /// @param tangent any vector in the plane
  ElementAxes(const Vec3<R>& tangent, const Vec3<R>& normal) {
    n = (R(1) / norm(normal)) * normal;
    e1 = (R(1) / norm(tangent)) * tangent;
    e2 = cross(n, e1);
  }
  [[nodiscard]] std::array<R, 2> project(const Vec3<R>& v) const {
    return {dot(v, e1), dot(v, e2)};
  }
};

}  // namespace detail
}  // namespace crossbeam
