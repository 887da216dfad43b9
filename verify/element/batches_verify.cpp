// The sweep gives the same forces whatever fills its lanes: any width, the contiguous and the
// gather path, full and partial batches, float and double.

#include "element/patches.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace patches;
using verify::Worst;

constexpr int nx = 5,
              ny = 11;  // columns of 11: no multiple of any width, so the last batch is partial

template <class R>
WovenMembrane<CrossedBeamCell<R>, PolynomialShear<R>> fabric_in() {
  const FibreAngle<R> angle = FibreAngle<R>::right();
  return {CrossedBeamCell<R>(CellParameters<R>{}),
          PolynomialShear<R>(PolynomialCurve<R>(
              {R(0.051e-3), R(-0.83e-3), R(6.1275e-3), R(-12.0972e-3), R(8.48e-3)})),
          angle};
}

struct Answer {
  Points f;
  double energy = 0;
  std::vector<double> shear;
};

template <class T>
NodalState<real_t<T>> state_in(const Mesh<4>& m, const Points& x, const Points& v) {
  using R = real_t<T>;
  const auto real = [](const Eigen::Vector3d& p) { return Vec3<R>{R(p.x()), R(p.y()), R(p.z())}; };
  NodalState<R> state(m, areal_mass);
  for (int n = 0; n < m.node_count; ++n) {
    state.x.set(n, vec3(x[n]));
    state.v.set(n, real(v[n]));
    state.v_predicted.set(n, real(v[n]));
  }
  return state;
}

template <class T, class Element>
Answer answer(const Mesh<4>& m, const Points& x, const Points& v, bool bending) {
  using R = real_t<T>;
  auto state = state_in<T>(m, x, v);
  const auto law = fabric_in<R>();
  MembraneSweep<T, Element, std::decay_t<decltype(law)>> sweep(m, law, areal_mass, {0.01, 0.06});
  sweep.add_forces(state, 1.0);
  EnergyLedger e;
  sweep.add_energy(state, e);
  if (bending) {
    BendingSweep<T> bend(m, {1.4e-3, 2e-3}, areal_mass);
    bend.add_forces(state, 1.0);
    bend.add_energy(state, e);
  }
  Answer out;
  for (int n = 0; n < m.node_count; ++n) {
    const auto f = state.f.get(n);
    out.f.push_back({double(f.x), double(f.y), double(f.z)});
  }
  out.energy = e.stored() + e.value("bulk_viscosity");
  std::vector<ElementSample> samples;
  sweep.sample(state, samples);
  for (const auto& s : samples) out.shear.push_back(s.shear_angle);
  return out;
}

struct Scene {
  Mesh<4> rows, shuffled;
  std::vector<std::size_t> order;  // of the shuffled elements
  Points x, v;
};

/// @param regular equal elements along the yarns, the same constants for all; else distorted ones
/// @param gaps most elements of odd row and column are missing: rows leave nodes out all over the
/// place
Scene scene(verify::Random& random, bool regular, bool gaps) {
  const Points X = grid(nx, ny, 5, regular ? 0 : 0.2, random);
  auto elements = cells<4>(nx, ny);
  if (gaps)
    std::erase_if(elements, [&](const std::array<int, 4>& corners) {
      const int i = corners[0] / (ny + 1), j = corners[0] % (ny + 1);
      return i % 2 == 1 && j % 2 == 1 && i + 1 < nx && j + 1 < ny && random.uniform(0, 1) < 0.8;
    });
  std::vector<std::size_t> order(elements.size());
  for (std::size_t e = 0; e < order.size(); ++e) order[e] = e;
  for (std::size_t e = order.size(); e > 1; --e)
    std::swap(order[e - 1], order[static_cast<std::size_t>(random.uniform(0, double(e)))]);
  std::vector<std::array<int, 4>> mixed;
  for (std::size_t e : order) mixed.push_back(elements[e]);
  Points x = X, v = X;
  for (std::size_t n = 0; n < x.size(); ++n) {
    x[n] += random.vector(0.2);
    v[n] = random.vector(2);
  }
  const double angle = regular ? 0 : 0.3;
  return {mesh<4>(X, elements, angle, pi / 2), mesh<4>(X, mixed, angle, pi / 2), order, x, v};
}

template <class T>
int contiguous_batches(const Mesh<4>& m) {
  const IndexBatches<4, T> batches(m.elements);
  int count = 0;
  for (int b = 0; b < batches.size(); ++b) count += batches[b].gather_row < 0;
  return count;
}

double difference(const Answer& a, const Answer& b) {
  double worst = 0;
  for (std::size_t n = 0; n < a.f.size(); ++n) worst = std::max(worst, (a.f[n] - b.f[n]).norm());
  return std::max(worst / largest(a.f), std::abs(a.energy / b.energy - 1));
}

}  // namespace

TEST_SUITE_BEGIN("element");
TEST_CASE("V-ELEM-06 batches: every width, path and filling of the lanes gives the same forces") {
  VERIFY_RANDOM(random, 106);
  Worst in_double, in_float, samples;
  for (const auto& [regular, gaps] :
       {std::pair(false, false), {false, true}, {true, false}, {true, true}}) {
    const Scene s = scene(random, regular, gaps);
    REQUIRE((s.rows.element_count() < nx * ny) == gaps);
    bool left_out = false;  // lanes between others
    const auto with = [&]<class T, class Element>(const Answer& reference, Worst& worst,
                                                  const char* name) {
      for (bool shuffled : {false, true}) {
        const Mesh<4>& m = shuffled ? s.shuffled : s.rows;
        if (lanes_v < T >> 2) {
          const IndexBatches<4, T> batches(m.elements);
          // Both paths are taken: rows load whole packs, shuffled elements hardly ever.
          const double contiguous = double(contiguous_batches<T>(m)) / batches.size();
          REQUIRE((shuffled ? contiguous < 0.25 : contiguous > 0.5));
          bool partial = false;
          for (int b = 0; b < batches.size(); ++b) {
            partial |= !batches[b].is_full();
            left_out |= std::popcount(batches[b].held) < batches[b].length();
          }
          REQUIRE(partial);
        }
        const Answer now = answer<T, Element>(m, s.x, s.v, true);
        worst.see(difference(reference, now), name, lanes_v<T>, shuffled ? "shuffled" : "rows");
        for (std::size_t e = 0; e < now.shear.size(); ++e)
          if (sizeof(real_t<T>) == 8)
            samples.see(std::abs(now.shear[e] - reference.shear[shuffled ? s.order[e] : e]), name,
                        lanes_v<T>, shuffled ? "shuffled" : "rows", e);
      }
    };
    const auto widths = [&]<class Element>(const char* name) {
      const Answer reference = answer<Pack<double, 1>, Element>(s.rows, s.x, s.v, true);
      REQUIRE(largest(reference.f) > 0.1);
      with.template operator()<Pack<double, 1>, Element>(reference, in_double, name);
      with.template operator()<Pack<double, 2>, Element>(reference, in_double, name);
      with.template operator()<Pack<double, 4>, Element>(reference, in_double, name);
      with.template operator()<Pack<double, 8>, Element>(reference, in_double, name);
      with.template operator()<NativePack<float>, Element>(reference, in_float, name);
      with.template operator()<Pack<float, 4>, Element>(reference, in_float, name);
    };
    widths.template operator()<Quadrilateral<1>>("1 point");
    widths.template operator()<Quadrilateral<4>>("2x2 points");
    REQUIRE(left_out);
  }
  // Lanes compute like scalars; only the order in which elements add to a node differs: a few
  // roundings of the largest force. The cell is iterated until its slowest lane has converged, so
  // a lane may get one sweep more: its error is the square of 1e-12.
  in_double.claim("V-ELEM-06", 5e-15, "double, any width against one lane, relative");
  samples.claim("V-ELEM-06", 1e-15, "shear angles, and in the order of the elements [rad]");
  // Differences of double positions: a few roundings of 6e-8, of strains of order 0.05.
  in_float.claim("V-ELEM-06", 1e-5, "float against double, relative");
}

TEST_CASE("V-ELEM-06 batches: idle lanes before the last tuple of a batch count in its bandwidth") {
  // The second batch goes on where the first ends, at node 4: its lanes 0 and 1 hold no tuple, but
  // what they read gets zeros, so that no other thread may be at work there.
  const IndexBatches<2, Pack<double, 4>> batches({{0, 10}, {1, 11}, {6, 16}, {7, 17}});
  REQUIRE(batches.size() == 2);
  REQUIRE(!batches[1].holds(0));
  REQUIRE(batches.node(1, 0, 0) == 4);
  verify::claim("V-ELEM-06", (17 - 4) - batches.bandwidth(), 0,
                "nodes that a batch writes to beyond its bandwidth");
}

TEST_SUITE_END();
