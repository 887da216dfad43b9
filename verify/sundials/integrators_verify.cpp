// Independent time integrators of the same model: what the reference is worth, and the order of the
// explicit scheme against it.

#include "sundials/scenes.hpp"
#include "support/plots.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace {

using namespace reference_scenes;
using verify::claim;

/// Largest displacement of any node at the times of the frames.
double displacement(const SphereSheet& sheet, const Frames& frames) {
  const Frames start(frames.size(), positions(sheet.model<double>()));
  return reference_scenes::distance(start, frames);
}

}  // namespace

TEST_SUITE_BEGIN("reference");

TEST_CASE("V-REF-03 Runge-Kutta of order 5 and Adams agree on a drape over a sphere") {
  const SphereSheet sheet;
  const Frames a = frames<reference::RungeKutta5>(sheet, {1e-10, 1e-10});
  const Frames b = frames<reference::Adams>(sheet, {1e-10, 1e-10});
  const double moved = displacement(sheet, a);
  REQUIRE(moved > 13.9);                            // the ball lifted the middle
  REQUIRE(a.back()[sheet.elements / 2].x() > 1);           // and drew the rim in
  REQUIRE(a.back()[0].z() == a.front()[0].z());     // which stays in its plane
  double gap = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    gap = std::max(gap, scenes::distance(a[k], b[k]));
  // Both control their errors at 1e-10 a step; contact and slackness have kinks in higher
  // derivatives, where the estimates are of low order.
  claim("V-REF-03", gap / moved, 1e-7, "gap at ten times over the largest displacement");
}

TEST_CASE("V-REF-04 the explicit scheme approaches the reference with order 2") {
  // Yarns go slack and taut on the way and nodes come into contact: kinks in the derivatives of a
  // continuous force, which cost no order.
  const SphereSheet sheet;
  const Frames reference = frames<reference::RungeKutta5>(sheet, {1e-11, 1e-11});
  const int coarse =
      static_cast<int>(std::ceil(sheet.duration / 10 / (0.4 * sheet.model<double>().critical_step())));
  verify::Plot plot{"V-REF-04", "Explicit scheme against Runge-Kutta of order 5", "time step [ms]",
                    "largest distance of any node at ten times [mm]", true, true, {},
                    "The slope is the order; the reference's own uncertainty is 1e-8 mm (V-REF-03)."};
  verify::Curve curve{"central differences", {}, {}};
  double before = 0, worst = 0;
  std::string table;
  for (int k = 0; k <= 3; ++k) {
    const int steps = coarse << k;
    const double error = reference_scenes::distance(explicit_frames(sheet, steps), reference);
    curve.x.push_back(sheet.duration / 10 / steps);
    curve.y.push_back(error);
    table += "\n  " + std::to_string(10 * steps) + " steps: " + std::to_string(1e6 * error) + " nm";
    if (k > 0) {
      table += ", order " + std::to_string(std::log2(before / error));
      worst = std::max(worst, std::abs(std::log2(before / error) - 2));
    }
    before = error;
  }
  INFO(table);
  plot.curves.push_back(curve);
  plot.curves.push_back(verify::guide("order 2", 2, curve));
  verify::show(plot);
  REQUIRE(before > 3e-9);  // above the uncertainty of the reference
  claim("V-REF-04", worst, 0.05, "distance of the order from 2, three halvings");
}

TEST_CASE("V-REF-05 backward differences by rate and by residual reach the same drape") {
  SphereSheet sheet;
  sheet.elements = 6;
  sheet.stroke = 4;
  const Frames a = frames<reference::RungeKutta5>(sheet, {1e-9, 1e-9});
  const double moved = displacement(sheet, a);
  REQUIRE(moved > 3.9);
  const auto compare = [&](const Frames& b, const std::string& name) {
    // Two thousand steps at 1e-6 each, damped.
    claim("V-REF-05", reference_scenes::distance(a, b), 1e-4, name);
  };
  compare(frames<reference::BackwardDifferences>(sheet, {1e-6, 1e-6}),
          "CVODE's backward differences with the sparse tangent [mm]");
  compare(frames<reference::ResidualForm>(sheet, {1e-6, 1e-6}), "IDA on residuals [mm]");
}

TEST_SUITE_END();
