#pragma once
/// @file
/// The membrane sweep with a consistent tangent, for implicit methods and statics: only who asks
/// for it compiles it. Theory: docs/theory/reference.md, [R-2].

#include "crossbeam/model/tangent_entries.hpp"
#include "crossbeam/sweep/membrane_sweep.hpp"

#include <array>
#include <concepts>
#include <vector>

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

/// The tangent of one membrane element, in plain numbers: one template for all laws and packs.
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
      for (int k = 0; k < K; ++k) corner_[k][a] = D[k].x;
    }
  }

  void clear() { stiffness_ = damping_ = {}; }

  /// Derivatives of add_point_forces by D_k and its rate.
  void add(const MembranePointTangent<M>& p) {
    const double f[2][3] = {{p.f[0].x, p.f[0].y, p.f[0].z}, {p.f[1].x, p.f[1].y, p.f[1].z}};
    const double rate[2][3] = {{p.rate[0].x, p.rate[0].y, p.rate[0].z},
                               {p.rate[1].x, p.rate[1].y, p.rate[1].z}};
    const StrainHessian<double>& h = p.hessian;
    const double H[3][3] = {{h.h11, h.h12, h.h13}, {h.h12, h.h22, h.h23}, {h.h13, h.h23, h.h33}};
    const double stress[2][2] = {{p.stress.m11, p.stress.m12}, {p.stress.m12, p.stress.m22}};
    // Derivatives of (beta11, beta22, beta12) by f1 and f2, then of the point's P1 and P2.
    double B[3][6] = {}, S[6][6] = {}, C[6][6] = {};
    for (int c = 0; c < 3; ++c) {
      B[0][c] = f[0][c];
      B[1][3 + c] = f[1][c];
      B[2][c] = 0.5 * f[1][c];
      B[2][3 + c] = 0.5 * f[0][c];
    }
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) {
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) S[r][c] += B[a][r] * H[a][b] * B[b][c];
        if (r % 3 == c % 3) S[r][c] += stress[r / 3][c / 3];
      }
    if (p.viscosity > 0)
      for (int i = 0; i < 2; ++i) {  // [D-5]: P_i = mu (f.rate) f / (f.f)
        const double Q = dot(p.f[i], p.f[i]), power = dot(p.f[i], p.rate[i]), c = p.viscosity / Q;
        for (int r = 0; r < 3; ++r)
          for (int s = 0; s < 3; ++s) {
            C[3 * i + r][3 * i + s] = c * f[i][r] * f[i][s];
            S[3 * i + r][3 * i + s] += c * ((r == s ? power : 0) + f[i][r] * rate[i][s] -
                                            2 * power / Q * f[i][r] * f[i][s]);
          }
      }
    for (int r = 0; r < 3 * M; ++r)
      for (int c = 0; c < 3 * M; ++c)
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) {
            const double factor = p.weight * p.t[i][r / 3] * p.t[j][c / 3];
            stiffness_[r][c] += factor * S[3 * i + r % 3][3 * j + c % 3];
            damping_[r][c] += factor * C[3 * i + r % 3][3 * j + c % 3];
          }
  }

  /// [E-4], amplitude D_3 - p1 D_1 - p2 D_2.
  void add_hourglass(double p1, double p2, double stiffness) {
    const double g[3] = {-p1, -p2, 1};
    for (int r = 0; r < 9; ++r)
      for (int c = r % 3; c < 9; c += 3) stiffness_[r][c] += stiffness * g[r / 3] * g[c / 3];
  }

  /// Adds the element's blocks to those of its nodes.
  void assemble(const std::array<int, corners>& node, bool viscous, TangentEntries& tangent) const {
    assemble(node, stiffness_, tangent.stiffness);
    if (tangent.with_damping && viscous) assemble(node, damping_, tangent.damping);
  }

 private:
  using Block = std::array<std::array<double, 3 * K>, 3 * K>;

  void assemble(const std::array<int, corners>& node, const Block& block,
                std::vector<TangentEntries::Entry>& list) const {
    for (int a = 0; a < corners; ++a)
      for (int c = 0; c < corners; ++c)
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            double sum = 0;
            for (int k = 0; k < K; ++k)
              for (int n = 0; n < K; ++n)
                sum += corner_[k][a] * corner_[n][c] * block[3 * k + i][3 * n + j];
            list.push_back({3 * node[a] + i, 3 * node[c] + j, sum});
          }
  }

  double corner_[K][corners];  // D_k = sum_a corner_[k][a] x_a
  Block stiffness_, damping_;
};

/// A law with second derivatives, which an energy cell has.
template <class Law, class T>
concept MembraneLawWithTangent =
    MembraneLaw<Law, T> && requires(const Law& law, const FibreStrain<T>& b) {
      { law.hessian(law.evaluate(b)) } -> std::same_as<StrainHessian<T>>;
    };

/// As MembraneSweep, for FirstOrderSystem's Jacobian and StaticProblem.
template <class T, class Element, class Law>
  requires MembraneLawWithTangent<Law, T>
class MembraneSweepWithTangent final : public MembraneSweep<T, Element, Law> {
  using Sweep = MembraneSweep<T, Element, Law>;

 public:
  using Sweep::Sweep;
  using typename Sweep::R;

  void add_tangent(const NodalState<R>& state, TangentEntries& tangent) const override {
    constexpr int M = Sweep::M, K = Sweep::K, corners = Sweep::corners, lanes = Sweep::lanes;
    const auto& points = this->membrane();
    const bool viscous = points.constants.is_viscous();
    MembraneTangent<Element> element;
    MembranePointTangent<M> at_point[lanes][Element::points];
    points.for_each_point(state.x, [&](const auto& at) {
      Vec3<T> v[corners], rate[K];
      for (int a = 0; a < corners; ++a) v[a] = points.batches.gather(state.v, at.batch, a);
      Element::relative_vectors(v, rate);
      const PointLanes<T, M> point = at.constants.point();
      const PointKinematics<T, M, K> rates(rate, point);
      const FibreStress<T> m = points.law.stress(at.state);
      const StrainHessian<T> h = points.law.hessian(at.state);
      const T mu = at.constants.viscosity();
      for (int l = 0; l < lanes; ++l) {
        if (!at.batch.holds(l)) continue;
        const auto real = [l](const T& value) { return static_cast<double>(value[l]); };
        const auto vector = [&](const Vec3<T>& f) {
          return Vec3<double>{real(f.x), real(f.y), real(f.z)};
        };
        MembranePointTangent<M>& out = at_point[l][at.p];
        for (int k = 0; k < M; ++k) {
          out.t[0][k] = real(point.t1[k]);
          out.t[1][k] = real(point.t2[k]);
        }
        out.weight = real(point.weight);
        out.viscosity = real(mu);
        out.f[0] = vector(at.kinematics.f1);
        out.f[1] = vector(at.kinematics.f2);
        out.rate[0] = vector(rates.f1);
        out.rate[1] = vector(rates.f2);
        out.stress = {real(m.m11), real(m.m22), real(m.m12)};
        out.hessian = {real(h.h11), real(h.h22), real(h.h33),
                       real(h.h12), real(h.h13), real(h.h23)};
        if (at.p + 1 < Element::points) continue;
        element.clear();
        for (const auto& p : at_point[l]) element.add(p);
        if constexpr (Element::has_hourglass) {
          const auto& c = at.constants;
          const T stiffness = T(points.constants.hourglass_modulus()) * c.hourglass(2);
          element.add_hourglass(real(c.hourglass(0)), real(c.hourglass(1)), real(stiffness));
        }
        std::array<int, corners> node;
        for (int a = 0; a < corners; ++a) node[a] = points.batches.node(at.b, a, l);
        element.assemble(node, viscous, tangent);
      }
    });
  }
};

}  // namespace crossbeam
