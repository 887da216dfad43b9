// The cell that is followed: one residual evaluation per step, at the heights of the last one.

#include "cell/states.hpp"
#include "crossbeam/base/simd.hpp"

#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace {

using crossbeam::CrimpHeights;
using crossbeam::Pack;
using verify::Cell;
using verify::Parameters;

CrimpHeights<double> equilibrium(const Cell& cell, double u1, double u2) {
  const auto s = cell.solve(u1, u2);
  return {s.forces.w1, s.forces.w2};
}

/// Largest force error, as a strain of the yarn, along a closed path of elongations in `steps`.
double path_error(const Cell& cell, double centre, double amplitude, int steps, bool& slack,
                  bool& taut) {
  const double L1 = cell.warp().L, L2 = cell.weft().L;
  const auto u = [&](int k, int yarn) {
    const double angle = 2 * std::numbers::pi * k / steps;
    return centre + amplitude * (yarn == 0 ? std::sin(angle) : std::cos(2 * angle));
  };
  CrimpHeights<double> heights = equilibrium(cell, L1 * u(0, 0), L2 * u(0, 1));
  double worst = 0;
  for (int k = 1; k <= steps; ++k) {
    const double u1 = L1 * u(k, 0), u2 = L2 * u(k, 1);
    const auto now = cell.follow(u1, u2, heights);
    const auto exact = cell.solve(u1, u2);
    slack = slack || !(exact.contact_stiffness > 0);
    taut = taut || exact.contact_stiffness > 0;
    worst = std::max({worst, std::abs(now.F1 - exact.forces.F1) / (cell.warp().ka * L1),
                      std::abs(now.F2 - exact.forces.F2) / (cell.weft().ka * L2)});
  }
  return worst;
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE(
    "V-CELL-35 a followed cell has the forces of the equilibrium with second order in the step") {
  const Cell cell(verify::table_1());
  verify::Plot plot{
      "V-CELL-35",
      "Followed cell along a closed path",
      "steps around the path",
      "largest force error [strain of the yarn]",
      true,
      true,
      {},
      "Taut: 0.5 to 1.5 % both ways. Slack: -1.5 to -0.5 %. Across: through slackness "
      "and back, where the tangent jumps by a factor 259."};
  const auto orders = [&](const char* name, double centre, double amplitude, bool want_slack,
                          bool want_taut, double order) {
    verify::Curve curve{name, {}, {}};
    std::vector<double> error;
    bool slack = false, taut = false;
    for (int steps = 1000; steps <= 32000; steps *= 2) {
      error.push_back(path_error(cell, centre, amplitude, steps, slack, taut));
      curve.x.push_back(steps);
      curve.y.push_back(error.back());
    }
    REQUIRE(slack == want_slack);
    REQUIRE(taut == want_taut);
    REQUIRE(error.back() > 1e-13);  // not yet rounding
    plot.curves.push_back(curve);
    const double measured = std::log2(error.front() / error.back()) / 5;
    verify::claim("V-CELL-35", measured, order, std::string(name) + ": order over five halvings",
                  verify::Bound::lower);
    return error;
  };
  // One Newton correction from a point that is off by dw leaves dw^2; dw is the step. Across the
  // slack boundary, where the tangent jumps, the step that meets it is of first order.
  orders("taut", 0.01, 0.005, false, true, 1.9);
  orders("slack", -0.01, 0.005, true, false, 1.9);
  const auto across = orders("across", 0.0, 0.01, true, true, 0.9);
  // 37 548 steps of the double dome: strains of a per cent in thousands of steps.
  verify::claim("V-CELL-35", across.back(), 1e-7,
                "largest error across slackness in 32 000 steps, strain of the yarn");
  verify::show(plot);

  // At rest the equilibrium stays: the fixed point of the correction is the solution.
  VERIFY_RANDOM(random, 1235);
  verify::Worst rest, returns;
  int compared = 0;
  for (const verify::State& s : verify::states_on_both_sides(random, 400, 1e-4)) {
    const Cell any(s.parameters);
    CrimpHeights<double> heights = equilibrium(any, s.u1, s.u2);
    const auto exact = any.solve(s.u1, s.u2);
    const double force = std::max(any.warp().ka * any.warp().L, any.weft().ka * any.weft().L);
    const auto error = [&](const crossbeam::YarnForces<double>& F) {
      return std::max(std::abs(F.F1 - exact.forces.F1), std::abs(F.F2 - exact.forces.F2)) / force;
    };
    rest.see(error(any.follow(s.u1, s.u2, heights)), "state", compared);
    // Heights thrown off by a tenth of the yarns' distance come back.
    heights.w1 += 0.1 * s.parameters.contact_length * random.uniform(-1, 1);
    heights.w2 += 0.1 * s.parameters.contact_length * random.uniform(-1, 1);
    crossbeam::YarnForces<double> F{};
    for (int k = 0; k < 60; ++k) F = any.follow(s.u1, s.u2, heights);
    returns.see(error(F), "state", compared++);
  }
  rest.claim("V-CELL-35", 1e-14, "at rest, error of the force over EA/l0 L: some roundings");
  returns.claim("V-CELL-35", 1e-13, "after 60 evaluations from heights that were off by a tenth");

  // Without bending: exactly nothing where the yarns are slack, at the heights that solve() has.
  // The yarns differ, so that nobody takes one for the other.
  Parameters unequal = verify::table_1_without_bending();
  unequal.weft.length *= 1.2;
  unequal.weft.cross_section *= 1.5;
  unequal.warp_height_fraction = 0.4;
  const Cell bare(unequal);
  int wrong = 0, slack = 0;
  for (int k = 0; k < 2000; ++k) {
    const double u1 = bare.warp().L * random.uniform(-0.05, 0.02);
    const double u2 = bare.weft().L * random.uniform(-0.05, 0.02);
    CrimpHeights<double> heights = equilibrium(bare, u1 + 1e-5, u2 - 1e-5);
    const auto now = bare.follow(u1, u2, heights);
    const auto exact = bare.solve(u1, u2);
    if (exact.contact_stiffness > 0) continue;
    ++slack;
    wrong += !(std::abs(now.F1 - exact.forces.F1) <= 1e-14 &&
               std::abs(now.F2 - exact.forces.F2) <= 1e-14 &&
               std::abs(heights.w1 - exact.forces.w1) <= 1e-14 &&
               std::abs(heights.w2 - exact.forces.w2) <= 1e-14);
  }
  REQUIRE(slack > 500);
  verify::claim("V-CELL-35", wrong, 0,
                "slack states without bending whose force or heights are not solve()'s");

  // The two guards: the tangent of a height without a spring, and the largest step of a height.
  verify::Worst guards;
  for (const auto* yarn : {&bare.warp(), &bare.weft()}) {
    const auto idle = Cell::evaluate_yarn(*yarn, -0.1 * yarn->L, 0.0);
    guards.see(std::abs(idle.D / (1e-6 * yarn->ka) - 1), "least tangent");
  }
  const Cell tight(verify::table_1());
  const double step = tight.parameters().contact_length / 8;
  for (const double off : {-1.0, 1.0}) {
    const CrimpHeights<double> rest = equilibrium(tight, 0.02, 0.02);
    CrimpHeights<double> heights{rest.w1 + 4 * step * off, rest.w2 + 4 * step * off};
    const CrimpHeights<double> before = heights;
    tight.follow(0.02, 0.02, heights);
    guards.see(std::abs(std::abs(heights.w1 - before.w1) / step - 1), "step of the warp", off);
    guards.see(std::abs(std::abs(heights.w2 - before.w2) / step - 1), "step of the weft", off);
  }
  guards.claim("V-CELL-35", 1e-14, "guards off 1e-6 EA/l0 and L3/8, relative: a sum's rounding");

  // Wild jumps give finite forces and heights that come back, in both precisions.
  int lost = 0;
  const auto jumps = [&]<class R>(R) {
    const crossbeam::CrossedBeamCell<R> c(verify::table_1().cast<R>());
    CrimpHeights<R> heights{};
    for (int k = 0; k < 3000; ++k) {
      const R u1 = R(2.5 * random.uniform(-0.5, 0.3)), u2 = R(2.5 * random.uniform(-0.5, 0.3));
      const auto F = c.follow(u1, u2, heights);
      lost += !(std::isfinite(F.F1) && std::isfinite(F.F2) && std::isfinite(heights.w1) &&
                std::isfinite(heights.w2));
    }
  };
  jumps(1.0);
  jumps(1.0F);
  verify::claim("V-CELL-35", lost, 0, "jumps of up to 50 % whose answer is NaN");

  // Lanes.
  int differ = 0;
  const auto lanes = [&]<class P>(P) {
    using R = crossbeam::real_t<P>;
    constexpr int N = crossbeam::lanes_v<P>;
    const crossbeam::CrossedBeamCell<R> c(verify::table_1().cast<R>());
    for (int k = 0; k < 500; ++k) {
      std::array<R, N> u1, u2, w1, w2;
      for (int l = 0; l < N; ++l) {
        u1[l] = R(2.5 * random.uniform(-0.03, 0.03));
        u2[l] = R(2.5 * random.uniform(-0.03, 0.03));
        w1[l] = R(random.uniform(-0.1, 0.1));
        w2[l] = R(random.uniform(-0.1, 0.1));
      }
      CrimpHeights<P> packed{P::load(w1.data()), P::load(w2.data())};
      const auto F = c.follow(P::load(u1.data()), P::load(u2.data()), packed);
      for (int l = 0; l < N; ++l) {
        CrimpHeights<R> single{w1[l], w2[l]};
        const auto f = c.follow(u1[l], u2[l], single);
        differ += !(f.F1 == F.F1[l] && f.F2 == F.F2[l] && single.w1 == packed.w1[l] &&
                    single.w2 == packed.w2[l]);
      }
    }
  };
  lanes(Pack<double, 2>(0));
  lanes(Pack<double, 4>(0));
  lanes(Pack<float, 8>(0));
  verify::claim("V-CELL-35", differ, 0, "lanes that differ from the scalar in any bit");
}

TEST_SUITE_END();
