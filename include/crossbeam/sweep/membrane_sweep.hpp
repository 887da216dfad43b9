#pragma once
/// @file
/// The membrane forces of a mesh, a run of elements at a time: strains, stresses, viscosity,
/// forces, scatter. Its words stand in index_batches.hpp. Theory: docs/theory/sweep.md.

#include "crossbeam/model/force_block.hpp"
#include "crossbeam/sweep/membrane_memory.hpp"
#include "crossbeam/sweep/membrane_points.hpp"
#include "crossbeam/sweep/membrane_queries.hpp"
#include "crossbeam/sweep/point_rows.hpp"
#include "crossbeam/sweep/run_vectors.hpp"

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace crossbeam {

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

  /// @throws InputError when the fibre angle of an element differs from the law's.
  MembraneSweep(const Mesh<corners>& mesh, Law law, double areal_mass,
                const MembraneOptions& options = {})
      : points_(mesh, std::move(law), areal_mass, options),
        node_count_(mesh.node_count),
        areal_mass_(areal_mass) {
    if constexpr (follows) heights_ = Heights(points_.batches.size());
    if constexpr (!has_energy) yarn_work_ = Work(points_.batches.size());
  }

  /// @name Forces
  /// @{
  [[nodiscard]] int bandwidth() const override { return points_.batches.bandwidth(); }
  void arrange(const std::vector<int>& level_start) override {
    points_.batches.arrange(level_start);
  }
  void begin_step(const NodalState<R>& state) override {
    started_ = begun_;
    begun_ = true;
    if (static_cast<int>(stage_sums_.size()) != points_.batches.stages())
      stage_sums_.assign(static_cast<std::size_t>(points_.batches.stages()), {});
    if constexpr (follows)
      if (!heights_.are_known()) heights_.begin(points_, state.x);
  }
  void add_forces(NodalState<R>& state, double dt) override {
    begin_step(state);
    for (int stage = 0; stage < points_.batches.stages(); ++stage) add_stage(state, dt, stage);
  }
  void add_stage(NodalState<R>& state, double dt, int stage) override {
    StageSums& sums = stage_sums_[stage];
    // A copy that no store can change: its constants then stay in registers or on the stack.
    using LocalLaw = std::conditional_t<std::is_trivially_copyable_v<Law>, const Law, const Law&>;
    LocalLaw law = points_.law;
    T power(R(0));
    Rows rows;
    const Batches& batches = points_.batches;
    for (int r = batches.first_run(stage); r < batches.first_run(stage + 1); ++r)
      run_forces(law, state, batches.run(r), rows, power, sums);
    const double step = static_cast<double>(lane_sum(power)) * dt;
    sums.viscous_step = step;
    sums.viscous_work += started_ ? step : 0.5 * step;  // nothing before t = 0
  }
  /// @}

  void add_energy(const NodalState<R>& state, EnergyLedger& ledger) const override {
    const MembraneEnergy energy = membrane_energy(points_, state.x);
    double yarn = energy.yarn, viscous = 0;
    for (const StageSums& sums : stage_sums_) {
      yarn += sums.path_work;
      // At t_n only half of this step's dissipation has happened.
      viscous += sums.viscous_work - 0.5 * sums.viscous_step;
    }
    ledger.add("yarn", EnergyKind::stored, yarn);
    ledger.add("shear", EnergyKind::stored, energy.shear);
    ledger.add("hourglass", EnergyKind::stored, energy.hourglass);
    ledger.add("bulk_viscosity", EnergyKind::dissipated, viscous);
  }
  void sample(const NodalState<R>& state, std::vector<ElementSample>& out) const override {
    sample_membrane(points_, state.x, heights_, out);
  }
  [[nodiscard]] std::optional<int> node_count() const override { return node_count_; }
  [[nodiscard]] std::optional<double> areal_mass() const override { return areal_mass_; }
  [[nodiscard]] bool has_memory() const override { return follows; }
  [[nodiscard]] double omega_squared() const override { return points_.constants.omega_squared(); }
  [[nodiscard]] double damping_rate() const override { return points_.constants.damping_rate(); }
  [[nodiscard]] long long points() const override {
    return static_cast<long long>(points_.element_count) * Element::points;
  }
  [[nodiscard]] long long fallbacks() const override {
    long long sum = 0;
    for (const StageSums& sums : stage_sums_) sum += sums.fallbacks;
    return sum;
  }
  [[nodiscard]] const Law& law() const { return points_.law; }

 protected:
  [[nodiscard]] const MembranePoints<T, Element, Law>& membrane() const { return points_; }

 private:
  static constexpr bool follows = FollowingLaw<Law, T>;
  static constexpr bool has_energy = MembraneLawWithEnergy<Law, T>;
  using Batches = IndexBatches<corners, T>;
  using Run = typename Batches::Run;
  using Heights = CellHeights<T, Element::points>;
  using Work = YarnWork<T, Element::points>;
  using Narrow = difference_lanes_t<T>;
  using Wide = double_lanes_t<Narrow>;  // of positions, tag [D-6]
  template <class U>
  using View = typename Batches::template View<U>;

  /// Whether the first point's loop forms the relative vectors, which then need no pass for them.
  static constexpr bool in_one_pass = std::is_same_v<R, double>;

  /// What the loops over one run hand on to each other: it stays in the first-level cache.
  struct Rows : PointRows<T, Batches::run_capacity> {
    using typename PointRows<T, Batches::run_capacity>::VectorRow;
    VectorRow D[K], force[K];  ///< relative vectors, generalised forces: of more than one pass
    VectorRow hourglass;       ///< its force
    RunVectors<corners, corners, T> corner;
    typename Batches::template Gathered<Wide> positions;
    typename Batches::template Gathered<T> velocities;
  };

  /// The run in short loops: one body for all of it would be a single chain of dependent roots and
  /// divisions, too long for the processor to overlap two batches, tag [S-4].
  CROSSBEAM_INLINE void run_forces(const Law& law, NodalState<R>& state, const Run& run, Rows& rows,
                                   T& power, StageSums& sums) {
    const auto x = points_.batches.template view<Wide>(state.x, run, rows.positions);
    if constexpr (!in_one_pass) relative_vectors(x, run, rows);
    for (int p = 0; p < Element::points; ++p) {
      strains(x, run, p, rows);
      clear_idle_lanes(run, rows);
      stresses(law, run, p, rows, sums);
      if (points_.constants.is_viscous())
        add_viscous_stresses(
            points_.batches.template view<T>(state.v_predicted, run, rows.velocities), run, p, rows,
            power);
      forces(run, p, rows);
    }
    rows.corner.subtract_from(state.f, points_.batches, run);
  }

  [[nodiscard]] CROSSBEAM_INLINE auto constants(const Run& run, int p) const {
    return points_.constants.at_point(run.first_batch, p);
  }

  /// Of positions more precise than the run: differences first, then rounded [D-6].
  CROSSBEAM_INLINE void relative_vectors(const View<Wide>& x, const Run& run, Rows& rows) const {
    for (int i = 0; i < run.batches * lanes; i += lanes_v<Wide>) {
      Vec3<Wide> corner[corners], D[K];
      x.load_all(i, corner);
      Element::relative_vectors(corner, D);
      unrolled<K>([&](auto k) CROSSBEAM_INLINE_LAMBDA {
        convert<Narrow>(D[k].x).store(rows.D[k].x.number + i);
        convert<Narrow>(D[k].y).store(rows.D[k].y.number + i);
        convert<Narrow>(D[k].z).store(rows.D[k].z.number + i);
      });
    }
  }

  /// Fibre vectors and strains at point p, and the hourglass force of the one point.
  CROSSBEAM_INLINE void strains(const View<Wide>& x, const Run& run, int p, Rows& rows) const {
    const R cosine = points_.law.reference().cosine;
    const T hourglass(points_.constants.hourglass_modulus());
    const bool has_hourglass = points_.constants.hourglass_modulus() > R(0);
    const bool skewed = points_.constants.is_skewed();
    auto c = constants(run, p);
    for (int i = 0; i < run.batches * lanes; i += lanes, c.next()) {
      Vec3<T> D[K];
      if constexpr (in_one_pass)
        if (Element::points == 1 || p == 0) {
          Vec3<T> corner[corners];
          x.load_all(i, corner);
          Element::relative_vectors(corner, D);
          if constexpr (Element::points > 1)
            unrolled<K>([&](auto k) CROSSBEAM_INLINE_LAMBDA { rows.D[k].store(i, D[k]); });
        }
      if (!in_one_pass || (Element::points > 1 && p > 0))
        unrolled<K>([&](auto k) CROSSBEAM_INLINE_LAMBDA { D[k] = rows.D[k].load(i); });
      if constexpr (Element::has_hourglass)
        if (has_hourglass) {
          Vec3<T> q = D[2];
          if (skewed) q = q - (c.hourglass(0) * D[0] + c.hourglass(1) * D[1]);
          rows.hourglass.store(i, hourglass * c.hourglass(2) * q);
        }
      const PointKinematics<T, M, K> kinematics(D, c.point());
      const FibreStrain<T> beta = kinematics.strain(cosine);
      rows.f1.store(i, kinematics.f1);
      rows.f2.store(i, kinematics.f2);
      rows.store_strain(i, beta);
    }
  }

  /// Lanes without an element read some node or other: without strain, and with fibre vectors of no
  /// length, they exert no force and lose no power.
  CROSSBEAM_INLINE void clear_idle_lanes(const Run& run, Rows& rows) const {
    for (int k = 0; k < run.batches; ++k) {
      const auto& batch = points_.batches[run.first_batch + k];
      if (!batch.is_full()) clear_idle_lanes(k * lanes, points_.batches.active(batch), rows);
    }
  }
  template <class Mask>
  static void clear_idle_lanes(int i, const Mask& active, Rows& rows) {
    for (auto* vectors : {&rows.hourglass, &rows.f1, &rows.f2}) vectors->keep(i, active);
    for (auto* strains : {&rows.b11, &rows.b22, &rows.b12}) strains->keep(i, active);
  }

  CROSSBEAM_INLINE void stresses(const Law& law, const Run& run, int p, Rows& rows,
                                 [[maybe_unused]] StageSums& sums) {
    if constexpr (follows) {
      law.stresses(rows, run.batches * lanes, heights_.at_point(run.first_batch, p),
                   heights_.stride());
    } else {
      [[maybe_unused]] auto c = constants(run, p);
      for (int k = 0, i = 0; k < run.batches; ++k, i += lanes, c.next()) {
        const auto at = law.evaluate(rows.strain(i));
        const InverseStretches<T> inv(at.fibres.lambda1, at.fibres.lambda2);
        rows.inv1.store(i, inv.first);
        rows.inv2.store(i, inv.second);
        rows.store_stress(i, law.stress(at));
        if constexpr (!has_energy) {
          const int b = run.first_batch + k;
          const auto active = points_.batches.active(points_.batches[b]);
          sums.path_work +=
              yarn_work_.book(b, p, c.point().weight, at.fibres, law.yarn_tension(at), active);
          if constexpr (requires { at.cell.fallback; }) {
            const T fallbacks = select(active, at.cell.fallback, T(R(0)));
            sums.fallbacks +=
                static_cast<long long>(static_cast<double>(lane_sum(fallbacks)) + 0.5);
          }
        }
      }
    }
  }

  /// [D-5]; `power` collects what it takes.
  CROSSBEAM_INLINE void add_viscous_stresses(const View<T>& v, const Run& run, int p, Rows& rows,
                                             T& power) const {
    auto c = constants(run, p);
    for (int i = 0; i < run.batches * lanes; i += lanes, c.next()) {
      Vec3<T> corner[corners], rate[K];
      v.load_all(i, corner);
      Element::relative_vectors(corner, rate);
      const PointLanes<T, M> point = c.point();
      const PointKinematics<T, M, K> rates(rate, point);
      const T mu = c.viscosity();
      const T inv1 = rows.inv1.load(i), inv2 = rows.inv2.load(i);
      const T r1 = dot(rows.f1.load(i), rates.f1) * inv1;
      const T r2 = dot(rows.f2.load(i), rates.f2) * inv2;
      rows.m11.store(i, rows.m11.load(i) + mu * r1 * inv1);
      rows.m22.store(i, rows.m22.load(i) + mu * r2 * inv2);
      power = power + point.weight * mu * (r1 * r1 + r2 * r2);
    }
  }

  /// Adds the point's generalised forces, and after the last point gives them to the corners.
  CROSSBEAM_INLINE void forces(const Run& run, int p, Rows& rows) const {
    const bool has_hourglass = points_.constants.hourglass_modulus() > R(0);
    const bool skewed = points_.constants.is_skewed();
    const T zero(R(0));
    const Vec3<T> none{zero, zero, zero};
    auto c = constants(run, p);
    for (int i = 0; i < run.batches * lanes; i += lanes, c.next()) {
      const PointKinematics<T, M, K> kinematics(rows.f1.load(i), rows.f2.load(i));
      Vec3<T> force[K];
      point_forces(kinematics, rows.stress(i), c.point(), force);
      if constexpr (Element::points > 1) {
        if (p > 0)
          unrolled<K>([&](auto k)
                          CROSSBEAM_INLINE_LAMBDA { force[k] = rows.force[k].load(i) + force[k]; });
        if (p + 1 < Element::points) {
          unrolled<K>([&](auto k) CROSSBEAM_INLINE_LAMBDA { rows.force[k].store(i, force[k]); });
          continue;
        }
      }
      for (int k = M; k < K; ++k) force[k] = none;
      if constexpr (Element::has_hourglass)
        if (has_hourglass) {
          const Vec3<T> q = rows.hourglass.load(i);
          force[2] = q;
          if (skewed) {
            force[0] = force[0] - c.hourglass(0) * q;
            force[1] = force[1] - c.hourglass(1) * q;
          }
        }
      Vec3<T> corner[corners];
      Element::corner_forces(force, corner);
      unrolled<corners>([&](auto a) CROSSBEAM_INLINE_LAMBDA { rows.corner.put(a, i, corner[a]); });
    }
  }

  MembranePoints<T, Element, Law> points_;
  Heights heights_;  // of the cells, where the law follows them
  Work yarn_work_;   // of a law without a potential
  int node_count_;
  double areal_mass_;
  bool started_ = false, begun_ = false;
  std::vector<StageSums> stage_sums_;
};

}  // namespace crossbeam
