// The contact law as functions, and one tool asked directly: what its formulas say at one node,
// before any time integration.

#include "crossbeam/contact/rigid_tool_contact.hpp"
#include "crossbeam/tools/height_surface.hpp"
#include "crossbeam/tools/primitives.hpp"

#include "element/patches.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

namespace {

using namespace patches;
using verify::claim;
using verify::Worst;

template <class Shape = Plane<double>>
RigidToolContact<Lane, Shape> contact_of(const ContactParameters& p, Shape shape,
                                         ToolMotion motion = ToolMotion::fixed()) {
  return {std::move(shape), std::move(motion), p, 4};
}
Plane<double> ground() { return {{0, 0, 0}, {0, 0, 1}}; }

/// A plate of four nodes, all at the same depth and velocity.
NodalState<double> plate(double depth, const Vec3<double>& v) {
  NodalState<double> state(rectangle(2, 2, 1, 1), areal_mass);
  for (int n = 0; n < 4; ++n) {
    state.x.z[n] = -depth;
    state.v.set(n, v);
    state.v_predicted.set(n, v);
  }
  return state;
}

/// The least that the contact asks of a surface: an answer to its pack.
struct OwnGround {
  SurfaceGap<Lane> gap(const Vec3<Lane>& p) const {
    return {p.z, {Lane(0), Lane(0), Lane(1)}, p.z};
  }
};
struct OwnHeight {
  double slope;
  HeightSample<double> height(double, double) const { return {0, 0, 0}; }
  [[nodiscard]] double max_slope() const { return slope; }
};

void clear(NodalState<double>& state) {
  for (int n = 0; n < 4; ++n) state.f.set(n, {0, 0, 0});
}

double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

}  // namespace

TEST_SUITE_BEGIN("contact");
TEST_CASE("V-CONT-31 the contact law as functions: force, cone and regularisations by hand") {
  Worst normal, stick, viscous, smooth, flat;
  const double k = 0.07, c = 3e-4;
  for (double depth : {0.0, 0.01, 0.3})
    for (double closing : {-500.0, -1.0, 0.0, 2.0}) {
      const NormalForce<double> a = normal_force(depth, closing, k, c, true);
      const double pressure = std::max(k * depth + c * closing, 0.0);
      normal.see(std::abs(a.pressure - pressure), depth, closing);
      normal.see(std::abs(a.viscous - (pressure - k * depth)), depth, closing);
      normal.see(std::abs(a.energy - k * depth * depth / 2), depth, closing);
      const NormalForce<double> off = normal_force(0.0, closing, k, c, false);
      normal.see(std::abs(off.pressure) + std::abs(off.viscous) + off.energy, depth, closing);
      // Half of the smoothing depth: k e (1/8 - 1/32), c/2, k e^2 (1/64 - 1/320).
      const double e = 2 * depth;
      if (depth == 0) continue;
      const NormalForce<double> s = normal_force(depth, closing, k, c, e, true);
      const double elastic = k * e * 3 / 32;
      normal.see(std::abs(s.pressure - std::max(elastic + c / 2 * closing, 0.0)), depth, closing);
      normal.see(std::abs(s.energy - k * e * e / 80), depth, closing);
    }

  // Stick: on a slope; below the cone the damped spring, on it mu p against the slip.
  const Vec3<double> n = detail::require_direction("n", Vec3<double>{0.3, -0.5, 0.8});
  const Vec3<double> along = tangential<false>(Vec3<double>{1, 0.2, -0.4}, n);
  const double k_t = 0.04, c_t = 1e-3;
  for (double size : {0.0, 0.1, 0.5, 2.0})
    for (double rate : {0.0, 0.3}) {
      const Vec3<double> xi = size * along + 0.7 * n, v = rate * along;
      const double trial = length(k_t * size * along + c_t * v), limit = 0.02;
      const StickFriction<double> a = stick_friction<false>(xi, v, n, k_t, c_t, limit);
      CHECK(a.slips == (trial > limit));
      stick.see(std::abs(length(a.force) - std::min(trial, limit)), size, rate);
      stick.see(std::abs(dot(a.force, along) + length(a.force) * length(along)), size, rate);
      stick.see(length(a.trial - size * along), size, rate);
      stick.see(length(k_t * a.slipped + a.force), size, rate);
    }
  for (double rate : {0.01, 0.04, 0.5}) {
    const Vec3<double> v = (rate / length(along)) * along;
    const double limit = 0.02, v_s = 0.04, cap = 0.3;
    const double least = std::min(limit / std::max(rate, v_s), cap);
    viscous.see(length(viscous_friction(v, limit, v_s, cap) + least * v), rate);
    viscous.see(length(viscous_friction(v, limit, v_s, 1e-3) + 1e-3 * v), rate);
    smooth.see(std::abs(length(smooth_friction(v, limit, v_s)) -
                        limit * rate / std::sqrt(rate * rate + v_s * v_s)),
               rate);
    smooth.see(std::abs(dot(smooth_friction(v, limit, v_s), along) +
                        length(smooth_friction(v, limit, v_s)) * length(along)),
               rate);
  }
  // A flat part leaves out the component that its normal does not have.
  for (double side : {1.0, -1.0}) {
    const Vec3<double> z{0, 0, side}, v{0.3, -0.2, 0.9};
    flat.see(std::abs(along_normal<true>(v, z) - along_normal<false>(v, z)), side);
    flat.see(length(tangential<true>(v, z) - tangential<false>(v, z)), side);
    flat.see(length(stick_friction<true>(v, tangential<true>(v, z), z, k_t, c_t, 0.02).force -
                    stick_friction<false>(v, tangential<false>(v, z), z, k_t, c_t, 0.02).force),
             side);
  }
  // Ten roundings of numbers below 1.
  normal.claim("V-CONT-31", 1e-15, "pressure, damping and energy of the penalty [kN], [kN mm]");
  stick.claim("V-CONT-31", 1e-15, "stick: force, direction and elastic slip [kN], [mm]");
  viscous.claim("V-CONT-31", 1e-15, "viscous friction and its cap [kN]");
  smooth.claim("V-CONT-31", 1e-15, "smooth friction [kN]");
  flat.claim("V-CONT-31", 0, "flat part against the general answer");
}

TEST_CASE("V-CONT-32 no slip has happened before t = 0") {
  ContactParameters p;
  p.damping_ratio = 0;  // nor does a damper answer to the speed
  p.friction = 10;
  auto contact = contact_of(p, ground());
  constexpr double depth = 0.1, speed = 2, dt = 1e-3;
  auto state = plate(depth, {speed, 0, 0});
  contact.add_forces(state, dt, 0);
  claim("V-CONT-32", std::abs(state.f.x[0]), 0, "tangential force of a sheet that starts sliding");
  // From then on the stick stretches by speed dt a step.
  const double k_t = p.stick_ratio * p.penalty * state.area[0];
  Worst stretched;
  for (int step = 1; step <= 3; ++step) {
    clear(state);
    contact.add_forces(state, dt, 0);
    stretched.see(std::abs(state.f.x[0] / (-k_t * step * speed * dt) - 1), step);
  }
  stretched.claim("V-CONT-32", 1e-14, "tangential force -k_t v t afterwards, relative");
}

TEST_CASE(
    "V-CONT-33 statics: the tangent of sticking and slipping nodes; other models hold nothing") {
  ContactParameters p;
  p.friction = 0.3;
  const Sphere<double> ball({1, 1, -20}, 20);
  const auto parts = [&](Friction model, double stretch, auto ask) {
    p.friction_model = model;
    auto contact = contact_of(p, ball);
    auto state = plate(0.3, {0, 0, 0});
    contact.add_forces(state, 1e-3, 0);
    contact.come_to_rest(state);
    // Every node goes another way from where it rested.
    for (int n = 0; n < 4; ++n) {
      const Vec3<double> X = state.x.get(n);
      state.x.set(n, X + stretch * Vec3<double>{0.6 + 0.1 * n, -0.8 + 0.2 * n, 0.1});
    }
    ask(contact, state);
  };
  Worst tangents;
  // k_t = k/2: the cone is reached at 2 mu = 0.6 of the depth, 0.2 mm.
  for (double stretch : {0.02, 0.5})
    for (double smoothing : {0.0, 0.5}) {
      p.smoothing = smoothing;
      parts(Friction::elastic_stick, stretch, [&](auto& contact, NodalState<double>& state) {
        const auto forces = [&](TangentEntries* tangent) {
          clear(state);
          contact.add_rest_forces(state, -1, tangent);
          std::array<double, 12> f{};
          for (int n = 0; n < 4; ++n) {
            const Vec3<double> at = state.f.get(n);
            f[3 * n] = at.x, f[3 * n + 1] = at.y, f[3 * n + 2] = at.z;
          }
          return f;
        };
        TangentEntries tangent;
        const auto at = forces(&tangent);
        // What slips: friction is on the cone, at mu times the force along the normal.
        int slipping = 0;
        for (int n = 0; n < 4; ++n) {
          const Vec3<double> f{at[3 * n], at[3 * n + 1], at[3 * n + 2]};
          const Vec3<double> normal = ball.gap(state.x.get(n)).normal;
          const double pressure = dot(f, normal);
          slipping += std::abs(length(f - pressure * normal) / (p.friction * pressure) - 1) < 1e-12;
        }
        REQUIRE(slipping == (stretch < 0.1 ? 0 : 4));
        Eigen::Matrix<double, 12, 12> K = Eigen::Matrix<double, 12, 12>::Zero();
        for (const auto& entry : tangent.stiffness) K(entry.row, entry.column) += entry.value;
        constexpr double h = 1e-5;
        for (int j = 0; j < 12; ++j) {
          auto& x = j % 3 == 0 ? state.x.x : j % 3 == 1 ? state.x.y : state.x.z;
          const double kept = x[j / 3];
          x[j / 3] = kept + h;
          const auto up = forces(nullptr);
          x[j / 3] = kept - h;
          const auto down = forces(nullptr);
          x[j / 3] = kept;
          for (int i = 0; i < 12; ++i)
            tangents.see(std::abs(-(up[i] - down[i]) / (2 * h) - K(i, j)) / p.penalty, stretch, i,
                         j);
        }
      });
    }
  // h^2 over the squared depth, and roundings of k d / h.
  tangents.claim("V-CONT-33", 1e-7, "tangent against differences, over the penalty");

  // A surface that answers its pack alone has forces and no tangent, and says so.
  auto own = contact_of(p, OwnGround{});
  auto state = plate(0.3, {0, 0, 0});
  own.add_forces(state, 1e-3, 0);
  CHECK(state.f.z[0] > 0);
  TangentEntries none;
  CHECK_THROWS_AS(own.add_tangent(state, -1, none), InputError);
  CHECK_THROWS_AS(own.add_rest_forces(state, -1, nullptr), InputError);
  for (double slope : {-1.0, std::nan("")})
    CHECK_THROWS_AS(HeightSurface(OwnHeight{slope}, Side::above), InputError);
  CHECK(HeightSurface(OwnHeight{INFINITY}, Side::above).gap(Vec3<double>{0, 0, 2}).clearance == 0);

  double held = 0;
  p.smoothing = 0;
  for (Friction model : {Friction::viscous, Friction::smooth})
    parts(model, 0.02, [&](auto& contact, NodalState<double>& state) {
      clear(state);
      contact.add_rest_forces(state, -1, nullptr);
      for (int n = 0; n < 4; ++n) {
        const Vec3<double> normal = ball.gap(state.x.get(n)).normal, f = state.f.get(n);
        REQUIRE(dot(f, normal) > 0);
        held = std::max(held, length(tangential<false>(f, normal)));
      }
    });
  claim("V-CONT-33", held, 1e-16, "friction at rest of the models that follow the slip rate [kN]");
}

TEST_CASE("V-CONT-34 a free tool's mass shortens the step by 1 + rho A/M") {
  ContactParameters p;
  constexpr double area = 400, mass = 3e-4;
  const auto fixed = contact_of(p, ground());
  const auto free =
      contact_of(p, ground(), ToolMotion::free_under([](double) { return 0.0; }, mass, 0));
  const double sides = 1 + areal_mass * area / mass;
  claim(
      "V-CONT-34",
      std::abs(
          free.omega_squared(areal_mass, area) / fixed.omega_squared(areal_mass, area) / sides - 1),
      1e-15, "share in the squared frequency, free over fixed, relative");
  claim("V-CONT-34",
        std::abs(
            free.damping_rate(areal_mass, area) / fixed.damping_rate(areal_mass, area) / sides - 1),
        1e-15, "share in the damping rate, free over fixed, relative");
  claim("V-CONT-34", std::abs(fixed.omega_squared(areal_mass, area) / (p.penalty / areal_mass) - 1),
        1e-15, "share of a fixed tool k_p/rho, relative");
  p.stick_ratio = 3;  // stiffer along the tool than across it
  claim("V-CONT-34",
        std::abs(contact_of(p, ground()).omega_squared(areal_mass, area) /
                     (3 * p.penalty / areal_mass) -
                 1),
        1e-15, "share of a stiff stick r k_p/rho, relative");
}

TEST_SUITE_END();
