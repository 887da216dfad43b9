// The contact law: penalty, damping and friction against slides, bounces and a rope around a
// bollard.

#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

namespace {

using namespace scenes;
using Eigen::Vector3d;
using verify::claim;
using verify::Curve;
using verify::Plot;
using verify::show;
using verify::Worst;

constexpr double g = 1.0;  // [mm/ms^2]

/// A plate on a plane that is inclined about the y axis, pressed in as far as its weight does. x'
/// goes down the slope.
struct Incline {
  double angle, mu;
  Friction model = Friction::elastic_stick;
  double speed = 0;  ///< at the start, down the slope
  double zeta = 1;
  ContactParameters contact{};

  [[nodiscard]] Vector3d down() const { return {std::cos(angle), 0, -std::sin(angle)}; }
  [[nodiscard]] Vector3d normal() const { return {std::sin(angle), 0, std::cos(angle)}; }

  [[nodiscard]] Model<double> resting() {
    contact.friction = mu;
    contact.friction_model = model;
    contact.damping_ratio = zeta;
    const double depth = g * std::cos(angle) * areal_mass / contact.penalty;
    Points X;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        X.push_back(5 * i * down() + Vector3d(0, 5 * j, 0) - depth * normal());
    std::vector<Vec3<double>> positions;
    for (const auto& p : X) positions.push_back(vec3(p));
    const Mesh<4> m(positions, cells<4>(1, 1), {{vec3(down()), {0, 1, 0}}});
    NodalState<double> state(m, areal_mass);
    for (int n = 0; n < 4; ++n) state.v.set(n, vec3(speed * down()));
    Model<double> out(state);
    out.add(std::make_unique<Gravity<>>(Vector3d(0, 0, -g)));
    out.add(tool<Lane>(Plane<double>({0, 0, 0}, vec3(normal())), ToolMotion::fixed(), contact, 4));
    return out;
  }
  /// Speed down the slope after a time, of a node.
  template <class Run>
  [[nodiscard]] double slide(const Run& r) const {
    return eigen(r.state().v.get(0)).dot(down());
  }
};

/// A plate thrown at a plane, all nodes alike; returns its kinetic energies and what acted.
struct Bounce {
  double before = 0, after = 0, damping = 0, residual = 0, pull = 0, stored = 0;
  double speed_along = 0, speed_away = 0;
};

Bounce bounce(double zeta, double omega_dt, double start, double speed = 2, double mu = 0) {
  const auto m = rectangle(5, 5, 1, 1);
  NodalState<double> state(m, areal_mass);
  for (int n = 0; n < 4; ++n) {
    const auto X = m.nodes.get(n);
    state.x.set(n, {X.x, X.y, start});
    state.v.set(n, {mu > 0 ? 5.0 : 0.5, 0, -speed});
  }
  Model<double> model(state);
  ContactParameters contact;
  contact.damping_ratio = zeta;
  contact.friction = mu;
  model.add(tool<Lane>(Plane<double>({0, 0, 0}, {0, 0, 1}), ToolMotion::fixed(), contact, 4));
  CentralDifference<Lane> run(std::move(model),
                              TimeStep::fixed(omega_dt / std::sqrt(contact.penalty / areal_mass)));
  Bounce out;
  bool touched = false;
  for (int k = 0; k < 1000000; ++k) {
    EnergyLedger ledger;
    run.step(&ledger);
    if (k == 0) out.before = ledger.value("kinetic");
    out.stored = std::max(out.stored, ledger.value("contact"));
    out.residual = std::max(out.residual, std::abs(ledger.residual()));
    out.pull = std::max(out.pull, -run.tools()[0]->force_on_fabric().z);
    touched = touched || ledger.value("contact") > 0;
    if (touched && ledger.value("contact") == 0) {
      out.after = ledger.value("kinetic");
      out.damping = ledger.value("contact_damping");
      out.speed_along = eigen(run.state().v.get(0)).x();
      out.speed_away = eigen(run.state().v.get(0)).z();
      return out;
    }
  }
  FAIL("the plate did not come back");
  return out;
}

}  // namespace

TEST_SUITE_BEGIN("contact");
TEST_CASE(
    "V-CONT-21 a plate on an incline slips from tan(angle) = mu on; viscous friction creeps") {
  constexpr double mu = 0.3;
  Worst holds, elastic, accelerates, creeps;
  Curve line{"closed form", {}, {}, Curve::Style::line};
  Curve points{"plate, elastic stick", {}, {}, Curve::Style::points};
  for (double factor : {0.5, 0.9, 0.999, 1.001, 1.1, 2.0}) {
    Incline slope{std::atan(mu * factor), mu};
    CentralDifference<Lane> run(slope.resting(), TimeStep::fraction(0.2));
    const Vector3d start = eigen(run.state().x.get(0));
    while (run.time() < 20) run.step();
    const double v1 = slope.slide(run), t1 = run.time();
    while (run.time() < 40) run.step();
    const double a = (slope.slide(run) - v1) / (run.time() - t1);
    const double expected = g * std::cos(slope.angle) * (std::tan(slope.angle) - mu);
    if (factor < 1) holds.see(std::abs(slope.slide(run)), factor);
    if (factor == 0.5) {  // critically damped, it never reached the cone: a spring under its load
      const double slip = (eigen(run.state().x.get(0)) - start).dot(slope.down());
      const double spring = slope.contact.stick_ratio * slope.contact.penalty;
      elastic.see(std::abs(slip / (g * std::sin(slope.angle) * areal_mass / spring) - 1), factor);
    }
    if (factor > 1) accelerates.see(std::abs(a / expected - 1), factor);
    points.x.push_back(slope.angle * 180 / pi);
    points.y.push_back((eigen(run.state().x.get(0)) - start).dot(slope.down()));
  }
  for (int k = 0; k <= 62; ++k) {
    const double angle = k / 2.0 * pi / 180;
    const double a = std::max(g * (std::sin(angle) - mu * std::cos(angle)), 0.0);
    line.x.push_back(k / 2.0);
    line.y.push_back(a / 2 * 40 * 40);
  }
  show(Plot{"V-CONT-21",
            "Plate on an incline, mu = 0.3",
            "angle of the incline [deg]",
            "way down in 40 ms [mm]",
            false,
            false,
            {line, points},
            "At rest up to 16.7 deg = atan(mu), a thousandth beyond it under way."});
  // At rest, the damped oscillation on the elastic stick has died: rounding of g dt is left.
  holds.claim("V-CONT-21", 1e-12, "speed below the angle of friction [mm/ms]");
  // 1e-5 mm of coordinates of up to 5 mm: eleven digits less than their sixteen, twice.
  elastic.claim("V-CONT-21", 1e-8, "elastic slip m g sin/k_t, relative");
  // Normal force and weight balance to rounding; against the difference of a thousandth at 1.001.
  accelerates.claim("V-CONT-21", 1e-9, "acceleration g (sin - mu cos) above it, relative");

  // Pinned: the regularised law has no static friction. It creeps at the speed at which its
  // viscous force holds the weight, v = v_slip tan(angle)/mu.
  for (double factor : {0.5, 0.9}) {
    Incline slope{std::atan(mu * factor), mu, Friction::viscous};
    CentralDifference<Lane> run(slope.resting(), TimeStep::fraction(0.2));
    while (run.time() < 20) run.step();
    creeps.see(std::abs(slope.slide(run) / (slope.contact.slip_speed * factor) - 1), factor);
  }
  creeps.claim("V-CONT-21", 1e-9, "viscous friction creeps at v_slip tan(angle)/mu, relative");
}

TEST_CASE("V-CONT-22 a sliding plate is braked by mu N, and the ledger has the heat") {
  Worst speeds, heats;
  for (Friction model : {Friction::elastic_stick, Friction::viscous})
    for (double angle : {0.0, 0.1, 0.5}) {
      Incline slope{angle, 0.2, model, 10};
      CentralDifference<Lane> run(slope.resting(), TimeStep::fraction(0.2));
      const double a = g * (std::sin(angle) - 0.2 * std::cos(angle));
      EnergyLedger ledger;
      while (run.time() < 20) run.step(&ledger);
      REQUIRE(slope.slide(run) > 1);  // still sliding
      // v_{n+1/2}, half a step before the end.
      const double t = run.time() - run.time_step() / 2;
      speeds.see(std::abs(slope.slide(run) - (10 + a * t)), angle, int(model));
      const double s = 10 * ledger.time + a * ledger.time * ledger.time / 2;
      const double heat = 0.2 * 25 * areal_mass * g * std::cos(angle) * s;
      heats.see(std::abs(ledger.value("friction") / heat - 1), angle, int(model));
    }
  // At full slip from the first step on: a constant force, integrated exactly; 25000 steps with a
  // rounding of 1e-15 each, and the plate's weight balanced to 1e-12.
  speeds.claim("V-CONT-22", 1e-9, "speed after 20 ms, off the closed form [mm/ms]");
  heats.claim("V-CONT-22", 1e-9, "friction's work against mu N s, relative");

  // Braked to rest on the level, it stays there: the stick holds what the slide has left in it.
  Incline level{0, 0.2, Friction::elastic_stick, 1};
  CentralDifference<Lane> run(level.resting(), TimeStep::fraction(0.2));
  while (run.time() < 20) run.step();
  const double way = eigen(run.state().x.get(0)).x();
  claim("V-CONT-22", std::abs(way - 1 / (2 * 0.2 * g)), 1e-3,
        "way to a stop off v^2/(2 mu g) [mm]");
  claim("V-CONT-22", std::abs(level.slide(run)), 1e-12, "speed afterwards [mm/ms]");

  // Lifted off in the middle of a slide and stopped, it has forgotten the slide when it comes
  // down.
  CentralDifference<Lane> lift(level.resting(), TimeStep::fraction(0.2));
  while (lift.time() < 1) lift.step();
  REQUIRE(level.slide(lift) > 0.5);
  for (int n = 0; n < 4; ++n) {
    lift.state().x.z[n] = 0.1;
    lift.state().v.x[n] = 0;
  }
  lift.step();
  REQUIRE(lift.tools()[0]->stored_energy() == 0);
  const double lifted = eigen(lift.state().x.get(0)).x();
  for (int k = 0; k < 3000; ++k) lift.step();
  REQUIRE(lift.tools()[0]->stored_energy() > 0);
  claim("V-CONT-22", std::abs(eigen(lift.state().x.get(0)).x() - lifted), 1e-12,
        "way along the plane after a vertical landing [mm]");

  // Thrown at a plane it loses mu times the normal impulse along it, whatever damping adds to
  // that.
  const Bounce b = bounce(0.5, 0.1, 0.1, 2, 0.2);
  REQUIRE(b.speed_along > 1);
  claim("V-CONT-22", std::abs((5 - b.speed_along) / (0.2 * (2 + b.speed_away)) - 1), 1e-12,
        "oblique impact: change of speed along the plane over mu times that across, off 1");
}

TEST_CASE("V-CONT-23 capstan: tension along a strip on a cylinder grows with exp(mu theta)") {
  // A strip of n facets per 180 deg around a bar, one end held, the other pulled slowly.
  constexpr double mu = 0.25, radius = 20, width = 2, top = 0.05;
  constexpr int wrap = 48, tail = 4;  // facets on the bar and on each straight end
  const double facet = pi / wrap, edge = 2 * radius * std::tan(facet / 2);
  Points X;
  const auto add = [&](const Vector3d& p) {
    X.push_back(p);
    X.push_back(p + Vector3d(0, width, 0));
  };
  // Nodes on the bar's surface; the tails leave along the tangents of their last facets.
  for (int k = -tail; k <= wrap + tail; ++k) {
    const double phi = pi * std::min(std::max(k, 0), wrap) / wrap;
    Vector3d p(-radius * std::cos(phi), 0, radius * std::sin(phi));
    if (k < 0) p += Vector3d(0, 0, edge * k);
    if (k > wrap) p += Vector3d(0, 0, -edge * (k - wrap));
    add(p);
  }
  std::vector<std::array<int, 4>> elements;
  std::vector<FibreDirections<double>> fibres;
  std::vector<Vec3<double>> positions;
  for (const auto& p : X) positions.push_back(vec3(p));
  const int rows = static_cast<int>(X.size()) / 2;
  for (int k = 0; k + 1 < rows; ++k) {
    elements.push_back({2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
    fibres.push_back({vec3((X[2 * k + 2] - X[2 * k]).normalized()), {0, 1, 0}});
  }
  const Mesh<4> m(positions, elements, fibres);
  std::vector<NodeConstraint> fixed;
  for (int n = 0; n < m.node_count; ++n) fixed.push_back({n, n < 2, true, n < 2});
  const auto law = fabric(pi / 2, 1e-3);
  using T = NativePack<double>;
  Model<real_t<T>> model(NodalState<double>(m, areal_mass, fixed), 3);
  model.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law)>>(
      m, law, areal_mass, MembraneOptions{1e-3, 0.06}));
  constexpr double ramp = 20;  // [ms], sixty times the slowest period
  const double force = top * width / 2;
  model.add(std::make_unique<Pull>(
      std::vector<int>{m.node_count - 2, m.node_count - 1},
      [=](double t) { return Vector3d(0, 0, -force * std::min(t / ramp, 1.0)); }));
  ContactParameters contact;
  contact.friction = mu;
  contact.penalty = 0.5;
  model.add(tool<T>(Cylinder<double>({0, 0, 0}, {0, 1, 0}, radius), ToolMotion::fixed(), contact,
                    m.node_count));
  CentralDifference<T> run(std::move(model), TimeStep::fraction(0.9));
  while (run.time() < 1.25 * ramp) run.step();
  std::vector<ElementSample> samples;
  run.blocks()[0]->sample(run.state(), samples);
  const auto tension = [&](int e) { return samples[static_cast<std::size_t>(e)].tension[0]; };
  REQUIRE(std::abs(tension(rows - 2) / top - 1) < 1e-3);  // the pulled end carries what pulls
  REQUIRE(std::abs(tension(0) / tension(1) - 1) < 1e-3);  // tails are at rest and even
  REQUIRE(tension(0) > 0.01);

  const double ratio = tension(rows - 2) / tension(0);
  // Every corner of the polygon: N = (T1 + T2) sin(f/2), (T2 - T1) cos(f/2) = mu N; the two end
  // corners, where the tail is tangential to the circle, turn half as far.
  const auto corner = [&](double turn) {
    const double t = mu * std::tan(turn / 2);
    return (1 + t) / (1 - t);
  };
  const double polygon = std::pow(corner(facet), wrap - 1) * std::pow(corner(facet / 2), 2);
  INFO(ratio, " ", polygon, " ", std::exp(mu * pi));
  REQUIRE(std::abs(polygon / std::exp(mu * pi) - 1) < 1e-3);
  // The first node slips by the length at which its stick gives way, 0.5 % of what the strip
  // stretches; the polygon is 3e-4 off the circle.
  Curve line{"mu theta", {}, {}, Curve::Style::line};
  Curve points{"mesh", {}, {}, Curve::Style::points};
  for (int e = tail; e < tail + wrap; ++e) {
    const double theta = pi * (e - tail + 0.5) / wrap;  // middle of the facet
    points.x.push_back(theta * 180 / pi);
    points.y.push_back(std::log(tension(e) / tension(0)));
    line.x.push_back(theta * 180 / pi);
    line.y.push_back(mu * theta);
  }
  show(Plot{"V-CONT-23",
            "Capstan, mu = 0.25",
            "angle from the held end [deg]",
            "logarithm of tension over that of the held end [-]",
            false,
            false,
            {line, points},
            "A straight line of slope mu: every facet slips at its limit."});
  claim("V-CONT-23", std::abs(ratio / polygon - 1), 5e-3,
        "tension ratio against the polygon's closed form, relative");
  claim("V-CONT-23", std::abs(ratio / std::exp(mu * pi) - 1), 6e-3,
        "tension ratio against exp(mu theta), relative");
}

TEST_CASE("V-CONT-24 culling changes no bit of a run") {
  TautSheet sheet;
  const auto end = [&](bool culling) {
    auto model = sheet.model<NativePack<double>>(1, 0.06);
    ContactParameters contact;
    contact.culling = culling;
    // One tool rises into the sheet, presses and leaves; another falls on it.
    model.add(tool<NativePack<double>>(
        Sphere<double>({25, 15, -32}, 30),
        ToolMotion::prescribed([](double t) { return 4 * std::sin(4 * t); }), contact,
        sheet.mesh.node_count));
    model.add(
        tool<NativePack<double>>(Sphere<double>({15, 25, 12}, 10),
                                 ToolMotion::free_under([](double) { return -0.001; }, 1e-4, 1),
                                 contact, sheet.mesh.node_count));
    CentralDifference<NativePack<double>> run(std::move(model), TimeStep::fraction(0.9));
    bool touched = false, left = false;
    for (int k = 0; k < 1500; ++k) {
      run.step();
      touched = touched || run.tools()[0]->stored_energy() > 0;
      left = left || (touched && run.tools()[0]->stored_energy() == 0);
    }
    REQUIRE(touched);
    REQUIRE(left);
    REQUIRE(run.tools()[1]->work().tool > 0);
    return positions(run);
  };
  const Points with = end(true), without = end(false);
  int different = 0;
  for (std::size_t n = 0; n < with.size(); ++n)
    different += std::memcmp(with[n].data(), without[n].data(), 3 * sizeof(double)) != 0;
  claim("V-CONT-24", different, 0, "nodes that differ in any bit");
}

TEST_CASE("V-CONT-25 contact stores energy and gives it back, with order 2 in the step") {
  // The force has a kink at both ends of the contact, and the error depends on where in a step
  // they fall: the largest of 64 starts is compared.
  const auto error = [](double dt) {
    double worst = 0, stored = 0;
    for (int k = 0; k < 64; ++k) {
      const double step = 2 * dt / std::sqrt(ContactParameters{}.penalty / areal_mass);  // [mm]
      const Bounce b = bounce(0, dt, 0.05 + step * k / 64);
      worst = std::max(worst, std::abs(b.after / b.before - 1));
      stored = b.stored / b.before;
    }
    // All but the motion along the plane, 0.5^2 / (0.5^2 + 2^2), and up to the dt between
    // samples.
    REQUIRE(std::abs(stored - 16.0 / 17) < 0.2 * dt);
    return worst;
  };
  // The contact lasts pi/omega. With half a step left over its two ends are always in opposite
  // phase; otherwise their errors would cancel more at one step than at another.
  const auto step = [](int steps) { return pi / (steps + 0.5); };
  const double e1 = error(step(16)), e2 = error(step(32)), e3 = error(step(64));
  const auto order = [](double coarse, double fine, double n, double m) {
    return std::log(coarse / fine) / std::log((m + 0.5) / (n + 0.5));
  };
  // (omega dt)^2 = 2.4e-3 times what a kink leaves of it, a quarter.
  claim("V-CONT-25", e3, 1e-3, "energy lost or gained in a bounce of 64 steps, relative");
  claim("V-CONT-25", std::abs(order(e1, e2, 16, 32) - 2), 0.1, "order from 16 to 32 steps, off 2");
  claim("V-CONT-25", std::abs(order(e2, e3, 32, 64) - 2), 0.1, "order from 32 to 64 steps, off 2");
}

TEST_CASE("V-CONT-26 damping never pulls, takes energy, and the ledger has all of it") {
  Worst pulls, residuals, against;
  double last = 1;
  for (double zeta : {0.0, 0.1, 0.2, 0.5, 1.0, 2.0}) {
    const Bounce b = bounce(zeta, 0.01, 0.1);
    pulls.see(b.pull, zeta);
    residuals.see(b.residual / b.before, zeta);
    CHECK(b.damping >= 0);
    CHECK(b.after <= b.before * (1 + 1e-4));
    const double left = b.after / b.before;
    if (zeta > 0) CHECK(left < last);
    last = left;
    // Closed form while zeta < 1 and the viscous force counts as long as the total presses:
    // coefficient of restitution exp(-zeta/s atan2(2 zeta s, 2 zeta^2 - 1)), s = sqrt(1 - zeta^2)
    // (contact ends when k d + c d' = 0).
    if (zeta > 0 && zeta < 1) {
      const double s = std::sqrt(1 - zeta * zeta);
      const double e = std::exp(-zeta / s * std::atan2(2 * zeta * s, 2 * zeta * zeta - 1));
      const double expected = (0.25 + 4 * e * e) / 4.25;
      against.see(std::abs(left - expected), zeta);
    }
  }
  pulls.claim("V-CONT-26", 0, "largest force towards the tool [kN]");
  residuals.claim("V-CONT-26", 1e-3, "ledger residual over the kinetic energy");
  // dt = 0.01/omega: the jump of the damping force at touch-down is smeared over one step.
  against.claim("V-CONT-26", 0.01, "energy after a damped bounce against the closed form");
}

TEST_CASE("V-CONT-27 a tool drags a resting plate along until both move alike") {
  // A plane tilted by 45 deg rises: friction is the only force along it; with enough friction the
  // plate is lifted as if glued, without it slides down the rising plane.
  constexpr double angle = pi / 4;
  const auto rise = [&](double mu) {
    Incline slope{angle, mu};
    slope.contact.friction = mu;
    slope.contact.damping_ratio = 1;
    Model<double> model(slope.resting().nodes());
    model.add(std::make_unique<Gravity<>>(Vector3d(0, 0, -g)));
    slope.contact.culling = true;
    model.add(tool<Lane>(Plane<double>({0, 0, 0}, vec3(slope.normal())),
                         ToolMotion::prescribed([](double t) { return 0.25 * t * t; }),
                         slope.contact, 4));
    CentralDifference<Lane> run(std::move(model), TimeStep::fraction(0.2));
    EnergyLedger ledger;
    while (run.time() < 10) run.step(&ledger);
    return std::pair{eigen(run.state().v.get(0)), ledger};
  };
  const auto [glued, with] = rise(1.5);
  REQUIRE(std::tan(angle) < 1.5);
  // Velocity 0.5 t half a step before the end: dt/4 = 1e-4 mm/ms.
  claim("V-CONT-27", (glued - Vector3d(0, 0, 5)).norm(), 1e-3,
        "stuck: velocity off the tool's [mm/ms]");
  // Work of the tool: weight and inertia, m (g + a) s; the start of the motion rings for 0.02 ms.
  claim("V-CONT-27", std::abs(with.value("tools") / (25 * areal_mass * (g + 0.5) * 25) - 1), 1e-3,
        "stuck: work of the tool, relative");
  const auto [sliding, without] = rise(0);
  // Without friction: along the plane only the weight acts; again half a step.
  const Vector3d down(std::cos(angle), 0, -std::sin(angle));
  claim("V-CONT-27", std::abs(sliding.dot(down) - g * std::sin(angle) * 10), 1e-3,
        "smooth: speed along the plane off g sin t [mm/ms]");
  claim("V-CONT-27", std::abs(without.value("friction")), 0, "smooth: work of friction [kN mm]");
  claim("V-CONT-27", std::abs(without.residual() / without.value("tools")), 1e-6,
        "smooth: ledger residual, relative");

  // Riding on a plane that shakes, with much damping: second order, the tool's velocity is taken
  // at the same instant as the node's.
  const auto ride = [&](int halving) {
    Incline level{0, 0};
    level.contact.damping_ratio = 0.5;
    Model<double> model(level.resting().nodes());
    model.add(std::make_unique<Gravity<>>(Vector3d(0, 0, -g)));
    level.contact.friction = 0;
    constexpr double w = 40;  // [1/ms]; acceleration below g: it does not lift off
    model.add(tool<Lane>(Plane<double>({0, 0, 0}, {0, 0, 1}), ToolMotion::prescribed([](double t) {
                           return 0.5 * g / (w * w) * (1 - std::cos(w * t));
                         }),
                         level.contact, 4));
    CentralDifference<Lane> run(std::move(model), TimeStep::fixed(1e-3 / (1 << halving)));
    for (int k = 0; k < 200 << halving; ++k) {
      run.step();
      REQUIRE(run.tools()[0]->stored_energy() > 0);
    }
    return eigen(run.state().x.get(0)).z();
  };
  const double z0 = ride(0), z1 = ride(1), z2 = ride(2), z3 = ride(3);
  // (omega dt)^2 = 0.07 at the coarsest step.
  claim("V-CONT-27", std::abs((z0 - z1) / (z1 - z2) - 4), 0.3, "riding: ratio of errors, off 4");
  claim("V-CONT-27", std::abs((z1 - z2) / (z2 - z3) - 4), 0.15, "riding: ratio of errors, off 4");
}

TEST_CASE(
    "V-CONT-29 the smooth contact: a force with two derivatives, Coulomb's law far from rest") {
  // One plate of four nodes on a plane, pressed to a depth and moved by hand.
  constexpr double e = 0.2, kp = 0.05, mu = 0.3, v_s = 0.1;
  const Mesh<4> plate = rectangle(2, 2, 1, 1);
  NodalState<double> state(plate, areal_mass);
  ContactParameters p;
  p.penalty = kp;
  p.friction = mu;
  p.friction_model = Friction::smooth;
  p.slip_speed = v_s;
  p.smoothing = e;
  const auto answer = [&](double depth, const Vec3<double>& v) {
    RigidToolContact<Lane, Plane<double>> contact(Plane<double>({0, 0, 0}, {0, 0, 1}),
                                                  ToolMotion::fixed(), p, 4);
    for (int n = 0; n < 4; ++n) {
      state.x.z[n] = -depth;
      state.f.set(n, {0, 0, 0});
      state.v.set(n, v);
      state.v_predicted.set(n, v);
    }
    contact.add_forces(state, 1, 0);
    struct Answer {
      Vec3<double> force{};
      double energy;
    };
    return Answer{state.f.get(0), contact.stored_energy() / 4};
  };
  const double k = kp * state.area[0], none = 0;

  // Closed forms by hand: the stiffness rises as 3 u^2 - 2 u^3 and stays.
  verify::Worst force, slope, kink, friction;
  const auto stiffness = [&](double d) {
    const double u = std::min(d / e, 1.0);
    return k * u * u * (3 - 2 * u);
  };
  for (int i = 0; i <= 60; ++i) {
    const double d = 0.01 * i, h = 1e-4;
    // Simpson's rule of the stiffness is exact for the cubic, on either side of e.
    const auto integral = [&](double a, double b) {
      return (b - a) / 6 * (stiffness(a) + 4 * stiffness((a + b) / 2) + stiffness(b));
    };
    const double expected = integral(0, std::min(d, e)) + integral(std::min(d, e), d);
    force.see(std::abs(answer(d, {}).force.z - expected) / (k * e), "depth", d);
    if (i == 0) continue;
    slope.see(std::abs((answer(d + h, {}).energy - answer(d - h, {}).energy) / (2 * h) -
                       answer(d, {}).force.z) /
                  (k * e),
              "depth", d);
    const double derivative = (answer(d + h, {}).force.z - answer(d - h, {}).force.z) / (2 * h);
    CHECK(derivative <= k * (1 + 1e-9));  // never stiffer than the bound of the step
  }
  // Second differences are bounded by 1.5 k/e where a kink would give k/h.
  for (double d : {0.0, e})
    for (double h : {1e-3, 1e-4, 1e-5})
      kink.see(std::abs(answer(d + h, {}).force.z - 2 * answer(d, {}).force.z +
                        (d > h ? answer(d - h, {}).force.z : none)) /
                   (h * h) / (1.5 * k / e),
               "depth", d, "step", h);
  for (double v : {1e-3, 0.1, 0.5, 10.0}) {
    const auto a = answer(0.5, {0.6 * v, -0.8 * v, 0});
    const double size = std::hypot(a.force.x, a.force.y);
    friction.see(std::abs(size / (mu * a.force.z) - v / std::hypot(v, v_s)), "speed", v);
    friction.see(std::abs(a.force.x * 0.8 + a.force.y * 0.6) / size, "direction", v);
    CHECK(a.force.x < 0);
  }
  CHECK(std::hypot(answer(0.5, {100, 0, 0}).force.x, 0.0) / answer(0.5, {}).force.z ==
        doctest::Approx(mu).epsilon(1e-6));
  // Damping rises with the stiffness, and never pulls.
  CHECK(answer(0.01 * e, {0, 0, -1}).force.z < 1e-3 * answer(2 * e, {0, 0, -1}).force.z);
  CHECK(answer(0.5 * e, {0, 0, 100}).force.z == 0);
  force.claim("V-CONT-29", 1e-14, "force against the integral of the stiffness");  // ten roundings
  slope.claim("V-CONT-29", 1e-6, "force against differences of the energy");       // h^2 / (6 e^2)
  kink.claim("V-CONT-29", 1.01, "second differences over the largest curvature");
  friction.claim("V-CONT-29", 1e-14, "friction against v / (v^2 + v_s^2)^(1/2)");
}

TEST_CASE("V-CONT-28 bad contact input is refused by field, value and range") {
  struct Case {
    const char* field;
    void (*spoil)(ContactParameters&);
  };
  const Case cases[] = {
      {"contact.penalty", [](ContactParameters& p) { p.penalty = 0; }},
      {"contact.damping_ratio", [](ContactParameters& p) { p.damping_ratio = -0.1; }},
      {"contact.friction", [](ContactParameters& p) { p.friction = std::nan(""); }},
      {"contact.stick_ratio", [](ContactParameters& p) { p.stick_ratio = 0; }},
      {"contact.slip_speed", [](ContactParameters& p) { p.slip_speed = -1; }},
      {"contact.smoothing", [](ContactParameters& p) { p.smoothing = -0.1; }},
  };
  int accepted = 0;
  const auto refused = [&](const std::string& field, auto build) {
    ++accepted;
    try {
      build();
    } catch (const InputError& error) {
      CHECK(error.field() == field);
      CHECK(std::string(error.what()).find("is not admissible: a finite number >") !=
            std::string::npos);
      --accepted;
    }
  };
  for (const Case& c : cases)
    refused(c.field, [&] {
      ContactParameters p;
      c.spoil(p);
      tool<Lane>(Plane<double>({0, 0, 0}, {0, 0, 1}), ToolMotion::fixed(), p, 4);
    });
  refused("tool.mass", [] { ToolMotion::free_under([](double) { return 0.0; }, 0, 0); });
  refused("tool.damping_rate", [] { ToolMotion::free_under([](double) { return 0.0; }, 1, -1); });
  claim("V-CONT-28", accepted, 0, "bad inputs accepted");
}

TEST_CASE("V-CONT-37 a free tool follows its force with order 2, and its damper's heat is booked") {
  constexpr double mass = 2e-3, T = 8;
  // High above a sheet that it never meets.
  const auto fly = [](auto force, double rate) {
    const auto m = rectangle(5, 5, 1, 1);
    Model<double> model(NodalState<double>(m, areal_mass));
    model.add(tool<Lane>(Plane<double>({0, 0, 0}, {0, 0, 1}),
                         ToolMotion::free_under(force, mass, rate, -1000), {}, 4));
    return model;
  };
  // F = c t: z = c t^3 / (6 M) without a damper; with it, F/(a M) - c/(a^2 M) of the speed at last.
  constexpr double c = 1e-4;
  const auto error = [&](double rate, int steps) {
    CentralDifference<Lane> run(fly([](double t) { return c * t; }, rate),
                                TimeStep::fixed(T / steps));
    for (int k = 0; k < steps; ++k) run.step();
    const double a = rate;
    const double z = a == 0 ? c * T * T * T / (6 * mass)
                            : c / (a * mass) * (T * T / 2 - T / a - std::expm1(-a * T) / (a * a));
    return run.tools()[0]->position() + 1000 - z;
  };
  // Two more orders are lost in (dt / T)^2 = 2.4e-4; without a damper the error is c T dt^2 / 6 M.
  for (double rate : {0.0, 0.5})
    claim("V-CONT-37", std::abs(error(rate, 64) / error(rate, 128) - 4), 0.01,
          "ratio of errors of the position at half the step, off 4");
  claim("V-CONT-37", std::abs(error(0, 64) / (-c * T * (T / 64) * (T / 64) / (6 * mass)) - 1), 1e-9,
        "error of the position against the scheme's own, relative");

  // The ledger's residual keeps its first value, and the damper's heat is that of the closed form.
  constexpr double rate = 0.5, force = 0.01;
  CentralDifference<Lane> run(fly([](double) { return force; }, rate), TimeStep::fixed(T / 64));
  EnergyLedger first, now;
  run.step(&first);
  double drift = 0;
  while (run.time() < T) {
    run.step(&now);
    drift = std::max(drift, std::abs(now.residual() - first.residual()));
  }
  REQUIRE(now.value("contact_damping") > 0.1 * now.value("tools"));
  claim("V-CONT-37", drift / now.value("tools"), 1e-14,
        "change of the residual over the force's work");
  const double v = force / (rate * mass), t = now.time;  // v (1 - e^(-a t)), squared and summed
  const double heat =
      mass * rate * v * v *
      (t + 2 * std::expm1(-rate * t) / rate - std::expm1(-2 * rate * t) / (2 * rate));
  claim("V-CONT-37", std::abs(now.value("contact_damping") / heat - 1), 1e-3,
        "heat of the tool's damper, relative");  // (a dt)^2 / 12 = 3e-4
}

TEST_SUITE_END();
