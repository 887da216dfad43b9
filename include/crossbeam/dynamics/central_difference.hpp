#pragma once
/// @file
/// Explicit dynamics: the central-difference (leap-frog) scheme with centred damping, a constant
/// proven bound of the critical step, and the energy ledger. Theory: docs/theory/dynamics.md.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/dynamics/step_order.hpp"
#include "crossbeam/model/ledger.hpp"
#include "crossbeam/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace crossbeam {

/// @tparam T pack; one lane per node in the update
template <class T>
class CentralDifference {
 public:
  using R = real_t<T>;
  using Wide = double_lanes_t<T>;
  static constexpr int lanes = lanes_v<T>;

  /// @param areal_mass   [kg/mm^2]
  /// @param mass_damping alpha of the force -alpha m v [1/ms]; >= 0
  CentralDifference(NodalState<R> state, double areal_mass, double mass_damping = 0)
      : model_(std::move(state), areal_mass, mass_damping) {}
  explicit CentralDifference(Model<R> model) : model_(std::move(model)) {}

  void add(std::unique_ptr<ForceBlock<R>> block) { model_.add(std::move(block)); }
  void add(std::unique_ptr<ToolContact<R>> tool) { model_.add(std::move(tool)); }

  /// Model::critical_step
  [[nodiscard]] double critical_step() const { return model_.critical_step(); }

  /// Starts the scheme from the state's positions and velocities (read as v at t = 0), with the
  /// step dt. Call once, after all blocks and tools were added.
  void start(double dt) {
    dt_ = require_positive("time_step", dt, "ms");
    require_positive("time_step in the run's precision", static_cast<R>(dt), "ms");
    time_ = 0;
    model_.state.v_predicted = model_.state.v;
    for (const auto& t : model_.tools) t->reset_culling();
    level_start_ = model_.arrange(least_level);
    level_travel_.assign(level_start_.size() - 1, 0);
    order_ = StepOrder(static_cast<int>(level_travel_.size()));
    tool_travel_ = 0;
    is_constrained_.assign(static_cast<std::size_t>(model_.padded_count() / lanes), 0);
    for (int n = 0; n < model_.state.node_count; ++n) {
      const Vec3<R> free = model_.state.free.get(n);
      if (!(free.x == R(1) && free.y == R(1) && free.z == R(1))) is_constrained_[n / lanes] = 1;
    }
  }

  /// One step: forces at t_n, velocities to t_{n+1/2}, positions to t_{n+1}. Level by level, so that
  /// what one part of the step has written is still in the cache for the next, tag [S-3].
  /// @param sample ledger to fill with the energies at t_n, or nullptr
  /// @throws RunError naming node, tool or ledger when a node moves faster than `speed_limit`, or
  /// anything is not a number
  void step(EnergyLedger* sample = nullptr) {
    CROSSBEAM_EXPECTS(dt_ > 0);
    if (sample || steps_ == 0)
      step_at_once(sample);
    else
      step_together(1);
  }

  /// As many calls of `step`, in every bit. Of a mesh of many levels several steps are in flight at a
  /// time: each follows the one before a few levels behind, through the same cache, tag [S-6]. Where a
  /// node moves too fast, those behind it have gone on when it is found.
  void advance(long long steps) {
    while (steps > 0) {
      const int together =
          steps_ == 0 ? 1 : static_cast<int>(std::min<long long>(steps, in_flight()));
      if (together > 1)
        step_together(together);
      else
        step();
      steps -= together;
    }
  }

  /// Steps that `advance` has in flight at a time: one with several threads, with few levels, and where
  /// a tool's motion depends on all of a step's forces.
  [[nodiscard]] int in_flight() const {
    if (threads() > 1 || levels() < least_levels_in_flight) return 1;
    for (const auto& t : model_.tools)
      if (t->motion().is_free()) return 1;
    return most_in_flight;
  }

  /// Speeds above this stop the run [mm/ms]; for instance the yarns' wave speed.
  void set_speed_limit(double limit) {
    speed_limit_ = require_positive("speed_limit", limit, "mm/ms");
  }

  /// Threads that share the step of a large mesh. The result is the same in every bit.
  void set_threads(int threads) { team_ = ThreadTeam(threads); }
  [[nodiscard]] int threads() const { return team_.threads(); }
  /// Levels of nodes and bands of levels that the step goes through; after `start`.
  [[nodiscard]] int levels() const { return order_.levels(); }
  [[nodiscard]] int bands() const { return order_.bands(); }

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double time_step() const { return dt_; }
  [[nodiscard]] long long steps() const { return steps_; }
  [[nodiscard]] const Model<R>& model() const { return model_; }
  [[nodiscard]] Model<R>& model() { return model_; }
  [[nodiscard]] const NodalState<R>& state() const { return model_.state; }
  [[nodiscard]] NodalState<R>& state() { return model_.state; }
  [[nodiscard]] const std::vector<std::unique_ptr<ForceBlock<R>>>& blocks() const {
    return model_.blocks;
  }
  [[nodiscard]] const std::vector<std::unique_ptr<ToolContact<R>>>& tools() const {
    return model_.tools;
  }

 private:
  static constexpr int least_level = 256;

  /// Steps in flight: as many as keep a loop's inputs in a second-level cache of a megabyte or two.
  static constexpr int most_in_flight = 4, least_levels_in_flight = 64;

  /// What a level leaves behind of a step.
  struct LevelSums {
    double speed = 0;               ///< largest [mm/ms]; no number stays none
    double mass_damping_power = 0;  ///< [kN mm/ms]
  };

  void clear_forces(int level) {
    const bool last = level + 1 == levels();
    model_.clear_forces(level_start_[level],
                        last ? model_.padded_count() : level_start_[level + 1]);
  }
  void add_internal_forces(const StepOrder::Place& place) {
    for (int level = place.clear_begin; level < place.clear_end; ++level) clear_forces(level);
    for (const auto& b : model_.blocks) b->add_stage(model_.state, dt_, place.stage);
  }
  [[nodiscard]] typename ToolContact<R>::Part part(int level, int flight) const {
    return {level_start_[level], level_start_[level + 1], level, flight};
  }
  void add_contact_forces(int level, int flight) {
    for (const auto& t : model_.tools)
      t->add_forces(model_.state, dt_, level_travel_[level] + flight_travel_[flight],
                    part(level, flight));
  }
  [[nodiscard]] LevelSums& sums(int level, int flight) { return sums_[flight * levels() + level]; }

  /// A stage's part of a step, and the rest of the step for nodes that have all their forces then.
  void pass(const StepOrder::Place& place, int flight) {
    add_internal_forces(place);
    for (int level = place.finish_begin; level < place.finish_end; ++level) {
      add_contact_forces(level, flight);
      move(level, flight);
      for (const auto& t : model_.tools) t->book_nodes(model_.state, 1, 0, part(level, flight));
      if (model_.mass_damping > 0)
        sums(level, flight).mass_damping_power =
            mass_damping_power(1, 0, level_start_[level], level_start_[level + 1]);
    }
  }

  void begin_steps(int count) {
    for (const auto& b : model_.blocks) b->begin_step(model_.state);
    sums_.resize(static_cast<std::size_t>(count * levels()));
    flight_travel_.resize(static_cast<std::size_t>(count));
    for (int flight = 0; flight < count; ++flight) {
      flight_travel_[flight] = tool_travel_;
      for (const auto& t : model_.tools) t->begin_forces(levels(), flight);
      if (count > 1) advance_tools(flight);
    }
  }

  /// @param count 1, or up to `in_flight`
  void step_together(int count) {
    begin_steps(count);
    const auto task = [this](const StepOrder::Place& place, int flight = 0) {
      pass(place, flight);
    };
    if (count == 1)
      order_.share(team_, task);
    else
      order_.follow(count, task);
    for (int flight = 0; flight < count; ++flight) {
      for (const auto& t : model_.tools) t->end_forces(flight);
      if (count == 1) advance_tools(flight);
      const double fastest = collect(flight);
      for (const auto& t : model_.tools) t->book_tool(1, 0, dt_, flight);
      book_mass_damping(dt_);
      end_step(fastest);
    }
  }

  /// Energies are those of x_n: no node moves before all forces are known.
  void step_at_once(EnergyLedger* sample) {
    begin_steps(1);
    order_.share(team_, [this](const StepOrder::Place& place) { add_internal_forces(place); });
    for (int level = 0; level < levels(); ++level) add_contact_forces(level, 0);
    for (const auto& t : model_.tools) t->end_forces();
    if (steps_ == 0) begin();
    EnergyLedger ledger;
    if (sample) {
      for (const auto& b : model_.blocks) b->add_energy(model_.state, ledger.internal);
      for (const auto& t : model_.tools) ledger.contact += t->stored_energy();
    }
    for (int level = 0; level < levels(); ++level) move(level, 0);
    const double fastest = collect(0);
    advance_tools(0);
    // First half of the step's work, the energies at t_n, then the second half. The first half of
    // the first step would lie before the start.
    if (steps_ > 0) book(2, -1, dt_ / 2);
    if (sample) {
      const Totals now = totals();
      ledger.time = time_;
      ledger.kinetic = now.kinetic;
      ledger.friction = now.friction;
      ledger.contact_damping = now.contact_damping;
      ledger.mass_damping = mass_damping_work_;
      ledger.external = now.external;
      ledger.initial = initial_;
      *sample = ledger;
    }
    book(0, 1, dt_ / 2);
    end_step(fastest);
    if (sample && !std::isfinite(sample->residual()))
      throw RunError(when() + "an entry of the energy ledger is not a finite number");
  }

  /// @return the largest speed of any node
  double collect(int flight) {
    double fastest = 0;
    for (int level = 0; level < levels(); ++level) {
      fastest = faster(fastest, sums(level, flight).speed);
      mass_damping_power_ += sums(level, flight).mass_damping_power;
    }
    return fastest;
  }

  void end_step(double fastest) {
    ++steps_;
    time_ = static_cast<double>(steps_) * dt_;
    if (fastest <= speed_limit_) return;
    throw RunError(when() + "node " + std::to_string(fastest_node()) + " moves at " +
                   detail::to_text(fastest) + " mm/ms, above the limit of " +
                   detail::to_text(speed_limit_) +
                   " mm/ms. The run is unstable: use a smaller time step (critical step bound " +
                   detail::to_text(critical_step()) + " ms, step " + detail::to_text(dt_) +
                   " ms); or an element around the node has collapsed");
  }

  /// The larger one; what is no number stays.
  static double faster(double a, double b) { return a >= b ? a : (b >= a ? b : a + b); }

  void advance_tools(int flight) {
    const double time = static_cast<double>(steps_ + flight) * dt_;
    double furthest = 0;
    for (std::size_t k = 0; k < model_.tools.size(); ++k) {
      const double moved = model_.tools[k]->advance(time, dt_, flight);
      if (!std::isfinite(moved))
        throw RunError(when() + "tool " + std::to_string(k) +
                       " is at z = " + detail::to_text(model_.tools[k]->position()) +
                       " mm: its motion z(t) or force F(t) gives no number");
      furthest = maximum(furthest, moved);
    }
    tool_travel_ += furthest;
  }

  struct Totals {
    double kinetic = 0, friction = 0, contact_damping = 0, external = 0;
  };

  [[nodiscard]] std::string when() const {
    return "time " + detail::to_text(time_) + " ms, step " + std::to_string(steps_) + ": ";
  }

  /// The first node that moves at no number, or else the fastest one.
  [[nodiscard]] int fastest_node() const {
    int fastest = 0;
    double most = -1;
    for (int n = 0; n < model_.state.node_count; ++n) {
      const Vec3<R> v = model_.state.v.get(n);
      const double speed_squared = static_cast<double>(dot(v, v));
      if (!std::isfinite(speed_squared)) return n;
      if (speed_squared > most) fastest = n;
      most = maximum(most, speed_squared);
    }
    return fastest;
  }

  /// v_{-1/2} = v_0 - dt/2 a_0 keeps the first step of second order; and the energy at the start.
  void begin() {
    InternalEnergy internal;
    for (const auto& b : model_.blocks) b->add_energy(model_.state, internal);
    initial_ = internal.stored();
    for (const auto& t : model_.tools) initial_ += t->stored_energy();
    const T half(static_cast<R>(-dt_ / 2)), alpha(static_cast<R>(model_.mass_damping));
    for (int n = 0; n < model_.state.node_count; n += lanes) {
      const Vec3<T> v = constrained(n, load<T>(model_.state.v, n));
      initial_ +=
          0.5 * static_cast<double>(lane_sum(T::load(model_.state.mass.data() + n) * dot(v, v)));
      store(model_.state.v, n, constrained(n, v + half * (acceleration(n) - alpha * v)));
    }
  }

  CROSSBEAM_INLINE Vec3<T> acceleration(int n) const {
    return T::load(model_.state.inverse_mass.data() + n) * load<T>(model_.state.f, n);
  }
  CROSSBEAM_INLINE Vec3<T> constrained(int n, const Vec3<T>& v) const {
    const Vec3<T> free = load<T>(model_.state.free, n);
    return {v.x * free.x, v.y * free.y, v.z * free.z};
  }

  /// v_{n+1/2} and x_{n+1} of a level, tag [D-1].
  void move(int level, int flight) {
    const double a = model_.mass_damping * dt_ / 2;
    const T keep(static_cast<R>((1 - a) / (1 + a))), push(static_cast<R>(dt_ / (1 + a)));
    const T half(R(0.5)), three_halves(R(1.5));
    const Wide dt(dt_);
    T fastest(R(0)), sum(R(0));
    NodalState<R>& state = model_.state;
    const NodePointers<double> x(state.x);
    const NodePointers<R> v(state.v), predicted(state.v_predicted), f(state.f);
    const R* const inverse_mass = state.inverse_mass.data();
    const char* const is_constrained = is_constrained_.data();
    const std::ptrdiff_t first = level_start_[level], last = level_start_[level + 1];
    for (std::ptrdiff_t n = first, pack = first / lanes; n < last; n += lanes, ++pack) {
      const Vec3<T> before = v.template load<T>(n);
      Vec3<T> after = keep * before + (push * T::load(inverse_mass + n)) * f.template load<T>(n);
      if (is_constrained[pack]) after = constrained(static_cast<int>(n), after);
      v.store(n, after);
      predicted.store(n, three_halves * after - half * before);
      x.store(n, x.template load<Wide>(n) + dt * convert<Wide>(after));
      const T speed_squared = dot(after, after);
      fastest = maximum(fastest, speed_squared);
      sum = sum + speed_squared;  // a NaN or an overflow stays in the sum
    }
    const double total = static_cast<double>(lane_sum(sum));
    const double speed =
        std::isfinite(total) ? std::sqrt(static_cast<double>(lane_maximum(fastest))) : total;
    sums(level, flight) = {speed, 0};
    level_travel_[level] += speed * dt_;
  }

  /// Work of the step's forces with the velocities a v_n + b v_{n+1/2} over a time, tag [D-4].
  void book(double a, double b, double weight) {
    for (const auto& t : model_.tools) t->book(model_.state, a, b, weight);
    if (model_.mass_damping > 0)
      mass_damping_power_ += mass_damping_power(a, b, 0, model_.state.node_count);
    book_mass_damping(weight);
  }
  [[nodiscard]] double mass_damping_power(double a, double b, int first, int last) const {
    const T ta(static_cast<R>(a)), tb(static_cast<R>(b));
    T sum(R(0));
    for (int n = first; n < last; n += lanes) {
      const Vec3<T> half = load<T>(model_.state.v, n), centre = centre_velocity(n);
      sum = sum + T::load(model_.state.mass.data() + n) * dot(centre, ta * centre + tb * half);
    }
    return static_cast<double>(lane_sum(sum));
  }
  void book_mass_damping(double weight) {
    mass_damping_work_ += model_.mass_damping * mass_damping_power_ * weight;
    mass_damping_power_ = 0;
  }

  /// v_n, once the nodes have moved: v_predicted is then the one for t_{n+1}.
  CROSSBEAM_INLINE Vec3<T> centre_velocity(int n) const {
    return T(R(2)) * load<T>(model_.state.v, n) - load<T>(model_.state.v_predicted, n);
  }

  /// Kinetic energy at t_n as m v_{n-1/2} v_{n+1/2} / 2, and the tools' works.
  [[nodiscard]] Totals totals() const {
    Totals out;
    const T two(R(2));
    for (int n = 0; n < model_.state.node_count; n += lanes) {
      const Vec3<T> v = load<T>(model_.state.v, n);
      const Vec3<T> before = two * centre_velocity(n) - v;
      out.kinetic += 0.5 * static_cast<double>(
                               lane_sum(T::load(model_.state.mass.data() + n) * dot(before, v)));
    }
    for (const auto& t : model_.tools) {
      out.kinetic += t->kinetic_energy();
      out.friction += t->work().friction;
      out.contact_damping += t->work().damping;
      out.external += t->work().tool;
    }
    return out;
  }

  Model<R> model_;
  std::vector<int> level_start_;
  std::vector<char> is_constrained_;  // packs with a node that is held
  std::vector<double> level_travel_;  // bound of how far any node has moved since the start [mm]
  StepOrder order_;
  std::vector<LevelSums> sums_;        // of flight 0, level after level; of flight 1, ...
  std::vector<double> flight_travel_;  // of all tools before the step
  ThreadTeam team_;
  double dt_ = 0, time_ = 0, tool_travel_ = 0, speed_limit_ = 1e6;
  double mass_damping_work_ = 0, mass_damping_power_ = 0, initial_ = 0;
  long long steps_ = 0;
};

}  // namespace crossbeam
