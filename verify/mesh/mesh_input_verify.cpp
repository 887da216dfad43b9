// Bad meshes are refused where they enter, with field, value and admissible range.

#include "element/patches.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace {

using namespace patches;
using verify::claim;
using verify::Worst;

/// A mesh as its constructor takes it: two quadrilaterals side by side.
struct Input {
  std::vector<Vec3<double>> X{{0, 0, 0}, {3, 0, 0}, {6, 0, 0}, {0, 3, 0}, {3, 3, 0}, {6, 3, 0}};
  std::vector<std::array<int, 4>> elements{{0, 1, 4, 3}, {1, 2, 5, 4}};
  std::vector<FibreDirections<double>> fibres{2, {{1, 0, 0}, {0, 1, 0}}};

  [[nodiscard]] Mesh<4> build() const { return {X, elements, fibres}; }
};

/// Whether the input is refused by an InputError whose field starts with `field` and whose text
/// holds the field, the value and the range.
bool refused(const std::function<void()>& build, const std::string& field, const std::string& value,
             const std::string& range) {
  try {
    build();
  } catch (const InputError& error) {
    const std::string text = error.what();
    INFO(text);
    const bool named = error.field().starts_with(field) && text.starts_with(field);
    const bool complete = text.find("= " + value) != std::string::npos &&
                          text.find("is not admissible: ") != std::string::npos &&
                          text.find(range) != std::string::npos;
    CHECK(named);
    CHECK(complete);
    return named && complete;
  }
  FAIL_CHECK("no InputError for " << field);
  return false;
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace

TEST_SUITE_BEGIN("mesh");
TEST_CASE("V-MESH-01 a bad mesh is refused, naming element or node, value and range") {
  REQUIRE_NOTHROW(Input().build());
  struct Case {
    const char* what;
    std::function<void(Input&)> spoil;
    std::string field, value, range;
  };
  const std::vector<Case> cases{
      {"no element", [](Input& m) { m.elements.clear(); }, "mesh.elements", "0", "1 or more"},
      {"one pair of directions too few", [](Input& m) { m.fibres.pop_back(); }, "mesh.fibres",
       "1 directions", "one pair per element, 2"},
      {"one pair of directions too many", [](Input& m) { m.fibres.push_back(m.fibres[0]); },
       "mesh.fibres", "3 directions", "one pair per element, 2"},
      {"node number too large", [](Input& m) { m.elements[1][2] = 6; }, "mesh.elements[1]", "6",
       "node numbers from 0 to 5"},
      {"node number negative", [](Input& m) { m.elements[0][0] = -1; }, "mesh.elements[0]", "-1",
       "node numbers from 0 to 5"},
      {"coordinate NaN", [](Input& m) { m.X[4].y = not_a_number; }, "mesh.nodes[4].y", "nan",
       "a finite number"},
      {"coordinate infinite", [](Input& m) { m.X[2].x = -infinity; }, "mesh.nodes[2].x", "-inf",
       "a finite number"},
      {"element collapsed to a line",
       [](Input& m) {
         m.X = {{0, 0, 0}, {3, 0, 0}, {6, 0, 0}, {0, 0, 0}, {3, 0, 0}, {6, 0, 0}};
       },
       "mesh.elements[0] area", "0", "> 0"},
      {"all corners one node",
       [](Input& m) {
         m.elements[1] = {2, 2, 2, 2};
       },
       "mesh.elements[1] area", "0", "> 0"},
      {"corner repeated",
       [](Input& m) {
         m.elements[1] = {1, 2, 2, 4};
       },
       "mesh.elements[1] corner", "0", "> 0"},
      {"edges that cross",
       [](Input& m) {
         m.elements[1] = {1, 2, 4, 5};
       },
       "mesh.elements[1]", "", "> 0"},
      {"corner pushed in: not convex",
       [](Input& m) {
         m.X[5] = {4, 1, 0};
       },
       "mesh.elements[1] corner 2", "-", "> 0"},
      // Clockwise corners turn the normal; warp and weft then come the wrong way round.
      {"element numbered clockwise",
       [](Input& m) {
         m.elements[0] = {0, 3, 4, 1};
       },
       "mesh.fibres[0] angle from warp to weft", "-90", "strictly between 0 and 180"},
      {"weft along warp",
       [](Input& m) {
         m.fibres[1].weft = {2, 0, 0};
       },
       "mesh.fibres[1] angle from warp to weft", "0", "strictly between 0 and 180"},
      {"weft against warp",
       [](Input& m) {
         m.fibres[1].weft = {-2, 0, 0};
       },
       "mesh.fibres[1] angle from warp to weft", "180", "strictly between 0 and 180"},
      {"warp of length zero",
       [](Input& m) {
         m.fibres[0].warp = {0, 0, 0};
       },
       "mesh.fibres[0].warp length", "0", "> 0"},
      {"weft NaN",
       [](Input& m) {
         m.fibres[0].weft = {0, not_a_number, 0};
       },
       "mesh.fibres[0].weft length", "nan", "finite"},
      {"warp 10 deg out of the plane",
       [](Input& m) {
         m.fibres[0].warp = {std::cos(pi / 18), 0, std::sin(pi / 18)};
       },
       "mesh.fibres[0].warp angle to the element's plane", "10", "0 to 5"},
  };
  int accepted = 0;
  for (const Case& c : cases) {
    CAPTURE(std::string(c.what));
    Input input;
    c.spoil(input);
    accepted += !refused([&] { static_cast<void>(input.build()); }, c.field, c.value, c.range);
  }
  // Further on: what only the state, the sweep or the bending can see.
  const Mesh<4> good = Input().build();
  Input loose;
  loose.X.push_back({9, 9, 0});
  const auto builds = [&](auto build, const char* field, const char* value, const char* range) {
    CAPTURE(std::string(field));
    accepted += !refused(build, field, value, range);
  };
  builds([&] { NodalState<double>(loose.build(), areal_mass); }, "mesh.nodes[6]", "no element",
         "every node belongs to an element");
  builds(
      [&] {
        NodalState<double>(good, areal_mass, {{6, true, true, true}});
      },
      "constraint.node", "6", "0 to 5");
  builds([&] { NodalState<double>(good, 0.0); }, "areal_mass", "0", "> 0");
  const auto sweep = [&](double angle, double mass, MembraneOptions options) {
    return [=, &good] {
      MembraneSweep<Lane, Quadrilateral<1>, decltype(fabric(1.0))>(good, fabric(angle), mass,
                                                                   options);
    };
  };
  builds(sweep(1.2, areal_mass, {}), "mesh.fibres[0] angle from warp to weft", "90",
         "the law's 68.7");
  builds(sweep(pi / 2, -1, {}), "areal_mass", "-1", "> 0");
  builds(sweep(pi / 2, areal_mass, {-0.1, 0}), "hourglass_modulus", "-0.1", ">= 0");
  builds(sweep(pi / 2, areal_mass, {0, not_a_number}), "bulk_viscosity", "nan", ">= 0");
  const auto bending = [&](double warp, double weft) {
    return [=, &good] { BendingSweep<Lane>(good, {warp, weft}, areal_mass); };
  };
  builds(bending(-1e-3, 0), "bending.warp", "-0.001", ">= 0");
  builds(bending(0, infinity), "bending.weft", "inf", ">= 0");
  builds([] { rectangle(10, 10, 0, 3); }, "rectangle.elements", "0 x 3", "1 x 1 or more");
  builds([] { rectangle(-1, 10, 2, 3); }, "rectangle.width", "-1", "> 0");
  claim("V-MESH-01", accepted, 0, "bad inputs that were not refused with field, value and range");
}

TEST_CASE(
    "V-MESH-02 areas: elements and tributary areas sum to that of the patch, whatever the "
    "fibres' "
    "length") {
  VERIFY_RANDOM(random, 301);
  Worst areas, directions;
  const auto check = [&](auto corners) {
    const Points X = grid(5, 4, 3, 0.25, random);
    const auto m = mesh<corners.value>(X, cells<corners.value>(5, 4), 0.4, 1.2, random.rotation());
    // The shoelace formula around the border.
    double twice = 0;
    for (const auto& [a, b] : border<corners.value>(m.elements))
      twice += X[a].x() * X[b].y() - X[b].x() * X[a].y();
    double elements = 0, nodes = 0;
    for (int e = 0; e < m.element_count(); ++e) elements += m.area(e);
    for (double a : m.tributary_areas()) nodes += a;
    areas.see(std::abs(elements / (twice / 2) - 1), corners.value, "elements");
    areas.see(std::abs(nodes / (twice / 2) - 1), corners.value, "nodes");
  };
  check(std::integral_constant<int, 3>{});
  check(std::integral_constant<int, 4>{});
  Input input;
  input.fibres[0] = {{1e-7, 0, 2e-9}, {3e4, 5e4, 0}};  // 1 deg out of the plane: put into it
  const auto m = input.build();
  directions.see((eigen(m.fibres[0].warp) - direction(0)).norm());
  directions.see((eigen(m.fibres[0].weft) - direction(std::atan2(5, 3))).norm());
  directions.see(std::abs(m.fibre_angle(0) - std::atan2(5, 3)));
  areas.claim("V-MESH-02", 1e-14, "area against the shoelace formula, relative");  // 20 terms
  directions.claim("V-MESH-02", 1e-15, "fibres are unit vectors in the plane");
}

TEST_SUITE_END();
