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
      {"first corner pushed in",
       [](Input& m) {
         m.X[0] = {2, 2, 0};
       },
       "mesh.elements[0] corner 0", "-", "> 0"},
      {"last corner pushed in",
       [](Input& m) {
         m.X[3] = {2, 1, 0};
       },
       "mesh.elements[0] corner 3", "-", "> 0"},
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
      {"warp 10 deg below the plane",
       [](Input& m) {
         m.fibres[0].warp = {std::cos(pi / 18), 0, -std::sin(pi / 18)};
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
  builds([] { rectangle(10, -1, 2, 3); }, "rectangle.length", "-1", "> 0");

  // Slivers, on both sides of the least area of 1e-9 of the longest edge squared: whichever edge is
  // the longest, however large it is and wherever it lies.
  for (const double unit : {1e-3, 1.0, 1e3})
    for (int longest = 0; longest < 4; ++longest) {
      const auto sliver = [&](double height) {
        const std::vector<Vec3<double>> corners{{10 * unit, 0, 0},
                                                {13 * unit, 0, 0},
                                                {12 * unit, height * unit, 0},
                                                {11 * unit, height * unit, 0}};
        std::array<int, 4> element;
        for (int a = 0; a < 4; ++a) element[a] = (a + longest) % 4;
        return Mesh<4>(corners, {element}, {{{1, 0, 0}, {0, 1, 0}}});
      };
      builds([&] { sliver(2.24e-9); }, "mesh.elements[0] area", "", "> 0");
      CHECK_NOTHROW(sliver(2.26e-9));
    }
  // 5 deg out of the plane are the limit, for fibres of any length.
  for (const double length : {0.01, 1.0, 1.4, 1.9, 77.0})
    for (const double side : {-1.0, 1.0}) {
      const auto tilted = [&](double degrees) {
        Input input;
        const double angle = degrees * pi / 180;
        input.fibres[1].weft = {0, length * std::cos(angle), side * length * std::sin(angle)};
        static_cast<void>(input.build());
      };
      builds([&] { tilted(5.01); }, "mesh.fibres[1].weft angle to the element's plane", "5.0",
             "0 to 5");
      CHECK_NOTHROW(tilted(4.99));
    }
  // Along the normal, whose product with it rounds to more than the lengths' now and then.
  VERIFY_RANDOM(random, 302);
  for (int sample = 0; sample < 200; ++sample) {
    const Eigen::Matrix3d Q = random.rotation();
    Input input;
    for (auto& X : input.X) X = vec3(Q * eigen(X));
    for (auto& f : input.fibres) f = {vec3(Q.col(2)), vec3(Q.col(1))};
    builds([&] { static_cast<void>(input.build()); },
           "mesh.fibres[0].warp angle to the element's plane", "", "0 to 5");
  }
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
  // In the plane of x and z, and of a length whose square no double holds.
  for (const double length : {1e-300, 1.0, 1e300}) {
    Input upright;
    for (auto& X : upright.X) X = {X.x, 0, X.y};
    for (auto& f : upright.fibres) f = {{length, 0, 0}, {0, 0, length}};
    const auto turned = upright.build();
    directions.see((eigen(turned.fibres[1].warp) - Eigen::Vector3d::UnitX()).norm(), length);
    directions.see((eigen(turned.fibres[1].weft) - Eigen::Vector3d::UnitZ()).norm(), length);
  }
  // Nodes are stored up to a multiple of the padding, and by as many again.
  for (int count : {1, array_padding - 1, array_padding, array_padding + 1, 1000}) {
    const NodeVectors<double> nodes(count);
    for (const auto* component : {&nodes.x, &nodes.y, &nodes.z}) {
      const int size = static_cast<int>(component->size());
      CHECK(size % array_padding == 0);
      CHECK(size >= count + array_padding);
      CHECK(size < count + 2 * array_padding);
    }
  }
  areas.claim("V-MESH-02", 1e-14, "area against the shoelace formula, relative");  // 20 terms
  directions.claim("V-MESH-02", 1e-15, "fibres are unit vectors in the plane");
}

TEST_CASE("V-MESH-05 mirror planes hold the nodes on them, and only across") {
  // Not a square, so that neither the planes nor the sides can be exchanged unnoticed.
  constexpr int nx = 3, ny = 5;
  const auto m = rectangle(30, 20, nx, ny);
  int wrong = 0, held = 0;
  for (const bool x : {false, true})
    for (const bool y : {false, true}) {
      const auto constraints = symmetry_constraints(m, {x, y});
      NodalState<double> state(m, areal_mass, constraints);
      for (int n = 0; n < m.node_count; ++n) {
        const auto X = m.nodes.get(n);
        const auto free = state.free.get(n);
        wrong += free.x != ((x && X.x == 0) ? 0 : 1);
        wrong += free.y != ((y && X.y == 0) ? 0 : 1);
        wrong += free.z != 1;
      }
      // One constraint for a node, that on both planes included.
      const int expected = (x ? ny + 1 : 0) + (y ? nx + 1 : 0) - (x && y ? 1 : 0);
      CHECK(static_cast<int>(constraints.size()) == expected);
      held += expected;
    }
  REQUIRE(held == 6 + 4 + 9);

  // On a plane is what is within the tolerance of it, on either side.
  Input input;
  for (auto& X : input.X) X = {X.x - 3, X.y + 1, X.z};
  input.X[1].x = input.X[4].x = 0;
  const double tolerance = plane_tolerance(input.build());
  REQUIRE(tolerance > 1e-6);
  input.X[1].x = 0.9 * tolerance;
  input.X[4].x = -0.9 * tolerance;
  CHECK(symmetry_constraints(input.build(), {true, false}).size() == 2);
  input.X[4].x = -1.1 * tolerance;
  CHECK(symmetry_constraints(input.build(), {true, false}).size() == 1);
  claim("V-MESH-05", wrong, 0, "components of nodes that are held and should not be, or not held");
}

TEST_SUITE_END();
