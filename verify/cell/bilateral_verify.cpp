// The bilateral contact, the paper's literal beam 3: where it agrees with the unilateral cell, and
// how it fails in compression. Pinned negative results.

#include "cell/states.hpp"
#include "crossbeam/base/simd.hpp"

#include "support/claim.hpp"
#include "support/random.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace {

using crossbeam::CellStatus;
using verify::Answer;
using verify::answer;
using verify::converged;
using Bilateral = crossbeam::BilateralCell<double>;
using Pack = crossbeam::Pack<double, 2>;

/// Newton on the heights from a start of one's own, which finds the minima that the cell's start at
/// w = 0 does not reach. True when it ends at a minimum of the energy.
bool minimise(const Bilateral& cell, double u, double& w1, double& w2) {
  const double k3 = cell.contact_stiffness();
  for (int k = 0; k < 100; ++k) {
    const crossbeam::YarnState<double> y1(cell.warp(), u, w1), y2(cell.weft(), u, w2);
    const double r1 = y1.vertical_force(cell.warp()) + k3 * (w1 + w2);
    const double r2 = y2.vertical_force(cell.weft()) + k3 * (w1 + w2);
    const double a = y1.k_hh(cell.warp()) + k3, b = y2.k_hh(cell.weft()) + k3;
    const double det = a * b - k3 * k3;
    if (std::abs(r1) + std::abs(r2) < 1e-13) return a > 0 && det > 0;
    w1 -= (b * r1 - k3 * r2) / det;
    w2 -= (a * r2 - k3 * r1) / det;
  }
  return false;
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-18 the bilateral contact is unstable in compression and not unique") {
  const Bilateral cell(verify::table_1());
  const verify::Cell unilateral(verify::table_1());

  // Wherever the contact presses, both cells are one.
  verify::Worst taut;
  for (int i = -8; i <= 12; ++i)
    for (int j = -8; j <= 12; ++j) {
      const double u1 = 0.0025 * i * 2.5, u2 = 0.0025 * j * 2.5;
      const Answer a = answer(unilateral, u1, u2);
      if (!(a.forces.q > 0)) continue;
      const Answer b = answer(cell, u1, u2);
      REQUIRE(converged(b));
      taut.see(std::max({std::abs(a.forces.F1 - b.forces.F1), std::abs(a.forces.F2 - b.forces.F2),
                         std::abs(a.forces.q - b.forces.q), std::abs(a.energy - b.energy),
                         std::abs(a.tangent.K12 - b.tangent.K12)}),
               i, j);
    }
  REQUIRE(taut.seen() > 100);
  // Forces below 1 kN, stiffness below 20 kN/mm, to their rounding.
  taut.claim("V-CELL-18", 1e-13, "bilateral against unilateral cell where q > 0 [kN, mm]");

  // Balanced shortening: the condensed tangent loses its sign at 5e-5 already.
  const auto antisymmetric = [&](double strain) {
    const Answer a = answer(cell, strain * 2.5, strain * 2.5);
    REQUIRE(converged(a));
    return a.tangent.K11 - a.tangent.K12;
  };
  double stable = 0, unstable = -1e-3;
  REQUIRE(antisymmetric(stable) > 0);
  REQUIRE(antisymmetric(unstable) < 0);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (stable + unstable);
    (antisymmetric(middle) > 0 ? stable : unstable) = middle;
  }
  verify::claim("V-CELL-18", std::abs(stable / -4.84e-5 - 1), 1e-3,
                "strain at which the fabric of bilateral cells becomes unstable, against -4.84e-5");
  CHECK(answer(cell, stable * 2.5, stable * 2.5).forces.F1 ==
        doctest::Approx(-1.64e-3).epsilon(3e-3));

  // The cell itself bifurcates at -2.78 %, and from there says so.
  double says_fine = -0.02, says_unstable = -0.04;
  REQUIRE(answer(cell, -0.02 * 2.5, -0.02 * 2.5).status == CellStatus::converged);
  REQUIRE(answer(cell, -0.04 * 2.5, -0.04 * 2.5).status == CellStatus::unstable);
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (says_fine + says_unstable);
    const Answer a = answer(cell, middle * 2.5, middle * 2.5);
    (converged(a) ? says_fine : says_unstable) = middle;
  }
  verify::claim("V-CELL-18", std::abs(says_fine / -0.02780 - 1), 1e-3,
                "strain from which the status is `unstable`, against -2.780 %");

  // Beyond it one state has two stable answers, warp up or weft up, and the start decides.
  double up1 = 0.2, up2 = -0.2, down1 = -0.2, down2 = 0.2;
  REQUIRE(minimise(cell, -0.03 * 2.5, up1, up2));
  REQUIRE(minimise(cell, -0.03 * 2.5, down1, down2));
  verify::claim("V-CELL-18", std::abs(up1 - down1), 0.3,
                "height between two minima of the energy at (-3, -3) % [mm]", verify::Bound::lower);

  // And a yarn pulled through the mid-plane, in a state that the unilateral cell leaves slack.
  const Answer through = answer(cell, -0.125, 0);
  REQUIRE(converged(through));
  verify::claim("V-CELL-18", -through.forces.F2, 0.4, "compression of the weft at (-5, 0) % [kN]",
                verify::Bound::lower);
  CHECK(cell.weft().H + through.forces.w2 < 0);
  CHECK(std::abs(answer(unilateral, -0.125, 0).forces.F2) < 1e-12);

  // The status says what the eigenvalues of the energy's second derivative in the heights say, and
  // that an iteration has not ended; for any fabric.
  VERIFY_RANDOM(random, 2018);
  int at_minimum = 0, elsewhere = 0, maxima = 0, open_ended = 0;
  long wrong = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const auto fabric = verify::random_fabric(random);
    const Bilateral any(fabric);
    const double u1 = fabric.warp.length * random.uniform(-0.2, 0.1);
    const double u2 = fabric.weft.length * random.uniform(-0.2, 0.1);
    const auto s = any.solve(u1, u2);
    CAPTURE(sample);
    // Ten times the tolerance of the cell, eps^(3/4).
    if (s.last_correction > 2e-11 * fabric.contact_length) {
      ++open_ended;
      wrong += s.status != CellStatus::not_converged || s.sweeps != 50;
      continue;
    }
    if (s.status == CellStatus::not_converged) continue;
    const crossbeam::YarnState<double> y1(any.warp(), u1, s.forces.w1),
        y2(any.weft(), u2, s.forces.w2);
    const double k3 = any.contact_stiffness();
    const double a = y1.k_hh(any.warp()) + k3, b = y2.k_hh(any.weft()) + k3;
    const double least = (a + b) / 2 - std::hypot((a - b) / 2, k3);
    if (std::abs(least) < 1e-9 * (std::abs(a) + std::abs(b))) continue;
    (least > 0 ? at_minimum : elsewhere)++;
    wrong += (s.status == CellStatus::converged) != (least > 0);
    // A maximum, where the determinant alone would be content, beside a minimum in the other lane.
    if (a < 0 && a * b > k3 * k3) {
      ++maxima;
      Pack u1s(u1), u2s(u2);
      u1s.set(1, 0.01 * fabric.warp.length);
      u2s.set(1, 0.01 * fabric.weft.length);
      wrong += any.solve(u1s, u2s).status == CellStatus::converged;
    }
  }
  CAPTURE(at_minimum);
  CAPTURE(elsewhere);
  REQUIRE(at_minimum > 1000);
  REQUIRE(elsewhere > 1000);
  REQUIRE(maxima > 10);
  REQUIRE(open_ended > 10);
  verify::claim("V-CELL-18", static_cast<double>(wrong), 0,
                "random states whose status is not that of the least eigenvalue");

  // One lane is enough.
  Pack u1(0.01 * 2.5), u2(0.01 * 2.5);
  REQUIRE(cell.solve(u1, u2).status == CellStatus::converged);
  u1.set(1, -0.04 * 2.5);
  u2.set(1, -0.04 * 2.5);
  CHECK(cell.solve(u1, u2).status == CellStatus::unstable);
}

TEST_SUITE_END();
