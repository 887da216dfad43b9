// The flat part of a tool: asked for its height alone, and for nothing else.

#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include "crossbeam/tools/height_surface.hpp"
#include "crossbeam/tools/height_table.hpp"
#include "crossbeam/tools/stadium_ring.hpp"
#include "double_dome.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace {

using namespace scenes;
using verify::claim;
using T = NativePack<double>;

HeightSurface<HeightTable<double>> die() {
  return {HeightTable<double>(DoubleDome<double>{}, {0, 100, 0, 200, 0.5, true, true}),
          Side::below};
}

/// Points where the tool says it is flat, and the largest difference of gap and normal there.
template <class Shape>
int compare_flat(const Shape& shape, verify::Random& random, verify::Worst& worst) {
  int flat = 0;
  for (int k = 0; k < 200000; ++k) {
    const Vec3<double> p{random.uniform(-140, 140), random.uniform(-240, 240),
                         random.uniform(-20, 20)};
    if (!shape.in_flat_part(p)) continue;
    ++flat;
    const auto a = shape.flat_gap(p), b = shape.gap(p);
    worst.see(std::max({std::abs(a.gap - b.gap), std::abs(a.clearance - b.clearance),
                        std::abs(a.normal.x - b.normal.x), std::abs(a.normal.y - b.normal.y),
                        std::abs(a.normal.z - b.normal.z)}),
              p.x, p.y, p.z);
  }
  return flat;
}

/// A sheet dragged over the rim of a tool, half of it on the flat.
template <class Shape>
Points dragged(const Shape& shape, double z, double push, bool classes) {
  const auto m = rectangle(60, 60, 12, 12);
  Mesh<4> moved = m;
  for (int n = 0; n < m.node_count; ++n) {
    const auto X = m.nodes.get(n);
    moved.nodes.set(n, {X.x + 60, X.y + 60, z});
  }
  NodalState<double> state(moved, areal_mass);
  for (int n = 0; n < m.node_count; ++n) state.v.set(n, {3, 1, 0});
  Model<real_t<T>> model(std::move(state));
  const auto law = fabric(pi / 2, 0.01);
  model.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, std::decay_t<decltype(law)>>>(
      moved, law, areal_mass, MembraneOptions{1e-4, 0.06}));
  model.add(std::make_unique<BendingSweep<T>>(moved, BendingStiffness{1.4e-3, 1.4e-3}, areal_mass));
  model.add(std::make_unique<Gravity<>>(Eigen::Vector3d(0, 0, push)));
  ContactParameters contact;
  contact.region_classes = classes;
  model.add(tool<T>(shape, ToolMotion::fixed(), contact, m.node_count));
  CentralDifference<T> run(std::move(model), TimeStep::fraction(0.9));
  for (int k = 0; k < 300; ++k) run.step();
  REQUIRE(run.tools()[0]->work().friction > 0);
  return positions(run);
}

}  // namespace

TEST_SUITE_BEGIN("contact");

TEST_CASE("V-CONT-30 the flat part of a tool answers as the tool does") {
  VERIFY_RANDOM(random, 430);
  const auto table = die();
  const StadiumRing<double> ring;
  verify::Worst on_table, on_ring;
  REQUIRE(compare_flat(table, random, on_table) > 20000);
  REQUIRE(compare_flat(ring, random, on_ring) > 20000);
  // Coefficients that agree to 8 roundings of the largest height, 60 mm, over half a cell.
  on_table.claim("V-CONT-30", 1e-12, "double dome: gap [mm], clearance [mm], normal");
  on_ring.claim("V-CONT-30", 1e-12, "blank holder: gap [mm], clearance [mm], normal");

  // A tool without a flat part has none, a plane is one altogether.
  const HeightTable<double> slope([](double x, double) { return std::cos(pi * x / 10); },
                                  {0, 10, 0, 5, 0.5, false, false});
  const HeightTable<double> plane([](double, double) { return 3.0; },
                                  {0, 10, 0, 5, 0.5, false, false});
  int wrong = 0;
  for (int k = 0; k < 1000; ++k) {
    const double x = random.uniform(0, 9.4), y = random.uniform(0, 5);
    wrong += slope.in_flat_part(x, y);
    wrong += !plane.in_flat_part(x, y) || !(std::abs(plane.flat_height() - 3.0) < 1e-14);
  }
  claim("V-CONT-30", wrong, 0, "points on a slope called flat, or on a plane called not");

  // In a run: with and without, the same motion to the rounding of 300 steps.
  claim("V-CONT-30", distance(dragged(table, 0, 50, true), dragged(table, 0, 50, false)), 1e-9,
        "sheet on the die's rim, classes on and off [mm]");
  claim("V-CONT-30", distance(dragged(ring, 0, -50, true), dragged(ring, 0, -50, false)), 1e-9,
        "sheet on the holder's rim, classes on and off [mm]");
  REQUIRE(distance(dragged(ring, 0, -50, true), dragged(ring, 0, -50.001, true)) > 1e-9);
}

TEST_SUITE_END();
