// The formed double dome as an equilibrium.

#include "cases.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace crossbeam;
using verify::claim;

}  // namespace

TEST_SUITE_BEGIN("reference");

TEST_CASE(
    "V-REF-08 the formed double dome has a static equilibrium close to the explicit end state") {
  drape::DrapeCase scene = drape::load_scene(drape::scene_path("realistic"));
  REQUIRE(scene.blank.element_size == 5);
  scene.fabric.cell_solve = drape::CellSolve::sweeps;
  scene.fabric.cell_sweeps = 8;  // the tangent is that of the equilibrium
  scene.process.hold = 1;
  auto start = drape::dome_case<double>(scene);
  CentralDifference<NativePack<double>> run(std::move(start.model), TimeStep::fraction(0.9));
  while (run.time() < start.duration) run.step();
  const auto state = [&] {
    return drape::formed_state(run.model(), start.mesh, start.nx, start.ny);
  };
  const drape::FormedState before = state();
  StaticProblem problem(run.model(), run.time());
  std::vector<double> q(static_cast<std::size_t>(problem.unknowns()));
  problem.read(q.data());
  REQUIRE(problem.internal_force(q.data()) > 1e-3);  // a part in tension, not a limp sheet [kN]
  const auto r = reference::find_equilibrium(problem, {1e-10, 400});
  std::string history;
  for (double f : r.history) history += " " + std::to_string(std::log10(f));
  INFO("log10 of the unbalanced force:", history);
  const drape::Errors moved = compare(before, state());
  const std::size_t n = r.history.size();
  REQUIRE(n > 4);
  claim("V-REF-08", r.residual, 1e-10,
        "largest unbalanced force over the internal forces, " + std::to_string(r.iterations) +
            " iterations, " + std::to_string(r.backtracks) + " backtracks");
  // The digits double until they end in round-off, which may take two iterations: the order is that
  // of the last iteration that ended clearly above the last force.
  std::size_t last = n - 2;
  while (last > 2 && !(r.history[last] > 10 * r.history[n - 1])) --last;
  claim({"V-REF-08",
         std::log(r.history[last] / r.history[last - 1]) /
             std::log(r.history[last - 1] / r.history[last - 2]),
         1.5, "order of the last iteration above ten times the last force", verify::Bound::lower});
  // What the run has not yet damped out after a hold as long as the stroke: a tenth of an element's
  // error by its size.
  claim("V-REF-08", moved.largest, 0.3, "largest distance of a node from its equilibrium [mm]");
  claim("V-REF-08", moved.shear_rms, 0.1, "shear angles, rms [deg]");
}

TEST_SUITE_END();
