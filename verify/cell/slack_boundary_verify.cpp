// Finite differences across the boundary of slackness, where the tangent jumps.

#include "cell/states.hpp"
#include "support/claim.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace {

using verify::answer;
using verify::Cell;
using verify::Parameters;

/// A state at which the contact just touches, and the tangents of its two sides.
template <class R>
struct Boundary {
  crossbeam::CrossedBeamCell<R> cell;
  R u1, u2;
  crossbeam::CellForces<R> at;
  crossbeam::CellTangent<R> taut, slack;

  Boundary(const Parameters& p, R warp_elongation, R weft_elongation)
      : cell(verify::converted<R>(p)), u1(warp_elongation), u2(weft_elongation) {
    auto s = cell.solve(u1, u2);
    REQUIRE(s.status == crossbeam::CellStatus::converged);
    at = s.forces;
    s.contact_stiffness = cell.contact_stiffness();
    taut = cell.tangent(u1, u2, s);
    s.contact_stiffness = 0;
    slack = cell.tangent(u1, u2, s);
  }

  /// Error of the one-sided difference quotient over a strain `step`, in the direction (d1, d2),
  /// against a tangent; relative to EA/l0.
  [[nodiscard]] double error(double step, double d1, double d2,
                             const crossbeam::CellTangent<R>& K) const {
    const R a = R(step) * R(d1) * cell.warp().L, b = R(step) * R(d2) * cell.weft().L;
    const auto moved = answer(cell, u1 + a, u2 + b).forces;
    const R size = R(std::abs(step)) *
                   std::max(cell.warp().ka * cell.warp().L, cell.weft().ka * cell.weft().L);
    return static_cast<double>(std::max(std::abs(moved.F1 - at.F1 - (K.K11 * a + K.K12 * b)),
                                        std::abs(moved.F2 - at.F2 - (K.K12 * a + K.K22 * b))) /
                               size);
  }
};

/// The warp elongation at which the contact closes, by bisection; with bending.
template <class R>
R closing_elongation(const Parameters& p, R u2) {
  const crossbeam::CrossedBeamCell<R> cell(verify::converted<R>(p));
  R slack = R(-0.1) * cell.warp().L, taut = R(0.1) * cell.warp().L;
  REQUIRE(!answer(cell, slack, u2).closed);
  REQUIRE(answer(cell, taut, u2).closed);
  for (int k = 0; k < 70; ++k) {
    const R middle = (slack + taut) / 2;
    (answer(cell, middle, u2).closed ? taut : slack) = middle;
  }
  return taut;
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-32 differences approach the tangent of their own side of the slack boundary") {
  VERIFY_RANDOM(random, 2032);
  verify::Worst order, best;
  double least_rise = 1e300, least_jump = 1e300;
  for (int sample = 0; sample < 40; ++sample) {
    Parameters p = sample % 2 == 0 ? verify::table_1() : verify::random_fabric(random);
    for (auto* yarn : {&p.warp, &p.weft})
      yarn->second_moment_of_area = std::max(yarn->second_moment_of_area, 1e-6);
    const Cell cell(p);
    double u2;
    do {
      u2 = cell.weft().L * random.uniform(-0.01, 0.01);
    } while (answer(cell, -0.1 * cell.warp().L, u2).closed ||
             !answer(cell, 0.1 * cell.warp().L, u2).closed);
    const Boundary<double> b(p, closing_elongation(p, u2), u2);
    const long double v2 = u2;
    const Boundary<long double> fine(p, closing_elongation(p, v2), v2);
    const double d1 = random.uniform(0.5, 1), d2 = random.uniform(0.5, 1);
    for (const double side : {1.0, -1.0}) {  // longer yarns are taut
      const char* name = side > 0 ? "taut" : "slack";
      const auto& own = side > 0 ? b.taut : b.slack;
      const auto& other = side > 0 ? b.slack : b.taut;
      // The order needs a decade above the rounding: long double.
      const auto result = verify::taylor_test(
          1,
          [&](double step) {
            return fine.error(side * step, d1, d2, side > 0 ? fine.taut : fine.slack);
          },
          1e-3, 1e-10);
      order.see(result.deviation, name, "sample", sample, result.table);
      double least = 1e300, rounding = 0;
      for (double step = 1e-3; step > 1e-13; step /= 2)
        least = std::min(least, b.error(side * step, d1, d2, own));
      for (const double step : {1e-13, 2e-13, 3e-13})
        rounding = std::max(rounding, b.error(side * step, d1, d2, own));
      best.see(least, name, "sample", sample);
      least_rise = std::min(least_rise, rounding / least);
      least_jump = std::min(least_jump, b.error(side * 1e-8, d1, d2, other));
    }
  }
  // Over a decade the next term of the series is some hundredth of the first.
  order.claim("V-CELL-32", 0.02,
              "|order - 1| of one-sided differences against their side's tangent");
  // The V of truncation and rounding has its tip at a step of the size of eps^(1/2).
  best.claim("V-CELL-32", 1e-6, "least error over all steps, relative to EA/l0");
  verify::claim("V-CELL-32", least_rise, 10, "error at steps of 1e-13 over the least one",
                verify::Bound::lower);
  verify::claim("V-CELL-32", least_jump, 1e-5,
                "distance of the differences from the other side's tangent, relative to EA/l0",
                verify::Bound::lower);

  // At the origin both sides have closed forms, and F = 0: no digits are lost.
  const Cell cell(verify::table_1());
  const auto& y = cell.warp();
  const double c = y.c0 * y.c0, s = y.s0 * y.s0, k3 = cell.contact_stiffness();
  const double sum =
      y.ka * c + y.kb * s - (y.ka - y.kb) * (y.ka - y.kb) * c * s / (y.ka * s + y.kb * c + 2 * k3);
  const double difference = y.ka * y.kb / (y.ka * s + y.kb * c);
  const double step = 1e-12 * y.L;
  const double ahead = answer(cell, step, 0).forces.F1 / step;
  const double behind = answer(cell, -step, 0).forces.F1 / -step;
  const double taut = (sum + difference) / 2;
  // What is left is the step over the squared crimp angle, 1e-10.
  verify::claim("V-CELL-32", std::abs(ahead / taut - 1), 1e-9,
                "origin, stretched: 6.776 kN/mm in closed form, relative");
  verify::claim("V-CELL-32", std::abs(behind / difference - 1), 1e-9,
                "origin, shortened: 0.0262 kN/mm in closed form, relative");
  verify::claim("V-CELL-32", std::abs(ahead / behind - 258.936), 1e-3,
                "ratio of the jump, 258.936");

  const double u2 = 0.01 * y.L;
  const Boundary<double> b(verify::table_1(), closing_elongation(verify::table_1(), u2), u2);
  verify::Curve on_taut{"taut side, taut tangent", {}, {}},
      on_slack{"slack side, slack tangent", {}, {}}, wrong{"taut side, slack tangent", {}, {}};
  for (double h = 1e-2; h > 1e-14; h /= 2) {
    const auto add = [&](verify::Curve& curve, double side, const auto& K) {
      curve.x.push_back(h);
      curve.y.push_back(std::max(b.error(side * h, 1, 1, K), 1e-17));
    };
    add(on_taut, 1, b.taut);
    add(on_slack, -1, b.slack);
    add(wrong, 1, b.slack);
  }
  verify::show(verify::Plot{"V-CELL-32",
                            "One-sided differences at the slack boundary, weft +1 %",
                            "step [strain]",
                            "error of the difference quotient over EA/l0 [-]",
                            true,
                            true,
                            {on_taut, on_slack, wrong},
                            "Each side has its V, truncation from the right and rounding from the "
                            "left; against the other "
                            "side's tangent no step helps."});
}

TEST_SUITE_END();
