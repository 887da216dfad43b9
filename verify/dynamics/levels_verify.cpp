// The step in levels, bands and threads, and with cells that are followed.

#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include "crossbeam/mesh/numbering.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace scenes;
using verify::claim;

using Lanes = NativePack<double>;
using Followed = WovenMembrane<CrossedBeamCell<double>, ConstantShear<double>, CellPrice::followed>;

/// The same scheme without levels: every force of the step, then every node.
class AtOnce final : public ForceBlock<double> {
 public:
  explicit AtOnce(std::unique_ptr<ForceBlock<double>> block) : block_(std::move(block)) {}
  void add_forces(NodalState<double>& state, double dt) override { block_->add_forces(state, dt); }
  void add_energy(const NodalState<double>& s, EnergyLedger& e) const override {
    block_->add_energy(s, e);
  }
  [[nodiscard]] double omega_squared() const override { return block_->omega_squared(); }
  [[nodiscard]] double damping_rate() const override { return block_->damping_rate(); }

 private:
  std::unique_ptr<ForceBlock<double>> block_;
};

/// A slender taut sheet pushed by a sphere: many levels, several bands, contact in some of them.
struct Strip {
  double length;
  Mesh<4> mesh;
  explicit Strip(bool shuffled = false, int rows = 560)
      : length(5.0 * rows), mesh(rectangle(length, 60, rows, 12, 0.0)) {
    if (shuffled) {
      verify::Random random(7);
      std::vector<std::array<int, 4>> elements = mesh.elements;
      auto fibres = mesh.fibres;
      for (std::size_t e = elements.size(); e > 1; --e) {
        const auto other = static_cast<std::size_t>(random.uniform(0, double(e)));
        std::swap(elements[e - 1], elements[other]);
        std::swap(fibres[e - 1], fibres[other]);
      }
      mesh.elements = elements;
      mesh.fibres = fibres;
    }
  }

  template <class Law>
  [[nodiscard]] Model<double> model(const Law& law, double viscosity = 0.06, bool tools = true,
                                    double speed = 1, bool at_once = false) const {
    std::vector<NodeConstraint> held;
    for (int n = 0; n < mesh.node_count; ++n) {
      const auto X = mesh.nodes.get(n);
      if (X.x == 0 || X.x == length || X.y == 0 || X.y == 60) held.push_back({n, true, true, true});
    }
    NodalState<double> state(mesh, areal_mass, held);
    for (int n = 0; n < mesh.node_count; ++n) {
      const auto X = mesh.nodes.get(n);
      state.x.set(n, {1.005 * X.x, 1.005 * X.y, 0});
      state.v.set(
          n, {0, 0, speed * state.free.z[n] * std::sin(pi * X.x / 140) * std::sin(pi * X.y / 60)});
    }
    Model<double> out(std::move(state), 0.02);
    const auto add = [&](std::unique_ptr<ForceBlock<double>> block) {
      out.add(at_once ? std::make_unique<AtOnce>(std::move(block)) : std::move(block));
    };
    add(std::make_unique<MembraneSweep<Lanes, Quadrilateral<1>, Law>>(
        mesh, law, areal_mass, MembraneOptions{1e-4, viscosity}));
    add(std::make_unique<BendingSweep<Lanes>>(mesh, BendingStiffness{1.4e-3, 1.4e-3}, areal_mass));
    if (!tools) return out;
    for (const double x : {length / 4, length * 3 / 4})
      out.add(tool<Lanes>(Sphere<double>({x, 30, -60}, 60),
                          ToolMotion::prescribed([](double t) { return 2 * t; }),
                          ContactParameters{}, mesh.node_count));
    return out;
  }
};

struct End {
  Points x;
  double viscous = 0, tool_work = 0, friction = 0, kinetic = 0;
  PackVisits visits{};
};

template <class Run>
End with_works(const Run& run, End out) {
  if (run.tools().empty()) return out;
  out.tool_work = run.tools()[0]->work().tool;
  out.friction = run.tools()[1]->work().friction;
  for (const auto& tool : run.tools()) out.visits += tool->visits();
  return out;
}

End finish(Model<double> model, int steps, int threads, double factor = 0.9) {
  CentralDifference<Lanes> run(std::move(model), TimeStep::fraction(factor));
  run.set_threads(threads);
  EnergyLedger ledger;
  for (int k = 0; k < steps; ++k) run.step(k % 50 == 49 ? &ledger : nullptr);
  run.step(&ledger);
  return with_works(
      run, {positions(run), ledger.value("bulk_viscosity"), 0, 0, ledger.value("kinetic")});
}

/// The same as `finish`, by `advance` from one sample to the next.
End finish_in_flight(Model<double> model, int steps) {
  CentralDifference<Lanes> run(std::move(model), TimeStep::fraction(0.9));
  EnergyLedger ledger;
  for (int k = 0; k < steps; k += 50) {
    run.advance(std::min(49, steps - k));
    if (k + 50 <= steps) run.step(&ledger);
  }
  run.step(&ledger);
  return with_works(
      run, {positions(run), ledger.value("bulk_viscosity"), 0, 0, ledger.value("kinetic")});
}

int different(const End& a, const End& b) {
  int count = 0;
  for (std::size_t n = 0; n < a.x.size(); ++n)
    count += std::memcmp(a.x[n].data(), b.x[n].data(), 3 * sizeof(double)) != 0;
  return count + (a.viscous != b.viscous) + (a.tool_work != b.tool_work) +
         (a.friction != b.friction) + (a.kinetic != b.kinetic) + !(a.visits == b.visits);
}

}  // namespace

TEST_SUITE_BEGIN("dynamics");

TEST_CASE("V-DYN-10 levels, bands and any number of threads give the same step") {
  const Strip strip;
  const auto law = fabric(pi / 2, 0.01);
  // Premise: there are bands to share, and more threads than one get some.
  {
    Model<double> model = strip.model(law);
    REQUIRE(model.blocks()[0]->bandwidth() < 64);
    const CentralDifference<Lanes> run(std::move(model), TimeStep::fraction(0.9));
    REQUIRE(run.bands() >= 2);
  }
  const End one = finish(strip.model(law), 400, 1);
  REQUIRE(one.tool_work > 0);
  REQUIRE(one.friction > 0);
  REQUIRE(one.viscous > 0);
  REQUIRE(different(one, finish(strip.model(law, 0.0600001), 400, 1)) > 0);  // can fail
  for (const int threads : {2, 3, 4})
    claim(
        "V-DYN-10", different(one, finish(strip.model(law), 400, threads)), 0,
        "nodes, works and visits that differ in any bit, " + std::to_string(threads) + " threads");
  // Two tools asked every pack of nodes in each of 401 steps.
  REQUIRE(one.visits.culled > 0);
  REQUIRE(one.visits.general > 0);
  const auto packs = static_cast<long long>((one.x.size() + lanes_v<Lanes> - 1) / lanes_v<Lanes>);
  claim("V-DYN-10", static_cast<double>(std::abs(one.visits.all() - 401 * 2 * packs)), 0,
        "visits of tools that are not counted");

  // Against the whole step at once: the order of a node's sums differs where bands meet.
  const End at_once = finish(strip.model(law, 0.06, true, 1, true), 400, 1);
  claim("V-DYN-10", distance(one.x, at_once.x), 1e-10,
        "positions against a step without levels [mm]: 400 steps of roundings of 1e-13");
  claim("V-DYN-10", std::abs(one.friction / at_once.friction - 1), 1e-8,
        "work of friction, relative");

  // Elements in any order: one level, gathered, the same motion.
  const Strip shuffled(true);
  const End mixed = finish(shuffled.model(law), 400, 2);
  claim("V-DYN-10", distance(one.x, mixed.x), 1e-10, "positions with shuffled elements [mm]");

  CHECK_THROWS_AS(ThreadTeam(0), InputError);
  CHECK_THROWS_AS(ThreadTeam(257), InputError);
}

TEST_CASE("V-DYN-13 steps in flight together are the same steps") {
  const Strip strip(false, 1400);
  const auto law = fabric(pi / 2, 0.01);
  const Followed followed(law.cell(), law.shear());
  // Premises: several are in flight, over seams, and something happens in them.
  {
    CentralDifference<Lanes> run(strip.model(law), TimeStep::fraction(0.9));
    REQUIRE(run.in_flight() > 1);
    REQUIRE(run.bands() > 2);
    run.set_threads(2);
    REQUIRE(run.in_flight() == 1);
  }
  const auto compare = [&](const auto& any_law, const char* what) {
    const End one = finish(strip.model(any_law), 203, 1);
    REQUIRE(one.tool_work > 0);
    REQUIRE(one.friction > 0);
    REQUIRE(one.viscous > 0);
    REQUIRE(one.visits.culled > 0);
    REQUIRE(different(one, finish_in_flight(strip.model(any_law, 0.0600001), 203)) >
            0);  // can fail
    claim("V-DYN-13", different(one, finish_in_flight(strip.model(any_law), 203)), 0,
          std::string("nodes, works and visits that differ in any bit, ") + what);
  };
  compare(law, "cells in equilibrium");
  compare(followed, "cells followed");

  // A free tool needs a step's forces before it moves: one at a time.
  Model<double> model = strip.model(law);
  model.add(tool<Lanes>(Sphere<double>({strip.length / 2, 30, -60}, 60),
                        ToolMotion::free_under([](double) { return 1e-3; }, 0.1, 0.1),
                        ContactParameters{}, strip.mesh.node_count));
  const CentralDifference<Lanes> pressed(std::move(model), TimeStep::fraction(0.9));
  CHECK(pressed.in_flight() == 1);

  // An unstable run is found at the step that it would be found at one by one.
  const auto stopped_at = [&](auto&& go) {
    Model<double> too_fast = strip.model(law);
    const double dt = 3 * too_fast.critical_step();
    CentralDifference<Lanes> run(std::move(too_fast), TimeStep::fixed(dt));
    run.set_speed_limit(50);
    run.step();
    try {
      go(run);
    } catch (const RunError&) {
      return run.steps();
    }
    return 0LL;
  };
  const long long one_by_one = stopped_at([](auto& run) {
    while (run.steps() < 1000) run.step();
  });
  REQUIRE(one_by_one > 5);
  CHECK(stopped_at([](auto& run) { run.advance(1000); }) == one_by_one);
}

TEST_CASE("V-DYN-11 a run with followed cells is one with cells in equilibrium, to second order") {
  const Strip strip;
  const auto law = fabric(pi / 2, 0.01);
  const Followed followed(law.cell(), law.shear());
  // The same step for both: what differs is the cell alone. No tools: first contact is a kink.
  const auto gap = [&](double factor) {
    const int steps = static_cast<int>(std::lround(60 / factor));
    return distance(finish(strip.model(law, 0.06, false, 40), steps, 2, factor).x,
                    finish(strip.model(followed, 0.06, false, 40), steps, 2, factor).x);
  };
  const double coarse = gap(0.8), fine = gap(0.2);
  REQUIRE(coarse > 1e-11);  // above rounding
  claim("V-DYN-11", std::log2(coarse / fine) / 2, 1.8, "order of the gap over two halvings",
        verify::Bound::lower);
  claim("V-DYN-11", coarse, 1e-5,
        "gap at 0.8 of the critical step [mm], of a motion of millimetres");

  // Methods that evaluate a state more than once have no last step to follow from.
  const Model<double> model = strip.model(followed);
  CHECK_THROWS_WITH_AS(model.require_no_memory(), doctest::Contains("followed from step to step"),
                       InputError);
}

TEST_SUITE_END();
