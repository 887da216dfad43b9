#pragma once
/// @file
/// Contact of the fabric's nodes with one rigid tool: penalty with damping, Coulomb friction,
/// culling of the nodes that provably cannot touch. Theory: docs/theory/contact.md.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"
#include "crossbeam/contact/contact_law.hpp"
#include "crossbeam/contact/start_check.hpp"
#include "crossbeam/model/tool_contact.hpp"
#include "crossbeam/tools/surface.hpp"

#include <limits>
#include <utility>

namespace crossbeam {

/// Contact with a tool of a given shape. T is the pack the sweep runs on.
template <class T, class Shape>
  requires Surface<Shape, T>
class RigidToolContact final : public ToolContact<real_t<T>> {
 public:
  using R = real_t<T>;
  using Base = ToolContact<R>;
  using Wide = double_lanes_t<T>;
  static constexpr int lanes = lanes_v<T>;

  /// @param nodes number of nodes of the fabric
  RigidToolContact(Shape shape, ToolMotion motion, const ContactParameters& parameters, int nodes)
      : Base(std::move(motion)),
        shape_(std::move(shape)),
        parameters_(parameters),
        nodes_(nodes),
        batches_((nodes + lanes - 1) / lanes),
        stick_(nodes),
        friction_(nodes),
        damping_(nodes),
        normal_(padded(nodes)),
        safe_until_(batches_, 0.0),
        active_(batches_, 0) {
    validate(parameters);
  }

  /// Nodes inside the tool where it is now.
  [[nodiscard]] StartPenetration start_penetration(const NodalState<R>& state) const {
    StartPenetration out;
    const T zero(R(0));
    for (int n = 0; n < state.node_count; n += lanes) {
      const T area = T::load(state.area.data() + n);
      Vec3<Wide> x = load<Wide>(state.x, n);
      x.z = x.z - Wide(this->now_.z);
      const T gap = shape_.gap(convert<T>(x)).gap;
      const auto inside = (gap < zero) && (area > zero);
      if (!any(inside)) continue;
      const T depth = select(inside, -gap, zero), k = constant<T>(parameters_.penalty) * area;
      const T energy = penalty_force(depth, zero, k, zero, inside).energy;
      for (int lane = 0; lane < lanes; ++lane) {
        const double d = static_cast<double>(depth[lane]);
        if (!(d > 0)) continue;
        ++out.nodes;
        if (d <= out.depth) continue;
        out.deepest = n + lane;
        out.depth = d;
        // Of a depth that is mere rounding, a smooth onset's energy may be below zero by as much.
        out.speed = std::sqrt(2 * maximum(static_cast<double>(energy[lane]), 0.0) /
                              static_cast<double>(state.mass[n + lane]));
      }
    }
    return out;
  }
  /// What can be said before a run from `state`; nothing unless parameters.check_start.
  /// @throws InputError (require_gentle, require_no_gap)
  void check_start(const NodalState<R>& state) const override {
    if (!parameters_.check_start) return;
    require_no_gap(smallest_width(shape_), state.widest_element);
    require_gentle(start_penetration(state));
  }

  using Base::add_forces;
  using Base::book_nodes;

  [[nodiscard]] std::optional<int> node_count() const override { return nodes_; }

  void begin_forces(int parts, int flight) override {
    Base::begin_forces(parts, flight);
    at_start_ = !started_;
    started_ = true;
  }

  void add_forces(NodalState<R>& state, double dt, double travel,
                  const typename Base::Part& part) override {
    Step step;
    step.slip_time = T(static_cast<R>(at_start_ ? 0.0 : dt));  // no slip has happened before t = 0
    step.half_over_dt = T(static_cast<R>(0.5 / dt));
    auto& flight = this->flights_[part.flight];
    step.z = Wide(flight.at.z);
    step.velocity = T(static_cast<R>(flight.at.v_plus));
    step.velocity_now = T(static_cast<R>(flight.at.predicted_velocity()));
    Sums sums;
    PackVisits visits;
    const T zero(R(0));
    for (int n = part.first; n < part.last; n += lanes) {
      const int b = n / lanes;
      if (parameters_.culling && travel < safe_until_[b]) {
        ++visits.culled;
        continue;
      }
      const T area = T::load(state.area.data() + n);
      Vec3<Wide> x = load<Wide>(state.x, n);
      x.z = x.z - step.z;
      const Vec3<T> p = convert<T>(x);
      const auto real = area > zero;
      if constexpr (HasFlatPart<Shape, T>)
        if (parameters_.region_classes && all(shape_.in_flat_part(p) || !real)) {
          ++visits.flat;
          touch<true>(state, n, travel, step, area, p, sums);
          continue;
        }
      ++visits.general;
      touch<false>(state, n, travel, step, area, p, sums);
    }
    auto& out = flight.parts[part.number];
    out.force = {static_cast<double>(lane_sum(sums.force.x)),
                 static_cast<double>(lane_sum(sums.force.y)),
                 static_cast<double>(lane_sum(sums.force.z))};
    out.stored = static_cast<double>(lane_sum(sums.energy));
    out.visits = visits;
  }

  void book_nodes(const NodalState<R>& state, double a, double b,
                  const typename Base::Part& part) override {
    // v_n = 2 v_{n+1/2} - v_predicted, whichever step the latter is for.
    const T ta(static_cast<R>(-a)), tb(static_cast<R>(2 * a + b));
    const T zero(R(0));
    T friction = zero, friction_z = zero, damping = zero, damping_z = zero;
    for (int n = part.first; n < part.last; n += lanes) {
      if (!active_[n / lanes]) continue;
      const Vec3<T> v = ta * load<T>(state.v_predicted, n) + tb * load<T>(state.v, n);
      const Vec3<T> f = load<T>(friction_, n), d = load<T>(damping_, n);
      friction = friction + dot(f, v);
      friction_z = friction_z + f.z;
      damping = damping + dot(d, v);
      damping_z = damping_z + d.z;
    }
    auto& out = this->flights_[part.flight].parts[part.number];
    out.friction_power = static_cast<double>(lane_sum(friction));
    out.friction_z = static_cast<double>(lane_sum(friction_z));
    out.damping_power = static_cast<double>(lane_sum(damping));
    out.damping_z = static_cast<double>(lane_sum(damping_z));
  }

  void add_pressure(const NodalState<R>& state, std::vector<double>& pressure) const override {
    for (int n = 0; n < state.node_count; ++n)
      pressure[n] += static_cast<double>(normal_[n]) / static_cast<double>(state.area[n]);
  }

  [[nodiscard]] double omega_squared(double areal_mass, double area) const override {
    return sides(areal_mass, area) * penalty() / areal_mass;
  }
  [[nodiscard]] double damping_rate(double areal_mass, double area) const override {
    return sides(areal_mass, area) * 2 * parameters_.damping_ratio *
           std::sqrt(penalty() / areal_mass);
  }

  void reset_culling() override { std::fill(safe_until_.begin(), safe_until_.end(), 0.0); }

  [[nodiscard]] bool is_rate_form() const override {
    return parameters_.friction == 0 || parameters_.friction_model == Friction::smooth;
  }

  void add_tangent(const NodalState<R>& state, int tool_row,
                   TangentEntries& tangent) const override {
    using D = Dual<R, 6>;  // position and velocity of the node against the tool
    if constexpr (!Surface<Shape, D>)
      throw no_tangent();
    else
      for (int n = 0; n < state.node_count; ++n) {
        Vec3<D> p, v;
        const Vec3<R> x = seen(state.x.get(n), this->now_.z), rate = state.v.get(n);
        p = {D::variable(x.x, 0), D::variable(x.y, 1), D::variable(x.z, 2)};
        v = {D::variable(rate.x, 3), D::variable(rate.y, 4),
             D::variable(rate.z - R(this->now_.v_plus), 5)};
        const SurfaceGap<D> at = shape_.gap(p);
        if (!(at.gap < D(R(0)))) continue;
        const D k(R(parameters_.penalty) * state.area[n]), m(state.mass[n]);
        using std::sqrt;
        const NormalForce<D> normal =
            penalty_force(-at.gap, -dot(v, at.normal), k, sqrt(k * m), true);
        const Vec3<D> force =
            normal.pressure * at.normal + smooth_friction(tangential<false>(v, at.normal),
                                                          friction_limit(normal.pressure),
                                                          constant<D>(parameters_.slip_speed));
        const D component[3] = {force.x, force.y, force.z};
        Eigen::Matrix3d K, C;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            K(i, j) = -static_cast<double>(component[i].d[j]);
            C(i, j) = -static_cast<double>(component[i].d[3 + j]);
          }
        add_blocks(tangent.stiffness, n, tool_row, K);
        if (tangent.with_damping) add_blocks(tangent.damping, n, tool_row, C);
      }
  }

  void come_to_rest(const NodalState<R>& state) override {
    rest_ = state.x;
    rest_z_ = this->now_.z;
  }

  double add_rest_forces(NodalState<R>& state, int tool_row,
                         TangentEntries* tangent) const override {
    using D = Dual<R, 3>;
    double sum = 0;
    if constexpr (!Surface<Shape, D>)
      throw no_tangent();
    else
      for (int n = 0; n < state.node_count; ++n) {
        const Vec3<R> x = seen(state.x.get(n), this->now_.z), x0 = seen(rest_.get(n), rest_z_);
        const Vec3<R> xi0 = stick_.get(n);
        const Vec3<D> p{D::variable(x.x, 0), D::variable(x.y, 1), D::variable(x.z, 2)};
        const SurfaceGap<D> at = shape_.gap(p);
        if (!(at.gap < D(R(0)))) continue;
        const D k(R(parameters_.penalty) * state.area[n]), none(R(0));
        const NormalForce<D> normal = penalty_force(-at.gap, none, k, none, true);
        Vec3<D> force = normal.pressure * at.normal;
        if (parameters_.friction_model == Friction::elastic_stick) {
          const Vec3<D> xi{D(xi0.x) + p.x - D(x0.x), D(xi0.y) + p.y - D(x0.y),
                           D(xi0.z) + p.z - D(x0.z)};
          force = force + stick_friction<false>(xi, Vec3<D>{}, at.normal,
                                                constant<D>(parameters_.stick_ratio) * k, none,
                                                friction_limit(normal.pressure))
                              .force;
        }
        const Vec3<R> f{force.x.value, force.y.value, force.z.value};
        state.f.set(n, state.f.get(n) + f);
        sum += static_cast<double>(f.z);
        if (!tangent) continue;
        const D component[3] = {force.x, force.y, force.z};
        Eigen::Matrix3d K;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) K(i, j) = -static_cast<double>(component[i].d[j]);
        add_blocks(tangent->stiffness, n, tool_row, K);
      }
    return sum;
  }

  [[nodiscard]] const Shape& shape() const { return shape_; }

 private:
  /// What all nodes of a step share, in every lane.
  struct Step {
    T slip_time, half_over_dt;
    Wide z;                    ///< of the tool
    T velocity, velocity_now;  ///< of the tool
  };
  struct Sums {
    Vec3<T> force{T(R(0)), T(R(0)), T(R(0))};
    T energy{R(0)};
  };

  /// A node in the frame of a tool at z [mm], tag [D-6].
  static Vec3<R> seen(const Vec3<double>& x, double z) { return {R(x.x), R(x.y), R(x.z - z)}; }

  /// One pack of nodes, against the flat part of the tool or against all of it.
  template <bool Flat>
  CROSSBEAM_INLINE void touch(NodalState<R>& state, int n, double travel, const Step& step,
                              const T& area, const Vec3<T>& p, Sums& sums) {
    const int b = n / lanes;
    const T zero(R(0));
    const auto real = area > zero;
    SurfaceGap<T> at;
    if constexpr (Flat)
      at = shape_.flat_gap(p);
    else
      at = shape_.gap(p);
    const auto touching = (at.gap < zero) && real;
    if (!any(touching)) {
      const T clearance = select(real, at.clearance, T((std::numeric_limits<R>::max)()));
      // `travel` grows by what node and tool move together: it must use up the clearance first
      // [F-4].
      safe_until_[b] = travel + static_cast<double>(-lane_maximum(-clearance));
      if (active_[b]) release(n, b);
      return;
    }
    active_[b] = 1;
    const T m = T::load(state.mass.data() + n);
    const Vec3<T> v_half = load<T>(state.v, n), v_now = load<T>(state.v_predicted, n);
    const T depth = select(touching, -at.gap, zero);
    const T k = constant<T>(parameters_.penalty) * area;
    const T closing = -(along_normal<Flat>(v_now, at.normal) - step.velocity_now * at.normal.z);
    using std::sqrt;
    const T root = sqrt(k * m);
    const NormalForce<T> normal = penalty_force(depth, closing, k, root, touching);
    const T limit = friction_limit(normal.pressure);

    Vec3<T> t;
    if (parameters_.friction_model == Friction::smooth) {
      t = smooth_friction(slip<Flat>(v_now, step.velocity_now, at.normal), limit,
                          constant<T>(parameters_.slip_speed));
    } else if (parameters_.friction_model == Friction::elastic_stick) {
      const Vec3<T> slip_rate = slip<Flat>(v_half, step.velocity, at.normal);
      const T c_t = minimum(
          constant<T>(2 * parameters_.damping_ratio * std::sqrt(parameters_.stick_ratio)) * root,
          m * step.half_over_dt);
      const Vec3<T> xi = load<T>(stick_, n) + step.slip_time * slip_rate;
      const StickFriction<T> stick = stick_friction<Flat>(
          xi, slip_rate, at.normal, constant<T>(parameters_.stick_ratio) * k, c_t, limit);
      t = select_lanes(touching, stick.force);
      const Vec3<T> kept = {select(stick.slips, stick.slipped.x, stick.trial.x),
                            select(stick.slips, stick.slipped.y, stick.trial.y),
                            select(stick.slips, stick.slipped.z, stick.trial.z)};
      store(stick_, n, select_lanes(touching, kept));
    } else {
      t = select_lanes(
          touching, viscous_friction(slip<Flat>(v_half, step.velocity, at.normal), limit,
                                     constant<T>(parameters_.slip_speed), m * step.half_over_dt));
    }

    const Vec3<T> force = normal.pressure * at.normal + t;
    store(state.f, n, load<T>(state.f, n) + force);
    store(friction_, n, t);
    store(damping_, n, normal.viscous * at.normal);
    normal.pressure.store(normal_.data() + n);
    sums.force = sums.force + force;
    sums.energy = sums.energy + normal.energy;
  }

  /// The law with this contact's constants: the node's penalty k and root = (k m)^(1/2).
  template <class S, class Mask>
  CROSSBEAM_INLINE NormalForce<S> penalty_force(const S& depth, const S& closing, const S& k,
                                                const S& root, const Mask& touching) const {
    const S c = constant<S>(2 * parameters_.damping_ratio) * root;
    if (parameters_.smoothing > 0)
      return normal_force(depth, closing, k, c, constant<S>(parameters_.smoothing), touching);
    return normal_force(depth, closing, k, c, touching);
  }
  template <class S>
  CROSSBEAM_INLINE S friction_limit(const S& pressure) const {
    return constant<S>(parameters_.friction) * pressure;
  }
  template <class S>
  CROSSBEAM_INLINE static S constant(double value) {
    return S(static_cast<R>(value));
  }

  /// Velocity of a node against the tool, in the tangent plane.
  template <bool Flat, class S>
  CROSSBEAM_INLINE static Vec3<S> slip(Vec3<S> v, const S& tool_v, const Vec3<S>& normal) {
    v.z = v.z - tool_v;
    return tangential<Flat>(v, normal);
  }

  static InputError no_tangent() {
    return {"tool surface", "not for dual numbers", "",
            "gap(Vec3<T>) for any scalar T, where a tangent or forces at rest are asked for"};
  }

  static void add_blocks(std::vector<TangentEntries::Entry>& list, int node, int tool_row,
                         const Eigen::Matrix3d& K) {
    TangentEntries::add(list, 3 * node, 3 * node, K);
    if (tool_row < 0) return;
    TangentEntries::add(list, 3 * node, tool_row, -K.col(2));
    TangentEntries::add(list, tool_row, 3 * node, -K.row(2));
    list.push_back({tool_row, tool_row, K(2, 2)});
  }

  [[nodiscard]] double penalty() const {
    return parameters_.penalty * maximum(1.0, parameters_.stick_ratio);
  }
  /// A free tool moves against the nodes: each spring works on 1/m and its share of the tool's 1/M.
  [[nodiscard]] double sides(double areal_mass, double area) const {
    return this->motion_.is_free() ? 1 + areal_mass * area / this->motion_.mass : 1;
  }

  template <class Mask>
  CROSSBEAM_INLINE static Vec3<T> select_lanes(const Mask& mask, const Vec3<T>& a) {
    const T zero(R(0));
    return {select(mask, a.x, zero), select(mask, a.y, zero), select(mask, a.z, zero)};
  }

  /// A batch that lost contact forgets its stick and its forces.
  void release(int n, int b) {
    const T zero(R(0));
    const Vec3<T> none{zero, zero, zero};
    store(stick_, n, none);
    store(friction_, n, none);
    store(damping_, n, none);
    zero.store(normal_.data() + n);
    active_[b] = 0;
  }

  Shape shape_;
  ContactParameters parameters_;
  int nodes_, batches_;
  NodeVectors<R> stick_;     // elastic slip xi [mm]
  NodeVectors<R> friction_;  // force on the node [kN]
  NodeVectors<R> damping_;   // force on the node [kN]
  AlignedArray<R> normal_;   // normal force on the node, pressure positive [kN]
  std::vector<double> safe_until_;
  std::vector<char> active_;
  NodeVectors<double> rest_;  // positions where statics began
  double rest_z_ = 0;
  bool started_ = false, at_start_ = true;
};

}  // namespace crossbeam
