// What a contact says before a run: nodes that begin inside a tool, tools that fit between nodes.

#include "crossbeam/contact/start_check.hpp"

#include "crossbeam/tools/stadium_ring.hpp"
#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

namespace {

using namespace scenes;
using verify::claim;

constexpr double h = 10;  // edge of the elements [mm]
constexpr int side = 4;   // elements a side

Mesh<4> sheet() { return rectangle(side * h, side * h, side, side); }

/// Pack: nodes in fours, so that the last pack has idle lanes.
using Four = Pack<double, 4>;

template <class T = Four, class Shape>
RigidToolContact<T, Shape> contact_of(Shape shape, ContactParameters p = {},
                                      ToolMotion motion = ToolMotion::fixed()) {
  return {std::move(shape), std::move(motion), p, (side + 1) * (side + 1)};
}
Plane<double> ground(double z = 0) { return {{0, 0, z}, {0, 0, 1}}; }

/// Text of the refusal, empty for none.
template <class Check>
std::string refusal(Check check) {
  try {
    check();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_SUITE_BEGIN("contact");
TEST_CASE("V-CONT-35 a start deep in a tool is refused with the speed that it would cause") {
  const Mesh<4> mesh = sheet();
  const NodalState<double> state(mesh, areal_mass);
  const auto text = [&](const auto& contact) {
    return refusal([&] { contact.check_start(state); });
  };
  // Laid exactly on the tool, beside it, or as deep as its own weight presses it (g = 0.01).
  CHECK(text(contact_of(ground())) == "");
  CHECK(text(contact_of(ground(-3))) == "");
  CHECK(text(contact_of(ground(0.01 * areal_mass / 0.05))) == "");
  CHECK(contact_of(ground()).start_penetration(state).nodes == 0);
  CHECK(contact_of(ground()).start_penetration(state).deepest == -1);

  const std::string deep = text(contact_of(ground(1)));
  CHECK(deep.find("tool: depth of nodes[") == 0);
  CHECK(deep.find("= 1 [mm]") != std::string::npos);
  CHECK(deep.find("25 nodes") != std::string::npos);
  ContactParameters unchecked;
  unchecked.check_start = false;
  CHECK(text(contact_of(ground(1), unchecked)) == "");

  // A prescribed tool is asked where it is at t = 0, in its own frame.
  CHECK(text(contact_of(ground(), {}, ToolMotion::prescribed([](double) { return 1.0; }))) == deep);
  CHECK(text(contact_of(ground(1), {}, ToolMotion::prescribed([](double) { return -1.0; }))) == "");
  CHECK(text(contact_of(ground(), {},
                        ToolMotion::free_under([](double) { return 0.0; }, 1e-3, 0, 1.0))) == deep);

  // A ball off the centre, below the middle of no element: one node is deepest.
  const Sphere<double> ball({11, 19, -19}, 20);
  const auto found = contact_of(ball).start_penetration(state);
  int nodes = 0, deepest = -1;
  double depth = 0;
  for (int n = 0; n < mesh.node_count; ++n) {
    const double d = -ball.gap(mesh.nodes.get(n)).gap;
    nodes += d > 0;
    if (d > depth) depth = d, deepest = n;
  }
  REQUIRE(nodes > 0);
  CHECK(found.nodes == nodes);
  CHECK(found.deepest == deepest);
  CHECK(found.depth == depth);
  const auto by_one = contact_of<Lane>(ball).start_penetration(state);
  CHECK(by_one.depth == found.depth);
  CHECK(by_one.deepest == found.deepest);

  // A depth of mere rounding under a smooth onset is a start like any other.
  ContactParameters smooth;
  smooth.smoothing = 0.05;
  for (double depth = 1e-14; depth < 1e-3; depth *= 1.37)
    CHECK(text(contact_of(ground(depth), smooth)) == "");

  // The speed that is foretold is the one that comes, of a sheet that nothing holds together.
  const auto thrown = [&](double smoothing, double z) {
    ContactParameters p;
    p.damping_ratio = 0;
    p.smoothing = smoothing;
    const double foretold = contact_of<Lane>(ground(z), p).start_penetration(state).speed;
    Model<double> model(state);
    p.check_start = false;
    model.add(tool<Lane>(ground(z), ToolMotion::fixed(), p, mesh.node_count));
    CentralDifference<Lane> run(std::move(model),
                                TimeStep::fixed(0.01 / std::sqrt(p.penalty / areal_mass)));
    for (int k = 0; k < 2000; ++k) run.step();
    REQUIRE(run.tools()[0]->stored_energy() == 0);
    return std::abs(double(run.state().v.get(0).z) / foretold - 1);
  };
  // (omega dt)^2 / 8 = 1.25e-5, and what the kink leaves of it.
  claim("V-CONT-35", thrown(0, 1), 1e-4, "speed foretold against the run's, relative");
  claim("V-CONT-35", thrown(0.4, 1), 1e-4, "the same with a smoothing depth, relative");
  // Where the limit lies: k_p z^2 = rho v^2.
  const double limit = most_start_speed * std::sqrt(areal_mass / ContactParameters{}.penalty);
  CHECK(text(contact_of(ground(0.999 * limit))) == "");
  CHECK(text(contact_of(ground(1.001 * limit))) != "");
}

TEST_CASE("V-CONT-36 a tool that fits between the nodes of an element is refused") {
  const Mesh<4> mesh = sheet();
  const NodalState<double> state(mesh, areal_mass);
  CHECK(std::abs(widest_element(mesh) / (h * std::sqrt(2.0)) - 1) < 1e-15);
  const auto text = [&](const auto& contact) {
    return refusal([&] { contact.check_start(state); });
  };
  constexpr double infinite = std::numeric_limits<double>::infinity();
  CHECK(smallest_width(ground()) == infinite);
  CHECK(smallest_width(StadiumRing<double>()) == infinite);  // its rounded edge has no far side
  CHECK(smallest_width(Sphere<double>({0, 0, 0}, 6)) == 12);
  CHECK(smallest_width(Cylinder<double>({0, 0, 0}, {0, 1, 0}, 6, 1)) == 14);

  // Raised under the middle of an element: the balls that slip through without a contact are
  // refused, the one that lifts the sheet is not.
  int silent = 0, accepted = 0;
  for (double r : {20.0, 8.0, 7.0, 6.0, 2.0}) {
    const Sphere<double> ball({1.5 * h, 1.5 * h, -r - 0.1}, r);
    const bool refused = text(contact_of(ball)).find("tool: width = ") == 0;
    Model<double> model(state);
    ContactParameters unchecked;
    unchecked.check_start = false;
    model.add(tool<Lane>(ball, ToolMotion::prescribed([](double t) { return 2 * t; }), unchecked,
                         mesh.node_count));
    CentralDifference<Lane> run(std::move(model), TimeStep::fixed(1e-3));
    bool touched = false;
    while (!touched && run.time() < r + 1) {
      run.step();
      touched = run.tools()[0]->stored_energy() > 0;
    }
    CHECK(refused == !touched);
    silent += !touched && !refused;
    accepted += !refused;
  }
  REQUIRE(accepted == 2);
  claim("V-CONT-36", silent, 0, "balls that pass without a contact and without a word");
  CHECK(text(contact_of(StadiumRing<double>())) == "");
}

TEST_SUITE_END();
