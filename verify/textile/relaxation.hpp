#pragma once
/// @file
/// What the virtual tests share: a model of one sheet, and its way to rest by dynamic relaxation
/// with the library's own time steps.

#include "dynamics/scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace textile {

using namespace scenes;
using T = NativePack<double>;
using Run = CentralDifference<T>;

/// A sheet whose nodes start at `x`; components that may move are off by up to `perturbation`.
template <class Element, class Law>
Model<double> sheet(const Mesh<Element::corners>& m, const Law& law,
                    const std::vector<NodeConstraint>& constraints, const Points& x,
                    verify::Random& random, double perturbation, double hourglass_modulus = 0.01) {
  NodalState<double> state(m, areal_mass, constraints);
  for (int n = 0; n < m.node_count; ++n) {
    const auto d = random.vector(perturbation);
    const auto free = state.free.get(n);
    state.x.set(n, vec3(x[n]) + Vec3<double>{d.x() * free.x, d.y() * free.y, d.z() * free.z});
  }
  Model<double> model(std::move(state));
  model.add(std::make_unique<MembraneSweep<T, Element, Law>>(
      m, law, areal_mass, MembraneOptions{hourglass_modulus, 0}));
  return model;
}

/// Steps until no free component of a nodal force exceeds `tolerance` [kN], ten steps in a row.
///
/// Between steps the velocities are damped critically for the mode that moves: its frequency is the
/// Rayleigh quotient of the last change of the forces (Underwood's adaptive dynamic relaxation).
/// What the steps converge to does not depend on it.
inline Run relax(Model<double> model, double tolerance, long most = 400000) {
  Run run(std::move(model), TimeStep::fraction(0.9));
  NodalState<double>& s = run.state();
  const double dt = run.time_step();
  auto before = s.f, moved = s.v;  // forces and velocities of the last step
  double residual = 0;
  long step = 0;
  int calm = 0;
  for (; step < most && calm < 10; ++step) {
    run.step();
    double stiffness = 0, mass = 0;
    residual = 0;
    const auto see = [&](const auto& f, const auto& f_before, const auto& v, const auto& free) {
      for (int n = 0; n < s.node_count; ++n) {
        if (free[n] == 0) continue;
        residual = std::max(residual, std::abs(f[n]));
        stiffness -= v[n] * (f[n] - f_before[n]);
        mass += s.mass[n] * v[n] * v[n];
      }
    };
    see(s.f.x, before.x, moved.x, s.free.x);
    see(s.f.y, before.y, moved.y, s.free.y);
    see(s.f.z, before.z, moved.z, s.free.z);
    calm = residual <= tolerance ? calm + 1 : 0;
    before = s.f;
    moved = s.v;
    const double omega_dt = mass > 0 ? std::sqrt(std::max(stiffness * dt / mass, 0.0)) : 0;
    // Stable for omega dt <= 1.8, because 1.8^2 < 2 (1 + keep).
    const double a = std::min(omega_dt, 0.2);
    const double keep = (1 - a) / (1 + a);
    for (auto* u : {&s.v.x, &s.v.y, &s.v.z})
      for (double& value : *u) value *= keep;
  }
  INFO("largest force left: ", residual, " kN, after ", step, " steps");
  REQUIRE(residual <= tolerance);
  return run;
}

/// Yarns that are as stiff pressed as pulled and all but straight: the limit in which trellises,
/// chains and elastic lines have their closed forms. EA/l0 of Table 1 times `stiffer`.
inline CellParameters<double> straight_yarns(double stiffer = 1) {
  CellParameters<double> p;
  p.contact_length = 1e-4;  // crimp 2e-10
  for (auto* yarn : {&p.warp, &p.weft}) {
    yarn->youngs_modulus *= stiffer;
    yarn->second_moment_of_area = 0;
  }
  // A slack yarn has no stiffness of its own.
  p.residual_compression_stiffness = p.warp.youngs_modulus * p.warp.cross_section / p.warp.length;
  return p;
}

/// Nodes whose reference position fulfils a condition.
template <int Corners, class Condition>
std::vector<int> nodes_where(const Mesh<Corners>& m, Condition condition) {
  std::vector<int> out;
  for (int n = 0; n < m.node_count; ++n)
    if (condition(eigen(m.nodes.get(n)))) out.push_back(n);
  return out;
}

/// Force of the supports on some nodes [kN]. The residual of relax() is what it is uncertain by.
inline Eigen::Vector3d reaction(const Run& run, const std::vector<int>& nodes) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int n : nodes) sum -= eigen(run.state().f.get(n));
  return sum;
}

inline std::vector<ElementSample> samples(const Run& run) {
  std::vector<ElementSample> out;
  run.blocks()[0]->sample(run.state(), out);
  return out;
}

}  // namespace textile
