// The consistent tangent of a whole model, by the rate of Taylor remainders.

#include "sundials/scenes.hpp"
#include "support/plots.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

namespace {

using namespace reference_scenes;
using verify::claim;
using Vector = Eigen::VectorXd;

/// A taut, deformed and moving sheet that a ball and a free plate press on: no node of it is at the
/// border of a contact or of slackness, so that its rate is smooth around it.
template <class Kind>
struct PressedSheet {
  static constexpr int corners = Kind::Element::corners;
  static constexpr int n = 4;
  static constexpr double edge = 5;
  Mesh<corners> sheet;
  Model<double> model;

  PressedSheet(double warp_angle, verify::Random& random, bool planes)
      : sheet(mesh<corners>(grid(n, n, edge, 0.15, random), cells<corners>(n, n), warp_angle,
                            pi / 2)),
        model(NodalState<double>(sheet, areal_mass), 0.3) {
    const auto law = fabric(pi / 2, 0.01);
    model.add(std::make_unique<MembraneSweepWithTangent<T, typename Kind::Element, decltype(law)>>(
        sheet, law, areal_mass, MembraneOptions{1e-2, 0.06}));
    model.add(std::make_unique<BendingSweep<T>>(sheet, BendingStiffness{2e-3, 1e-3}, areal_mass,
                                                SymmetryPlanes{planes, planes}));
    ContactParameters contact;
    contact.friction_model = Friction::smooth;
    contact.slip_speed = 0.3;
    contact.smoothing = 0.5;
    // A large ball below the whole sheet, and a plate above its middle nodes.
    model.add(tool<T>(
        Sphere<double>({10, 10, -99.3}, 100),
        ToolMotion::prescribed([](double t) { return 0.05 + 0.4 * t; }, [](double) { return 0.4; }),
        contact, sheet.node_count));
    model.add(tool<T>(Plane<double>({10, 10, 0.2}, {0.02, 0.01, -1}),
                      ToolMotion::free_under([](double) { return -0.02; }, 1e-4, 0.5, 0.05),
                      contact, sheet.node_count));
    for (int k = 0; k < sheet.node_count; ++k) {
      const Vec3<double> X = sheet.nodes.get(k);
      const bool inside = X.x > 3 && X.x < 17 && X.y > 3 && X.y < 17;
      const Eigen::Vector3d d = random.vector(0.05);
      const double lift = inside ? 0.75 : -0.55;
      model.nodes().x.set(k, {1.015 * X.x + d.x(), 1.012 * X.y + d.y(), lift + d.z()});
      model.nodes().v.set(k, vec3(random.vector(0.5)));
    }
  }
};

}  // namespace

TEST_SUITE_BEGIN("reference");

TEST_CASE(
    "V-REF-01 the sparse tangent is the derivative of the rate: all blocks, contact, damping") {
  VERIFY_RANDOM(random, 901);
  verify::Plot plot{"V-REF-01",
                    "Remainders of the rate of a whole model",
                    "step",
                    "remainder",
                    true,
                    true,
                    {},
                    "Membrane, hourglass, viscosity, bending, two tools with damping and friction, "
                    "one of them free, and mass damping: slope 2 says that the sparse matrix is "
                    "the derivative."};
  double deviation = 0, slip = 0;
  for_each_kind([&](auto kind) {
    using Kind = decltype(kind);
    for (double angle : {0.0, 0.4})
      for (bool planes : {false, true}) {
        CAPTURE(std::string(Kind::name));
        PressedSheet<Kind> pressed(angle, random, planes);
        FirstOrderSystem system(pressed.model);
        const int n = system.size();
        REQUIRE(n == 6 * pressed.sheet.node_count + 2);
        Vector y(n), rate(n), moved(n), direction(n);
        system.read(y.data());
        system.rate(0.1, y.data(), rate.data());
        std::vector<double> below(pressed.sheet.node_count, 0.0), above = below;
        pressed.model.tools()[0]->add_pressure(pressed.model.nodes(), below);
        pressed.model.tools()[1]->add_pressure(pressed.model.nodes(), above);
        int held = 0, pressing = 0;
        for (double p : below) held += p > 0;
        for (double p : above) pressing += p > 0;
        REQUIRE(held > 4);
        REQUIRE(pressing > 4);
        FirstOrderSystem::Matrix J;
        system.jacobian(0.1, y.data(), J);
        for (int i = 0; i < n; ++i) direction[i] = random.uniform(-1, 1);
        // Accelerations, per 1/mass: stiffness 7 kN/mm over 2e-5 kg.
        const double scale = (J * direction).norm();
        const auto result = verify::taylor_test(
            2,
            [&](double h) {
              const Vector at = y + h * direction;
              system.rate(0.1, at.data(), moved.data());
              return (moved - rate - h * (J * direction)).norm() / scale;
            },
            1e-3, 1e-13);
        INFO(result.table);
        deviation = std::max(deviation, result.deviation);
        if (angle > 0 && !planes) plot.curves.push_back(verify::remainders(Kind::name, result));
        // The premises of a full test: both matrices count.
        slip = std::max(slip, (J.block(n / 2, n / 2, n / 2, n / 2) * direction.tail(n / 2)).norm());
      }
  });
  plot.curves.push_back(verify::guide("slope 2", 2, plot.curves[0]));
  verify::show(plot);
  REQUIRE(slip > 0);
  // Third-order terms within a decade of steps that starts a few steps above round-off.
  claim("V-REF-01", deviation, 0.02, "distance of the slope from 2, worst of twelve models");
}

TEST_CASE(
    "V-REF-02 a model in rate form has the forces of the explicit scheme, skipped contacts or "
    "not") {
  const SphereSheet sheet;
  Model<double> model = sheet.model<double>();
  FirstOrderSystem system(model);
  Model<double> plain = sheet.model<double>();
  const int n = system.size(), half = n / 2;
  Vector y(n), rate(n), back(n);
  CentralDifference<T> run(sheet.model<double>(), TimeStep::fraction(0.5));
  long different = 0, changed = 0, touching = 0;
  // Forth and back along a run: the culling has to keep up with both.
  std::vector<Vector> states;
  for (int k = 0; k < 30; ++k) {
    while (run.time() < sheet.duration * (k + 1) / 30) run.step();
    run.state().v_predicted = run.state().v;
    FirstOrderSystem(run.model()).read(y.data());
    states.push_back(y);
  }
  for (int pass = 0; pass < 2; ++pass)
    for (int k = 0; k < 30; ++k) {
      const std::size_t at = static_cast<std::size_t>(pass == 0 ? k : (k % 2 == 0 ? k : 29 - k));
      const double t = sheet.duration * (static_cast<double>(at) + 1) / 30;
      system.rate(t, states[at].data(), rate.data());
      system.read(back.data());
      changed += (back - states[at]).cwiseAbs().maxCoeff() > 0;
      // The same forces by hand, without skipping.
      plain.nodes().x = model.nodes().x;
      plain.nodes().v = plain.nodes().v_predicted = model.nodes().v;
      plain.tools()[0]->place(sheet.travel(t), sheet.speed(t));
      plain.tools()[0]->reset_culling();
      plain.compute_forces(1, 0);
      touching += plain.tools()[0]->force_on_fabric().z > 0;
      for (int i = 0; i < half; ++i) {
        const auto& s = plain.nodes();
        const double* f[] = {s.f.x.data(), s.f.y.data(), s.f.z.data()};
        const double* free[] = {s.free.x.data(), s.free.y.data(), s.free.z.data()};
        const double expected = free[i % 3][i / 3] * (s.inverse_mass[i / 3] * f[i % 3][i / 3] -
                                                      sheet.mass_damping * states[at][half + i]);
        different += rate[half + i] != expected || rate[i] != states[at][half + i];
      }
    }
  REQUIRE(touching > 30);
  claim("V-REF-02", static_cast<double>(different), 0, "components of the rate with other bits");
  claim("V-REF-02", static_cast<double>(changed), 0, "states that reading back changes");

  // What has no rate form is refused by name.
  SphereSheet sticky = sheet;
  sticky.friction_model = Friction::elastic_stick;
  Model<double> refused = sticky.model<double>();
  try {
    FirstOrderSystem none(refused);
    FAIL_CHECK("an elastic stick was accepted");
  } catch (const InputError& error) {
    CHECK(error.field() == "tools[0].friction_model");
  }
  // A sweep that was compiled without a tangent says so.
  Model<double> bare(NodalState<double>(sheet.mesh(), areal_mass), areal_mass);
  const auto law = fabric(pi / 2, 0.01);
  bare.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law)>>(
      sheet.mesh(), law, areal_mass, MembraneOptions{}));
  FirstOrderSystem without(bare);
  Vector at_rest(without.size());
  without.read(at_rest.data());
  FirstOrderSystem::Matrix none;
  try {
    without.jacobian(0, at_rest.data(), none);
    FAIL_CHECK("a sweep without a tangent gave one");
  } catch (const InputError& error) {
    CHECK(error.field() == "force block");
  }
  Model<double> still(NodalState<double>(sheet.mesh(), areal_mass), areal_mass);
  ContactParameters smooth;
  smooth.friction_model = Friction::smooth;
  still.add(tool<T>(Plane<double>({0, 0, -1}, {0, 0, 1}),
                    ToolMotion::prescribed([](double t) { return t; }), smooth,
                    still.nodes().node_count));
  try {
    FirstOrderSystem none(still);
    FAIL_CHECK("a tool without its velocity was accepted");
  } catch (const InputError& error) {
    CHECK(error.field() == "tools[0].velocity");
  }
}

TEST_SUITE_END();
