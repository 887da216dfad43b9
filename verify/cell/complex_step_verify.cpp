// Derivatives of the cell by the complex step, through every sweep of the solver.

#include "support/complex_step.hpp"

#include "cell/states.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace {

using crossbeam::SolverControl;
using verify::answer;
using verify::Cell;
using verify::ComplexStep;

/// dU/du and dF/du of one column each, after a fixed number of sweeps in complex numbers.
struct ByComplexStep {
  double F[2], K[2][2];

  ByComplexStep(const Cell& cell, double u1, double u2, int sweeps) {
    for (int j = 0; j < 2; ++j) {
      const ComplexStep a = j == 0 ? ComplexStep::variable(u1) : ComplexStep(u1);
      const ComplexStep b = j == 1 ? ComplexStep::variable(u2) : ComplexStep(u2);
      const auto s = cell.solve(a, b, SolverControl::fixed(sweeps));
      F[j] = cell.energy(a, b, s).derivative();
      K[0][j] = s.forces.F1.derivative();
      K[1][j] = s.forces.F2.derivative();
    }
  }
  [[nodiscard]] double error_of_tangent(const crossbeam::CellTangent<double>& t) const {
    return std::max({std::abs(K[0][0] - t.K11), std::abs(K[0][1] - t.K12),
                     std::abs(K[1][0] - t.K12), std::abs(K[1][1] - t.K22)});
  }
};

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-31 the complex step through the iteration gives forces and tangent") {
  VERIFY_RANDOM(random, 2031);
  verify::Worst forces, tangents, one_more;
  double one_less = 0;
  for (const bool bending : {true, false})
    for (const auto& s : verify::states_on_both_sides(random, 400, 1e-5, bending)) {
      const Cell cell(s.parameters);
      const auto at = answer(cell, s.u1, s.u2);
      REQUIRE(verify::converged(at));
      const double ka = std::max(cell.warp().ka, cell.weft().ka);
      const double u = std::max(std::abs(s.u1), std::abs(s.u2));
      const auto see = [&](verify::Worst& worst, double error) {
        worst.see(error, s.taut ? "taut" : "slack", "u =", s.u1, s.u2, "sweeps", at.sweeps);
      };
      const ByComplexStep d(cell, s.u1, s.u2, at.sweeps + 2);
      see(forces,
          std::max(std::abs(d.F[0] - at.forces.F1), std::abs(d.F[1] - at.forces.F2)) / (ka * u));
      see(tangents, d.error_of_tangent(at.tangent) / ka);
      if (at.sweeps < 2) continue;
      // The solver's last sweep only confirms: one more leaves no doubt in the derivatives either.
      see(one_more,
          ByComplexStep(cell, s.u1, s.u2, at.sweeps + 1).error_of_tangent(at.tangent) / ka);
      one_less = std::max(
          one_less,
          ByComplexStep(cell, s.u1, s.u2, at.sweeps - 1).error_of_tangent(at.tangent) / ka);
    }
  // The same formulas in another arithmetic: some roundings of the terms.
  forces.claim("V-CELL-31", 1e-14, "dU/du against F, relative to EA/l0 u");
  tangents.claim("V-CELL-31", 1e-14, "dF/du against the tangent, relative to EA/l0");
  one_more.claim("V-CELL-31", 1e-14, "the same one sweep after the solver's last");
  // They are derivatives of the iteration, not of the closed form: too few sweeps show.
  verify::claim("V-CELL-31", one_less, 1e-12, "one sweep before the solver's last: not yet",
                verify::Bound::lower);

  // 1 % along the warp of Table 1.
  const Cell cell(verify::table_1());
  const auto at = answer(cell, 0.025, 0);
  verify::Curve value{"force", {}, {}}, slope{"tangent by complex step", {}, {}};
  for (int sweeps = 1; sweeps <= 6; ++sweeps) {
    const auto s = cell.solve(0.025, 0.0, SolverControl::fixed(sweeps));
    const double F = std::abs(s.forces.F1 - at.forces.F1) / at.forces.F1;
    const double K =
        ByComplexStep(cell, 0.025, 0, sweeps).error_of_tangent(at.tangent) / at.tangent.K11;
    for (auto [curve, y] : {std::pair{&value, F}, std::pair{&slope, K}}) {
      curve->x.push_back(sweeps);
      curve->y.push_back(std::max(y, 1e-17));
    }
  }
  verify::show(
      verify::Plot{"V-CELL-31",
                   "Newton seen through the complex step",
                   "sweeps",
                   "relative error [-]",
                   false,
                   true,
                   {value, slope},
                   "Every sweep squares both errors: the iteration itself is differentiated "
                   "and converges to the tangent. (1e-17 stands for zero.)"});
}

TEST_SUITE_END();
