/// @file
/// The double dome as a whole: the case "realistic" against the bands of a preceding study, its
/// determinism, its energy ledger, its critical step, tension locking, precision, culling.
/// Theory: docs/theory/double_dome.md.

#include "drape.hpp"
#include "formed_part.hpp"
#include "presets.hpp"
#include "references.hpp"
#include "scene.hpp"
#include "support/claim.hpp"

#include "crossbeam/base/simd.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

namespace drape = crossbeam::drape;
using drape::DrapeCase;
using drape::DrapeResult;
using verify::Bound;
using verify::claim;

DrapeCase scene(const std::string& name) { return drape::load_scene(drape::scene_path(name)); }

DrapeCase realistic(double element_size, double speed) {
  DrapeCase c = scene("realistic");
  c.blank.element_size = element_size;
  c.process.speed = speed;
  c.output.frames = 1;
  return c;
}

DrapeResult run(const DrapeCase& c) { return drape::run(c, drape::Progress()); }

drape::References references() {
  return drape::load_references(drape::scene_folder() / "references.toml");
}

double shear(const DrapeResult& r, int point) { return r.shear_points.at(point - 1).shear_deg; }

/// Largest change of the shear angle at points 1 to `last` between two runs [deg].
double largest_change(const DrapeResult& a, const DrapeResult& b, int last) {
  double worst = 0;
  for (int p = 1; p <= last; ++p) worst = std::max(worst, std::abs(shear(a, p) - shear(b, p)));
  return worst;
}

bool same_bits(const DrapeResult& a, const DrapeResult& b) {
  const std::vector<double>&x = a.formed.points, &y = b.formed.points;
  return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) == 0;
}

/// What a run that has to stop says; empty when it runs to its end.
std::string reason_to_stop(const DrapeCase& c) {
  try {
    run(c);
  } catch (const crossbeam::RunError& error) {
    return error.what();
  }
  return {};
}

/// Linear interpolation of the outline's coordinate `of` at the value `at` of the other one.
double on_outline(const std::vector<std::array<double, 2>>& line, int of, double at) {
  const int other = 1 - of;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const auto &a = line[k], &b = line[k + 1];
    if ((a[other] - at) * (b[other] - at) <= 0 && a[other] != b[other])
      return a[of] + (at - a[other]) / (b[other] - a[other]) * (b[of] - a[of]);
  }
  return std::nan("");
}

}  // namespace

TEST_SUITE_BEGIN("drape");

namespace {

/// The bands are the study's own: its extrapolation over mesh and speed, and what two honest codes
/// may differ by.
/// @param left_out points that are not judged here
void lies_in_the_bands(const std::string& id, const DrapeResult& r,
                       const std::vector<int>& left_out = {}) {
  const drape::StudyReference study = references().study;
  REQUIRE(study.shear_deg.size() == 8);
  for (int p = 1; p <= 8; ++p)
    if (std::find(left_out.begin(), left_out.end(), p) == left_out.end())
      claim(id, std::abs(shear(r, p) - study.shear_deg[p - 1].value), study.shear_deg[p - 1].band,
            "deg, distance from the study at point " + std::to_string(p));
  for (int p : {9, 10})
    claim(id, std::abs(shear(r, p)), study.slack_flange_shear_deg,
          "deg, magnitude in the slack flange at point " + std::to_string(p));
  claim(id, std::abs(r.maximum_shear_deg - study.maximum_shear_deg.value),
        study.maximum_shear_deg.band, "deg, largest element angle");
  claim(id, std::abs(r.draw_in_x - study.draw_in_x.value), study.draw_in_x.band,
        "mm, draw-in along x");
  claim(id, std::abs(r.draw_in_y - study.draw_in_y.value), study.draw_in_y.band,
        "mm, draw-in along y");
  for (int i = 0; i < 2; ++i)
    claim(id, std::abs(r.corner[i] - study.corner[i].value), study.corner[i].band,
          i == 0 ? "mm, corner x" : "mm, corner y");
  claim(id, std::abs(r.ledger.back().shear - study.shear_energy.value), study.shear_energy.band,
        "kN mm, shear energy of the quarter");
  claim(id, std::abs(r.residual_over_punch_work), 1e-3, "ledger residual over punch work");
}

/// Shear angles along the diagonal, this run's between the study's bands.
void show_points(const std::string& id, const DrapeResult& r, const std::string& title) {
  verify::Curve found{title, {}, {}, verify::Curve::Style::line};
  verify::Curve low{"study, band", {}, {}, verify::Curve::Style::guide}, high = low;
  verify::Curve middle{"study", {}, {}, verify::Curve::Style::points};
  for (int p = 1; p <= 10; ++p) {
    found.x.push_back(p);
    found.y.push_back(shear(r, p));
  }
  int p = 0;
  for (const auto& value : references().study.shear_deg) {
    for (auto* curve : {&low, &high, &middle}) curve->x.push_back(p + 1);
    low.y.push_back(value.value - value.band);
    high.y.push_back(value.value + value.band);
    middle.y.push_back(value.value);
    ++p;
  }
  high.name = "";
  verify::show(verify::Plot{id,
                            "Double dome: shear angles, " + title,
                            "point on the diagonal",
                            "shear angle [deg]",
                            false,
                            false,
                            {found, middle, low, high},
                            "One high peak at point 5, a small one at point 8.",
                            false});
}

DrapeCase with_study_friction(double element_size, double speed) {
  DrapeCase c = realistic(element_size, speed);
  REQUIRE(c.contact.friction_model == crossbeam::Friction::elastic_stick);
  c.contact.friction_model = crossbeam::Friction::viscous;
  return c;
}

}  // namespace

// Point 2 depends on the friction model and is judged in V-DRAPE-02. On a mesh of 5 mm point 8, the
// small peak, is low by another 0.4 deg and at the edge of its band; the long run has it inside.
TEST_CASE("V-DRAPE-01 the realistic case at 5 mm and 1 m/s lies in the study's bands") {
  const DrapeResult slow = run(realistic(5, 1)), fast = run(realistic(5, 2));
  REQUIRE(slow.quads.size() == 27 * 47);
  lies_in_the_bands("V-DRAPE-01", slow, {2, 8});
  show_points("V-DRAPE-01", slow, "5 mm, 1 m/s");
  // Development runs are made at 2 m/s. Halving the speed may change the part by 0.5 deg: beyond
  // it, a run is not quasi-static.
  for (int p : {2, 3, 4, 5, 6})
    claim("V-DRAPE-01", std::abs(shear(fast, p) - shear(slow, p)), 0.5,
          "deg, 2 m/s against 1 m/s, 5 mm, at point " + std::to_string(p));
}

TEST_CASE("V-DRAPE-01 the realistic case at 2.5 mm and 1 m/s lies in the study's bands (long)") {
  const DrapeResult fine = run(realistic(2.5, 1));
  REQUIRE(fine.quads.size() == 54 * 94);
  lies_in_the_bands("V-DRAPE-01", fine, {2});
  show_points("V-DRAPE-01", fine, "2.5 mm, 1 m/s");
  // 5 mm at 2 m/s against it, as development runs are made. Point 5 sits on the peak, and a speed
  // of 2 m/s takes 0.25 deg off it whatever the mesh: at 1 m/s the same mesh has to come within
  // 0.3.
  const DrapeResult coarse = run(realistic(5, 2)), slow = run(realistic(5, 1));
  for (int p : {2, 3, 4, 6})
    claim("V-DRAPE-01", std::abs(shear(coarse, p) - shear(fine, p)), 0.3,
          "deg, 5 mm and 2 m/s against 2.5 mm and 1 m/s at point " + std::to_string(p));
  claim("V-DRAPE-01", std::abs(shear(coarse, 5) - shear(fine, 5)), 0.5,
        "deg, 5 mm and 2 m/s against 2.5 mm and 1 m/s at point 5, the peak");
  claim("V-DRAPE-01", std::abs(shear(slow, 5) - shear(fine, 5)), 0.3,
        "deg, 5 mm and 1 m/s against 2.5 mm and 1 m/s at point 5");
}

// The study ran a slip-rate friction; the elastic stick moves point 2 by 0.25 deg. With the study's
// own model all of the study's own numbers have to come out.
TEST_CASE("V-DRAPE-02 with the study's friction model all its points are met") {
  lies_in_the_bands("V-DRAPE-02", run(with_study_friction(5, 1)));
  claim("V-DRAPE-02", shear(run(realistic(5, 2)), 2) - shear(run(with_study_friction(5, 2)), 2),
        0.15, "deg that the elastic stick adds at point 2", Bound::lower);
}

TEST_CASE("V-DRAPE-02 with the study's friction model all its points are met at 2.5 mm (long)") {
  lies_in_the_bands("V-DRAPE-02", run(with_study_friction(2.5, 1)));
}

// What any drape that claims the benchmark has to show, independent of the study's digits.
TEST_CASE("V-DRAPE-03 the formed part is the benchmark's: peak, second maximum, draw-in, outline") {
  const drape::NetReference net = references().net;
  const DrapeResult r = run(realistic(5, 2));
  int peak = 1;
  for (int p = 1; p <= 10; ++p)
    if (shear(r, p) > shear(r, peak)) peak = p;
  CHECK(peak == 5);
  CHECK(shear(r, 5) > 33);
  CHECK(shear(r, 5) < 44);
  for (int p : {1, 10}) CHECK(std::abs(shear(r, p)) < 12);
  CHECK(shear(r, 8) > shear(r, 7));
  CHECK(shear(r, 8) > shear(r, 9));
  CHECK(shear(r, 8) > 5);
  CHECK(shear(r, 8) < 12);
  claim("V-DRAPE-03", std::abs(r.draw_in_x - 28.9), 0.6, "mm, draw-in x around 28.3 .. 29.5");
  claim("V-DRAPE-03", std::abs(r.draw_in_y - 25.1), 0.6, "mm, draw-in y around 24.5 .. 25.7");
  double worst = 0;
  int compared = 0;
  for (const auto& [x, y] : net.long_edge)
    if (y <= 75) {  // the straight part beside the ridge
      worst = std::max(worst, std::abs(on_outline(r.outline, 0, std::max(y, 0.5)) - x));
      ++compared;
    }
  for (const auto& [x, y] : net.short_edge)
    if (x <= 12.5 || x >= 87.5) {
      worst = std::max(worst, std::abs(on_outline(r.outline, 1, std::max(x, 0.5)) - y));
      ++compared;
    }
  REQUIRE(compared >= 4);
  claim("V-DRAPE-03", worst, 2.0, "mm between the outline and the net's on the straight parts");
}

// Rounding noise of 1e-9 mm must not show: bending makes the drape deterministic. Without it
// wrinkles localise and the same noise moves the answer by an order of magnitude more: pinned
// beside it.
namespace {

void noise_does_not_show(const std::vector<std::uint64_t>& seeds) {
  DrapeCase c = realistic(5, 2);
  c.output.frames = 2;
  const auto with_start = [&c](std::vector<double>& start) {
    return drape::run(c, drape::Progress(), [&start](const auto&, const drape::Frame& frame) {
      if (start.empty()) start = frame.points;
    });
  };
  std::vector<double> calm_start;
  const DrapeResult calm = with_start(calm_start);
  double worst = 0, largest_shift = 0;
  for (std::uint64_t seed : seeds) {
    c.blank.perturbation = 1e-9;
    c.blank.seed = seed;
    std::vector<double> noisy_start;
    const DrapeResult noisy = with_start(noisy_start);
    worst = std::max(worst, largest_change(calm, noisy, 8));
    for (std::size_t k = 0; k < calm_start.size(); ++k)
      largest_shift = std::max(largest_shift, std::abs(calm_start[k] - noisy_start[k]));
  }
  REQUIRE(largest_shift > 1e-10);  // the start really differs
  REQUIRE(largest_shift < 1e-8);
  claim("V-DRAPE-04", worst, 0.05, "deg, largest change at points 1 to 8");
}

}  // namespace

TEST_CASE("V-DRAPE-04 a start perturbation of 1e-9 mm moves points 1 to 8 by less than 0.05 deg") {
  noise_does_not_show({1});
  DrapeCase bare = scene("paper-literal");
  bare.fabric.formulation = drape::CellFormulation::energy;
  bare.output.frames = 1;
  const DrapeResult bare_calm = run(bare);
  bare.blank.perturbation = 1e-9;
  const DrapeResult bare_noisy = run(bare);
  claim("V-DRAPE-04", largest_change(bare_calm, bare_noisy, 8), 0.05,
        "deg, the same noise on a membrane without bending", Bound::lower);
}

TEST_CASE("V-DRAPE-04 and so do three other perturbations of 1e-9 mm (long)") {
  noise_does_not_show({2, 3, 4});
}

TEST_CASE("V-DRAPE-05 the energy ledger closes in double and in float, and every term is there") {
  DrapeCase c = realistic(5, 2);
  const DrapeResult r = run(c);
  const drape::LedgerRow& end = r.ledger.back();
  for (double term :
       {end.punch_work, end.yarn, end.shear, end.bending, end.hourglass, end.contact, end.kinetic,
        end.friction, end.contact_damping, end.mass_damping, end.bulk_viscosity})
    REQUIRE(term > 0);
  claim("V-DRAPE-05", std::abs(r.residual_over_punch_work), 1e-3,
        "largest residual over punch work, double");
  const double internal = end.yarn + end.shear + end.bending + end.hourglass;
  claim("V-DRAPE-05", end.hourglass / internal, 0.01, "hourglass share of the internal energy");
  claim("V-DRAPE-05", end.contact / internal, 1e-3, "contact share of the internal energy");
  c.integration.precision = drape::Precision::float_;
  const DrapeResult single = run(c);
  claim("V-DRAPE-05", std::abs(single.residual_over_punch_work), 1e-3,
        "largest residual over punch work, float");
  claim("V-DRAPE-05", largest_change(r, single, 8), 0.1,
        "deg, float against double at points 1 to 8");
}

// Nodes up to 1e-3 mm off their places are far out of equilibrium: v(0) = 0 and a(0) of the stiffest
// modes. The first sample counts m v(-1/2) v(+1/2) / 2, which the start's m v(0)^2 / 2 is not.
TEST_CASE("V-DRAPE-05 the ledger closes from a start out of equilibrium" *
          doctest::should_fail(true)) {
  DrapeCase c = realistic(5, 2);
  c.blank.perturbation = 1e-3;
  const DrapeResult r = run(c);
  claim("V-DRAPE-05", std::abs(r.residual_over_punch_work), 1e-3,
        "ledger residual over punch work, start perturbed by 1e-3 mm");
}

TEST_CASE("V-DRAPE-06 0.9 of the critical step runs, 1.5 of it blows up with a clear message") {
  DrapeCase c = realistic(5, 4);
  c.integration.step_factor = 0.9;
  CHECK_NOTHROW(run(c));
  c.integration.step_factor = 1.5;
  const std::string message = reason_to_stop(c);
  INFO("message: ", message);
  CHECK(message.find("time step") != std::string::npos);
}

// The taut yarn's modulus is a penalty in a drape: tension comes from shear, friction and
// slackness.
TEST_CASE("V-DRAPE-12 yarns ten times softer along give the same part with longer steps") {
  DrapeCase c = realistic(5, 2);
  c.contact.penalty = 0.005;  // else the contact's own step is the shorter one
  const DrapeResult stiff = run(c);
  c.integration.axial_scaling = 10;
  const DrapeResult soft = run(c);
  claim("V-DRAPE-12", static_cast<double>(stiff.cost.steps) / static_cast<double>(soft.cost.steps),
        2.5, "steps saved", Bound::lower);
  // The study: 0.06 deg at 1 m/s; 0.05 deg more for the noise of V-DRAPE-04 at 2 m/s.
  claim("V-DRAPE-12", largest_change(stiff, soft, 8), 0.15, "deg, change at points 1 to 8");
  claim("V-DRAPE-12",
        std::hypot(stiff.draw_in_x - soft.draw_in_x, stiff.draw_in_y - soft.draw_in_y), 0.1,
        "mm, change of the draw-in");
  claim("V-DRAPE-12", std::abs(soft.residual_over_punch_work), 1e-3,
        "largest residual over punch work");
  DrapeCase fast = realistic(5, 2);
  drape::apply_preset(fast, "fast");
  REQUIRE(fast.blank.element_size == c.blank.element_size);
  REQUIRE(fast.process.speed == c.process.speed);
  REQUIRE(fast.integration.axial_scaling == 25);
  claim("V-DRAPE-12", largest_change(stiff, run(fast), 8), 0.25,
        "deg, change at points 1 to 8 by the preset fast, 25 times softer and in float");
}

// Fibres at 45 deg to the mesh: with 2x2 points an element cannot shear without stretching its
// yarns somewhere, and stores energy in them. One point with hourglass control of shear size does
// not.
TEST_CASE("V-DRAPE-07 one point cures the tension locking of a mesh at 45 deg to the yarns") {
  DrapeCase c = realistic(5, 2);
  c.blank.layout = 45;
  const DrapeResult one = run(c);
  c.blank.gauss_points = 4;
  const DrapeResult four = run(c);
  claim("V-DRAPE-07", one.ledger.back().yarn / four.ledger.back().yarn, 0.1,
        "yarn energy with one point over that with 2x2: what 2x2 stores is locking, not fabric");
  claim("V-DRAPE-07", one.ledger.back().hourglass / one.ledger.back().shear, 0.05,
        "hourglass over shear energy with one point: the cure is not hidden stiffness");

  // Yarns along the mesh do not lock, at twice the speed either.
  DrapeCase aligned = realistic(5, 4);
  const DrapeResult aligned_one = run(aligned);
  aligned.blank.gauss_points = 4;
  const DrapeResult aligned_four = run(aligned);
  claim("V-DRAPE-07", aligned_one.ledger.back().yarn / aligned_four.ledger.back().yarn, 0.5,
        "the same ratio with the yarns along the mesh", Bound::lower);
}

TEST_CASE("V-DRAPE-08 the same case gives the same bits, with contact culling on and off") {
  DrapeCase c = realistic(10, 4);
  const DrapeResult first = run(c), second = run(c);
  CHECK(same_bits(first, second));
  c.contact.culling = false;
  const DrapeResult every_node = run(c);
  CHECK(same_bits(first, every_node));
  c.blank.perturbation = 1e-9;
  CHECK_FALSE(same_bits(first, run(c)));  // the comparison can fail
}

TEST_CASE("V-DRAPE-13 two threads give the same part, and the counts of work add up") {
  DrapeCase c = realistic(2.5, 8);  // fine enough that there is something to share
  c.process.stroke = 6;
  const DrapeResult one = run(c);
  c.integration.threads = 2;
  const DrapeResult two = run(c);
  CHECK(same_bits(one, two));
  CHECK(one.ledger.back().residual == two.ledger.back().residual);
  CHECK(one.work == two.work);
  c.integration.threads = 1;
  c.blank.perturbation = 1e-9;
  CHECK_FALSE(same_bits(one, run(c)));  // the comparison can fail

  // Punch, die and holder ask every pack of nodes in every step; all kinds of answer occur.
  const drape::WorkCounts& work = one.work;
  const auto lanes = static_cast<std::int64_t>(crossbeam::lanes_v<crossbeam::NativePack<double>>);
  const auto nodes = static_cast<std::int64_t>(one.formed.points.size() / 3);
  CHECK(work.contact_culled > 0);
  CHECK(work.contact_flat > 0);
  CHECK(work.contact_general > 0);
  claim(
      "V-DRAPE-13",
      static_cast<double>(std::abs(work.contact_culled + work.contact_flat + work.contact_general -
                                   3 * one.cost.steps * ((nodes + lanes - 1) / lanes))),
      0, "visits of packs that are not counted");
  claim("V-DRAPE-13", static_cast<double>(std::abs(work.gauss_points - one.cost.element_steps)), 0,
        "Gauss points that are not counted");
  claim("V-DRAPE-13",
        static_cast<double>(
            std::abs(work.steps_sampled - static_cast<std::int64_t>(one.ledger.size()))),
        0, "sampled steps that are not counted");
  c.contact.culling = false;
  CHECK(run(c).work.contact_culled == 0);
}

// Over the whole stroke half of the runs with this cell stop with an open ledger: it creates energy
// (docs/theory/double_dome.md). Up to 50 mm it has to behave, and to need no fallback.
TEST_CASE("V-DRAPE-09 the second-order cell drapes to 50 mm with a closed ledger") {
  DrapeCase c = scene("paper-literal");
  c.fabric.formulation = drape::CellFormulation::second_order;
  c.process.stroke = 50;
  c.output.frames = 1;
  const DrapeResult r = run(c);
  CHECK(r.cell_fallbacks == 0);
  CHECK(std::isfinite(r.ledger.back().yarn));
  claim("V-DRAPE-09", std::abs(r.residual_over_punch_work), 1e-3,
        "largest residual over punch work; the yarns' share is summed along the path");
}

// Independent of any drape: a smooth field sampled at the centres of a smoothly deformed mesh.
TEST_CASE("V-DRAPE-10 the shear angle at a plan point is recovered with third order") {
  const auto field = [](double X, double Y) { return 0.5 * std::sin(X / 30) * std::cos(Y / 40); };
  // Twenty maps that differ in their draw-in put the points at all places within the elements.
  constexpr int maps = 20;
  const auto formed = [](double X, double Y, int map) {
    const double draw = 0.78 + 0.004 * map;
    return std::array<double, 2>{X * (draw - 0.0002 * Y + 1e-6 * X * X),
                                 Y * (0.9 - 0.0003 * X + 1e-6 * Y * X)};
  };
  std::vector<double> error;
  for (int refinement : {1, 2, 4}) {
    const drape::QuarterGrid grid{27 * refinement, 47 * refinement, 135, 235};
    double sum = 0;
    int count = 0;
    for (int map = 0; map < maps; ++map) {
      std::vector<double> points, shear;
      for (int i = 0; i <= grid.nx; ++i)
        for (int j = 0; j <= grid.ny; ++j) {
          const auto p = formed(135.0 * i / grid.nx, 235.0 * j / grid.ny, map);
          points.insert(points.end(), {p[0], p[1], 0.0});
        }
      for (int i = 0; i < grid.nx; ++i)
        for (int j = 0; j < grid.ny; ++j)
          shear.push_back(field(135 * (i + 0.5) / grid.nx, 235 * (j + 0.5) / grid.ny));
      const auto found = drape::shear_points(grid, points, shear);
      REQUIRE(found.size() == 10);
      for (int p = 2; p <= 9; ++p) {  // away from the edges, where the field is continued linearly
        const drape::ShearPoint& at = found[p - 1];
        double X = at.x, Y = at.y;  // the material point, by fixed-point iteration on the exact map
        for (int k = 0; k < 400; ++k) {
          const auto q = formed(X, Y, map);
          X += at.x - q[0];
          Y += at.y - q[1];
        }
        const auto back = formed(X, Y, map);
        REQUIRE(std::abs(back[0] - at.x) + std::abs(back[1] - at.y) < 1e-10);
        const double exact = field(X, Y) * 180 / 3.14159265358979323846;
        sum += (at.shear_deg - exact) * (at.shear_deg - exact);
        ++count;
      }
    }
    error.push_back(std::sqrt(sum / count));
  }
  // Cubic convolution is of third order; the first halving is not yet asymptotic.
  claim("V-DRAPE-10", std::log2(error[0] / error[1]), 2.5, "order, 5 -> 2.5 mm", Bound::lower);
  claim("V-DRAPE-10", std::log2(error[1] / error[2]), 2.8, "order, 2.5 -> 1.25 mm", Bound::lower);
}

TEST_CASE("V-DRAPE-11 a run that goes wrong names place and cause") {
  DrapeCase c = realistic(10, 4);
  // Yarns of rubber, held as by a vice: they have to stretch far beyond what a yarn can.
  c.fabric.cell.warp.youngs_modulus = c.fabric.cell.weft.youngs_modulus = 2e-5;
  c.process.holder_force = 10;
  c.contact.friction = 1;
  const std::string message = reason_to_stop(c);
  INFO("message: ", message);
  CHECK(message.find("stroke") != std::string::npos);
  CHECK(message.find("material point") != std::string::npos);
  CHECK(message.find("admissible") != std::string::npos);
}

TEST_SUITE_END();
