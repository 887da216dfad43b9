#pragma once
/// @file
/// The yardstick: the paper's model programmed the way one reads it, equation by equation in plain
/// scalar Eigen. The cell's constants are computed once, as anyone would; the rest where the
/// equations use it. Nothing in the library calls it. Its answers are those of the library's
/// second-order cell, and every benchmark that times it first checks that.

#include "crossbeam/cell/parameters.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>

namespace bench::paper {

using Base = Eigen::Matrix<double, 3, 2>;  ///< base vectors as columns
using Corners = Eigen::Matrix<double, 3, 4>;

/// How the linear system of an iteration is solved.
enum class Solver {
  lu_4x4,      ///< Eq. 25 as a whole, the master nodes held by unit rows, by LU
  inverse_2x2  ///< only the two heights, by the explicit inverse
};

/// A yarn's unstressed chord (length, cosine, sine; the sine negative for the yarn below) and its
/// stiffnesses along and across it.
struct Yarn {
  double l0, c, s, along, across;

  Yarn(const crossbeam::YarnParameters<double>& y, double height, double boundary_factor)
      : l0(std::hypot(y.length, height)), c(y.length / l0), s(height / l0) {
    along = y.youngs_modulus * y.cross_section / l0;
    across = boundary_factor * y.youngs_modulus * y.second_moment_of_area / (l0 * l0 * l0);
  }

  /// A stiffness along and one across the chord, turned to horizontal and vertical.
  [[nodiscard]] Eigen::Matrix2d turned(double k_along, double k_across) const {
    Eigen::Matrix2d T;
    T << c, s, -s, c;
    return T.transpose() * Eigen::Vector2d(k_along, k_across).asDiagonal() * T;
  }
};

/// Eq. 24-25. Displacements (u1, u2, u3, u4): the master nodes along their yarns, the crossing
/// nodes of warp and weft upwards.
class Cell {
 public:
  explicit Cell(const crossbeam::CellParameters<double>& p)
      : warp_(p.warp, p.warp_height_fraction * p.contact_length, p.bending_boundary_factor),
        weft_(p.weft, -(1 - p.warp_height_fraction) * p.contact_length, p.bending_boundary_factor) {
    const double k3 = p.contact_modulus * p.contact_area / p.contact_length;
    K_E_ =
        assembled(warp_.turned(warp_.along, warp_.across), weft_.turned(weft_.along, weft_.across));
    K_E_.bottomRightCorner<2, 2>() += (Eigen::Matrix2d() << k3, -k3, -k3, k3).finished();
    tolerance_ = 1e-13 * warp_.along;
  }

  /// Forces (F_warp, F_weft). The iteration begins at the forces given: none for a cold start,
  /// those of the cell's previous answer for a warm one.
  template <Solver solver>
  [[nodiscard]] Eigen::Vector2d forces(const Eigen::Vector2d& u,
                                       Eigen::Vector2d F = Eigen::Vector2d::Zero()) const {
    for (int iteration = 0; iteration < 50; ++iteration) {
      const Eigen::Matrix4d K = K_E_ + geometric_stiffness(F);
      Eigen::Vector4d x;
      if constexpr (solver == Solver::lu_4x4) {
        Eigen::Matrix4d held = K;
        held.topRows<2>().setIdentity();
        x = held.partialPivLu().solve(Eigen::Vector4d(u(0), u(1), 0, 0));
      } else {
        const Eigen::Matrix2d K_hh = K.bottomRightCorner<2, 2>();
        x << u, -K_hh.inverse() * K.bottomLeftCorner<2, 2>() * u;
      }
      const Eigen::Vector2d next = K.topRows<2>() * x;
      const double change = (next - F).lpNorm<Eigen::Infinity>();
      F = next;
      if (change <= tolerance_) break;
    }
    return F;
  }

 private:
  /// The warp works on (u1, u3), the weft on (u2, u4).
  static Eigen::Matrix4d assembled(const Eigen::Matrix2d& warp, const Eigen::Matrix2d& weft) {
    Eigen::Matrix4d K = Eigen::Matrix4d::Zero();
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        K(2 * i, 2 * j) = warp(i, j);
        K(2 * i + 1, 2 * j + 1) = weft(i, j);
      }
    return K;
  }

  [[nodiscard]] Eigen::Matrix4d geometric_stiffness(const Eigen::Vector2d& F) const {
    return assembled(warp_.turned(0, F(0) / warp_.l0), weft_.turned(0, F(1) / weft_.l0));
  }

  Yarn warp_, weft_;
  Eigen::Matrix4d K_E_;
  double tolerance_;  ///< of the forces [kN]
};

/// Eq. 1-20, 26 and 27 at one Gauss point.
class Membrane {
 public:
  Membrane(const crossbeam::CellParameters<double>& parameters, double G12, double alpha_bar,
           double delta_bar)
      : cell_(parameters),
        L1_(parameters.warp.length),
        L2_(parameters.weft.length),
        G12_(G12),
        alpha_bar_(alpha_bar),
        delta_bar_(delta_bar) {}

  /// Eq. 5 and 7.
  [[nodiscard]] Eigen::Matrix2d cartesian_from_convected(const Eigen::Matrix2d& A) const {
    const double det = A.determinant(), c = std::cos(alpha_bar_), s = std::sin(alpha_bar_);
    const double skew = A(0, 1) / std::sqrt(det * A(0, 0)), across = std::sqrt(A(0, 0) / det);
    Eigen::Matrix2d d;
    d << c / std::sqrt(A(0, 0)) - skew * s, across * s,  //
        -s / std::sqrt(A(0, 0)) - skew * c, across * c;
    return d;
  }

  /// Second Piola-Kirchhoff stress in the axes Y at the strain E in the same axes.
  /// @param previous the point's forces of the step before, replaced by those of this one; null for
  ///        a cold start
  template <Solver solver>
  [[nodiscard]] Eigen::Matrix2d stress(const Eigen::Matrix2d& E,
                                       Eigen::Vector2d* previous = nullptr) const {
    Eigen::Matrix2d c;  // Eq. 9
    c << 1, 0, std::cos(delta_bar_), std::sin(delta_bar_);
    const Eigen::Matrix2d beta = c * E * c.transpose();     // Eq. 10
    const double l1 = std::sqrt(2 * beta(0, 0) + 1) * L1_;  // Eq. 13
    const double l2 = std::sqrt(2 * beta(1, 1) + 1) * L2_;
    const Eigen::Vector2d u(l1 - L1_, l2 - L2_);  // Eq. 14
    const Eigen::Vector2d F =                     // Eq. 24, 25
        previous ? cell_.forces<solver>(u, *previous) : cell_.forces<solver>(u);
    if (previous) *previous = F;
    const double P11 = F(0) / L2_, P22 = F(1) / L1_;  // Eq. 15
    Eigen::Matrix2d m = Eigen::Matrix2d::Zero();      // Eq. 19
    m(0, 0) = P11 / (l1 / L1_);                       // Eq. 17, 18
    m(1, 1) = P22 / (l2 / L2_);
    Eigen::Matrix2d S = c.transpose() * m * c;  // Eq. 20
    S(0, 1) += G12_ * E(0, 1);                  // Eq. 26, 27
    S(1, 0) += G12_ * E(1, 0);
    return S;
  }

  /// Forces of the corners of a four-node element with one point, from its corners before and
  /// after.
  template <Solver solver>
  [[nodiscard]] Corners corner_forces(const Corners& X, const Corners& x,
                                      Eigen::Vector2d* previous = nullptr) const {
    Eigen::Matrix<double, 4, 2> dN;  // of the shape functions at the centre
    dN << -0.25, -0.25, 0.25, -0.25, 0.25, 0.25, -0.25, 0.25;
    const Base G = X * dN, g = x * dN;                                              // Eq. 1
    const Eigen::Matrix2d A = G.transpose() * G, a = g.transpose() * g;             // Eq. 2
    const Eigen::Matrix2d alpha = (a - A) / 2;                                      // Eq. 3
    const Eigen::Matrix2d d = cartesian_from_convected(A);                          // Eq. 4, 5, 7
    const Eigen::Matrix2d S = stress<solver>(d * alpha * d.transpose(), previous);  // Eq. 6
    const double area = 4 * std::sqrt(A.determinant());
    return area * g * (d.transpose() * S * d) * dN.transpose();
  }

 private:
  Cell cell_;
  double L1_, L2_, G12_, alpha_bar_, delta_bar_;
};

}  // namespace bench::paper
