#pragma once
/// @file
/// The membrane forces of a mesh, a batch of elements at a time: relative vectors -> fibre vectors
/// -> law -> generalised forces -> corners. Theory: docs/theory/sweep.md.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/element/frequency.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/model/force_block.hpp"
#include "crossbeam/sweep/index_batches.hpp"
#include "crossbeam/sweep/lane_array.hpp"
#include "crossbeam/sweep/point_rows.hpp"
#include "crossbeam/sweep/run_vectors.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace crossbeam {

struct MembraneOptions {
  double hourglass_modulus = 0;  ///< of one-point quadrilaterals [kN/mm]; >= 0, tag [E-4]
  double bulk_viscosity = 0;     ///< linear, on the fibre stretch rates [-]; >= 0, tag [D-5]
};

/// Without a tangent: MembraneSweepWithTangent (sweep/membrane_tangent.hpp) is the same with one.
/// @tparam T pack; @tparam Element Triangle or Quadrilateral<1 or 4>
template <class T, class Element, class Law>
  requires MembraneLaw<Law, T>
class MembraneSweep : public ForceBlock<real_t<T>> {
 public:
  using R = real_t<T>;
  static constexpr int lanes = lanes_v<T>;
  static constexpr int M = Element::membrane_vectors;
  static constexpr int K = Element::vectors;
  static constexpr int corners = Element::corners;
  static constexpr int point_size =
      2 * M + 2;  ///< constants of one point: t1, t2, weight, viscosity
  /// A cell without a potential has its yarn work summed along the path instead.
  static constexpr bool has_energy =
      requires(const Law& law, const FibreStrain<T>& b) { law.yarn_energy(law.evaluate(b)); };

  /// Whether the law keeps the heights of its cells from step to step.
  static constexpr bool follows = requires {
    requires Law::follows_heights;
    typename Law::template CellSolution<T>;
  };

  /// A law of one's own need not have a cell; then there is nothing of a cell to sample.
  static constexpr bool has_cell = requires(const Law& law) { law.cell().parameters(); };

  /// @throws InputError when the fibre angle of an element differs from the law's.
  MembraneSweep(const Mesh<corners>& mesh, Law law, double areal_mass,
                const MembraneOptions& options = {})
      : law_(std::move(law)),
        batches_(mesh.elements),
        constants_(batches_.size(),
                   Element::points * point_size + (Element::has_hourglass ? 3 : 0)),
        previous_(has_energy ? 0 : batches_.size(), has_energy ? 0 : Element::points * 4),
        heights_(follows ? batches_.size() : 0, follows ? Element::points * 2 : 0),
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
        throw InputError(
            "mesh.fibres[" + std::to_string(e) + "] angle from warp to weft",
            detail::to_text(mesh.fibre_angle(e) * 180 / std::numbers::pi), "deg",
            "the law's " + detail::to_text(static_cast<double>(law_.reference().delta) * 180 /
                                           std::numbers::pi));
      const double omega_squared = element_omega_squared<Element>(
          mesh.corners(e), mesh.fibres[e], stiffness, static_cast<double>(hourglass_),
          areal_mass * mesh.area(e) / corners);
      if (!std::isfinite(omega_squared))
        throw InputError("squared frequency of mesh.elements[" + std::to_string(e) + "]",
                         detail::to_text(omega_squared), "1/ms^2", "a finite number");
      omega_squared_ = maximum(omega_squared_, omega_squared);
      // mu = b rho c h with h = sqrt(A); it acts where the stiffness acts, mu / stiffness as
      // strong.
      double area = 0;
      for (const auto& p : Element::coefficients(mesh.corners(e), mesh.fibres[e]))
        area = maximum(area, Element::points * p.weight);
      damping_rate_ =
          maximum(damping_rate_, impedance * std::sqrt(area) / stiffness * omega_squared);
    }
    viscosity_ = options.bulk_viscosity > 0;
    for (int b = 0; b < batches_.size(); ++b)
      for (int l = 0; l < lanes; ++l) fill_constants(mesh, b, l, impedance);
    collapse_constants();
  }

  [[nodiscard]] int bandwidth() const override { return batches_.bandwidth(); }
  void arrange(const std::vector<int>& level_start) override { batches_.arrange(level_start); }

  void begin_step(const NodalState<R>& state) override {
    started_ = begun_;
    begun_ = true;
    if (static_cast<int>(stage_sums_.size()) != batches_.stages())
      stage_sums_.assign(static_cast<std::size_t>(batches_.stages()), {});
    if constexpr (follows)
      if (!heights_known_) begin_heights(state);
  }

  void add_forces(NodalState<R>& state, double dt) override {
    begin_step(state);
    for (int stage = 0; stage < batches_.stages(); ++stage) add_stage(state, dt, stage);
  }

  void add_stage(NodalState<R>& state, double dt, int stage) override {
    if (viscosity_)
      sweep<true>(state, dt, stage);
    else
      sweep<false>(state, dt, stage);
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
        const auto at = law_.evaluate(strain(PointKinematics<T, M, K>(D, point), batch));
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
    for (const StageSums& sums : stage_sums_) {
      energy.yarn += sums.path_work;
      // At t_n only half of this step's dissipation has happened.
      energy.bulk_viscosity += sums.viscous_work - 0.5 * sums.viscous_step;
    }
  }

  [[nodiscard]] bool has_memory() const override { return follows; }
  [[nodiscard]] double omega_squared() const override { return omega_squared_; }
  [[nodiscard]] double damping_rate() const override { return damping_rate_; }
  [[nodiscard]] long long points() const override {
    return static_cast<long long>(element_count_) * Element::points;
  }
  [[nodiscard]] long long fallbacks() const override {
    long long sum = 0;
    for (const StageSums& sums : stage_sums_) sum += sums.fallbacks;
    return sum;
  }
  [[nodiscard]] const Law& law() const { return law_; }

  void sample(const NodalState<R>& state, std::vector<ElementSample>& out) const override {
    const std::size_t offset = out.size();
    out.resize(offset + static_cast<std::size_t>(element_count_));
    const double share = 1.0 / Element::points;
    for (int b = 0; b < batches_.size(); ++b) {
      const auto& batch = batches_[b];
      Vec3<T> D[K];
      relative_vectors(state.x, batch, D);
      for (int p = 0; p < Element::points; ++p) {
        const PointLanes<T, M> point = load_point(b, p);
        const PointKinematics<T, M, K> kinematics(D, point);
        const auto at = law_.evaluate(strain(kinematics, batch));
        const T cosine = fibre_cosine(at.fibres.beta, at.fibres.lambda1, at.fibres.lambda2,
                                      law_.reference().cosine);
        const T gamma = shear_angle(cosine, law_.reference());
        const auto tension = law_.yarn_tension(at);
        for (int l = 0; l < lanes; ++l) {
          if (!batch.holds(l)) continue;
          ElementSample& s = out[offset + static_cast<std::size_t>(batches_.tuple(b, l))];
          s.shear_angle += share * static_cast<double>(gamma[l]);
          const double lambda[2] = {static_cast<double>(at.fibres.lambda1[l]),
                                    static_cast<double>(at.fibres.lambda2[l])};
          for (int i = 0; i < 2; ++i) {
            s.stretch[i] += share * (lambda[i] - 1);
            s.tension[i] += share * static_cast<double>(tension(i)[l]);
          }
          if constexpr (has_cell) sample_cell(at, l, s);
          if constexpr (follows)
            if (heights_known_) sample_heights(at, b, p, l, s);
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

 protected:
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
          maximum(s.cell_correction, static_cast<double>(at.cell.last_correction[lane]));
    else
      s.fallback = s.fallback || at.cell.fallback[lane] > R(0);
  }

  /// How far the heights that the next step will find are from the equilibrium.
  template <class State>
  void sample_heights(const State& at, int b, int p, int lane, ElementSample& s) const {
    CrimpHeights<T> heights{heights_.load(b, 2 * p), heights_.load(b, 2 * p + 1)};
    law_.cell().follow(at.u1, at.u2, heights);
    const T off1 = magnitude(heights.w1 - at.cell.forces.w1);
    const T off2 = magnitude(heights.w2 - at.cell.forces.w2);
    s.cell_correction = (std::max)(
        {s.cell_correction, static_cast<double>(off1[lane]), static_cast<double>(off2[lane])});
  }

  /// What one stage has summed up: since the start, and in the last step.
  struct StageSums {
    double viscous_work = 0, viscous_step = 0, path_work = 0;
    long long fallbacks = 0;
  };

  using Batches = IndexBatches<corners, T>;
  using Run = typename Batches::Run;
  using Narrow = difference_lanes_t<T>;
  using Wide = double_lanes_t<Narrow>;  // of positions, tag [D-6]
  template <class U>
  using View = typename Batches::template View<U>;

  /// What the loops over one run hand on to each other: it stays in the first-level cache.
  struct Work : PointRows<T, Batches::run_capacity> {
    using Rows = PointRows<T, Batches::run_capacity>;
    using typename Rows::Row;
    using typename Rows::VectorRow;
    VectorRow D[K], force[K];  ///< relative vectors, generalised forces: of more than one point
    VectorRow hourglass;       ///< its force
    RunVectors<corners, corners, T> corner;
    typename Batches::template Gathered<Wide> positions;
    typename Batches::template Gathered<T> velocities;

    /// Lanes without a tuple are kept at rest, whatever nodes they read: without strain, and with fibre
    /// vectors of no length they exert no force and lose no power.
    /// @param i place of lane 0 in the run; @param active the lanes with a tuple
    template <class Mask>
    void rest(int i, const Mask& active) {
      for (VectorRow* v : {&hourglass, &this->f1, &this->f2})
        for (Row* component : {&v->x, &v->y, &v->z}) component->rest(i, active);
      for (Row* strain : {&this->b11, &this->b22, &this->b12}) strain->rest(i, active);
    }
  };

  /// The run in short loops: one body for all of it would be a single chain of dependent roots and
  /// divisions, too long for the processor to overlap two batches, tag [S-4].
  template <bool Viscous>
  CROSSBEAM_INLINE void run_forces(const Law& law, NodalState<R>& state, const Run& run, Work& work,
                                   T& power, StageSums& sums) {
    for (int p = 0; p < Element::points; ++p) {
      if (p == 0)
        strains<true>(batches_.template view<Wide>(state.x, run, work.positions), run, p, work);
      else
        strains<false>({}, run, p, work);
      for (int k = 0; k < run.batches; ++k)
        if (const Batch& batch = batches_[run.first_batch + k]; !batch.is_full())
          work.rest(k * lanes, batches_.active(batch));
      stresses(law, run, p, work, sums);
      if constexpr (Viscous)
        viscous_stresses(batches_.template view<T>(state.v_predicted, run, work.velocities), run, p,
                         work, power);
      collect_forces(run, p, work);
    }
    work.corner.subtract_from(state.f, batches_, run);
  }

  /// Constants of the batches of a run at one point.
  struct Constants {
    const R* at;
    std::size_t stride;
    CROSSBEAM_INLINE void next() { at += stride; }
    CROSSBEAM_INLINE T load(int component) const { return T::load(at + component * lanes); }
    CROSSBEAM_INLINE PointLanes<T, M> point() const {
      PointLanes<T, M> out;
      unrolled<M>([&](auto k) CROSSBEAM_INLINE_LAMBDA {
        out.t1[k] = load(k);
        out.t2[k] = load(M + k);
      });
      out.weight = load(2 * M);
      return out;
    }
    [[nodiscard]] CROSSBEAM_INLINE T viscosity() const { return load(2 * M + 1); }
  };
  [[nodiscard]] CROSSBEAM_INLINE Constants constants(const Run& run, int p) const {
    return {constants_.data(run.first_batch) + p * point_size * lanes, constants_.stride()};
  }

  /// Relative vectors of positions more precise than the run: differences first, then rounded [D-6].
  CROSSBEAM_INLINE void differences(const View<Wide>& x, int end, Work& work) const {
    for (int i = 0; i < end; i += lanes_v<Wide>) {
      Vec3<Wide> corner[corners], D[K];
      x.load_all(i, corner);
      Element::relative_vectors(corner, D);
      unrolled<K>([&](auto v) CROSSBEAM_INLINE_LAMBDA {
        convert<Narrow>(D[v].x).store(work.D[v].x.number + i);
        convert<Narrow>(D[v].y).store(work.D[v].y.number + i);
        convert<Narrow>(D[v].z).store(work.D[v].z.number + i);
      });
    }
  }

  /// Fibre vectors and strains; at the first point also what all points share.
  template <bool First>
  CROSSBEAM_INLINE void strains(const View<Wide>& x, const Run& run, int p, Work& work) const {
    const int end = run.batches * lanes;
    const R cosine = law_.reference().cosine;
    const T hourglass(hourglass_);
    const bool has_hourglass = hourglass_ > R(0);
    if constexpr (First && !std::is_same_v<R, double>) differences(x, end, work);
    Constants c = constants(run, p);
    for (int i = 0; i < end; i += lanes, c.next()) {
      Vec3<T> D[K];
      if constexpr (First) {
        if constexpr (std::is_same_v<R, double>) {
          Vec3<T> corner[corners];
          x.load_all(i, corner);
          Element::relative_vectors(corner, D);
        } else {
          unrolled<K>([&](auto v) CROSSBEAM_INLINE_LAMBDA { D[v] = work.D[v].load(i); });
        }
        if constexpr (Element::has_hourglass) {
          if (has_hourglass) {
            Vec3<T> q = D[2];
            if (skewed_) q = q - (c.load(hourglass_at) * D[0] + c.load(hourglass_at + 1) * D[1]);
            work.hourglass.store(i, hourglass * c.load(hourglass_at + 2) * q);
          }
        } else if constexpr (Element::points > 1 && std::is_same_v<R, double>) {
          unrolled<K>([&](auto v) CROSSBEAM_INLINE_LAMBDA { work.D[v].store(i, D[v]); });
        }
      } else {
        unrolled<K>([&](auto v) CROSSBEAM_INLINE_LAMBDA { D[v] = work.D[v].load(i); });
      }
      const PointKinematics<T, M, K> kinematics(D, c.point());
      const FibreStrain<T> beta = kinematics.strain(cosine);
      work.f1.store(i, kinematics.f1);
      work.f2.store(i, kinematics.f2);
      work.store_strain(i, beta);
    }
  }

  /// Adds the point's generalised forces, and after the last point gives them to the corners.
  CROSSBEAM_INLINE void collect_forces(const Run& run, int p, Work& work) const {
    const int end = run.batches * lanes;
    const bool has_hourglass = Element::has_hourglass && hourglass_ > R(0);
    const T zero(R(0));
    const Vec3<T> none{zero, zero, zero};
    Constants c = constants(run, p);
    for (int i = 0; i < end; i += lanes, c.next()) {
      const PointKinematics<T, M, K> kinematics(work.f1.load(i), work.f2.load(i));
      const FibreStress<T> m = work.stress(i);
      Vec3<T> force[K];
      point_forces(kinematics, m, c.point(), force);
      if constexpr (Element::points > 1) {
        if (p > 0)
          unrolled<K>([&](auto v)
                          CROSSBEAM_INLINE_LAMBDA { force[v] = work.force[v].load(i) + force[v]; });
        if (p + 1 < Element::points) {
          unrolled<K>([&](auto v) CROSSBEAM_INLINE_LAMBDA { work.force[v].store(i, force[v]); });
          continue;
        }
      }
      if constexpr (Element::has_hourglass) {
        if (has_hourglass) {
          const Vec3<T> q = work.hourglass.load(i);
          force[2] = q;
          if (skewed_) {
            force[0] = force[0] - c.load(hourglass_at) * q;
            force[1] = force[1] - c.load(hourglass_at + 1) * q;
          }
        } else {
          force[2] = none;
        }
      } else {
        for (int k = M; k < K; ++k) force[k] = none;
      }
      Vec3<T> corner[corners];
      Element::corner_forces(force, corner);
      unrolled<corners>([&](auto a) CROSSBEAM_INLINE_LAMBDA { work.corner.put(a, i, corner[a]); });
    }
  }

  CROSSBEAM_INLINE void stresses(const Law& law, const Run& run, int p, Work& work,
                                 [[maybe_unused]] StageSums& sums) {
    const int end = run.batches * lanes;
    if constexpr (follows) {
      work.follow(law, end, heights_.data(run.first_batch) + 2 * p * lanes, heights_.stride());
    } else {
      for (int k = 0, i = 0; k < run.batches; ++k, i += lanes) {
        const int b = run.first_batch + k;
        const FibreStrain<T> beta = work.strain(i);
        const auto at = law.evaluate(beta);
        if constexpr (!has_energy)
          book_path(b, p, load_point(b, p), beta, at, batches_.active(batches_[b]), sums);
        const FibreStress<T> m = law.stress(at);
        const InverseStretches<T> inv(at.fibres.lambda1, at.fibres.lambda2);
        work.inv1.store(i, inv.first);
        work.inv2.store(i, inv.second);
        work.store_stress(i, m);
      }
    }
  }

  /// [D-5]; `power` collects what it takes.
  CROSSBEAM_INLINE void viscous_stresses(const View<T>& v, const Run& run, int p, Work& work,
                                         T& power) const {
    const int end = run.batches * lanes;
    Constants c = constants(run, p);
    for (int i = 0; i < end; i += lanes, c.next()) {
      Vec3<T> corner[corners], rate[K];
      v.load_all(i, corner);
      Element::relative_vectors(corner, rate);
      const PointLanes<T, M> point = c.point();
      const PointKinematics<T, M, K> rates(rate, point);
      const T mu = c.viscosity();
      const T inv1 = work.inv1.load(i), inv2 = work.inv2.load(i);
      const T r1 = dot(work.f1.load(i), rates.f1) * inv1;
      const T r2 = dot(work.f2.load(i), rates.f2) * inv2;
      work.m11.store(i, work.m11.load(i) + mu * r1 * inv1);
      work.m22.store(i, work.m22.load(i) + mu * r2 * inv2);
      power = power + point.weight * mu * (r1 * r1 + r2 * r2);
    }
  }

  template <bool Viscous>
  void sweep(NodalState<R>& state, double dt, int stage) {
    StageSums& sums = stage_sums_[stage];
    // A copy that no store can change: its constants then stay in registers or on the stack.
    using LocalLaw = std::conditional_t<std::is_trivially_copyable_v<Law>, const Law, const Law&>;
    LocalLaw law = law_;
    T power(R(0));
    Work work;
    for (int r = batches_.first_run(stage); r < batches_.first_run(stage + 1); ++r)
      run_forces<Viscous>(law, state, batches_.run(r), work, power, sums);
    if constexpr (Viscous) {
      const double step = static_cast<double>(lane_sum(power)) * dt;
      sums.viscous_step = step;
      sums.viscous_work += started_ ? step : 0.5 * step;  // nothing before t = 0
    }
  }

  void begin_heights(const NodalState<R>& state) {
    for (int b = 0; b < batches_.size(); ++b) {
      Vec3<T> D[K];
      relative_vectors(state.x, batches_[b], D);
      for (int p = 0; p < Element::points; ++p) {
        const auto at =
            law_.evaluate(strain(PointKinematics<T, M, K>(D, load_point(b, p)), batches_[b]));
        heights_.store(b, 2 * p, at.cell.forces.w1);
        heights_.store(b, 2 * p + 1, at.cell.forces.w2);
      }
    }
    heights_known_ = true;
  }

  void relative_vectors(const NodeVectors<double>& x, const Batch& batch, Vec3<T> (&D)[K]) const {
    using U = double_lanes_t<T>;
    Vec3<U> corner[corners], difference[K];
    for (int a = 0; a < corners; ++a) corner[a] = batches_.template gather<U>(x, batch, a);
    Element::relative_vectors(corner, difference);
    for (int k = 0; k < K; ++k) D[k] = convert<T>(difference[k]);
  }

  CROSSBEAM_INLINE PointLanes<T, M> load_point(int b, int p) const {
    PointLanes<T, M> point;
    unrolled<M>([&](auto k) CROSSBEAM_INLINE_LAMBDA {
      point.t1[k] = constants_.load(b, p * point_size + k);
      point.t2[k] = constants_.load(b, p * point_size + M + k);
    });
    point.weight = constants_.load(b, p * point_size + 2 * M);
    return point;
  }

  /// Strain of a point; idle lanes are kept at rest, whatever nodes they read.
  CROSSBEAM_INLINE FibreStrain<T> strain(const PointKinematics<T, M, K>& kinematics,
                                         const Batch& batch) const {
    FibreStrain<T> b = kinematics.strain(law_.reference().cosine);
    if (!batch.is_full()) {
      const auto active = batches_.active(batch);
      const T zero(R(0));
      b = {select(active, b.b11, zero), select(active, b.b22, zero), select(active, b.b12, zero)};
    }
    return b;
  }

  CROSSBEAM_INLINE Vec3<T> hourglass_vector(int b, const Vec3<T> (&D)[K]) const {
    return D[2] -
           (constants_.load(b, hourglass_at) * D[0] + constants_.load(b, hourglass_at + 1) * D[1]);
  }
  CROSSBEAM_INLINE T hourglass_stiffness(int b) const {
    return T(hourglass_) * constants_.load(b, hourglass_at + 2);
  }
  CROSSBEAM_INLINE T viscosity_coefficient(int b, int p) const {
    return constants_.load(b, p * point_size + 2 * M + 1);
  }

  template <class State, class Mask>
  void book_path(int b, int p, const PointLanes<T, M>& point, const FibreStrain<T>& beta,
                 const State& at, const Mask& active, StageSums& sums) {
    const auto tension = law_.yarn_tension(at);
    const T zero(R(0));
    const T m1 = select(active, tension(0) / at.fibres.lambda1, zero);
    const T m2 = select(active, tension(1) / at.fibres.lambda2, zero);
    const int i = p * 4;
    const T work = T(R(0.5)) * point.weight *
                   ((m1 + previous_.load(b, i)) * (beta.b11 - previous_.load(b, i + 1)) +
                    (m2 + previous_.load(b, i + 2)) * (beta.b22 - previous_.load(b, i + 3)));
    sums.path_work += static_cast<double>(lane_sum(select(active, work, zero)));
    previous_.store(b, i, m1);
    previous_.store(b, i + 1, beta.b11);
    previous_.store(b, i + 2, m2);
    previous_.store(b, i + 3, beta.b22);
    sums.fallbacks += static_cast<long long>(
        static_cast<double>(lane_sum(select(active, at.cell.fallback, zero))) + 0.5);
  }

  /// Coefficients are compared with the largest of their point, [1/length].
  void collapse_constants() {
    constants_.collapse_if_uniform(
        [this](int c) {
          R largest(0);
          const int point = c / point_size * point_size;
          if (c < Element::points * point_size && c % point_size < 2 * M)
            for (int k = 0; k < 2 * M; ++k)
              largest = maximum(largest, std::abs(constants_.at(0, point + k, 0)));
          else if (c < Element::points * point_size || c == hourglass_at + 2)
            largest = std::abs(constants_.at(0, c, 0));
          else
            largest = R(1);
          return largest;
        },
        [this](int b, int lane) { return batches_[b].holds(lane); });
  }

  void fill_constants(const Mesh<corners>& mesh, int b, int lane, double impedance) {
    const int e = batches_.tuple(b, lane);
    const auto X = mesh.corners(e);
    const auto points = Element::coefficients(X, mesh.fibres[e]);
    for (int p = 0; p < Element::points; ++p) {
      for (int k = 0; k < M; ++k) {
        constants_.at(b, p * point_size + k, lane) = R(points[p].t1[k]);
        constants_.at(b, p * point_size + M + k, lane) = R(points[p].t2[k]);
      }
      constants_.at(b, p * point_size + 2 * M, lane) = R(points[p].weight);
      constants_.at(b, p * point_size + 2 * M + 1, lane) =
          R(impedance * std::sqrt(Element::points * points[p].weight));
    }
    if constexpr (Element::has_hourglass) {
      const auto h = Element::hourglass(X);
      constexpr double rounding = 1e-11;  // of the mesh's coordinates: a parallelogram has p = 0
      const bool skewed = std::abs(h.p1) > rounding || std::abs(h.p2) > rounding;
      skewed_ = skewed_ || skewed;
      constants_.at(b, hourglass_at, lane) = skewed ? R(h.p1) : R(0);
      constants_.at(b, hourglass_at + 1, lane) = skewed ? R(h.p2) : R(0);
      constants_.at(b, hourglass_at + 2, lane) = R(h.stiffness);
    }
  }

  Law law_;
  IndexBatches<corners, T> batches_;
  LaneArray<T> constants_;
  LaneArray<T> previous_;
  LaneArray<T> heights_;  // of the cells, where the law follows them
  int element_count_;
  R hourglass_{};
  bool skewed_ = false;  // an element that is no parallelogram
  bool viscosity_ = false, started_ = false, begun_ = false, heights_known_ = false;
  double omega_squared_ = 0, damping_rate_ = 0;
  std::vector<StageSums> stage_sums_;
};

}  // namespace crossbeam
