#pragma once
/// @file
/// The consistent tangent of one membrane element, in plain numbers: one template for all laws and
/// packs. Theory: docs/theory/reference.md, [R-2].

#include "crossbeam/element/coefficients.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/model/tangent_entries.hpp"

#include <Eigen/Core>

#include <array>

namespace crossbeam {

/// State of one Gauss point, as its tangent needs it.
template <int M>
struct MembranePointTangent {
  double t[2][M];    ///< coefficients of the fibre vectors [1/length]
  double weight;     ///< reference area [length^2]
  double viscosity;  ///< mu of [D-5]
  Vec3<double> f[2], rate[2];
  FibreStress<double> stress;
  StrainHessian<double> hessian;
};

/// @tparam Element as MembraneSweep
template <class Element>
class MembraneTangent {
 public:
  static constexpr int M = Element::membrane_vectors, K = Element::vectors;
  static constexpr int corners = Element::corners;

  MembraneTangent() {
    for (int a = 0; a < corners; ++a) {
      Vec3<double> x[corners]{}, D[K];
      x[a].x = 1;
      Element::relative_vectors(x, D);
      for (int k = 0; k < K; ++k) corner_(k, a) = D[k].x;
    }
  }

  void clear() {
    stiffness_.setZero();
    damping_.setZero();
  }

  /// Derivatives of add_point_forces by D_k and its rate.
  void add(const MembranePointTangent<M>& p) {
    const auto vector = [](const Vec3<double>& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    const Eigen::Vector3d f[2] = {vector(p.f[0]), vector(p.f[1])};
    const Eigen::Vector3d rate[2] = {vector(p.rate[0]), vector(p.rate[1])};
    const StrainHessian<double>& h = p.hessian;
    Eigen::Matrix3d H;
    H << h.h11, h.h12, h.h13, h.h12, h.h22, h.h23, h.h13, h.h23, h.h33;
    // Derivatives of (beta11, beta22, beta12) by f1 and f2, then of the point's P1 and P2.
    Eigen::Matrix<double, 3, 6> B = decltype(B)::Zero();
    B.block<1, 3>(0, 0) = f[0].transpose();
    B.block<1, 3>(1, 3) = f[1].transpose();
    B.block<1, 3>(2, 0) = 0.5 * f[1].transpose();
    B.block<1, 3>(2, 3) = 0.5 * f[0].transpose();
    Eigen::Matrix<double, 6, 6> S = B.transpose() * H * B, C = decltype(C)::Zero();
    const double stress[2][2] = {{p.stress.m11, p.stress.m12}, {p.stress.m12, p.stress.m22}};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        S.block<3, 3>(3 * i, 3 * j) += stress[i][j] * Eigen::Matrix3d::Identity();
    if (p.viscosity > 0)
      for (int i = 0; i < 2; ++i) {  // [D-5]: P_i = mu (f.rate) f / (f.f)
        const double Q = f[i].squaredNorm(), power = f[i].dot(rate[i]), c = p.viscosity / Q;
        C.block<3, 3>(3 * i, 3 * i) = c * f[i] * f[i].transpose();
        S.block<3, 3>(3 * i, 3 * i) +=
            c * (power * Eigen::Matrix3d::Identity() + f[i] * rate[i].transpose() -
                 2 * power / Q * f[i] * f[i].transpose());
      }
    for (int k = 0; k < M; ++k)
      for (int n = 0; n < M; ++n)
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) {
            const double factor = p.weight * p.t[i][k] * p.t[j][n];
            stiffness_.template block<3, 3>(3 * k, 3 * n) += factor * S.block<3, 3>(3 * i, 3 * j);
            damping_.template block<3, 3>(3 * k, 3 * n) += factor * C.block<3, 3>(3 * i, 3 * j);
          }
  }

  /// [E-4], amplitude D_3 - p1 D_1 - p2 D_2.
  void add_hourglass(double p1, double p2, double stiffness) {
    const double g[3] = {-p1, -p2, 1};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        stiffness_.template block<3, 3>(3 * i, 3 * j) +=
            stiffness * g[i] * g[j] * Eigen::Matrix3d::Identity();
  }

  /// Adds the element's blocks to those of its nodes.
  void assemble(const std::array<int, corners>& node, bool viscous, TangentEntries& tangent) const {
    assemble(node, stiffness_, tangent.stiffness);
    if (tangent.with_damping && viscous) assemble(node, damping_, tangent.damping);
  }

 private:
  using Block = Eigen::Matrix<double, 3 * K, 3 * K>;

  void assemble(const std::array<int, corners>& node, const Block& block,
                std::vector<TangentEntries::Entry>& list) const {
    for (int a = 0; a < corners; ++a)
      for (int c = 0; c < corners; ++c) {
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (int k = 0; k < K; ++k)
          for (int n = 0; n < K; ++n)
            sum += corner_(k, a) * corner_(n, c) * block.template block<3, 3>(3 * k, 3 * n);
        TangentEntries::add(list, 3 * node[a], 3 * node[c], sum);
      }
  }

  Eigen::Matrix<double, K, corners> corner_;  // D_k = sum_a corner_(k, a) x_a
  Block stiffness_, damping_;
};

}  // namespace crossbeam
