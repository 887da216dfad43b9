#pragma once
/// @file
/// A tool as a model and its time integration see it: forces on the nodes, work, bounds of the
/// step. Theory: docs/theory/contact.md.

#include "crossbeam/model/nodal_state.hpp"
#include "crossbeam/model/tangent_entries.hpp"
#include "crossbeam/model/tool_motion.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace crossbeam {

/// Work done up to now [kN mm]; each entry counts in one place of the energy ledger only.
struct ContactWork {
  double tool = 0;  ///< of a prescribed tool on the fabric, or of the force applied to a free one
  double friction = 0;  ///< taken by friction (its elastic stick included)
  double damping = 0;   ///< taken by contact and tool damping
};

/// How often packs of nodes were asked by a tool, by what was spent on them.
struct PackVisits {
  long long culled = 0;   ///< nothing: they cannot have reached the tool
  long long flat = 0;     ///< the height of its flat part
  long long general = 0;  ///< all of its surface

  [[nodiscard]] long long all() const { return culled + flat + general; }
  PackVisits& operator+=(const PackVisits& other) {
    culled += other.culled;
    flat += other.flat;
    general += other.general;
    return *this;
  }
  friend bool operator==(const PackVisits&, const PackVisits&) = default;
};

/// The part of a step whose work is booked, and the velocity a v_n + b v_{n+1/2} that goes with it,
/// tag [D-4].
struct BookedTime {
  double a, b;
  double duration;  ///< [ms]

  /// From t_{n-1/2} to t_{n+1/2}, at v_n: what a step books that nobody looks at.
  static BookedTime whole(double dt) { return {1, 0, dt}; }
  /// From t_{n-1/2} to t_n, at 2 v_n - v_{n+1/2} = v_{n-1/2}.
  static BookedTime until_now(double dt) { return {2, -1, dt / 2}; }
  /// From t_n to t_{n+1/2}, at v_{n+1/2}.
  static BookedTime from_now(double dt) { return {0, 1, dt / 2}; }
};

/// A step takes a tool through begin, add_forces, move and book, in this order, whatever the number
/// of steps in flight; another order is a std::logic_error that names both calls. Nodes may be asked
/// for in parts, by several threads; what the parts sum up is added in their order, tag [S-5].
template <class R>
class ToolContact {
 public:
  virtual ~ToolContact() = default;

  /// @throws InputError (validate)
  explicit ToolContact(ToolMotion motion) : motion_(std::move(motion)) {
    validate(motion_);
    now_.z = motion_.is_free() ? motion_.start : motion_.position(0);
  }

  /// @name A step
  /// @{
  /// Several steps may be in flight, tag [S-6]: `flight` 0, 1, ... counts them; they begin in their
  /// order, and end in it.
  struct Part {
    int first, last;  ///< nodes: multiples of the pack width, or the node count
    int number;       ///< 0 to parts - 1
    int flight = 0;
  };

  /// Begins the step from t to t + dt; a prescribed tool then stands where the step will end, and
  /// the next step in flight may begin.
  void begin(int parts, double t, double dt, int flight = 0) {
    require_turn(flight, Turn::idle, "begin");
    begin_forces(parts, flight);
    flights_[flight].turn = Turn::begun;
    if (!motion_.is_free()) advance(t, dt, flight);
  }
  /// Contact forces at t_n of a part's nodes: adds them to state.f and keeps them for the booking.
  /// @param travel upper bound of the distance any node or this tool has moved since the start
  virtual void add_forces(NodalState<R>& state, double dt, double travel, const Part& part) = 0;
  /// Sums the forces of all parts, and moves a free tool to t + dt.
  /// @return distance that the tool moves in this step [mm]; NaN where its motion is none
  double move(double t, double dt, int flight = 0) {
    require_turn(flight, Turn::begun, "move");
    sum_forces(flight);
    if (motion_.is_free()) advance(t, dt, flight);
    flights_[flight].turn = Turn::moved;
    return std::abs(flights_[flight].after.v_plus) * dt;
  }
  /// Distance that a prescribed tool moves in this step [mm], from `begin` on; 0 for a free one.
  [[nodiscard]] double prescribed_travel(double dt, int flight = 0) const {
    return motion_.is_free() ? 0.0 : std::abs(flights_[flight].after.v_plus) * dt;
  }
  /// Power of the forces on a part's nodes, once these have moved, for `book`.
  void book_nodes(const NodalState<R>& state, const BookedTime& time, const Part& part) {
    book_nodes(state, time.a, time.b, part);
  }
  /// Books the nodes' powers and the work at the tool itself.
  void book(const BookedTime& time, int flight = 0) {
    require_turn(flight, Turn::moved, "book");
    book_tool(time.a, time.b, time.duration, flight);
  }
  /// Ends the step: the next one of this flight may begin.
  void end(int flight = 0) {
    require_turn(flight, Turn::moved, "end");
    flights_[flight].turn = Turn::idle;
  }
  /// @}

  /// Contact forces where nodes and tool stand, outside of any step: adds them to state.f.
  void add_forces(NodalState<R>& state, double dt, double travel) {
    begin_forces(1, 0);
    add_forces(state, dt, travel, {0, state.node_count, 0});
    sum_forces(0);
    flights_[0].turn = Turn::idle;
  }

  [[nodiscard]] double stored_energy() const { return stored_; }
  /// Contact pressure of every node [kN/mm^2].
  virtual void add_pressure(const NodalState<R>& state, std::vector<double>& pressure) const = 0;
  /// What can be said against a simulation that begins with these nodes and the tool where it is.
  /// @throws InputError naming what is wrong and both sides of it
  virtual void check_start(const NodalState<R>& /*state*/) const {}
  /// Number of nodes that the tool was made for, where it was made for any.
  [[nodiscard]] virtual std::optional<int> node_count() const { return {}; }
  /// Bound of this contact's share in the squared frequency of fabric and tool [1/ms^2], tag [D-3].
  /// @param area of the whole fabric [mm^2]: no more than that can rest on the tool
  [[nodiscard]] virtual double omega_squared(double areal_mass, double area) const = 0;
  /// Bound of its share in the damping rate c/m [1/ms].
  [[nodiscard]] virtual double damping_rate(double areal_mass, double area) const = 0;
  /// Whether these forces are a function of positions and velocities alone: no step, no memory.
  [[nodiscard]] virtual bool is_rate_form() const = 0;
  /// Adds -df/dx and -df/dv of a contact in rate form at state.x, state.v, tag.
  /// @param tool_row row of this tool where it is free, else -1
  virtual void add_tangent(const NodalState<R>& state, int tool_row,
                           TangentEntries& tangent) const = 0;

  /// @name Statics: the forces at rest, tag
  /// @{
  /// Positions from which the elastic stick is stretched further by what comes: those of its last
  /// step.
  virtual void come_to_rest(const NodalState<R>& state) = 0;
  /// Forces at rest at state.x, with their tangent on request. @return force on the fabric along z
  virtual double add_rest_forces(NodalState<R>& state, int tool_row,
                                 TangentEntries* tangent) const = 0;
  /// @}

  /// Forgets what is known about clearances: `travel` begins anew.
  virtual void reset_culling() = 0;

  /// Puts the tool to a place and a velocity, for methods that keep their own time: the next
  /// add_forces takes both as those of its instant.
  void place(double z, double velocity) { now_ = {z, velocity, velocity}; }

  [[nodiscard]] const ToolMotion& motion() const { return motion_; }
  [[nodiscard]] double position() const { return now_.z; }
  [[nodiscard]] double velocity() const { return now_.v_plus; }
  [[nodiscard]] const ContactWork& work() const { return work_; }
  /// Kinetic energy of a free tool at t_n, as v_{n-1/2} v_{n+1/2} m/2; after `move`.
  [[nodiscard]] double kinetic_energy() const {
    return motion_.mass * now_.v_minus * now_.v_plus / 2;
  }
  /// In all evaluations of the forces up to now.
  [[nodiscard]] const PackVisits& visits() const { return visits_; }
  /// Sum of the forces on the fabric at t_n [kN].
  [[nodiscard]] const Vec3<double>& force_on_fabric() const { return force_; }

 protected:
  struct Kinematics {
    double z = 0;                    ///< position [mm]
    double v_minus = 0, v_plus = 0;  ///< velocities of the last but one half step and the last
    /// Velocity predicted for t_n, before the tool moves on, as that of the nodes, tag [D-2].
    [[nodiscard]] double predicted_velocity() const { return 1.5 * v_plus - 0.5 * v_minus; }
    /// Velocity that goes with the node velocities a v_n + b v_{n+1/2}, once the tool has moved.
    [[nodiscard]] double velocity(double a, double b) const {
      return a * (v_minus + v_plus) / 2 + b * v_plus;
    }
  };
  struct PartSums {
    Vec3<double> force{};
    double stored = 0;
    PackVisits visits;
    /// Powers of the forces booked last, and the forces along z.
    double friction_power = 0, friction_z = 0, damping_power = 0, damping_z = 0;
  };
  enum class Turn { idle, begun, moved };
  struct Flight {
    Kinematics at, after;  ///< at t_n, and at t_{n+1}
    std::vector<PartSums> parts;
    Turn turn = Turn::idle;
  };

  /// A step's forces in the making.
  virtual void begin_forces(int parts, int flight) {
    if (static_cast<int>(flights_.size()) <= flight) flights_.resize(flight + 1);
    flights_[flight].at = now_;
    flights_[flight].parts.assign(static_cast<std::size_t>(parts), {});
  }
  /// Powers with the velocities a v_n + b v_{n+1/2} of the nodes.
  virtual void book_nodes(const NodalState<R>& state, double a, double b, const Part& part) = 0;

  ToolMotion motion_;
  Kinematics now_;
  std::vector<Flight> flights_;

 private:
  void require_turn(int flight, Turn turn, const char* call) const {
    const Turn is = flight < static_cast<int>(flights_.size()) ? flights_[flight].turn : Turn::idle;
    if (is == turn) return;
    static constexpr const char* after[] = {"end", "begin", "move"};
    throw std::logic_error(std::string("ToolContact::") + call + " cannot follow " +
                           after[static_cast<int>(is)] +
                           ": a step is begin, add_forces, move, book, end");
  }

  void sum_forces(int flight) {
    force_ = {};
    stored_ = 0;
    for (const PartSums& p : flights_[flight].parts) {
      force_ = force_ + p.force;
      stored_ += p.stored;
      visits_ += p.visits;
    }
  }

  void advance(double t, double dt, int flight) {
    Kinematics& tool = now_;
    tool.v_minus = tool.v_plus;
    if (motion_.is_free()) {
      applied_ = motion_.force(t);
      const double a = motion_.damping_rate;
      // At rest at t = 0: v_{-1/2} as for the nodes.
      if (!moved_) tool.v_minus = -dt / 2 * (applied_ - force_.z) / motion_.mass;
      tool.v_plus = ((1 - a * dt / 2) * tool.v_minus + dt * (applied_ - force_.z) / motion_.mass) /
                    (1 + a * dt / 2);
      tool.z += dt * tool.v_plus;
    } else {
      const double z = motion_.position(t + dt);
      tool.v_plus = (z - tool.z) / dt;
      if (!moved_) tool.v_minus = tool.v_plus;
      tool.z = z;
    }
    moved_ = true;
    flights_[flight].after = tool;
  }

  void book_tool(double a, double b, double duration, int flight) {
    const Kinematics& tool = flights_[flight].after;
    const double v = tool.velocity(a, b);
    double friction = 0, damping = 0;
    // Against the tool: its velocity is taken off all nodes at once.
    for (const PartSums& p : flights_[flight].parts) {
      friction += p.friction_power - p.friction_z * v;
      damping += p.damping_power - p.damping_z * v;
    }
    work_.friction -= friction * duration;
    work_.damping -= damping * duration;
    if (motion_.is_free()) {
      work_.tool += applied_ * v * duration;
      work_.damping +=
          motion_.mass * motion_.damping_rate * (tool.v_minus + tool.v_plus) / 2 * v * duration;
    } else {
      work_.tool += force_.z * v * duration;
    }
  }

  ContactWork work_;
  double applied_ = 0;
  bool moved_ = false;
  Vec3<double> force_{};
  double stored_ = 0;
  PackVisits visits_;
};

}  // namespace crossbeam
