// A numbering by levels moves no geometry and no force, and puts neighbours next to each other.

#include "element/patches.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace patches;
using verify::Worst;

std::vector<int> shuffled(int count, verify::Random& random) {
  std::vector<int> out(count);
  std::iota(out.begin(), out.end(), 0);
  for (int i = count; i > 1; --i)
    std::swap(out[i - 1], out[static_cast<int>(random.uniform(0, i))]);
  return out;
}

/// Points and elements in a plane that is then turned; every element has fibres of its own, and
/// nodes and elements have no order. Without the library's own permutations.
template <int Corners>
Mesh<Corners> mesh_in_disorder(const Points& X, const std::vector<std::array<int, Corners>>& cells,
                               verify::Random& random) {
  const Eigen::Matrix3d Q = random.rotation();
  const std::vector<int> number = shuffled(static_cast<int>(X.size()), random);
  std::vector<Vec3<double>> positions(X.size());
  for (std::size_t n = 0; n < X.size(); ++n) positions[number[n]] = vec3(Q * X[n]);
  std::vector<std::array<int, Corners>> elements;
  std::vector<FibreDirections<double>> fibres;
  for (int e : shuffled(static_cast<int>(cells.size()), random)) {
    elements.push_back(cells[e]);
    for (int& n : elements.back()) n = number[n];
    const double warp = random.uniform(-pi, pi);
    fibres.push_back({vec3(Q * direction(warp)), vec3(Q * direction(warp + pi / 2))});
  }
  return {positions, elements, fibres};
}

/// A mesh and the number of nodes that its narrowest levels have.
template <int Corners>
struct Scene {
  std::string name;
  Mesh<Corners> mesh;
  int narrow;
};

/// Besides rectangles: a ring, whose levels meet on the far side; a fan, whose hub sees all nodes;
/// parts that are not connected.
template <int Corners>
std::vector<Scene<Corners>> scenes(verify::Random& random) {
  std::vector<Scene<Corners>> out;
  const auto add = [&](const char* name, const Points& X,
                       const std::vector<std::array<int, Corners>>& elements, int narrow) {
    out.push_back({name, mesh_in_disorder<Corners>(X, elements, random), narrow});
  };
  add("strip", grid(40, 60, 3, 0.2, random), cells<Corners>(40, 60), 41);
  add("square", grid(25, 25, 3, 0.2, random), cells<Corners>(25, 25), 26);
  {
    Points X{{0, 0, 0}, {3, 0, 0}, {4, 3, 0}, {1, 3, 0}};
    X.resize(Corners);
    std::array<int, Corners> all;
    std::iota(all.begin(), all.end(), 0);
    add("one element", X, {all}, 2);
  }
  {
    constexpr int wide = 6, round = 80;
    Points X;
    auto elements = cells<Corners>(round, wide);
    for (int i = 0; i < round; ++i)
      for (int j = 0; j <= wide; ++j) X.push_back((100 + 3 * j) * direction(-2 * pi * i / round));
    for (auto& element : elements)
      for (int& n : element) n %= round * (wide + 1);
    add("ring", X, elements, 2 * (wide + 1));
  }
  {
    Points X = grid(12, 30, 3, 0.2, random);
    auto elements = cells<Corners>(12, 30);
    const int first = static_cast<int>(X.size());
    for (const auto& p : grid(9, 5, 3, 0.2, random)) X.push_back(p + Eigen::Vector3d(100, 0, 0));
    for (auto element : cells<Corners>(9, 5)) {
      for (int& n : element) n += first;
      elements.push_back(element);
    }
    add("two parts", X, elements, 13);
    X.push_back({-50, 0, 0});
    add("two parts and a node alone", X, elements, 13);
  }
  if constexpr (Corners == 3) {
    Points X{{0, 0, 0}};
    std::vector<std::array<int, 3>> elements;
    for (int i = 0; i < 50; ++i) {
      X.push_back(40 * direction(2 * pi * i / 50));
      elements.push_back({0, i + 1, (i + 1) % 50 + 1});
    }
    add("fan", X, elements, 50);
  }
  return out;
}

/// Places, fibres and area of each element, without any number, in ascending order.
template <int Corners>
auto content(const Mesh<Corners>& m) {
  std::vector<std::array<double, 3 * Corners + 7>> out;
  for (int e = 0; e < m.element_count(); ++e) {
    auto& entry = out.emplace_back();
    auto at = entry.begin();
    const auto put = [&at](const Vec3<double>& v) {
      for (double component : {v.x, v.y, v.z}) *at++ = component;
    };
    for (const auto& X : m.corners(e)) put(X);
    put(m.fibres[e].warp);
    put(m.fibres[e].weft);
    *at = m.area(e);
  }
  std::sort(out.begin(), out.end());
  return out;
}

bool is_permutation_of_all(std::vector<int> p, int count) {
  std::sort(p.begin(), p.end());
  if (static_cast<int>(p.size()) != count) return false;
  for (int i = 0; i < count; ++i)
    if (p[i] != i) return false;
  return true;
}

/// Elements that do not stand in one level or in two neighbouring ones; all, if it is no list of
/// blocks that hold all nodes, each at least one.
template <int Corners>
int across_levels(const Mesh<Corners>& m, const std::vector<int>& start) {
  if (start.size() < 2 || start.front() != 0 || start.back() != m.node_count ||
      std::adjacent_find(start.begin(), start.end(), std::greater_equal<>()) != start.end())
    return m.element_count();
  int count = 0;
  for (const auto& element : m.elements) {
    const auto [low, high] = std::minmax_element(element.begin(), element.end());
    const auto level = [&](int n) { return std::upper_bound(start.begin(), start.end(), n); };
    count += level(*high) - level(*low) > 1;
  }
  return count;
}

template <int Corners>
int bandwidth(const Mesh<Corners>& m) {
  int most = 0;
  for (const auto& element : m.elements) {
    const auto [low, high] = std::minmax_element(element.begin(), element.end());
    most = std::max(most, *high - *low);
  }
  return most;
}

/// Batches of eight lanes that do not load whole packs, and all.
std::pair<int, int> gathered(const Mesh<4>& m) {
  const IndexBatches<4, Pack<double, 8>> batches(m.elements);
  int count = 0;
  for (int b = 0; b < batches.size(); ++b) count += batches[b].gather_row >= 0;
  return {count, batches.size()};
}

template <class Check>
void for_each_scene(verify::Random& random, Check check) {
  for (const auto& s : scenes<3>(random)) check(s);
  for (const auto& s : scenes<4>(random)) check(s);
}

template <int Corners>
constexpr const char* shape = Corners == 3 ? "triangles" : "quadrilaterals";

}  // namespace

TEST_SUITE_BEGIN("mesh");
TEST_CASE(
    "V-MESH-03 numbering by levels moves no geometry; an element stands in two levels at most") {
  VERIFY_RANDOM(random, 303);
  Worst numbers, geometry, levels, in_place, order, data, narrow;
  for_each_scene(random, [&]<int Corners>(const Scene<Corners>& s) {
    const Mesh<Corners>& m = s.mesh;
    CAPTURE(s.name);
    const auto before = content(m);
    // No two elements are equal, nor are their fibres, and the numbers have no order.
    REQUIRE(std::adjacent_find(before.begin(), before.end()) == before.end());
    for (int e = 1; e < m.element_count(); ++e)
      REQUIRE(detail::norm(m.fibres[e].warp - m.fibres[e - 1].warp) > 0);
    if (m.node_count > 51) REQUIRE(bandwidth(m) > m.node_count / 2);

    const Numbering numbering = number_by_levels(m);
    const Mesh<Corners> now = renumbered(m, numbering);
    numbers.see(!is_permutation_of_all(numbering.node, m.node_count), s.name, "nodes");
    numbers.see(!is_permutation_of_all(numbering.element, m.element_count()), s.name, "elements");
    REQUIRE(now.element_count() == m.element_count());
    REQUIRE(now.fibres.size() == m.fibres.size());
    REQUIRE(now.node_count == m.node_count);
    const auto after = content(now);
    int different = 0;
    for (std::size_t e = 0; e < before.size(); ++e) different += before[e] != after[e];
    geometry.see(different, s.name, shape<Corners>);

    levels.see(across_levels(now, numbering.level_start), s.name, shape<Corners>);
    in_place.see(across_levels(now, levels_in_place(now)), s.name, "new numbers");
    in_place.see(across_levels(m, levels_in_place(m)), s.name, "in disorder");
    Numbering swapped = numbering;  // some order left: more than two levels, fewer than before
    for (int i = 0; m.node_count > 51 && i < 20; ++i) {
      const auto n = swapped.node.begin() + static_cast<int>(random.uniform(0, m.node_count - 9));
      std::swap(n[0], n[static_cast<int>(random.uniform(1, 9))]);
    }
    const Mesh<Corners> partly = renumbered(m, swapped);
    in_place.see(across_levels(partly, levels_in_place(partly)), s.name, "partly in order");
    if (s.name == "strip") REQUIRE(levels_in_place(partly).size() > 10);
    narrow.see(double(bandwidth(now)) / (s.narrow + 1), s.name, shape<Corners>);
    std::vector<int> lowest;
    for (const auto& element : now.elements)
      lowest.push_back(*std::min_element(element.begin(), element.end()));
    order.see(!std::is_sorted(lowest.begin(), lowest.end()), s.name, shape<Corners>);

    // Data go with their nodes, and back.
    std::vector<int> number(m.node_count);
    std::iota(number.begin(), number.end(), 0);
    data.see(to_new(number, numbering.node) != numbering.node, s.name, "to new");
    data.see(to_old(numbering.node, numbering.node) != number, s.name, "to old");
    const NodeVectors<double> back = to_old(now.nodes, numbering.node);
    data.see(back.x != m.nodes.x || back.y != m.nodes.y || back.z != m.nodes.z, s.name, "places");
    REQUIRE((now.nodes.x != m.nodes.x || m.node_count < 10));
  });
  numbers.claim("V-MESH-03", 0, "lists that are no permutation");
  geometry.claim("V-MESH-03", 0, "elements with another bit in a corner, fibre or area");
  levels.claim("V-MESH-03", 0, "elements in more than two levels or in two that are no neighbours");
  in_place.claim("V-MESH-03", 0, "the same of the levels that the numbers themselves give");
  order.claim("V-MESH-03", 0, "lists of elements not ordered by their lowest node");
  data.claim("V-MESH-03", 0, "nodal data not where their node is");
  // Two levels follow one another within twice the width of one.
  narrow.claim("V-MESH-03", 2, "bandwidth over that of rows across the shape");

  // Rows are found again: in the numbers of a rectangle, and from none.
  int rows = 0;
  for (const auto& [nx, ny] : {std::pair{1, 1}, {7, 3}, {3, 7}, {1, 9}, {9, 1}, {40, 60}}) {
    const std::vector<int> start = levels_in_place(rectangle(10, 10, nx, ny));
    bool all = start.size() == static_cast<std::size_t>(nx) + 2;
    for (std::size_t l = 0; all && l < start.size(); ++l)
      all = start[l] == static_cast<int>(l) * (ny + 1);
    rows += !all;
  }
  verify::claim("V-MESH-03", rows, 0, "rectangles whose levels in place are not their rows");
  Worst excess;  // whatever node the search begins with
  for (const auto& [nx, ny] : {std::pair{1, 5}, {3, 2}, {3, 20}, {8, 12}, {10, 10}, {25, 25}})
    for (int i = 0; i < 40; ++i) {
      const Mesh<4> m = mesh_in_disorder<4>(grid(nx, ny, 3, 0.2, random), cells<4>(nx, ny), random);
      excess.see(bandwidth(renumbered(m, number_by_levels(m))) - (std::min(nx, ny) + 2), nx, ny);
    }
  excess.claim("V-MESH-03", 0, "bandwidth of shuffled rectangles beyond that of their short rows");
  const Mesh<4> strip = mesh_in_disorder<4>(grid(40, 60, 3, 0.2, random), cells<4>(40, 60), random);
  const auto [mixed, all] = gathered(strip);
  REQUIRE(mixed > 0.99 * all);
  // 60 rows of 40 elements with a lane left out between two: 2459 lanes, the last three by
  // themselves.
  verify::claim("V-MESH-03", gathered(renumbered(strip, number_by_levels(strip))).first, 1,
                "gathered batches of a shuffled strip, numbered: the rest at its end");
}

namespace {

/// Forces of a mesh in a state given on another that it came from by `numbering`, in its numbers.
template <class T, class Element, int Corners>
NodalState<double> forces(const Mesh<Corners>& m, NodalState<double> state) {
  const auto law = fabric(pi / 2);
  MembraneSweep<T, Element, std::decay_t<decltype(law)>> sweep(m, law, areal_mass, {0.01, 0.06});
  sweep.add_forces(state, 1.0);
  return state;
}

}  // namespace

TEST_CASE("V-MESH-04 membrane forces on the new numbers, carried back, are those on the old") {
  VERIFY_RANDOM(random, 304);
  Worst force, mass;
  const auto check = [&]<class T, class Element, int Corners>(const Scene<Corners>& s) {
    if (s.name.ends_with("alone")) return;  // a node without mass cannot move
    const Mesh<Corners>& m = s.mesh;
    CAPTURE(s.name);
    NodalState<double> old_state(m, areal_mass);
    for (int n = 0; n < m.node_count; ++n) {
      old_state.x.set(n, 1.05 * m.nodes.get(n) + vec3(random.vector(0.03)));  // taut
      old_state.v.set(n, vec3(random.vector(2)));
      old_state.v_predicted.set(n, vec3(random.vector(2)));
    }
    const Numbering numbering = number_by_levels(m);
    const Mesh<Corners> now = renumbered(m, numbering);
    NodalState<double> new_state(now, areal_mass);
    new_state.x = to_new(old_state.x, numbering.node);
    new_state.v = to_new(old_state.v, numbering.node);
    new_state.v_predicted = to_new(old_state.v_predicted, numbering.node);

    old_state = forces<T, Element>(m, old_state);
    const auto back = to_old(forces<T, Element>(now, new_state).f, numbering.node);
    const auto masses = to_old(new_state.mass, numbering.node);
    double largest_force = 0;
    for (int n = 0; n < m.node_count; ++n)
      largest_force = std::max(largest_force, detail::norm(old_state.f.get(n)));
    REQUIRE(largest_force > 0.01);
    for (int n = 0; n < m.node_count; ++n) {
      force.see(detail::norm(back.get(n) - old_state.f.get(n)) / largest_force, s.name, lanes_v<T>,
                "lanes", shape<Corners>);
      mass.see(std::abs(masses[n] / old_state.mass[n] - 1), s.name, shape<Corners>);
    }
  };
  const auto widths = [&]<class Element, int Corners>(const std::vector<Scene<Corners>>& all) {
    for (const auto& s : all) {
      check.template operator()<Pack<double, 1>, Element>(s);
      check.template operator()<Pack<double, 8>, Element>(s);
    }
  };
  widths.template operator()<Triangle>(scenes<3>(random));
  widths.template operator()<Quadrilateral<1>>(scenes<4>(random));
  widths.template operator()<Quadrilateral<4>>(scenes<4>(random));
  // Coordinates and fibres are equal in every bit; only the order differs in which elements add to
  // a node: 50 at the hub of the fan, each sum rounded to half of 2.2e-16 of what it has reached.
  // The cell's slowest lane may bring another lane one sweep more, as in V-ELEM-06.
  force.claim("V-MESH-04", 1e-14, "nodal forces, over the largest");
  mass.claim("V-MESH-04", 1e-14, "nodal masses, relative");
}

TEST_SUITE_END();
