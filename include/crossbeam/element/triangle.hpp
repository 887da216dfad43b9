#pragma once
/// @file
/// Three-node membrane triangle: constant strain, one point. Theory: docs/theory/element.md.

#include "crossbeam/element/coefficients.hpp"

namespace crossbeam {

struct Triangle {
  static constexpr int corners = 3;
  static constexpr int points = 1;
  static constexpr int vectors = 2;           ///< relative vectors in all
  static constexpr int membrane_vectors = 2;  ///< of them in the Gauss points
  static constexpr bool has_hourglass = false;

  /// D_1 = x2 - x1, D_2 = x3 - x1.
  template <class T>
  CROSSBEAM_INLINE static void relative_vectors(const Vec3<T> (&x)[corners],
                                                Vec3<T> (&D)[vectors]) {
    D[0] = x[1] - x[0];
    D[1] = x[2] - x[0];
  }
  /// The transposed map: corner forces f_a = sum_k c_ka R_k.
  template <class T>
  CROSSBEAM_INLINE static void corner_forces(const Vec3<T> (&R)[vectors], Vec3<T> (&f)[corners]) {
    f[1] = R[0];
    f[2] = R[1];
    f[0] = T(-1) * (R[0] + R[1]);
  }

  /// Normal times twice the area.
  template <class R>
  static Vec3<R> area_vector(const std::array<Vec3<R>, corners>& X) {
    return cross(X[1] - X[0], X[2] - X[0]);
  }

  template <class R>
  static std::array<PointCoefficients<R, vectors>, points> coefficients(
      const std::array<Vec3<R>, corners>& X, const FibreDirections<R>& fibres) {
    const Vec3<R> n = area_vector(X);
    const detail::ElementAxes<R> axes(X[1] - X[0], n);
    const auto b = axes.project(X[2] - X[0]);
    const R a = detail::norm(X[1] - X[0]);  // along the first axis
    const auto solve = [&](const std::array<R, 2>& F) {
      return std::array<R, vectors>{(F[0] * b[1] - F[1] * b[0]) / (a * b[1]), F[1] / b[1]};
    };
    return {{{solve(axes.project(fibres.warp)), solve(axes.project(fibres.weft)),
              detail::norm(n) / R(2)}}};
  }
};

}  // namespace crossbeam
