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

/// How long a step is.
class TimeStep {
 public:
  /// A share of the model's proven critical step.
  /// @param share in (0, 1]
  static TimeStep fraction(double share) {
    if (!(share > 0 && share <= 1))
      throw InputError("time step over the critical step", detail::to_text(share), "-",
                       "above 0 and at most 1");
    return TimeStep(share, 0);
  }
  /// That many ms; nothing says that the scheme is stable with it.
  static TimeStep fixed(double dt) { return TimeStep(0, require_positive("time_step", dt, "ms")); }

  /// [ms]
  template <class R>
  [[nodiscard]] double of(const Model<R>& model) const {
    const double dt = share_ > 0 ? share_ * model.critical_step() : fixed_;
    require_positive("time_step in the run's precision", static_cast<R>(dt), "ms");
    return dt;
  }

 private:
  TimeStep(double share, double fixed) : share_(share), fixed_(fixed) {}
  double share_, fixed_;
};

/// A simulation: it takes a model that is complete.
/// @tparam T pack; one lane per node in the update
template <class T>
class CentralDifference {
 public:
  using R = real_t<T>;
  using Wide = double_lanes_t<T>;
  static constexpr int lanes = lanes_v<T>;

  /// The scheme at t = 0, from the nodes' positions and velocities.
  /// @throws InputError for a step out of its range, and for nodes or elements that a tool finds
  /// unfit to begin with (ToolContact::check_start)
  CentralDifference(Model<R> model, const TimeStep& step)
      : model_(std::move(model)), dt_(step.of(model_)) {
    model_.close();
    model_.nodes().v_predicted = model_.nodes().v;
    for (const auto& t : model_.tools()) {
      t->check_start(model_.nodes());
      t->reset_culling();
    }
    level_start_ = model_.arrange(least_level);
    level_travel_.assign(level_start_.size() - 1, 0);
    order_ = StepOrder(static_cast<int>(level_travel_.size()));
    is_constrained_.assign(static_cast<std::size_t>(model_.padded_count() / lanes), 0);
    for (int n = 0; n < model_.nodes().node_count; ++n) {
      const Vec3<R> free = model_.nodes().free.get(n);
      if (!(free.x == R(1) && free.y == R(1) && free.z == R(1))) is_constrained_[n / lanes] = 1;
    }
  }

  /// Model::critical_step
  [[nodiscard]] double critical_step() const { return model_.critical_step(); }

  /// One step: forces at t_n, velocities to t_{n+1/2}, positions to t_{n+1}. Level by level, so that
  /// what one part of the step has written is still in the cache for the next, tag [S-3].
  /// @param sample ledger that is filled anew with the energies at t_n, or nullptr
  /// @throws RunError naming node, tool or ledger when a node moves faster than `speed_limit`, or
  /// anything is not a number
  void step(EnergyLedger* sample = nullptr) {
    begin_unbroken();
    if (sample || steps_ == 0)
      step_at_once(sample);
    else
      step_together(1);
    unfinished_ = false;
  }
  /// A step whose energies are looked at.
  [[nodiscard]] EnergyLedger sampled_step() {
    EnergyLedger ledger;
    step(&ledger);
    return ledger;
  }

  /// As many calls of `step`, in every bit. Of a mesh of many levels several steps are in flight at a
  /// time: each follows the one before a few levels behind, through the same cache, tag [S-6]. Where a
  /// node moves too fast, those behind it have gone on when it is found.
  void advance(long long steps) {
    while (steps > 0) {
      const int together =
          steps_ == 0 ? 1 : static_cast<int>(minimum<long long>(steps, in_flight()));
      if (together > 1) {
        begin_unbroken();
        step_together(together);
        unfinished_ = false;
      } else {
        step();
      }
      steps -= together;
    }
  }

  /// As many steps as it takes until `time` is reached.
  void advance_until(double time) {
    require_finite("time", time, "ms");
    while (time_ < time)
      advance(maximum<long long>(1, static_cast<long long>((time - time_) / dt_)));
  }

  /// Steps that `advance` has in flight at a time: one with several threads, with few levels, and where
  /// a tool's motion depends on all of a step's forces.
  [[nodiscard]] int in_flight() const {
    if (threads() > 1 || levels() < least_levels_in_flight) return 1;
    for (const auto& t : model_.tools())
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
  /// For the statics in between; nothing can be added to it.
  [[nodiscard]] Model<R>& model() { return model_; }
  [[nodiscard]] const NodalState<R>& state() const { return model_.nodes(); }
  /// For who moves nodes by hand between two steps; the tools then forget what they knew of them.
  [[nodiscard]] NodalState<R>& state() {
    for (const auto& t : model_.tools()) t->reset_culling();
    return model_.nodes();
  }
  [[nodiscard]] const std::vector<std::unique_ptr<ForceBlock<R>>>& blocks() const {
    return model_.blocks();
  }
  [[nodiscard]] const std::vector<std::unique_ptr<ToolContact<R>>>& tools() const {
    return model_.tools();
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
    for (const auto& b : model_.blocks()) b->add_stage(model_.nodes(), dt_, place.stage);
  }
  [[nodiscard]] typename ToolContact<R>::Part part(int level, int flight) const {
    return {level_start_[level], level_start_[level + 1], level, flight};
  }
  void add_contact_forces(int level, int flight) {
    for (const auto& t : model_.tools())
      t->add_forces(model_.nodes(), dt_, level_travel_[level] + flight_travel_[flight],
                    part(level, flight));
  }
  [[nodiscard]] LevelSums& sums(int level, int flight) { return sums_[flight * levels() + level]; }

  /// A stage's part of a step, and the rest of the step for nodes that have all their forces then.
  void pass(const StepOrder::Place& place, int flight) {
    add_internal_forces(place);
    for (int level = place.finish_begin; level < place.finish_end; ++level) {
      add_contact_forces(level, flight);
      move(level, flight);
      for (const auto& t : model_.tools())
        t->book_nodes(model_.nodes(), BookedTime::whole(dt_), part(level, flight));
      if (model_.mass_damping() > 0)
        sums(level, flight).mass_damping_power =
            mass_damping_power(1, 0, level_start_[level], level_start_[level + 1]);
    }
  }

  void begin_steps(int count) {
    for (const auto& b : model_.blocks()) b->begin_step(model_.nodes());
    sums_.resize(static_cast<std::size_t>(count * levels()));
    flight_travel_.resize(static_cast<std::size_t>(count));
    for (int flight = 0; flight < count; ++flight) {
      flight_travel_[flight] = tool_travel_;
      double furthest = 0;
      for (std::size_t k = 0; k < model_.tools().size(); ++k) {
        model_.tools()[k]->begin(levels(), begin_of(flight), dt_, flight);
        furthest = maximum(furthest, moved(k, model_.tools()[k]->prescribed_travel(dt_, flight)));
      }
      tool_travel_ += furthest;
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
      move_tools(flight);
      const double fastest = collect(flight);
      for (const auto& t : model_.tools()) t->book(BookedTime::whole(dt_), flight);
      book_mass_damping(dt_);
      end_step(fastest, flight);
    }
  }

  /// Energies are those of x_n: no node moves before all forces are known.
  void step_at_once(EnergyLedger* sample) {
    begin_steps(1);
    order_.share(team_, [this](const StepOrder::Place& place) { add_internal_forces(place); });
    for (int level = 0; level < levels(); ++level) add_contact_forces(level, 0);
    move_tools(0);
    if (steps_ == 0) begin();
    EnergyLedger ledger;
    ledger.time = time_;
    if (sample || steps_ == 0) {
      for (const auto& b : model_.blocks()) b->add_energy(model_.nodes(), ledger);
      double contact = 0;
      for (const auto& t : model_.tools()) contact += t->stored_energy();
      ledger.add("contact", EnergyKind::stored, contact);
    }
    for (int level = 0; level < levels(); ++level) move(level, 0);
    const double fastest = collect(0);
    // First half of the step's work, the energies at t_n, then the second half. The first half of
    // the first step would lie before the start.
    if (steps_ > 0) book(BookedTime::until_now(dt_));
    if (sample || steps_ == 0) {
      add_totals(ledger);
      // All that is there at t = 0, with the kinetic energy in the scheme's own measure.
      if (steps_ == 0) initial_ = -ledger.residual();
      ledger.add("initial", EnergyKind::supplied, initial_);
    }
    if (sample) *sample = ledger;
    book(BookedTime::from_now(dt_));
    end_step(fastest, 0);
    if (sample && !is_finite(sample->residual()))
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

  void end_step(double fastest, int flight) {
    for (const auto& t : model_.tools()) t->end(flight);
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

  /// t_n of a step in flight.
  [[nodiscard]] double begin_of(int flight) const {
    return static_cast<double>(steps_ + flight) * dt_;
  }
  void move_tools(int flight) {
    const double time = static_cast<double>(steps_) * dt_;
    double furthest = 0;
    for (std::size_t k = 0; k < model_.tools().size(); ++k)
      furthest = maximum(furthest, moved(k, model_.tools()[k]->move(time, dt_, flight)));
    tool_travel_ = maximum(tool_travel_, flight_travel_[flight] + furthest);
  }
  /// @throws RunError for a tool that moves a distance of NaN or infinity
  double moved(std::size_t tool, double distance) const {
    if (!is_finite(distance))
      throw RunError(when() + "tool " + std::to_string(tool) +
                     " is at z = " + detail::to_text(model_.tools()[tool]->position()) +
                     " mm: its motion z(t) or force F(t) is not a finite number");
    return distance;
  }

  void begin_unbroken() {
    if (unfinished_)
      throw RunError(when() + "the step before was left by an exception: this run cannot go on");
    unfinished_ = true;
  }

  [[nodiscard]] std::string when() const {
    return "time " + detail::to_text(time_) + " ms, step " + std::to_string(steps_) + ": ";
  }

  /// The first node that moves at no number, or else the fastest one.
  [[nodiscard]] int fastest_node() const {
    int fastest = 0;
    double most = -1;
    for (int n = 0; n < model_.nodes().node_count; ++n) {
      const Vec3<R> v = model_.nodes().v.get(n);
      const double speed_squared = static_cast<double>(dot(v, v));
      if (!is_finite(speed_squared)) return n;
      if (speed_squared > most) fastest = n;
      most = maximum(most, speed_squared);
    }
    return fastest;
  }

  /// v_{-1/2} = v_0 - dt/2 a_0 keeps the first step of second order.
  void begin() {
    const T half(static_cast<R>(-dt_ / 2)), alpha(static_cast<R>(model_.mass_damping()));
    for (int n = 0; n < model_.nodes().node_count; n += lanes) {
      const Vec3<T> v = constrained(n, load<T>(model_.nodes().v, n));
      store(model_.nodes().v, n, constrained(n, v + half * (acceleration(n) - alpha * v)));
    }
  }

  CROSSBEAM_INLINE Vec3<T> acceleration(int n) const {
    return T::load(model_.nodes().inverse_mass.data() + n) * load<T>(model_.nodes().f, n);
  }
  CROSSBEAM_INLINE Vec3<T> constrained(int n, const Vec3<T>& v) const {
    const Vec3<T> free = load<T>(model_.nodes().free, n);
    return {v.x * free.x, v.y * free.y, v.z * free.z};
  }

  /// v_{n+1/2} and x_{n+1} of a level, tag [D-1].
  void move(int level, int flight) {
    const double a = model_.mass_damping() * dt_ / 2;
    const T keep(static_cast<R>((1 - a) / (1 + a))), push(static_cast<R>(dt_ / (1 + a)));
    const T half(R(0.5)), three_halves(R(1.5));
    const Wide dt(dt_);
    T fastest(R(0)), sum(R(0));
    NodalState<R>& state = model_.nodes();
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
        is_finite(total) ? std::sqrt(static_cast<double>(lane_maximum(fastest))) : total;
    sums(level, flight) = {speed, 0};
    level_travel_[level] += speed * dt_;
  }

  /// Books the work of the step's forces over a part of it, tag [D-4].
  void book(const BookedTime& time) {
    for (const auto& t : model_.tools()) {
      t->book_nodes(model_.nodes(), time, {0, model_.nodes().node_count, 0});
      t->book(time);
    }
    if (model_.mass_damping() > 0)
      mass_damping_power_ += mass_damping_power(time.a, time.b, 0, model_.nodes().node_count);
    book_mass_damping(time.duration);
  }
  [[nodiscard]] double mass_damping_power(double a, double b, int first, int last) const {
    const T ta(static_cast<R>(a)), tb(static_cast<R>(b));
    T sum(R(0));
    for (int n = first; n < last; n += lanes) {
      const Vec3<T> half = load<T>(model_.nodes().v, n), centre = centre_velocity(n);
      sum = sum + T::load(model_.nodes().mass.data() + n) * dot(centre, ta * centre + tb * half);
    }
    return static_cast<double>(lane_sum(sum));
  }
  void book_mass_damping(double weight) {
    mass_damping_work_ += model_.mass_damping() * mass_damping_power_ * weight;
    mass_damping_power_ = 0;
  }

  /// v_n, once the nodes have moved: v_predicted is then the one for t_{n+1}.
  CROSSBEAM_INLINE Vec3<T> centre_velocity(int n) const {
    return T(R(2)) * load<T>(model_.nodes().v, n) - load<T>(model_.nodes().v_predicted, n);
  }

  /// Kinetic energy at t_n as m v_{n-1/2} v_{n+1/2} / 2, and the works.
  void add_totals(EnergyLedger& ledger) const {
    double kinetic = 0, friction = 0, contact_damping = 0, tools = 0;
    const T two(R(2));
    for (int n = 0; n < model_.nodes().node_count; n += lanes) {
      const Vec3<T> v = load<T>(model_.nodes().v, n);
      const Vec3<T> before = two * centre_velocity(n) - v;
      kinetic += 0.5 * static_cast<double>(
                           lane_sum(T::load(model_.nodes().mass.data() + n) * dot(before, v)));
    }
    for (const auto& t : model_.tools()) {
      kinetic += t->kinetic_energy();
      friction += t->work().friction;
      contact_damping += t->work().damping;
      tools += t->work().tool;
    }
    ledger.add("kinetic", EnergyKind::stored, kinetic);
    ledger.add("friction", EnergyKind::dissipated, friction);
    ledger.add("contact_damping", EnergyKind::dissipated, contact_damping);
    ledger.add("mass_damping", EnergyKind::dissipated, mass_damping_work_);
    ledger.add("tools", EnergyKind::supplied, tools);
  }

  Model<R> model_;
  std::vector<int> level_start_;
  std::vector<char> is_constrained_;  // packs with a node that is held
  std::vector<double> level_travel_;  // bound of how far any node has moved since the start [mm]
  StepOrder order_;
  std::vector<LevelSums> sums_;        // of flight 0, level after level; of flight 1, ...
  std::vector<double> flight_travel_;  // of all tools before the step
  ThreadTeam team_;
  double dt_, time_ = 0, tool_travel_ = 0, speed_limit_ = 1e6;
  double mass_damping_work_ = 0, mass_damping_power_ = 0, initial_ = 0;
  long long steps_ = 0;
  bool unfinished_ = false;  // a step that an exception has left
};

template <class R>
CentralDifference(Model<R>, const TimeStep&) -> CentralDifference<NativePack<R>>;

}  // namespace crossbeam
