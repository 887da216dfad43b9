// Independent time integrators of the same model: what the reference is worth, and the order of the
// explicit scheme against it.

#include "sundials/scenes.hpp"
#include "support/plots.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

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
  REQUIRE(moved > 13.9);                          // the ball lifted the middle
  REQUIRE(a.back()[sheet.elements / 2].x() > 1);  // and drew the rim in
  REQUIRE(a.back()[0].z() == a.front()[0].z());   // which stays in its plane
  double gap = 0;
  for (std::size_t k = 0; k < a.size(); ++k) gap = std::max(gap, scenes::distance(a[k], b[k]));
  // Both control their errors at 1e-10 a step; contact and slackness have kinks in higher
  // derivatives, where the estimates are of low order.
  claim("V-REF-03", gap / moved, 1e-7, "gap at ten times over the largest displacement");
}

TEST_CASE("V-REF-04 the explicit scheme approaches the reference with order 2") {
  // Yarns go slack and taut on the way and nodes come into contact: kinks in the derivatives of a
  // continuous force, which cost no order.
  const SphereSheet sheet;
  const Frames reference = frames<reference::RungeKutta5>(sheet, {1e-11, 1e-11});
  const int coarse = static_cast<int>(
      std::ceil(sheet.duration / 10 / (0.4 * sheet.model<double>().critical_step())));
  verify::Plot plot{
      "V-REF-04",
      "Explicit scheme against Runge-Kutta of order 5",
      "time step [ms]",
      "largest distance of any node at ten times [mm]",
      true,
      true,
      {},
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

TEST_CASE("V-REF-09 the fast vector operations are those of SUNDIALS, in place too") {
  VERIFY_RANDOM(random, 909);
  ::sundials::Context context;
  verify::Worst worst;
  const auto fill = [&](N_Vector v) {
    for (sunindextype i = 0; i < N_VGetLength(v); ++i)
      N_VGetArrayPointer(v)[i] = random.uniform(-2, 2);
  };
  const auto off = [](N_Vector a, N_Vector b) {
    double out = 0;
    for (sunindextype i = 0; i < N_VGetLength(a); ++i)
      out = std::max(out, std::abs(N_VGetArrayPointer(a)[i] - N_VGetArrayPointer(b)[i]));
    return out;
  };
  for (const int n : {1, 7, 8, 255, 256, 257, 1000}) {
    constexpr int count = 6;
    std::vector<std::unique_ptr<reference::Vector>> fast;
    std::vector<N_Vector> x, y;
    sunrealtype c[count];
    for (int k = 0; k < count; ++k) {
      fast.push_back(std::make_unique<reference::Vector>(n, context));
      x.push_back(*fast.back());
      y.push_back(N_VNew_Serial(n, context));  // with the library's operations
      fill(x.back());
      N_VScale_Serial(1, x.back(), y.back());
      c[k] = random.uniform(-1, 1);
    }
    N_Vector clone = N_VClone(x[0]);
    REQUIRE((clone->ops->nvlinearcombination == x[0]->ops->nvlinearcombination));
    REQUIRE((clone->ops->nvlinearcombination != y[0]->ops->nvlinearcombination));
    for (int used = 1; used <= count; ++used) {
      N_VLinearCombination(used, c, x.data(), x[0]);  // into the first of them
      N_VLinearCombination_Serial(used, c, y.data(), y[0]);
      worst.see(off(x[0], y[0]), "combination of", used, "length", n);
    }
    for (int into : {0, 1, 2}) {
      N_VLinearSum(c[0], x[0], c[1], x[1], x[into]);
      N_VLinearSum_Serial(c[0], y[0], c[1], y[1], y[into]);
      worst.see(off(x[into], y[into]), "sum into", into, "length", n);
      N_VScale(c[2], x[1], x[into]);
      N_VScale_Serial(c[2], y[1], y[into]);
      worst.see(off(x[into], y[into]), "scaled into", into, "length", n);
    }
    worst.see(std::abs(N_VWrmsNorm(x[3], x[4]) - N_VWrmsNorm_Serial(y[3], y[4])), "norm, length",
              n);
    N_VDestroy(clone);
    for (N_Vector v : y) N_VDestroy(v);
  }
  // Numbers up to 10, summed in another order.
  worst.claim("V-REF-09", 1e-13, "difference of any entry");
}

TEST_SUITE_END();
