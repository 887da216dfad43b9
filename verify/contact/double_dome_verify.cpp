// The double-dome surface: against the tabulated heights of the fitted tool, against its geometric
// definition (smoothness, parallel family), and as a Surface.

#include "crossbeam/tools/height_surface.hpp"
#include "double_dome.hpp"

#include "contact/closest_point.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace crossbeam;
using closest_point::Point;
using std::numbers::pi;

constexpr double die_play = 5.0 / 3.0;  // punch to die when closed, normal [mm]
constexpr double half_thickness = 0.5;  // of the fabric [mm]

/// Same sections, but the dome's axis 3 mm further out: below y = 100 this is the surface whose
/// ramp runs over 75..100 and whose rounding would end at 103.
DoubleDome<double> late_ramp() {
  DoubleDomeParameters<double> p;
  p.dome_axis = 103, p.blend_end = 100;
  return DoubleDome<double>(p);
}

enum class Region { plateau, ridge, blend, dome, flange };

Region region_of(const DoubleDome<double>& tool, double x, double y) {
  const auto& p = tool.parameters();
  const double h = tool.height(x, y).h - tool.offset();
  if (h <= 0) return Region::flange;
  if (y >= p.dome_axis) return Region::dome;
  if (h >= p.depth) return Region::plateau;
  return y <= p.blend_start - p.blend_rounding ? Region::ridge : Region::blend;
}

Point normal_of(const HeightSample<double>& s) {
  const double n_z = 1 / std::sqrt(1 + s.h_x * s.h_x + s.h_y * s.h_y);
  return {-s.h_x * n_z, -s.h_y * n_z, n_z};
}

/// Largest kink |h(t+eps) - 2 h(t) + h(t-eps)| / eps over t = low, low + eps, ...: the difference
/// of the two one-sided slopes. It is of the order of eps on a C1 curve, tends to the jump where
/// the slope jumps and grows like 1/eps where the height jumps; no border can be missed, because
/// the scan is as fine as the probe.
template <class Curve>
double largest_kink(const Curve& curve, double low, double high, double eps) {
  const int steps = static_cast<int>((high - low) / eps);
  double before = curve(low), here = curve(low + eps), largest = 0;
  for (int i = 2; i <= steps; ++i) {
    const double after = curve(low + i * eps);
    largest = std::fmax(largest, std::abs(after - 2 * here + before) / eps);
    before = here, here = after;
  }
  return largest;
}

}  // namespace

TEST_SUITE_BEGIN("contact");

TEST_CASE("V-CONT-04 the double dome has the tabulated heights and the derived dimensions") {
  const DoubleDome<double> punch;
  // Heights are printed to 0.01: half of that, plus the rounding of the comparison.
  constexpr double printed = 0.005 + 1e-9;

  SUBCASE("ridge and domes") {
    const struct {
      double y, z[10];
    } rows[] = {{0, {60, 60, 59.30, 46.26, 30.57, 14.90, 5.13, 0.92, 0, 0}},
                {100, {60, 59.14, 56.46, 51.69, 44.13, 31.71, 12.50, 4.10, 0.55, 0}},
                {120, {56.46, 55.54, 52.68, 47.52, 39.12, 24.09, 9.00, 2.73, 0.19, 0}},
                {140, {44.13, 42.93, 39.12, 31.71, 17.73, 8.28, 3.04, 0.44, 0, 0}},
                {160, {12.50, 11.51, 9.00, 5.90, 3.04, 0.95, 0.02, 0, 0, 0}},
                {180, {0.55, 0.44, 0.19, 0.01, 0, 0, 0, 0, 0, 0}}};
    for (const auto& row : rows)
      for (int i = 0; i < 10; ++i)
        for (double sx : {-1.0, 1.0})
          for (double sy : {-1.0, 1.0}) {
            INFO("x ", sx * 10 * i, ", y ", sy * row.y);
            CHECK(std::abs(punch.height(sx * 10 * i, sy * row.y).h - row.z[i]) < printed);
          }
  }
  SUBCASE("blend: the tabulated rows belong to a ramp over 75..100") {
    // That ramp's rounding would end 3 mm beyond the dome's axis and leave a step there, which is
    // why the tool's own ramp ends at 97. The rows still check the blend of the half widths.
    const struct {
      double y, g, z[10];
    } rows[] = {{75, 0.03, {60, 60, 59.16, 46.61, 31.08, 15.28, 5.29, 0.98, 0, 0}},
                {85, 0.40, {60, 60, 57.67, 49.62, 37.16, 20.42, 7.51, 1.89, 0.02, 0}},
                {95, 0.80, {60, 59.50, 56.76, 51.21, 42.29, 27.94, 10.59, 3.26, 0.29, 0}}};
    const DoubleDome<double> late = late_ramp();
    double largest = 0;
    for (const auto& row : rows) {
      REQUIRE(std::abs(late.ramp(row.y).g - row.g) < 1e-12);
      for (int i = 0; i < 10; ++i) {
        INFO("x ", 10 * i, ", y ", row.y);
        CHECK(std::abs(late.height(10 * i, row.y).h - row.z[i]) < printed);
        largest = std::fmax(largest, std::abs(punch.height(10 * i, row.y).h - row.z[i]));
      }
    }
    MESSAGE("tool (ramp 75..97) against the rows of the ramp 75..100: at most ", largest, " mm");
    CHECK(largest > 1.9);
    CHECK(largest < 2.1);

    double step = 0;
    for (double x = 0; x < 90; x += 0.05)
      step = std::fmax(
          step, std::abs(late.height(x, std::nextafter(100.0, 0)).h - punch.height(x, 100).h));
    MESSAGE("step that the ramp 75..100 leaves at y = 100: ", step, " mm");
    CHECK(step > 0.3);
  }
  SUBCASE("share of the dome section") {
    // Symmetric about 86; parabolas through 1/22 * 3/4 of a corner's half length; arrives at 100.
    CHECK(std::abs(punch.ramp(86).g - 0.5) < 1e-14);
    CHECK(std::abs(punch.ramp(75).g - 0.75 / 22) < 1e-14);
    CHECK(std::abs(punch.ramp(97).g - (1 - 0.75 / 22)) < 1e-14);
    CHECK(punch.ramp(72).g == 0);
    CHECK(punch.ramp(99.99).g < 1);
    CHECK(punch.ramp(100).g == 1);
  }
  SUBCASE("derived dimensions") {
    const auto& ridge = punch.ridge();
    const auto& dome = punch.dome();
    constexpr double three_digits = 0.0005 + 1e-9;  // printed to 0.001
    CHECK(std::abs(ridge.flat() - 16.667) < three_digits);
    CHECK(std::abs(ridge.wall_start() - 23.693) < three_digits);
    CHECK(std::abs(ridge.at(ridge.wall_start()).z - 56.147) < three_digits);
    CHECK(std::abs(ridge.wall_end() - 49.670) < three_digits);
    CHECK(std::abs(ridge.at(ridge.wall_end()).z - 15.411) < three_digits);
    CHECK(std::abs(ridge.foot() - 77.775) < three_digits);
    CHECK(std::abs(dome.wall_start() - 54.74) < printed);
    CHECK(std::abs(dome.wall_end() - dome.wall_start()) < 1e-12);  // no straight piece
    CHECK(std::abs(dome.at(dome.wall_start()).z - 21.82) < printed);
    CHECK(std::abs(dome.foot() - 86.02) < printed);
    CHECK(std::abs(100 + dome.foot() - 186.0) < 0.05);  // printed to 0.1
    CHECK(std::abs(std::atan(dome.max_slope()) * 180 / pi - 69.8) < 0.05);
    // The wall's line meets the top plane at x_w; for the die at 22.150.
    const auto wall_at_top = [](const DomeProfile<double>& p, double top) {
      const auto w = p.at((p.wall_start() + p.wall_end()) / 2);
      return (p.wall_start() + p.wall_end()) / 2 + (top - w.z) / w.slope;
    };
    CHECK(std::abs(wall_at_top(ridge, 60) - 21.236) < three_digits);
    const DoubleDome<double> die = punch.offset(die_play);
    CHECK(std::abs(wall_at_top(die.ridge(), 60 + die_play) - 22.150) < three_digits);
    CHECK(std::abs(die.ridge().foot() - ridge.foot()) < 1e-12);
    CHECK(std::abs(die.dome().foot() - dome.foot()) < 1e-12);
    CHECK(die.height(0, 200).h == die_play);
    // Radius of the die's dome, 60 about a centre on its own flange.
    const double rho = 30;
    const double z = die.height(rho, 100).h - die_play;
    CHECK(std::abs(std::hypot(rho, z) - 60) < 1e-12);
  }
}

TEST_CASE("V-CONT-05 the double dome has no jump in height or slope") {
  const auto scan = [](const auto& height, double eps) {
    double largest = 0;
    for (double x : {0.0, 0.3, 3.0, 9.0, 14.0, 16.6, 18.0, 22.0, 24.0, 31.0, 40.0, 50.0, 60.0, 72.0,
                     79.0, 84.0})
      largest =
          std::fmax(largest, largest_kink([&](double y) { return height(x, y); }, -4, 190, eps));
    for (double y : {0.0, 50.0, 71.9, 73.0, 77.9, 85.0, 93.9, 96.0, 98.5, 99.9, 100.0, 104.0, 130.0,
                     154.7, 170.0})
      largest =
          std::fmax(largest, largest_kink([&](double x) { return height(x, y); }, -4, 110, eps));
    return largest;
  };

  SUBCASE("the tool: the largest kink halves with the probe distance") {
    for (double offset : {0.0, half_thickness, die_play}) {
      const DoubleDome<double> tool({}, offset);
      const auto height = [&](double x, double y) { return tool.height(x, y).h; };
      double previous = scan(height, 0.04);
      for (double eps : {0.02, 0.01, 0.005}) {
        const double kink = scan(height, eps);
        INFO("offset ", offset, ", eps ", eps, ": kink ", kink, ", before ", previous);
        // Rate 1. The largest curvature sits at a border between two arcs, where the probe sees a
        // mixture of both: the ratio is 2 only within some percent.
        CHECK(previous / kink > 1.9);
        CHECK(previous / kink < 2.1);
        previous = kink;
      }
      MESSAGE("offset ", offset, ": largest curvature seen ", previous / 0.005, " 1/mm");
      CHECK(previous / 0.005 < 1.2);  // finite: no crease hides below the probe
    }
  }
  SUBCASE("finer, through the blend: a plateau or foot border misplaced by 0.01 mm would show") {
    const DoubleDome<double> tool;
    const auto fine_scan = [&](double eps) {
      double largest = 0;
      for (double y : {73.0, 85.0, 96.0, 99.0})
        largest = std::fmax(
            largest, largest_kink([&](double x) { return tool.height(x, y).h; }, -1, 90, eps));
      for (double x : {1.0, 9.0, 14.0, 80.0})
        largest = std::fmax(
            largest, largest_kink([&](double y) { return tool.height(x, y).h; }, 70, 101, eps));
      return largest;
    };
    double previous = fine_scan(1e-3);
    for (double eps : {5e-4, 2.5e-4}) {
      const double kink = fine_scan(eps);
      INFO("eps ", eps, ": kink ", kink, ", before ", previous);
      CHECK(previous / kink > 1.9);
      CHECK(previous / kink < 2.1);
      previous = kink;
    }
  }
  SUBCASE("the same scan sees a step of the height and a crease") {
    const DoubleDome<double> tool, late = late_ramp();
    const auto stepped = [&](double x, double y) { return (y < 100 ? late : tool).height(x, y).h; };
    CHECK(scan(stepped, 0.01) > 1.9 * scan(stepped, 0.02));  // grows like 1 / eps
    const auto creased = [&](double x, double y) {
      return tool.height(x, y).h + 1e-2 * std::fmax(0, y - 97);
    };
    CHECK(scan(creased, 0.0025) > 0.6 * scan(creased, 0.005));  // does not vanish at rate 1
  }
  SUBCASE("at every border, in value and analytic gradient, down to rounding") {
    for (double offset : {0.0, half_thickness, die_play}) {
      const DoubleDome<double> tool({}, offset);
      std::vector<Point> borders;  // x, y of points on borders
      for (double y : {0.0, 72.0, 78.0, 94.0, 97.0, 100.0})
        for (double x = 0; x < 90; x += 0.7) borders.push_back({x, y, 0});
      // In the blend: plateau edge, ends of either section's arcs, foot; each moves with g.
      for (double y = 60; y <= 100; y += 0.5) {
        const double g = tool.ramp(y).g;
        const auto &a = tool.ridge(), &b = tool.dome();
        borders.push_back({(1 - g) * a.flat(), y, 0});
        borders.push_back({(1 - g) * a.foot() + g * b.foot(), y, 0});
        for (double z : {a.at(a.wall_start()).z, a.at(a.wall_end()).z, b.at(b.wall_start()).z}) {
          const double delta = 60 + offset - z;
          const double u = std::sqrt(delta), w = std::sqrt(60 - delta);
          borders.push_back({(1 - g) * a.at_level(u, w).s + g * b.at_level(u, w).s, y, 0});
        }
      }
      for (int i = 0; i <= 40; ++i)  // on the dome: end of the sphere, foot
        for (double rho : {tool.dome().wall_start(), tool.dome().foot()})
          borders.push_back({rho * std::sin(pi * i / 80), 100 + rho * std::cos(pi * i / 80), 0});
      for (const Point& p : borders)
        for (double angle : {0.0, 0.7, 1.5, 2.3}) {
          double previous_slope_jump = HUGE_VAL;
          for (double eps : {1e-2, 1e-4, 1e-6, 1e-8}) {
            const double ex = eps * std::cos(angle), ey = eps * std::sin(angle);
            const auto plus = tool.height(p.x + ex, p.y + ey);
            const auto minus = tool.height(p.x - ex, p.y - ey);
            // Value less its linear part from both sides: second order in eps; gradient: first
            // order; curvature below 1.2/mm (scan above). Rounding: 60 mm * 2e-16 in the height
            // and position, times slope 2.8; the slope's own, near a flat, is that over sqrt.
            const double value_jump =
                plus.h - minus.h - (plus.h_x + minus.h_x) * ex - (plus.h_y + minus.h_y) * ey;
            const double slope_jump = std::hypot(plus.h_x - minus.h_x, plus.h_y - minus.h_y);
            INFO("offset ", offset, " at ", p.x, " ", p.y, " angle ", angle, " eps ", eps);
            CHECK(std::abs(value_jump) < 2.4 * eps * eps + 2e-13);
            CHECK(slope_jump < 2.4 * eps + 2e-12);
            CHECK(slope_jump <= previous_slope_jump + 2e-12);
            previous_slope_jump = slope_jump;
          }
        }
    }
  }
}

TEST_CASE("V-CONT-06 the double dome's gradient is the derivative of its height") {
  const DoubleDome<double> tool({}, half_thickness);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along_x(-95, 95), along_y(-195, 195), turn(0, 2 * pi);
  double remainder[4] = {};
  const double eps[4] = {8e-3, 4e-3, 2e-3, 1e-3};
  int seen[5] = {};
  double steepest = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = along_x(random), y = along_y(random), angle = turn(random);
    const auto at = tool.height(x, y);
    ++seen[static_cast<int>(region_of(tool, std::abs(x), std::abs(y)))];
    steepest = std::fmax(steepest, std::hypot(at.h_x, at.h_y));
    for (int k = 0; k < 4; ++k) {
      const double ex = eps[k] * std::cos(angle), ey = eps[k] * std::sin(angle);
      remainder[k] += std::abs(tool.height(x + ex, y + ey).h - at.h - at.h_x * ex - at.h_y * ey);
    }
  }
  for (int n : seen) CHECK(n > 100);  // premise: every region was met
  CHECK(steepest > 2.5);              // premise: the gradients were not small
  CHECK(steepest <= tool.max_slope());
  for (int k = 1; k < 4; ++k) {
    const double rate = std::log2(remainder[k - 1] / remainder[k]);
    INFO("remainder ", remainder[k], " at eps ", eps[k]);
    // Taylor: rate 2. The few points that straddle a jump of curvature blur it in the third digit;
    // a gradient wrong by 1e-4 would already pull the last rate below 1.9.
    CHECK(rate > 1.98);
    CHECK(rate < 2.02);
  }
  // The bound of the slope is close enough to be of use in the clearance.
  CHECK(tool.max_slope() < 1.1 * steepest);
}

TEST_CASE("V-CONT-07 offset surfaces are parallel: exactly on ridge and domes") {
  const DoubleDome<double> punch;

  SUBCASE("distance along the normal") {
    for (double d : {half_thickness, die_play - half_thickness, die_play, -2.0}) {
      const DoubleDome<double> beside = punch.offset(d);
      double exact_parts = 0, blend_low = d, blend_high = d;
      int seen[5] = {};
      for (double x = 0.05; x < 92; x += 0.37)
        for (double y = 0.1; y < 192; y += 0.43) {
          const auto at = punch.height(x, y);
          const Point n = normal_of(at);
          const Point q = Point{x, y, at.h} + d * n;
          const Region region = region_of(punch, x, y);
          ++seen[static_cast<int>(region)];
          const auto there = beside.height(q.x, q.y);
          if (region != Region::blend) {
            // The foot of the normal may lie in the blend of the parallel surface only for dome
            // points within d of y = 100, whose normals have no y component there: none do.
            exact_parts = std::fmax(exact_parts, std::abs(there.h - q.z));
          } else {
            // The miss is small: the tangent plane gives the remaining distance to second order.
            const double miss = (q.z - there.h) * normal_of(there).z;
            blend_low = std::fmin(blend_low, d - miss),
            blend_high = std::fmax(blend_high, d - miss);
          }
        }
      for (int n : seen) CHECK(n > 100);
      INFO("offset ", d);
      CHECK(exact_parts < 1e-12);  // roundings of 60 mm and 190 mm, times slope 2.8
      MESSAGE("offset ", d, ": distance in the blend ", blend_low, " .. ", blend_high);
      // There the sections are blended, not offset: within 8 % and 5 %, measured, a property of the
      // definition that the theory page states; the bound only guards the statement.
      const double ratio_low = std::fmin(blend_low / d, blend_high / d);
      const double ratio_high = std::fmax(blend_low / d, blend_high / d);
      CHECK(ratio_low > 0.92);
      CHECK(ratio_high < 1.055);
    }
  }
  SUBCASE("closed play of the fabric's mid-surface") {
    const DoubleDome<double> lower = punch.offset(half_thickness);
    const DoubleDome<double> upper = punch.offset(die_play - half_thickness);
    const double play = die_play - 2 * half_thickness;
    double low = HUGE_VAL, high = 0;
    for (double x = 0.05; x < 92; x += 0.37)
      for (double y = 0.1; y < 192; y += 0.43) {
        const auto at = lower.height(x, y);
        const Point q = Point{x, y, at.h} + play * normal_of(at);
        const auto there = upper.height(q.x, q.y);
        const double miss = (q.z - there.h) * normal_of(there).z;
        if (region_of(lower, x, y) == Region::blend)
          low = std::fmin(low, play - miss), high = std::fmax(high, play - miss);
        else
          CHECK(std::abs(miss) < 1e-12);
      }
    MESSAGE("closed play of the mid-surface: 2/3 mm; in the blend ", low, " .. ", high, " mm");
    CHECK(low > 0.92 * play);  // as above
    CHECK(high < 1.055 * play);
  }
}

TEST_CASE("V-CONT-08 a height surface's gap is second-order exact, its clearance never too large") {
  const DoubleDome<double> dome({}, half_thickness);

  SUBCASE("gap and normal beside the surface") {
    for (Side side : {Side::above, Side::below}) {
      const HeightSurface surface(dome, side);
      const double sign = side == Side::above ? 1 : -1;
      const double distances[3] = {0.08, 0.04, 0.02};
      double gap_error[3] = {}, normal_error[3] = {};
      int count = 0;
      for (double x = -90; x < 92; x += 3.1)
        for (double y = -190; y < 192; y += 3.7) {
          const auto at = dome.height(x, y);
          if (region_of(dome, std::abs(x), std::abs(y)) == Region::flange) continue;
          const Point p{x, y, at.h}, n = sign * normal_of(at);
          const auto on = surface.gap(p);
          CHECK(std::abs(on.gap) < 1e-14);
          CHECK(closest_point::distance(on.normal, n) < 1e-14);
          for (int k = 0; k < 3; ++k) {
            const auto off = surface.gap(p + distances[k] * n);
            gap_error[k] += std::abs(off.gap - distances[k]);
            normal_error[k] += closest_point::distance(off.normal, n);
          }
          ++count;
        }
      CHECK(count > 1000);
      for (int k = 1; k < 3; ++k) {
        // Rates 2 and 1: the foot point lies gap * n_x beside the point asked about. Points within
        // that distance of a jump of curvature blur the second digit.
        CHECK(std::log2(gap_error[k - 1] / gap_error[k]) > 1.95);
        CHECK(std::log2(normal_error[k - 1] / normal_error[k]) > 0.95);
      }
      MESSAGE("mean error at a gap of 0.02 mm: ", gap_error[2] / count, " mm");
    }
  }
  SUBCASE("clearance") {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto surface_point = [&](double s, double t) { return Point{s, t, dome.height(s, t).h}; };
    double tightest = 0;
    for (Side side : {Side::above, Side::below}) {
      const HeightSurface surface(dome, side);
      for (int i = 0; i < 40; ++i) {
        const double x = 100 * unit(random), y = 200 * unit(random), lift = 40 * unit(random);
        const Point p{x, y, dome.height(x, y).h + (side == Side::above ? lift : -lift)};
        const double true_distance = closest_point::search(
            p, {x - lift, x + lift}, {y - lift, y + lift}, surface_point, 40, 1e-5);
        const auto answer = surface.gap(p);
        REQUIRE(answer.clearance > 0);
        CHECK(answer.clearance <= true_distance);
        tightest = std::fmax(tightest, answer.clearance / true_distance);
        CHECK(surface.gap(Point{x, y, 2 * dome.height(x, y).h - p.z}).clearance < 0);
      }
    }
    CHECK(tightest > 0.7);  // premise: on steep walls the bound is near the truth, so it could fail
  }
}

TEST_CASE("V-CONT-12 bad tools are refused by field, value and range") {
  const auto message = [](const auto& build) -> std::string {
    try {
      build();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto with = [](auto member, double value) {
    return [=] {
      DoubleDomeParameters<double> p;
      p.*member = value;
      DoubleDome<double> tool(p);
    };
  };
  using P = DoubleDomeParameters<double>;
  CHECK(message(with(&P::depth, 60.0)) == "accepted");  // premise: the defaults are good
  CHECK(message(with(&P::depth, -1.0)) ==
        "dome.depth = -1 [mm] is not admissible: a finite number > 0");
  CHECK(message(with(&P::depth, 92.0)).find("below dome_radius + dome_fillet = 91.66") !=
        std::string::npos);
  CHECK(message(with(&P::depth, 10.0)).find("two arcs = 19.26") != std::string::npos);
  CHECK(message(with(&P::wall_angle, 57.475)).find("dome.wall_angle = 57.475") == 0);
  CHECK(message(with(&P::ridge_edge, std::nan(""))).find("dome.ridge_edge = nan") == 0);
  CHECK(message(with(&P::dome_axis, 99.0))
            .find("dome.dome_axis = 99 [mm] is not admissible: at "
                  "least blend_end + blend_rounding = 100") == 0);
  CHECK(message(with(&P::blend_start, 95.0)).find("dome.blend_end = 97") == 0);
  CHECK(message(with(&P::blend_start, 1.0)).find("dome.blend_start = 1") == 0);
  CHECK(message([] { DoubleDome<double> tool({}, 34); }).find("dome.offset = 34") == 0);
  CHECK(message([] { return DoubleDome<double>().offset(-9); }).find("strictly between -8.33") !=
        std::string::npos);
  CHECK(std::isnan(DoubleDome<double>().height(std::nan(""), 3).h));
}

TEST_SUITE_END();
