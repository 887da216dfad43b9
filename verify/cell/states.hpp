#pragma once
/// @file
/// States and parameter sets that the tests of the cell share.

#include "crossbeam/cell/crossed_beam.hpp"

#include "support/random.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace verify {

using Cell = crossbeam::CrossedBeamCell<double>;
using Parameters = crossbeam::CellParameters<double>;

/// Table 1 of the paper, optionally without bending.
inline Parameters table_1() { return {}; }
inline Parameters table_1_without_bending() {
  Parameters p;
  p.warp.second_moment_of_area = p.weft.second_moment_of_area = 0;
  return p;
}

/// Any admissible fabric, far beyond those that are woven: moduli three decades apart, contact from
/// very soft to rigid, bending from none to beams as stiff as wood, crimp from flat to steep.
inline Parameters random_fabric(Random& random) {
  Parameters p;
  p.warp.youngs_modulus = 35.4;
  p.weft.youngs_modulus = 35.4 * random.log_uniform(1e-3, 1e3);
  p.contact_modulus = p.warp.youngs_modulus * random.log_uniform(1e-4, 10);
  const bool beams = random.uniform(0, 1) > 0.2;
  p.warp.second_moment_of_area = beams ? random.log_uniform(1e-7, 0.1) : 0;
  p.weft.second_moment_of_area = beams ? random.log_uniform(1e-7, 0.1) : 0;
  p.warp.cross_section = random.uniform(0.5, 2);
  p.weft.cross_section = random.uniform(0.5, 2);
  p.warp.length = random.uniform(1.5, 4);
  p.weft.length = random.uniform(1.5, 4);
  p.contact_length = random.uniform(0.05, 1.5);
  p.warp_height_fraction = random.uniform(0.05, 0.95);
  return p;
}

/// The fabric in units that make forces 2^force and lengths 2^length times the numbers they were.
inline Parameters in_other_units(Parameters p, int force, int length) {
  const auto scale = [](double& value, int exponent) {
    const double scaled = std::ldexp(value, exponent);
    value = std::ldexp(scaled, -exponent) == value ? scaled : std::nan("");  // no such number
  };
  for (auto* yarn : {&p.warp, &p.weft}) {
    scale(yarn->youngs_modulus, force - 2 * length);
    scale(yarn->cross_section, 2 * length);
    scale(yarn->second_moment_of_area, 4 * length);
    scale(yarn->length, length);
  }
  scale(p.contact_modulus, force - 2 * length);
  scale(p.contact_area, 2 * length);
  scale(p.contact_length, length);
  scale(p.residual_compression_stiffness, force - length);
  return p;
}

/// One evaluation, compiled once per program part instead of once per call.
template <class R>
struct BasicAnswer {
  crossbeam::CellForces<R> forces;
  crossbeam::CellStatus status;
  int sweeps;
  bool closed;
  R energy;
  crossbeam::CellTangent<R> tangent;
};
using Answer = BasicAnswer<double>;

template <class AnyCell>
[[gnu::noinline]] BasicAnswer<typename AnyCell::Real> answer(const AnyCell& cell,
                                                             typename AnyCell::Real u1,
                                                             typename AnyCell::Real u2) {
  const auto s = cell.solve(u1, u2);
  return {s.forces,
          s.status,
          s.sweeps,
          s.contact_stiffness > 0,
          cell.energy(u1, u2, s),
          cell.tangent(u1, u2, s)};
}

template <class R>
bool converged(const BasicAnswer<R>& a) {
  return a.status == crossbeam::CellStatus::converged;
}

/// Violation of the equilibrium conditions at an answer, computed in X: vertical forces g1 = g2 = q
/// relative to EA/l0 L3 of the stiffer yarn, contact law relative to L3, and the signs of heights.
template <class X, class R>
X violation(const crossbeam::CrossedBeamCell<R>& cell, R u1, R u2, const BasicAnswer<R>& a) {
  using crossbeam::magnitude;
  using crossbeam::maximum;
  const X w1(a.forces.w1), w2(a.forces.w2), q(a.forces.q);
  const crossbeam::YarnState<X> y1(cell.warp(), X(u1), w1), y2(cell.weft(), X(u2), w2);
  const X L3(cell.parameters().contact_length);
  const X force = X(cell.warp().ka < cell.weft().ka ? cell.weft().ka : cell.warp().ka) * L3;
  // Shortening q/k3 where the contact presses, a gap where it does not.
  const X gap = (w1 + w2 + q / X(cell.contact_stiffness())) / L3;
  const X contact = q > X(0) ? magnitude(gap) : maximum(X(-gap), X(0));
  const X below = maximum(X(-(X(cell.warp().H) + w1)), X(-(X(cell.weft().H) + w2))) / L3;
  const X vertical = maximum(magnitude(X(y1.vertical_force(cell.warp()) - q)),
                             magnitude(X(y2.vertical_force(cell.weft()) - q))) /
                     force;
  return maximum(maximum(vertical, contact), maximum(below, X(-q)));
}

/// The same fabric in another real type.
template <class R>
crossbeam::CellParameters<R> converted(const Parameters& p) {
  const auto yarn = [](const crossbeam::YarnParameters<double>& y) {
    return crossbeam::YarnParameters<R>{R(y.youngs_modulus), R(y.cross_section),
                                        R(y.second_moment_of_area), R(y.length)};
  };
  crossbeam::CellParameters<R> c;
  c.warp = yarn(p.warp);
  c.weft = yarn(p.weft);
  c.contact_modulus = R(p.contact_modulus);
  c.contact_area = R(p.contact_area);
  c.contact_length = R(p.contact_length);
  c.warp_height_fraction = R(p.warp_height_fraction);
  c.bending_boundary_factor = R(p.bending_boundary_factor);
  c.residual_compression_stiffness = R(p.residual_compression_stiffness);
  c.symmetry = p.symmetry;
  return c;
}

/// A state on a known side of the slack boundary, with a margin: the contact does not change within
/// `margin` [strain] in any of eight directions.
struct State {
  Parameters parameters;
  double u1, u2;
  bool taut;
};

inline bool contact_is_constant(const Cell& cell, double u1, double u2, double margin) {
  const bool closed = answer(cell, u1, u2).closed;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      if (answer(cell, u1 + i * margin * cell.warp().L, u2 + j * margin * cell.weft().L).closed !=
          closed)
        return false;
  return true;
}

/// `count` states of Table 1 and of random fabrics with bending, half of them taut, half slack.
/// @param bending whether every yarn has a bending stiffness, or none
inline std::vector<State> states_on_both_sides(Random& random, int count, double margin,
                                               bool bending = true) {
  std::vector<State> states;
  while (static_cast<int>(states.size()) < count) {
    const bool want_taut = states.size() % 2 == 0;
    Parameters p = states.size() % 4 < 2 ? table_1() : random_fabric(random);
    for (auto* yarn : {&p.warp, &p.weft})
      yarn->second_moment_of_area = bending ? std::max(yarn->second_moment_of_area, 1e-6) : 0.0;
    const Cell cell(p);
    const double u1 = p.warp.length * random.uniform(-0.05, 0.05);
    const double u2 = p.weft.length * random.uniform(-0.05, 0.05);
    if (answer(cell, u1, u2).closed == want_taut && contact_is_constant(cell, u1, u2, margin))
      states.push_back({p, u1, u2, want_taut});
  }
  return states;
}

}  // namespace verify
