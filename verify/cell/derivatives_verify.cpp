// Forces are the gradient of the stored energy, the condensed tangent is the derivative of the
// forces: by the rate of Taylor remainders (which trust no dual numbers) and by dual numbers (which
// see to round-off).

#include "cell/states.hpp"
#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"

#include "support/claim.hpp"
#include "support/plots.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace {

using crossbeam::Dual;
using crossbeam::Pack;
using verify::Answer;
using verify::Cell;

// Remainders are taken in long double: three decades more before round-off ends the slope.
using LongCell = crossbeam::CrossedBeamCell<long double>;
using LongAnswer = verify::BasicAnswer<long double>;

/// Remainder of the energy after its Taylor polynomial of the given order, along h at (u1, u2).
/// `spoil` multiplies one term: the same test must then fail.
long double energy_remainder(const LongCell& cell, const verify::State& s, const LongAnswer& at,
                             double h1, double h2, double eps, int order, double spoil) {
  const long double a = static_cast<long double>(eps) * h1, b = static_cast<long double>(eps) * h2;
  const LongAnswer moved = verify::answer(cell, s.u1 + a, s.u2 + b);
  REQUIRE(verify::converged(moved));
  REQUIRE(moved.closed == s.taut);
  long double r = moved.energy - at.energy;
  if (order >= 1) r -= spoil * at.forces.F1 * a + at.forces.F2 * b;
  if (order >= 2)
    r -= (at.tangent.K11 * a * a + 2 * at.tangent.K12 * a * b + at.tangent.K22 * b * b) / 2;
  return r;
}

/// Some roundings of the yarns' forces, and of their work on the largest elongation.
double force_round_off(const LongCell& cell, const verify::State& s) {
  const double u = std::max(std::abs(s.u1), std::abs(s.u2));
  return static_cast<double>(20 * std::numeric_limits<long double>::epsilon() *
                             std::max(cell.warp().ka, cell.weft().ka)) *
         u;
}

constexpr double margin = 2e-3;  // strain within which the contact does not change

/// Derivatives of a cell at a state from Dual<S, 2> and from the nested Dual<Dual<S, 2>, 2>.
template <class S>
struct ByDuals {
  S F1, F2;                  // dU/du by dual numbers
  S K11, K12, K21, K22;      // dF/du by dual numbers
  S H11, H12, H22;           // d2U/du2 by nested dual numbers
  S K111, K122, F111, F122;  // dK11/du1, dK12/du2 by dual, d2F1/du1^2, d2F1/du2^2 by nested

  [[gnu::noinline]] ByDuals(const Cell& cell, const S& u1, const S& u2) {
    using D = Dual<S, 2>;
    const D a = D::variable(u1, 0), b = D::variable(u2, 1);
    const auto s = cell.solve(a, b);
    const D energy = cell.energy(a, b, s);
    F1 = energy.d[0];
    F2 = energy.d[1];
    K11 = s.forces.F1.d[0];
    K12 = s.forces.F1.d[1];
    K21 = s.forces.F2.d[0];
    K22 = s.forces.F2.d[1];
    using DD = Dual<D, 2>;
    const DD aa = DD::variable(a, 0), bb = DD::variable(b, 1);
    const auto nested = cell.solve(aa, bb);
    const DD twice = cell.energy(aa, bb, nested);
    const auto K = cell.tangent(a, b, s);
    K111 = K.K11.d[0];
    K122 = K.K12.d[1];
    F111 = nested.forces.F1.d[0].d[0];
    F122 = nested.forces.F1.d[1].d[1];
    H11 = twice.d[0].d[0];
    H12 = twice.d[0].d[1];
    H22 = twice.d[1].d[1];
  }
};

/// Largest relative deviation of dual from closed derivatives. Scales: forces relative to EA/l0
/// times the elongation, tangents relative to EA/l0: the terms of which they are made.
double deviation(const Cell& cell, const Answer& closed, double u1, double u2,
                 const ByDuals<double>& d) {
  const double ka = std::max(cell.warp().ka, cell.weft().ka);
  const double F = ka * std::max(std::abs(u1), std::abs(u2));
  const auto& f = closed.forces;
  const auto& K = closed.tangent;
  return std::max(
      {std::abs(d.F1 - f.F1) / F, std::abs(d.F2 - f.F2) / F, std::abs(d.K11 - K.K11) / ka,
       std::abs(d.K12 - K.K12) / ka, std::abs(d.K21 - K.K12) / ka, std::abs(d.K22 - K.K22) / ka,
       std::abs(d.H11 - K.K11) / ka, std::abs(d.H12 - K.K12) / ka, std::abs(d.H22 - K.K22) / ka});
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-03 forces are the energy's gradient and the tangent its second derivative") {
  VERIFY_RANDOM(random, 2003);
  verify::Worst first, second, third, spoiled;
  verify::Plot plot{"V-CELL-03",
                    "Taylor remainders of the stored energy",
                    "step, as a share of h",
                    "remainder [kN mm]",
                    true,
                    true,
                    {},
                    "A taut state of Table 1: each remainder falls with the power of the first "
                    "term left out, down to round-off; with a force wrong by 1e-3 the slope turns "
                    "from 2 to 1."};
  for (const auto& s : verify::states_on_both_sides(random, 80, margin)) {
    const LongCell cell(verify::converted<long double>(s.parameters));
    const LongAnswer at = verify::answer(cell, s.u1, s.u2);
    REQUIRE(verify::converged(at));
    REQUIRE(at.closed == s.taut);
    const double angle = random.uniform(0, 2 * M_PI);
    const double h1 = margin * s.parameters.warp.length * std::cos(angle);
    const double h2 = margin * s.parameters.weft.length * std::sin(angle);
    REQUIRE(std::abs(at.forces.F1 * h1) + std::abs(at.forces.F2 * h2) > 0);
    const double noise = 1e-3 * force_round_off(cell, s) * std::max(std::abs(s.u1), std::abs(s.u2));
    const bool drawn = plot.curves.size() < 4;
    const auto measure = [&](int order, double spoil, verify::Worst& worst, double first_step,
                             const char* name) {
      const auto result = verify::taylor_test(
          order + 1,
          [&](double eps) { return energy_remainder(cell, s, at, h1, h2, eps, order, spoil); },
          first_step, noise);
      worst.see(result.deviation, s.taut ? "taut" : "slack", "u =", s.u1, s.u2, result.table);
      if (drawn) plot.curves.push_back(verify::remainders(name, result));
    };
    measure(0, 1, first, 0.5, "energy alone");
    measure(1, 1, second, 1, "with forces");
    measure(2, 1, third, 1, "with forces and tangent");
    measure(1, 1 + 1e-3, spoiled, 1, "one force wrong by 1e-3");
  }
  for (const int power : {1, 2, 3})
    plot.curves.push_back(
        verify::guide("slope " + std::to_string(power), power, plot.curves[power - 1]));
  verify::show(plot);
  // A slope over a decade differs from the integer by the next term of the series: some eps / 10 at
  // the end of the table; a missing or wrong term makes it differ by 1.
  first.claim("V-CELL-03", 0.02, "|slope - 1| of the energy alone");
  second.claim("V-CELL-03", 0.02, "|slope - 2| with the forces");
  third.claim("V-CELL-03", 0.02, "|slope - 3| with forces and tangent");
  verify::claim("V-CELL-03", spoiled.value(), 0.5,
                "a force wrong by 1e-3 is seen (mutation of the test)", verify::Bound::lower);
}

TEST_CASE("V-CELL-04 the condensed tangent is the forces' derivative on both sides of slackness") {
  VERIFY_RANDOM(random, 2004);
  verify::Worst taut, slack, spoiled;
  for (const auto& s : verify::states_on_both_sides(random, 80, margin)) {
    const LongCell cell(verify::converted<long double>(s.parameters));
    const LongAnswer at = verify::answer(cell, s.u1, s.u2);
    REQUIRE(at.closed == s.taut);
    const double angle = random.uniform(0, 2 * M_PI);
    const double h1 = margin * s.parameters.warp.length * std::cos(angle);
    const double h2 = margin * s.parameters.weft.length * std::sin(angle);
    const auto& K = at.tangent;
    REQUIRE(std::abs(K.K11) + std::abs(K.K22) > 0);
    // Not a norm: a norm of two remainders is no smooth function, a projection is.
    const double p = random.uniform(0.3, 1), r = random.uniform(0.3, 1);
    const auto remainder = [&](double eps, double spoil) {
      const long double a = static_cast<long double>(eps) * h1;
      const long double b = static_cast<long double>(eps) * h2;
      const LongAnswer moved = verify::answer(cell, s.u1 + a, s.u2 + b);
      REQUIRE(moved.closed == s.taut);
      return p * (moved.forces.F1 - at.forces.F1 - (spoil * K.K11 * a + K.K12 * b)) +
             r * (moved.forces.F2 - at.forces.F2 - (K.K12 * a + K.K22 * b));
    };
    const double noise = force_round_off(cell, s);
    const auto result = verify::taylor_test(
        2, [&](double eps) { return remainder(eps, 1); }, 1, noise);
    (s.taut ? taut : slack)
        .see(result.deviation, s.taut ? "taut" : "slack", "u =", s.u1, s.u2, result.table);
    spoiled.see(verify::taylor_test(
                    2, [&](double eps) { return remainder(eps, 1.001); }, 1, noise)
                    .deviation);
  }
  // As in V-CELL-03.
  taut.claim("V-CELL-04", 0.02, "|slope - 2| of the force remainder, contact closed");
  slack.claim("V-CELL-04", 0.02, "|slope - 2| of the force remainder, contact open");
  verify::claim("V-CELL-04", spoiled.value(), 0.5,
                "a K11 wrong by 1e-3 is seen (mutation of the test)", verify::Bound::lower);
}

TEST_CASE("V-CELL-05 dual and nested dual numbers agree with the closed forms") {
  VERIFY_RANDOM(random, 2005);
  verify::Worst scalar, lanes, second;
  const auto see = [](verify::Worst& worst, const verify::State& s, double error) {
    worst.see(error, s.taut ? "taut" : "slack", "u =", s.u1, s.u2,
              "E2 =", s.parameters.weft.youngs_modulus, "L3 =", s.parameters.contact_length);
  };
  for (const bool bending : {true, false})
    for (const auto& s : verify::states_on_both_sides(random, 400, 1e-5, bending)) {
      const Cell cell(s.parameters);
      const Answer at = verify::answer(cell, s.u1, s.u2);
      REQUIRE(verify::converged(at));
      const ByDuals<double> d(cell, s.u1, s.u2);
      see(scalar, s, deviation(cell, at, s.u1, s.u2, d));
      // Energies hide an inexact second derivative of the heights, because they are stationary in
      // them; second derivatives of the forces do not. They are sums of terms that cancel, each of
      // the size of EA/l0 over a height.
      const double height = std::min(cell.warp().H + at.forces.w1, cell.weft().H + at.forces.w2);
      const double scale = std::max(
          {std::abs(d.K111), std::abs(d.K122), std::max(cell.warp().ka, cell.weft().ka) / height});
      if (height > 1e-3)
        see(second, s, std::max(std::abs(d.F111 - d.K111), std::abs(d.F122 - d.K122)) / scale);
    }
  // Lanes in different states of one fabric, taut and slack mixed.
  using P = Pack<double, 4>;
  int mixed = 0;
  for (int sample = 0; sample < 200; ++sample) {
    const Cell cell(sample % 2 == 0 ? verify::table_1() : verify::random_fabric(random));
    P u1, u2;
    int closed = 0;
    for (int i = 0; i < 4; ++i) {
      do {
        u1.set(i, cell.warp().L * random.uniform(-0.05, 0.05));
        u2.set(i, cell.weft().L * random.uniform(-0.05, 0.05));
      } while (!verify::contact_is_constant(cell, u1[i], u2[i], 1e-5));
      closed += verify::answer(cell, u1[i], u2[i]).closed;
    }
    mixed += closed > 0 && closed < 4;
    const ByDuals<P> d(cell, u1, u2);
    for (int i = 0; i < 4; ++i) {
      const Answer at = verify::answer(cell, u1[i], u2[i]);
      // One lane of the pack as a scalar record.
      ByDuals<double> lane(cell, u1[i], u2[i]);
      lane.F1 = d.F1[i];
      lane.F2 = d.F2[i];
      lane.K11 = d.K11[i];
      lane.K12 = d.K12[i];
      lane.K21 = d.K21[i];
      lane.K22 = d.K22[i];
      lane.H11 = d.H11[i];
      lane.H12 = d.H12[i];
      lane.H22 = d.H22[i];
      see(lanes, {cell.parameters(), u1[i], u2[i], at.closed},
          deviation(cell, at, u1[i], u2[i], lane));
    }
  }
  REQUIRE(mixed > 50);
  // Both run the same formulas from the same crimp heights: round-off alone may differ.
  scalar.claim("V-CELL-05", 1e-12, "Dual and nested Dual of double against F and K");
  second.claim("V-CELL-05", 1e-11, "second derivatives of F by nested against dual K");
  lanes.claim("V-CELL-05", 1e-12, "the same in the lanes of a pack of four");
}

TEST_SUITE_END();
