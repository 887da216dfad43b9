// A run in float keeps its positions in double: what moves slowly moves, and what is far from the
// origin has the forces of what is near.

#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>

namespace {

using namespace scenes;
using Eigen::Vector3d;
using verify::Bound;
using verify::claim;
using verify::Worst;

constexpr double eps = std::numeric_limits<float>::epsilon();

double rounded(double x) { return static_cast<double>(static_cast<float>(x)); }
void round_positions(NodeVectors<double>& x) {
  for (auto* component : {&x.x, &x.y, &x.z})
    for (double& number : *component) number = rounded(number);
}

template <class R>
auto law() {
  return WovenMembrane<CrossedBeamCell<R>, ConstantShear<R>, CellPrice::followed>(
      CrossedBeamCell<R>(CellParameters<R>{}), ConstantShear<R>(R(0.01)));
}

/// What acts on a sheet; each with the size of its forces' parts before they cancel [kN].
enum class Block { membrane, membrane_2x2, bending, contact };

/// A sheet at rest, stretched by 1 % and curved, with its corner at `offset` in every component.
struct Sheet {
  static constexpr int n = 9;
  static constexpr double h = 5, strain = 0.01;
  Mesh<4> mesh;
  double offset;
  SymmetryPlanes planes{};

  Sheet(double at, double warp_angle, bool shuffled = false)
      : mesh(rectangle(n * h, n * h, n, n, warp_angle)), offset(at) {
    if (!shuffled) return;
    verify::Random random(3);
    for (std::size_t e = mesh.elements.size(); e > 1; --e)
      std::swap(mesh.elements[e - 1],
                mesh.elements[static_cast<std::size_t>(random.uniform(0, double(e)))]);
  }

  template <class T>
  [[nodiscard]] Points forces(Block what, bool round) const {
    using R = real_t<T>;
    NodalState<R> s(mesh, areal_mass);
    for (int k = 0; k < mesh.node_count; ++k) {
      const Vec3<double> X = mesh.nodes.get(k);
      const double a = std::sin(pi * X.x / (n * h)) * std::cos(pi * X.y / (n * h));
      // A mirror plane goes through the origin.
      s.x.set(k, {(planes.x ? 0 : offset) + (1 + strain) * X.x, offset + (1 + strain) * X.y,
                  offset + 2 * a});
    }
    if (round) round_positions(s.x);
    const auto add = [&](auto&& block) { block.add_forces(s, 1.0); };
    const MembraneOptions options{1e-3, 0};
    if (what == Block::membrane)
      add(MembraneSweep<T, Quadrilateral<1>, decltype(law<R>())>(mesh, law<R>(), areal_mass,
                                                                 options));
    else if (what == Block::membrane_2x2)
      add(MembraneSweep<T, Quadrilateral<4>, decltype(law<R>())>(mesh, law<R>(), areal_mass,
                                                                 options));
    else if (what == Block::bending)
      add(BendingSweep<T>(mesh, {1.4e-3, 2e-3}, areal_mass, planes));
    else
      tool<T>(Plane<R>({}, {0, 0, 1}), ToolMotion::prescribed([z = offset](double) { return z; }),
              ContactParameters{}, mesh.node_count)
          ->add_forces(s, 1.0, 0.0);
    Points f;
    for (int k = 0; k < mesh.node_count; ++k) {
      const Vec3<R> g = s.f.get(k);
      f.push_back({double(g.x), double(g.y), double(g.z)});
    }
    return f;
  }
};

/// A taut sheet of cells that are followed, bent and thrown at a sphere.
template <class T>
Model<real_t<T>> moving_sheet() {
  using R = real_t<T>;
  const int n = 12;
  const double h = 5;
  const Mesh<4> mesh = rectangle(n * h, n * h, n, n, 0.0);
  NodalState<R> s(mesh, areal_mass, fixed_rim(n, n));
  for (int k = 0; k < mesh.node_count; ++k) {
    const Vec3<double> X = mesh.nodes.get(k);
    s.x.set(k, {200 + 1.005 * X.x, 200 + 1.005 * X.y, 0});
    s.v.set(k, {R(0), R(0), R(4 * std::sin(pi * X.x / (n * h)) * std::sin(pi * X.y / (n * h)))});
  }
  Model<R> out(std::move(s), 0.05);
  out.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law<R>())>>(
      mesh, law<R>(), areal_mass, MembraneOptions{1e-4, 0.06}));
  out.add(std::make_unique<BendingSweep<T>>(mesh, BendingStiffness{1.4e-3, 1.4e-3}, areal_mass));
  out.add(tool<T>(Sphere<R>({R(230), R(230), R(20)}, R(20)),
                  ToolMotion::prescribed([](double t) { return -2 * t; }), ContactParameters{},
                  mesh.node_count));
  return out;
}

/// @param round round the positions to float after every step
template <class T>
Points end_of_run(double step, int steps, bool round) {
  CentralDifference<T> run(moving_sheet<T>(), TimeStep::fixed(step));
  for (int k = 0; k < steps; ++k) {
    run.step();
    if (round) round_positions(run.state().x);
  }
  return positions(run);
}

}  // namespace

TEST_SUITE_BEGIN("dynamics");

TEST_CASE("V-DYN-12 in float a node far out moves by v t, however slow") {
  const double X = 200, v = 1e-4, dt = 1e-2;
  const int steps = 4000;
  REQUIRE(rounded(X + v * dt) == rounded(X));  // a position in float would stand still
  const auto off = [&]<class T>() {
    NodalState<float> state(rectangle(10, 10, 2, 2, 0.0), areal_mass);
    for (int n = 0; n < state.node_count; ++n) {
      state.x.set(n, {X, X, X});
      state.v.set(n, {float(v), float(-v), float(2 * v)});
    }
    Model<real_t<T>> model(std::move(state));
    CentralDifference<T> run(std::move(model), TimeStep::fixed(dt));
    for (int k = 0; k < steps; ++k) run.step();
    Worst out;
    for (int n = 0; n < run.state().node_count; ++n) {
      const Vector3d moved = eigen(run.state().x.get(n)) - Vector3d::Constant(X);
      out.see((moved / (v * dt * steps) - Vector3d(1, -1, 2)).cwiseAbs().maxCoeff(), lanes_v<T>, n);
    }
    return out;
  };
  off.template operator()<NativePack<float>>().claim(
      "V-DYN-12", 2 * eps, "v t against the way, relative: half a float eps of 2 v, and its sum");
  off.template operator()<Pack<float, 1>>().claim("V-DYN-12", 2 * eps, "the same with one lane");
}

TEST_CASE("V-DYN-12 in float the forces of a sheet at rest do not know how far out it is") {
  struct Kind {
    const char* name;
    Block what;
    double tolerance;  ///< in float eps of the largest size below
    double size;       ///< of the forces' parts [kN]; 0: that of the forces
    bool mirrored = false;
    double warp_angle = 0;
  };
  // Yarn stiffness times an edge: what a strain of one makes of an element.
  const double membrane = static_cast<double>(law<double>().stiffness_bound()) * Sheet::h;
  for (const Kind& k : {Kind{"membrane", Block::membrane, 4, membrane},
                        Kind{"membrane, 2x2 points", Block::membrane_2x2, 4, membrane},
                        Kind{"bending", Block::bending, 20, 0},
                        Kind{"bending, mirrored", Block::bending, 20, 0, true},
                        Kind{"bending, oblique", Block::bending, 20, 0, false, 0.3},
                        Kind{"bending, oblique, mirrored", Block::bending, 20, 0, true, 0.3},
                        Kind{"contact", Block::contact, 4, 0}}) {
    Worst noise, shuffled;
    double far_noise = 0, far_rounded = 0;
    for (const double offset : {0.0, 500.0, -3000.0}) {
      Sheet sheet(offset, k.warp_angle);
      Sheet mixed(offset, k.warp_angle, true);
      sheet.planes.x = mixed.planes.x = k.mirrored;
      const Points exact = sheet.forces<Pack<double, 1>>(k.what, false);
      const double size = k.size > 0 ? k.size : largest(exact);
      REQUIRE(largest(exact) > 1e-6);
      const auto off = [&](const Points& f) { return distance(f, exact) / size / eps; };
      const double wide = off(sheet.forces<NativePack<float>>(k.what, false));
      noise.see(wide, "native", offset);
      noise.see(off(sheet.forces<Pack<float, 1>>(k.what, false)), "one lane", offset);
      noise.see(off(mixed.forces<NativePack<float>>(k.what, false)), "shuffled", offset);
      if (offset == 500) {
        far_noise = wide;
        far_rounded = off(sheet.forces<NativePack<float>>(k.what, true));
      }
    }
    noise.claim("V-DYN-12", k.tolerance,
                std::string("forces against double's in float eps, 0 to 3000 mm out, ") + k.name);
    // What it would be with positions in float.
    claim("V-DYN-12", far_rounded / far_noise, 20,
          std::string("times as much with rounded positions 500 mm out, ") + k.name, Bound::lower);
  }
}

TEST_CASE("V-DYN-12 a moving sheet ends in float where it ends in double") {
  const double step = 0.9 * moving_sheet<NativePack<double>>().critical_step();
  const int steps = 400;
  const Points exact = end_of_run<NativePack<double>>(step, steps, false);
  double way = 0;
  for (const auto& x : exact) way = std::max(way, std::abs(x.z()));
  REQUIRE(way > 0.5);
  const double gap = distance(end_of_run<NativePack<float>>(step, steps, false), exact);
  const double as_before = distance(end_of_run<NativePack<float>>(step, steps, true), exact);
  claim("V-DYN-12", gap, 2e-5, "largest distance from double's nodes after 400 steps [mm]");
  claim("V-DYN-12", as_before / gap, 10, "times as much with positions rounded after every step",
        Bound::lower);
}

TEST_SUITE_END();
