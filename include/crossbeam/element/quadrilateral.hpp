#pragma once
/// @file
/// Four-node membrane quadrilateral with one point and hourglass control, or with 2x2 points.
/// Theory: docs/theory/element.md.

#include "crossbeam/element/coefficients.hpp"

namespace crossbeam {

/// @tparam Points 1 or 4
template <int Points>
struct Quadrilateral {
  static_assert(Points == 1 || Points == 4, "a quadrilateral has 1 or 2x2 Gauss points");
  static constexpr int corners = 4;
  static constexpr int points = Points;
  static constexpr int vectors = 3;
  static constexpr int membrane_vectors = Points == 1 ? 2 : 3;
  static constexpr bool has_hourglass = Points == 1;

  /// The diagonals D_1 = x3 - x1, D_2 = x4 - x2 and the hourglass vector D_3 = x1 - x2 + x3 - x4.
  template <class T>
  CROSSBEAM_INLINE static void relative_vectors(const Vec3<T> (&x)[corners],
                                                Vec3<T> (&D)[vectors]) {
    D[0] = x[2] - x[0];
    D[1] = x[3] - x[1];
    D[2] = (x[0] - x[1]) + (x[2] - x[3]);
  }
  /// The transposed map: corner forces f_a = sum_k c_ka R_k.
  template <class T>
  CROSSBEAM_INLINE static void corner_forces(const Vec3<T> (&R)[vectors], Vec3<T> (&f)[corners]) {
    f[0] = R[2] - R[0];
    f[1] = T(-1) * (R[1] + R[2]);
    f[2] = R[0] + R[2];
    f[3] = R[1] - R[2];
  }

  /// Normal times twice the area, from the diagonals.
  template <class R>
  static Vec3<R> area_vector(const std::array<Vec3<R>, corners>& X) {
    return cross(X[2] - X[0], X[3] - X[1]);
  }

  /// Gradients of the four shape functions at (xi, eta), in element axes, and the Jacobian.
  template <class R>
  struct ShapeGradient {
    std::array<std::array<R, 2>, corners> dN;
    R jacobian;

    ShapeGradient(const std::array<std::array<R, 2>, corners>& X, R xi, R eta) {
      constexpr int sx[] = {-1, 1, 1, -1}, sy[] = {-1, -1, 1, 1};
      std::array<std::array<R, 2>, corners> d;
      R J[2][2] = {};
      for (int a = 0; a < corners; ++a) {
        d[a] = {R(sx[a]) * (R(1) + R(sy[a]) * eta) / R(4),
                R(sy[a]) * (R(1) + R(sx[a]) * xi) / R(4)};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) J[i][j] += X[a][i] * d[a][j];
      }
      jacobian = J[0][0] * J[1][1] - J[0][1] * J[1][0];
      for (int a = 0; a < corners; ++a)
        dN[a] = {(J[1][1] * d[a][0] - J[1][0] * d[a][1]) / jacobian,
                 (J[0][0] * d[a][1] - J[0][1] * d[a][0]) / jacobian};
    }
  };

  template <class R>
  static std::array<PointCoefficients<R, vectors>, points> coefficients(
      const std::array<Vec3<R>, corners>& X, const FibreDirections<R>& fibres) {
    using std::sqrt;
    const auto [axes, local] = flattened(X);
    const auto F1 = axes.project(fibres.warp), F2 = axes.project(fibres.weft);
    std::array<PointCoefficients<R, vectors>, points> out;
    for (int p = 0; p < points; ++p) {
      const R g = points == 1 ? R(0) : R(1) / sqrt(R(3));
      const R xi = (p & 1) ? g : -g, eta = (p & 2) ? g : -g;
      const ShapeGradient<R> shape(local, xi, eta);
      out[p].t1 = combine(shape, F1);
      out[p].t2 = combine(shape, F2);
      out[p].weight = shape.jacobian * (points == 1 ? R(4) : R(1));
    }
    return out;
  }

  /// Hourglass control of shear size (Flanagan and Belytschko), tag [E-4]: amplitude
  /// q = D_3 - p_1 D_1 - p_2 D_2, which no linear field excites, and energy stiffness/2 |q|^2.
  template <class R>
  struct Hourglass {
    R p1, p2;
    R stiffness;  ///< per unit of the hourglass modulus [-]
  };

  template <class R>
  static Hourglass<R> hourglass(const std::array<Vec3<R>, corners>& X) {
    const auto [axes, local] = flattened(X);
    const ShapeGradient<R> shape(local, R(0), R(0));
    std::array<R, 2> h{};
    R gradient_squared(0);
    for (int a = 0; a < corners; ++a)
      for (int i = 0; i < 2; ++i) {
        h[i] += R(a % 2 == 0 ? 1 : -1) * local[a][i];
        gradient_squared += shape.dN[a][i] * shape.dN[a][i];
      }
    const auto p = combine(shape, h);
    return {p[0], p[1], R(4) * shape.jacobian * gradient_squared / R(16)};
  }

 private:
  template <class R>
  struct Flattened {
    detail::ElementAxes<R> axes;
    std::array<std::array<R, 2>, corners> local;
  };
  template <class R>
  static Flattened<R> flattened(const std::array<Vec3<R>, corners>& X) {
    Flattened<R> out{{X[2] - X[0], area_vector(X)}, {}};
    for (int a = 0; a < corners; ++a) out.local[a] = out.axes.project(X[a] - X[0]);
    return out;
  }

  /// Derivative along the direction F as coefficients of D_1, D_2, D_3, tag [E-2].
  template <class R>
  static std::array<R, vectors> combine(const ShapeGradient<R>& shape, const std::array<R, 2>& F) {
    std::array<R, corners> b;
    for (int a = 0; a < corners; ++a) b[a] = shape.dN[a][0] * F[0] + shape.dN[a][1] * F[1];
    return {(b[2] - b[0]) / R(2), (b[3] - b[1]) / R(2), (b[0] + b[2]) / R(2)};
  }
};

}  // namespace crossbeam
