#pragma once
/// @file
/// The membrane forces of a mesh, a batch of elements at a time: relative vectors -> fibre vectors
/// -> law -> generalised forces -> corners. Theory: docs/theory/sweep.md.

#include "crossbeam/dynamics/force_block.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/mesh/batches.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace crossbeam {

struct MembraneOptions {
  double hourglass_modulus = 0;  ///< of one-point quadrilaterals [kN/mm]; >= 0, tag [E-4]
  double bulk_viscosity = 0;     ///< linear, on the fibre stretch rates [-]; >= 0, tag [D-5]
};

/// @tparam T pack; @tparam Element Triangle or Quadrilateral<1 or 4>
template <class T, class Element, class Law>
  requires MembraneLaw<Law, T>
class MembraneSweep final : public ForceBlock<real_t<T>> {
 public:
  using R = real_t<T>;
  static constexpr int lanes = lanes_v<T>;
  static constexpr int M = Element::membrane_vectors;
  static constexpr int K = Element::vectors;
  static constexpr int corners = Element::corners;
  static constexpr int point_size = 2 * M + 1;  ///< constants of one point: t1, t2, weight
  /// A cell without a potential has its yarn work summed along the path instead.
  static constexpr bool has_energy = requires(const Law& law, const FibreStrain<T>& b) {
    law.yarn_energy(law.evaluate(b));
  };

  static constexpr bool has_tangent = requires(const Law& law, const FibreStrain<T>& b) {
    { law.hessian(law.evaluate(b)) } -> std::same_as<StrainHessian<T>>;
  };

  /// A law of one's own need not have a cell; then there is nothing of a cell to sample.
  static constexpr bool has_cell = requires(const Law& law) { law.cell().parameters(); };

  /// @throws InputError when the fibre angle of an element differs from the law's.
  MembraneSweep(const Mesh<corners>& mesh, Law law, double areal_mass,
                const MembraneOptions& options = {})
      : law_(std::move(law)),
        batches_(mesh.elements),
        constants_(batches_.size(), Element::points * point_size + (Element::has_hourglass ? 3 : 0)),
        previous_(has_energy ? 0 : batches_.size(), has_energy ? 0 : Element::points * 4),
        element_count_(mesh.element_count()) {
    hourglass_ = R(require_non_negative("hourglass_modulus", options.hourglass_modulus, "kN/mm"));
    require_non_negative("bulk_viscosity", options.bulk_viscosity, "-");
    require_positive("areal_mass", areal_mass, "kg/mm^2");
    const double stiffness = static_cast<double>(law_.stiffness_bound());
    const double impedance = options.bulk_viscosity * std::sqrt(areal_mass * stiffness);
    for (int e = 0; e < element_count_; ++e) {
      const double difference =
          std::abs(mesh.fibre_angle(e) - static_cast<double>(law_.reference().delta));
      if (difference > 1e-6)
        throw InputError("mesh.fibres[" + std::to_string(e) + "] angle from warp to weft",
                         detail::to_text(mesh.fibre_angle(e) * 180 / std::numbers::pi), "deg",
                         "the law's " + detail::to_text(static_cast<double>(law_.reference().delta) *
                                                        180 / std::numbers::pi));
      const double omega_squared = element_omega_squared(mesh, e, stiffness, areal_mass);
      if (!std::isfinite(omega_squared))
        throw InputError("squared frequency of mesh.elements[" + std::to_string(e) + "]",
                         detail::to_text(omega_squared), "1/ms^2", "a finite number");
      omega_squared_ = std::max(omega_squared_, omega_squared);
      // mu = b rho c h with h = sqrt(A); it acts where the stiffness acts, mu / stiffness as
      // strong.
      double area = 0;
      for (const auto& p : Element::coefficients(mesh.corners(e), mesh.fibres[e]))
        area = std::max(area, Element::points * p.weight);
      damping_rate_ =
          std::max(damping_rate_, impedance * std::sqrt(area) / stiffness * omega_squared);
    }
    viscosity_ = options.bulk_viscosity > 0;
    impedance_ = R(impedance);
    for (int b = 0; b < batches_.size(); ++b)
      for (int l = 0; l < lanes; ++l) fill_constants(mesh, b, l);
  }

  void add_forces(NodalState<R>& state, double dt) override {
    if (viscosity_)
      sweep<true>(state, dt);
    else
      sweep<false>(state, dt);
  }

  void add_energy(const NodalState<R>& state, InternalEnergy& energy) const override {
    for (int b = 0; b < batches_.size(); ++b) {
      const auto& batch = batches_[b];
      const auto active = batches_.active(batch);
      Vec3<T> D[K];
      relative_vectors(state.x, batch, D);
      T yarn(R(0)), shear(R(0)), hourglass(R(0));
      for (int p = 0; p < Element::points; ++p) {
        const PointLanes<T, M> point = load_point(b, p);
        const auto at = law_.evaluate(strain(PointKinematics<T, M, K>(D, point), active));
        if constexpr (has_energy) yarn = yarn + point.weight * law_.yarn_energy(at);
        shear = shear + point.weight * law_.shear_energy(at);
      }
      if constexpr (Element::has_hourglass) {
        const Vec3<T> q = hourglass_vector(b, D);
        hourglass = T(R(0.5)) * hourglass_stiffness(b) * dot(q, q);
      }
      const T zero(R(0));
      energy.yarn += static_cast<double>(lane_sum(select(active, yarn, zero)));
      energy.shear += static_cast<double>(lane_sum(select(active, shear, zero)));
      energy.hourglass += static_cast<double>(lane_sum(select(active, hourglass, zero)));
    }
    energy.yarn += path_work_;
    // At t_n only half of this step's dissipation has happened.
    energy.bulk_viscosity += viscous_work_ - 0.5 * viscous_step_;
  }

  void add_tangent(const NodalState<R>& state, TangentEntries& tangent) const override {
    if constexpr (has_tangent)
      assemble(state, tangent);
    else
      ForceBlock<R>::add_tangent(state, tangent);
  }

  [[nodiscard]] double omega_squared() const override { return omega_squared_; }
  [[nodiscard]] double damping_rate() const override { return damping_rate_; }
  [[nodiscard]] long long points() const override {
    return static_cast<long long>(element_count_) * Element::points;
  }
  [[nodiscard]] long long fallbacks() const override { return fallbacks_; }
  [[nodiscard]] const Law& law() const { return law_; }

  void sample(const NodalState<R>& state, std::vector<ElementSample>& out) const override {
    const std::size_t offset = out.size();
    out.resize(offset + static_cast<std::size_t>(element_count_));
    const double share = 1.0 / Element::points;
    for (int b = 0; b < batches_.size(); ++b) {
      const auto& batch = batches_[b];
      const auto active = batches_.active(batch);
      Vec3<T> D[K];
      relative_vectors(state.x, batch, D);
      for (int p = 0; p < Element::points; ++p) {
        const PointLanes<T, M> point = load_point(b, p);
        const PointKinematics<T, M, K> kinematics(D, point);
        const auto at = law_.evaluate(strain(kinematics, active));
        const T cosine = fibre_cosine(at.fibres.beta, at.fibres.lambda1, at.fibres.lambda2,
                                      law_.reference().cosine);
        const T gamma = shear_angle(cosine, law_.reference());
        const auto tension = law_.yarn_tension(at);
        for (int l = 0; l < batch.active; ++l) {
          ElementSample& s = out[offset + static_cast<std::size_t>(batch.first_tuple + l)];
          s.shear_angle += share * static_cast<double>(gamma[l]);
          const double lambda[2] = {static_cast<double>(at.fibres.lambda1[l]),
                                    static_cast<double>(at.fibres.lambda2[l])};
          for (int i = 0; i < 2; ++i) {
            s.stretch[i] += share * (lambda[i] - 1);
            s.tension[i] += share * static_cast<double>(tension(i)[l]);
          }
          if constexpr (has_cell) sample_cell(at, l, s);
          const auto unit = [&](const Vec3<T>& f, double length) {
            return (share / length) * Vec3<double>{static_cast<double>(f.x[l]),
                                                   static_cast<double>(f.y[l]),
                                                   static_cast<double>(f.z[l])};
          };
          s.warp = s.warp + unit(kinematics.f1, lambda[0]);
          s.weft = s.weft + unit(kinematics.f2, lambda[1]);
        }
      }
    }
  }

 private:
  using Batch = typename IndexBatches<corners, T>::Batch;
  static constexpr int hourglass_at = Element::points * point_size;  // p1, p2, stiffness

  template <class State>
  void sample_cell(const State& at, int lane, ElementSample& s) const {
    constexpr double share = 1.0 / Element::points;
    const auto& cell = law_.cell().parameters();
    const double H1 = static_cast<double>(cell.warp_height_fraction * cell.contact_length);
    const double H2 = static_cast<double>(cell.contact_length) - H1;
    s.crimp_height[0] += share * (H1 + static_cast<double>(at.cell.forces.w1[lane]));
    s.crimp_height[1] += share * (H2 + static_cast<double>(at.cell.forces.w2[lane]));
    const double q = static_cast<double>(at.cell.forces.q[lane]);
    s.contact_force += share * q;
    s.slack = s.slack || !(q > 0);
    if constexpr (has_energy)
      s.cell_correction =
          std::max(s.cell_correction, static_cast<double>(at.cell.last_correction[lane]));
    else
      s.fallback = s.fallback || at.cell.fallback[lane] > R(0);
  }

  using Block = Eigen::Matrix<double, 3 * K, 3 * K>;

  static Eigen::Vector3d lane_of(const Vec3<T>& v, int lane) {
    return {static_cast<double>(v.x[lane]), static_cast<double>(v.y[lane]),
            static_cast<double>(v.z[lane])};
  }

  /// The element's tangent for its relative vectors D, then for its corners, tag.
  void assemble(const NodalState<R>& state, TangentEntries& tangent) const {
    // D_k = sum_a C_ak x_a
    Eigen::Matrix<double, 3 * K, 3 * corners> map = decltype(map)::Zero();
    for (int a = 0; a < corners; ++a) {
      Vec3<double> x[corners], D[K];
      x[a].x = 1;
      Element::relative_vectors(x, D);
      for (int k = 0; k < K; ++k)
        map.template block<3, 3>(3 * k, 3 * a) = D[k].x * Eigen::Matrix3d::Identity();
    }
    for (int b = 0; b < batches_.size(); ++b) {
      const Batch& batch = batches_[b];
      const auto active = batches_.active(batch);
      Vec3<T> D[K], v[corners], rate[K];
      relative_vectors(state.x, batch, D);
      for (int a = 0; a < corners; ++a) v[a] = batches_.gather(state.v, batch, a);
      Element::relative_vectors(v, rate);
      Block stiffness[lanes], damping[lanes];
      for (int l = 0; l < batch.active; ++l) {
        stiffness[l].setZero();
        damping[l].setZero();
      }
      for (int p = 0; p < Element::points; ++p) {
        const PointLanes<T, M> point = load_point(b, p);
        const PointKinematics<T, M, K> kinematics(D, point), rates(rate, point);
        const auto at = law_.evaluate(strain(kinematics, active));
        const FibreStress<T> m = law_.stress(at);
        const StrainHessian<T> h = law_.hessian(at);
        const T mu = viscosity_coefficient(point);
        for (int l = 0; l < batch.active; ++l)
          add_point_tangent(point, kinematics, rates, m, h, mu, l, stiffness[l], damping[l]);
      }
      if constexpr (Element::has_hourglass) {
        const T p1 = constants_.load(b, hourglass_at), p2 = constants_.load(b, hourglass_at + 1);
        const T k = hourglass_stiffness(b);
        for (int l = 0; l < batch.active; ++l) {
          const Eigen::Vector3d g(-static_cast<double>(p1[l]), -static_cast<double>(p2[l]), 1);
          for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
              stiffness[l].template block<3, 3>(3 * i, 3 * j) +=
                  static_cast<double>(k[l]) * g(i) * g(j) * Eigen::Matrix3d::Identity();
        }
      }
      for (int l = 0; l < batch.active; ++l) {
        add_corners(tangent.stiffness, b, l, map.transpose() * stiffness[l] * map);
        if (tangent.with_damping && viscosity_)
          add_corners(tangent.damping, b, l, map.transpose() * damping[l] * map);
      }
    }
  }

  /// Derivatives of add_point_forces by D_k and its rate, in one lane.
  void add_point_tangent(const PointLanes<T, M>& point, const PointKinematics<T, M, K>& kinematics,
                         const PointKinematics<T, M, K>& rates, const FibreStress<T>& m,
                         const StrainHessian<T>& h, const T& mu, int l, Block& stiffness,
                         Block& damping) const {
    const auto real = [l](const T& x) { return static_cast<double>(x[l]); };
    const Eigen::Vector3d f[2] = {lane_of(kinematics.f1, l), lane_of(kinematics.f2, l)};
    const Eigen::Vector3d rate[2] = {lane_of(rates.f1, l), lane_of(rates.f2, l)};
    Eigen::Matrix3d H;
    H << real(h.h11), real(h.h12), real(h.h13), real(h.h12), real(h.h22), real(h.h23), real(h.h13),
        real(h.h23), real(h.h33);
    // Derivatives of (beta11, beta22, beta12) by f1 and f2, then of the point's P1 and P2.
    Eigen::Matrix<double, 3, 6> B = decltype(B)::Zero();
    B.template block<1, 3>(0, 0) = f[0].transpose();
    B.template block<1, 3>(1, 3) = f[1].transpose();
    B.template block<1, 3>(2, 0) = 0.5 * f[1].transpose();
    B.template block<1, 3>(2, 3) = 0.5 * f[0].transpose();
    Eigen::Matrix<double, 6, 6> S = B.transpose() * H * B, C = decltype(C)::Zero();
    const double stress[2][2] = {{real(m.m11), real(m.m12)}, {real(m.m12), real(m.m22)}};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        S.template block<3, 3>(3 * i, 3 * j) += stress[i][j] * Eigen::Matrix3d::Identity();
    if (viscosity_)
      for (int i = 0; i < 2; ++i) {  // [D-5]: P_i = mu (f.rate) f / (f.f)
        const double Q = f[i].squaredNorm(), power = f[i].dot(rate[i]), c = real(mu) / Q;
        C.template block<3, 3>(3 * i, 3 * i) = c * f[i] * f[i].transpose();
        S.template block<3, 3>(3 * i, 3 * i) +=
            c * (power * Eigen::Matrix3d::Identity() + f[i] * rate[i].transpose() -
                 2 * power / Q * f[i] * f[i].transpose());
      }
    const double weight = real(point.weight);
    for (int k = 0; k < M; ++k)
      for (int n = 0; n < M; ++n) {
        const double t[2][2] = {
            {real(point.t1[k]) * real(point.t1[n]), real(point.t1[k]) * real(point.t2[n])},
            {real(point.t2[k]) * real(point.t1[n]), real(point.t2[k]) * real(point.t2[n])}};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) {
            stiffness.template block<3, 3>(3 * k, 3 * n) +=
                weight * t[i][j] * S.template block<3, 3>(3 * i, 3 * j);
            damping.template block<3, 3>(3 * k, 3 * n) +=
                weight * t[i][j] * C.template block<3, 3>(3 * i, 3 * j);
          }
      }
  }

  void add_corners(std::vector<TangentEntries::Entry>& list, int b, int lane,
                   const Eigen::Matrix<double, 3 * corners, 3 * corners>& block) const {
    for (int a = 0; a < corners; ++a)
      for (int c = 0; c < corners; ++c)
        TangentEntries::add(list, 3 * batches_.node(b, a, lane), 3 * batches_.node(b, c, lane),
                            block.template block<3, 3>(3 * a, 3 * c));
  }

  template <bool Viscous>
  void sweep(NodalState<R>& state, double dt) {
    double dissipation = 0;
    for (int b = 0; b < batches_.size(); ++b) {
      const Batch& batch = batches_[b];
      const auto active = batches_.active(batch);
      Vec3<T> D[K];
      relative_vectors(state.x, batch, D);
      [[maybe_unused]] Vec3<T> rate[K];
      if constexpr (Viscous) {
        Vec3<T> v[corners];
        for (int a = 0; a < corners; ++a)
          v[a] = state.predicted_velocity(batches_.gather(state.v, batch, a),
                                          batches_.gather(state.v_centre, batch, a));
        Element::relative_vectors(v, rate);
      }
      const T zero(R(0));
      Vec3<T> force[K];
      for (int k = 0; k < K; ++k) force[k] = {zero, zero, zero};
      for (int p = 0; p < Element::points; ++p) {
        const PointLanes<T, M> point = load_point(b, p);
        const PointKinematics<T, M, K> kinematics(D, point);
        const FibreStrain<T> beta = strain(kinematics, active);
        const auto at = law_.evaluate(beta);
        FibreStress<T> m = law_.stress(at);
        if constexpr (!has_energy) book_path(b, p, point, beta, at, active);
        if constexpr (Viscous) {
          const PointKinematics<T, M, K> rates(rate, point);
          const T mu = viscosity_coefficient(point);
          const T inv1 = T(R(1)) / at.fibres.lambda1, inv2 = T(R(1)) / at.fibres.lambda2;
          const T r1 = dot(kinematics.f1, rates.f1) * inv1, r2 = dot(kinematics.f2, rates.f2) * inv2;
          m.m11 = m.m11 + mu * r1 * inv1;
          m.m22 = m.m22 + mu * r2 * inv2;
          dissipation += static_cast<double>(
              lane_sum(select(active, point.weight * mu * (r1 * r1 + r2 * r2), zero)));
        }
        add_point_forces(kinematics, m, point, force);
      }
      if constexpr (Element::has_hourglass) {
        const Vec3<T> q = hourglass_stiffness(b) * hourglass_vector(b, D);
        force[0] = force[0] - constants_.load(b, hourglass_at) * q;
        force[1] = force[1] - constants_.load(b, hourglass_at + 1) * q;
        force[2] = force[2] + q;
      }
      if (batch.active < lanes)
        for (int k = 0; k < K; ++k)
          force[k] = {select(active, force[k].x, zero), select(active, force[k].y, zero),
                      select(active, force[k].z, zero)};
      Vec3<T> corner[corners];
      Element::corner_forces(force, corner);
      for (int a = 0; a < corners; ++a) batches_.subtract(state.f, batch, a, corner[a]);
    }
    if constexpr (Viscous) {
      viscous_step_ = dissipation * dt;
      viscous_work_ += started_ ? viscous_step_ : 0.5 * viscous_step_;  // nothing before t = 0
      started_ = true;
    }
  }

  CROSSBEAM_INLINE void relative_vectors(const NodeVectors<R>& x, const Batch& batch,
                                         Vec3<T> (&D)[K]) const {
    Vec3<T> corner[corners];
    for (int a = 0; a < corners; ++a) corner[a] = batches_.gather(x, batch, a);
    Element::relative_vectors(corner, D);
  }

  CROSSBEAM_INLINE PointLanes<T, M> load_point(int b, int p) const {
    PointLanes<T, M> point;
    for (int k = 0; k < M; ++k) {
      point.t1[k] = constants_.load(b, p * point_size + k);
      point.t2[k] = constants_.load(b, p * point_size + M + k);
    }
    point.weight = constants_.load(b, p * point_size + 2 * M);
    return point;
  }

  /// Strain of a point; idle lanes are kept at rest, whatever nodes they read.
  template <class Mask>
  CROSSBEAM_INLINE FibreStrain<T> strain(const PointKinematics<T, M, K>& kinematics,
                                         const Mask& active) const {
    const FibreStrain<T> b = kinematics.strain(law_.reference().cosine);
    const T zero(R(0));
    return {select(active, b.b11, zero), select(active, b.b22, zero), select(active, b.b12, zero)};
  }

  CROSSBEAM_INLINE Vec3<T> hourglass_vector(int b, const Vec3<T> (&D)[K]) const {
    return D[2] - (constants_.load(b, hourglass_at) * D[0] +
                   constants_.load(b, hourglass_at + 1) * D[1]);
  }
  CROSSBEAM_INLINE T hourglass_stiffness(int b) const {
    return T(hourglass_) * constants_.load(b, hourglass_at + 2);
  }
  CROSSBEAM_INLINE T viscosity_coefficient(const PointLanes<T, M>& point) const {
    using std::sqrt;
    return T(impedance_) * sqrt(T(R(Element::points)) * point.weight);
  }

  template <class State, class Mask>
  void book_path(int b, int p, const PointLanes<T, M>& point, const FibreStrain<T>& beta,
                 const State& at, const Mask& active) {
    const auto tension = law_.yarn_tension(at);
    const T zero(R(0));
    const T m1 = select(active, tension(0) / at.fibres.lambda1, zero);
    const T m2 = select(active, tension(1) / at.fibres.lambda2, zero);
    const int i = p * 4;
    const T work = T(R(0.5)) * point.weight *
                   ((m1 + previous_.load(b, i)) * (beta.b11 - previous_.load(b, i + 1)) +
                    (m2 + previous_.load(b, i + 2)) * (beta.b22 - previous_.load(b, i + 3)));
    path_work_ += static_cast<double>(lane_sum(select(active, work, zero)));
    previous_.store(b, i, m1);
    previous_.store(b, i + 1, beta.b11);
    previous_.store(b, i + 2, m2);
    previous_.store(b, i + 3, beta.b22);
    fallbacks_ += static_cast<long long>(
        static_cast<double>(lane_sum(select(active, at.cell.fallback, zero))) + 0.5);
  }

  void fill_constants(const Mesh<corners>& mesh, int b, int lane) {
    const int e = batches_.tuple(b, lane);
    const auto X = mesh.corners(e);
    const auto points = Element::coefficients(X, mesh.fibres[e]);
    for (int p = 0; p < Element::points; ++p) {
      for (int k = 0; k < M; ++k) {
        constants_.at(b, p * point_size + k, lane) = R(points[p].t1[k]);
        constants_.at(b, p * point_size + M + k, lane) = R(points[p].t2[k]);
      }
      constants_.at(b, p * point_size + 2 * M, lane) = R(points[p].weight);
    }
    if constexpr (Element::has_hourglass) {
      const auto h = Element::hourglass(X);
      constants_.at(b, hourglass_at, lane) = R(h.p1);
      constants_.at(b, hourglass_at + 1, lane) = R(h.p2);
      constants_.at(b, hourglass_at + 2, lane) = R(h.stiffness);
    }
  }

  /// Largest squared frequency of one element on its share of the mass, tag [D-3].
  double element_omega_squared(const Mesh<corners>& mesh, int e, double stiffness,
                               double areal_mass) const {
    using Vector = Eigen::Matrix<double, K, 1>;
    using Square = Eigen::Matrix<double, K, K>;
    const auto X = mesh.corners(e);
    // The element's stiffness in one direction of space is C Q C^T, with C the integers of
    // D_k = sum_a C_ak x_a; its eigenvalues are those of L^T Q L, where L L^T = C^T C.
    Eigen::Matrix<double, corners, K> C;
    for (int a = 0; a < corners; ++a) {
      Vec3<double> x[corners], D[K];
      x[a].x = 1;
      Element::relative_vectors(x, D);
      for (int k = 0; k < K; ++k) C(a, k) = D[k].x;
    }
    Square Q = Square::Zero();
    for (const auto& p : Element::coefficients(X, mesh.fibres[e])) {
      const Eigen::Map<const Vector> t1(p.t1.data()), t2(p.t2.data());
      Q += p.weight * stiffness * (t1 * t1.transpose() + t2 * t2.transpose());
    }
    if constexpr (Element::has_hourglass) {
      const auto h = Element::hourglass(X);
      const Vector g(-h.p1, -h.p2, 1.0);
      Q += static_cast<double>(hourglass_) * h.stiffness * g * g.transpose();
    }
    const Square L = (C.transpose() * C).llt().matrixL();
    const Square S = L.transpose() * Q * L;
    Eigen::SelfAdjointEigenSolver<Square> solver;
    solver.computeDirect(S, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff() / (areal_mass * mesh.area(e) / corners);
  }

  Law law_;
  IndexBatches<corners, T> batches_;
  LaneArray<T> constants_;
  LaneArray<T> previous_;
  int element_count_;
  R hourglass_{}, impedance_{};
  bool viscosity_ = false, started_ = false;
  double omega_squared_ = 0, damping_rate_ = 0;
  double viscous_work_ = 0, viscous_step_ = 0, path_work_ = 0;
  long long fallbacks_ = 0;
};

}  // namespace crossbeam
