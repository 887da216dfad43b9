// The tabulated height field: consistency of value and gradient, accuracy on the double dome,
// packs, bad input.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"
#include "crossbeam/tools/height_surface.hpp"
#include "crossbeam/tools/height_table.hpp"
#include "crossbeam/tools/primitives.hpp"
#include "crossbeam/tools/stadium_ring.hpp"
#include "double_dome.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <random>
#include <string>

namespace {

using namespace crossbeam;
using std::numbers::pi;

/// The quarter part's range, the far field on the flange, symmetric about x = 0 and y = 0.
template <class R>
HeightTableGrid<R> quarter_grid(R spacing) {
  return {R(0), R(100), R(0), R(200), spacing, true, true};
}

/// Smooth, with zero normal slope on all four sides of [0, 3] x [0, 2].
double wave(double x, double y) { return std::cos(pi * x / 3) * std::cos(pi * y); }
double wave_x(double x, double y) { return -pi / 3 * std::sin(pi * x / 3) * std::cos(pi * y); }
double wave_y(double x, double y) { return -pi * std::cos(pi * x / 3) * std::sin(pi * y); }

struct TableError {
  double height = 0, angle = 0;            // largest [mm], [deg]
  double mean_height = 0, mean_angle = 0;  // [mm], [deg]
  double steepest = 0;                     // of the table [-]
};

template <class Use>
TableError error_against(const HeightTable<double>& table, const DoubleDome<double>& tool,
                         double step, const Use& use) {
  TableError e;
  double count = 0;
  for (double x = 0.013; x < 95; x += step)
    for (double y = 0.017; y < 195; y += step) {
      if (!use(x, y)) continue;
      const auto a = table.height(x, y), b = tool.height(x, y);
      e.height = std::fmax(e.height, std::abs(a.h - b.h));
      // Angle between (-h_x, -h_y, 1) of both, by the cross product: exact for small angles.
      const double c_x = a.h_y - b.h_y, c_y = b.h_x - a.h_x, c_z = a.h_x * b.h_y - a.h_y * b.h_x;
      const double dot = 1 + a.h_x * b.h_x + a.h_y * b.h_y;
      const double angle = std::atan2(std::hypot(c_x, c_y, c_z), dot) * 180 / pi;
      e.angle = std::fmax(e.angle, angle);
      e.steepest = std::fmax(e.steepest, std::hypot(a.h_x, a.h_y));
      e.mean_height += std::abs(a.h - b.h), e.mean_angle += angle, ++count;
    }
  e.mean_height /= count, e.mean_angle /= count;
  return e;
}

}  // namespace

TEST_SUITE_BEGIN("contact");

TEST_CASE(
    "V-CONT-09 the table's gradient is the exact derivative of its value, inside and outside") {
  const DoubleDome<double> tool;
  const HeightTable<double> table(tool, quarter_grid(2.0));  // coarse: the rounding stays far away

  SUBCASE("Taylor rate 2") {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> along_x(-120, 120), along_y(-220, 220), turn(0, 2 * pi);
    const double eps[4] = {8e-3, 4e-3, 2e-3, 1e-3};
    double remainder[4] = {}, steepest = 0;
    for (int i = 0; i < 20000; ++i) {
      const double x = along_x(random), y = along_y(random), angle = turn(random);
      const auto at = table.height(x, y);
      steepest = std::fmax(steepest, std::hypot(at.h_x, at.h_y));
      for (int k = 0; k < 4; ++k) {
        const double ex = eps[k] * std::cos(angle), ey = eps[k] * std::sin(angle);
        remainder[k] += std::abs(table.height(x + ex, y + ey).h - at.h - at.h_x * ex - at.h_y * ey);
      }
    }
    CHECK(steepest > 2.4);  // premise: the gradients were not small
    CHECK(steepest <= table.max_slope());
    CHECK(table.max_slope() < 1.2 * steepest);  // 14 % too large on this coarse grid
    for (int k = 1; k < 4; ++k) {
      // A few points straddle a cell border, where the curvature jumps: third digit.
      CHECK(std::log2(remainder[k - 1] / remainder[k]) > 1.98);
      CHECK(std::log2(remainder[k - 1] / remainder[k]) < 2.02);
    }
  }
  SUBCASE("dual numbers, which differentiate the value's own arithmetic") {
    using Number = Dual<double, 2>;
    for (double x = -110; x < 111; x += 3.3)
      for (double y = -210; y < 211; y += 3.7) {
        const auto at = table.height(x, y);
        const Number h = table.height(Number::variable(x, 0), Number::variable(y, 1)).h;
        CHECK(h.value == at.h);
        // Nine coefficients of up to 60 mm over 2 mm, rounded.
        CHECK(std::abs(h.d[0] - at.h_x) < 1e-13);
        CHECK(std::abs(h.d[1] - at.h_y) < 1e-13);
      }
  }
  SUBCASE("value and gradient are continuous across cell borders and the ends of the table") {
    for (double border : {0.0, 2.0, 34.0, 50.0, 98.0, 100.0, -100.0})
      for (double other = -110; other < 110; other += 1.7)
        for (bool swap : {false, true})
          for (double eps : {1e-3, 1e-6, 1e-9}) {
            const double b = swap ? border * 2 : border;
            const auto plus = swap ? table.height(other, b + eps) : table.height(b + eps, other);
            const auto minus = swap ? table.height(other, b - eps) : table.height(b - eps, other);
            // Slope below 2.8, curvature of this coarse table below 1/mm; rounding of 60 mm / 2 mm.
            CHECK(std::abs(plus.h - minus.h) < 2 * 2.8 * eps + 1e-13);
            CHECK(std::hypot(plus.h_x - minus.h_x, plus.h_y - minus.h_y) < 2 * eps + 1e-13);
          }
  }
  SUBCASE("mirror images, and a constant far field with zero slope") {
    for (double x : {0.3, 17.0, 44.4, 83.0})
      for (double y : {0.2, 66.0, 97.0, 144.4}) {
        const auto a = table.height(x, y), b = table.height(-x, y), c = table.height(-x, -y);
        CHECK(a.h == b.h);
        CHECK(a.h == c.h);
        CHECK(a.h_x == -b.h_x);
        CHECK(a.h_y == b.h_y);
        CHECK(a.h_y == -c.h_y);
      }
    CHECK(table.height(0.0, 50.0).h_x == 0);
    // The spline's ringing beside the foot dies by 0.17 per cell, over the 7 cells to the end.
    const auto far = table.height(150.0, 400.0);
    CHECK(std::abs(far.h) < 1e-9);
    CHECK(far.h_x == 0);
    CHECK(far.h_y == 0);
    CHECK(table.height(100.0, 30.0).h_x == 0);
    // Without mirrors the other side of the plane is the constant continuation.
    const HeightTable<double> half(tool, {0.0, 100.0, 0.0, 200.0, 2.0, false, false});
    CHECK(half.height(-5.0, 120.0).h == half.height(0.0, 120.0).h);
    CHECK(half.height(-5.0, 120.0).h_x == 0);
  }
}

TEST_CASE("V-CONT-10 the table converges to the tool and is close at 0.5 mm") {
  SUBCASE("interpolation: the samples come back") {
    const HeightTable<double> table(wave, {0, 3, 0, 2, 0.1, false, false});
    for (int i = 0; i < 30; ++i)
      for (int j = 0; j < 20; ++j) {
        const double x = 0.05 + 0.1 * i, y = 0.05 + 0.1 * j;
        // Condition of the spline system is 2 per direction: a few roundings of 1.
        CHECK(std::abs(table.height(x, y).h - wave(x, y)) < 1e-14);
      }
  }
  SUBCASE("a smooth field: order 3 in value, 2 in gradient") {
    double value[4] = {}, gradient[4] = {};
    const double spacing[4] = {0.1, 0.05, 0.025, 0.0125};
    for (int k = 0; k < 4; ++k) {
      const HeightTable<double> table(wave, {0, 3, 0, 2, spacing[k], false, false});
      for (double x = 0; x <= 3; x += 0.0073)
        for (double y = 0; y <= 2; y += 0.0091) {
          const auto a = table.height(x, y);
          value[k] = std::fmax(value[k], std::abs(a.h - wave(x, y)));
          gradient[k] =
              std::fmax(gradient[k], std::hypot(a.h_x - wave_x(x, y), a.h_y - wave_y(x, y)));
        }
      if (k == 0) continue;
      INFO("spacing ", spacing[k], ": ", value[k], " ", gradient[k]);
      // Best approximation by quadratic splines. A tenth of an order for the pre-asymptotic range.
      CHECK(std::abs(std::log2(value[k - 1] / value[k]) - 3) < 0.1);
      CHECK(std::abs(std::log2(gradient[k - 1] / gradient[k]) - 2) < 0.1);
    }
  }
  SUBCASE("the double dome") {
    const DoubleDome<double> tool({}, 0.5);
    const auto everywhere = [](double, double) { return true; };
    // Smooth parts: 2.5 mm and more from every border between two arcs. A border's ringing dies by
    // 0.17 per cell; 5 cells of 0.5 mm leave a ten-thousandth of it.
    constexpr double margin = 2.5;
    const auto smooth = [&](double x, double y) {
      const auto clear = [](double s, const DomeProfile<double>& p) {
        for (double border : {p.flat(), p.wall_start(), p.wall_end(), p.foot()})
          if (std::abs(s - border) < margin) return false;
        return true;
      };
      if (y < 72 - margin) return clear(x, tool.ridge());
      const double rho = std::hypot(x, y - 100);
      return y > 100 + margin && (rho < margin || clear(rho, tool.dome()));
    };
    TableError before, smooth_before;
    for (double spacing : {0.5, 0.25, 0.125}) {
      const HeightTable<double> table(tool, quarter_grid(spacing));
      const TableError all = error_against(table, tool, 0.097, everywhere);
      const TableError part = error_against(table, tool, 0.097, smooth);
      MESSAGE("spacing ", spacing, " mm: at most ", all.height, " mm and ", all.angle,
              " deg; away from the borders of the arcs ", part.height, " mm and ", part.angle,
              " deg; ", table.bytes() / 1024, " KiB");
      if (spacing < 0.5) {
        // Curvature jumps at the borders: order 2 in value, 1 in slope there; 3 and 2 elsewhere.
        // How a border falls into the cells makes the largest error jitter by some 20 %: a third
        // of an order. The mean over the smooth parts has its order cleanly.
        CHECK(std::abs(std::log2(before.height / all.height) - 2) < 0.33);
        CHECK(std::abs(std::log2(before.angle / all.angle) - 1) < 0.33);
        INFO("means ", part.mean_height, " ", part.mean_angle, ", before ",
             smooth_before.mean_height, " ", smooth_before.mean_angle);
        CHECK(std::abs(std::log2(smooth_before.mean_height / part.mean_height) - 3) < 0.05);
        CHECK(std::abs(std::log2(smooth_before.mean_angle / part.mean_angle) - 2) < 0.05);
      } else {
        // What a drape may take for granted: about a hundredth of the fabric's thickness, and less
        // than the normal turns over a tenth of an element on the ridge's edge.
        CHECK(all.height < 0.012);
        CHECK(all.angle < 1);
        // The bound of the slope holds and is of use.
        CHECK(table.max_slope() >= all.steepest);
        CHECK(table.max_slope() < 1.05 * all.steepest);
      }
      before = all, smooth_before = part;
    }
  }
}

TEST_CASE_TEMPLATE("V-CONT-11 a pack asks the tools exactly as its lanes do", P, Pack<double, 2>,
                   Pack<double, 4>, Pack<double, 8>, Pack<float, 4>, Pack<float, 16>) {
  using R = typename P::Value;
  constexpr int lanes = lanes_v<P>;
  const DoubleDome<R> dome({}, R(1) / R(2));
  const HeightSurface punch(HeightTable<R>(dome, quarter_grid(R(1))), Side::above);
  const HeightSurface die(HeightTable<R>(dome, quarter_grid(R(1))), Side::below);
  const StadiumRing<R> ring;
  const Plane<R> plane({R(1), R(2), R(3)}, {R(1), R(1), R(3)});
  const Sphere<R> sphere({R(1), R(2), R(3)}, R(50));
  const Cylinder<R> cylinder({R(1), R(2), R(3)}, {R(1), R(0), R(3)}, R(40));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> along_x(-130, 130), along_y(-230, 230), up(-20, 80);

  // The same operations in the same order, each correctly rounded: bit for bit.
  const auto compare = [](const auto& surface, const std::array<std::array<R, lanes>, 3>& p) {
    const auto packed =
        surface.gap(Vec3<P>{P::load(p[0].data()), P::load(p[1].data()), P::load(p[2].data())});
    for (int i = 0; i < lanes; ++i) {
      const auto single = surface.gap(Vec3<R>{p[0][i], p[1][i], p[2][i]});
      CHECK(packed.gap[i] == single.gap);
      CHECK(packed.clearance[i] == single.clearance);
      CHECK(packed.normal.x[i] == single.normal.x);
      CHECK(packed.normal.y[i] == single.normal.y);
      CHECK(packed.normal.z[i] == single.normal.z);
    }
  };
  for (int round = 0; round < 100; ++round) {
    std::array<std::array<R, lanes>, 3> p;
    for (int i = 0; i < lanes; ++i) {
      p[0][i] = static_cast<R>(along_x(random)), p[1][i] = static_cast<R>(along_y(random));
      p[2][i] = static_cast<R>(up(random));
    }
    compare(punch, p), compare(die, p), compare(ring, p), compare(plane, p), compare(sphere, p);
    compare(cylinder, p);
  }
  // The singular points of the round tools, and a NaN in one lane: it stays in its lane.
  std::array<std::array<R, lanes>, 3> centre{};
  for (int i = 0; i < lanes; ++i) centre[0][i] = 1, centre[1][i] = 2, centre[2][i] = 3;
  compare(sphere, centre), compare(cylinder, centre);
  for (int i = 0; i < lanes; ++i) centre[0][i] = 0;
  compare(ring, centre);
  P x(R(30));
  x.set(1, std::numeric_limits<R>::quiet_NaN());
  const auto s = punch.height_function().height(x, P(R(20)));
  CHECK(s.h[0] == punch.height_function().height(R(30), R(20)).h);
  CHECK(std::isnan(s.h[1]));
}

TEST_CASE("V-CONT-12 bad tables, rings and primitives are refused by field, value and range") {
  const auto message = [](const auto& build) -> std::string {
    try {
      build();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  using Point = Vec3<double>;
  const double nan = std::nan("");
  const auto table = [](HeightTableGrid<double> grid) {
    return [=] { HeightTable<double> t(wave, grid); };
  };
  CHECK(message(table({0, 3, 0, 2, 0.1, false, false})) == "accepted");  // premise
  CHECK(message(table({0, 3, 0, 2, 0, false, false})) ==
        "table.spacing = 0 [mm] is not admissible: a finite number > 0");
  CHECK(message(table({0, 3, 0, 2, 1e-9, false, false})).find("at least 1/20000 of the range") !=
        std::string::npos);
  CHECK(message(table({3, 3, 0, 2, 0.1, false, false})) ==
        "table.x1 = 3 [mm] is not admissible: above x0 = 3");
  CHECK(message(table({0, 3, 0, nan, 0.1, false, false})).find("table.y1 = nan") == 0);
  CHECK(message([&] {
          HeightTable<double> t([&](double, double) { return nan; }, {0, 1, 0, 1});
        }).find("table.source(x, y) = nan") == 0);

  CHECK(message([] {
          Plane<double> p(Point{0, 0, 0}, Point{0, 0, 0});
        }) == "plane.normal = (0, 0, 0) [-] is not admissible: a vector of length > 0");
  CHECK(message([&] {
          Plane<double> p(Point{0, nan, 0}, Point{0, 0, 1});
        }).find("plane.point.y = nan") == 0);
  CHECK(message([] { Plane<double> p(Point{0, 0, 0}, Point{0, 0, 1e-200}); }) == "accepted");
  CHECK(message([] {
          Sphere<double> s(Point{0, 0, 0}, -2);
        }) == "sphere.radius = -2 [length] is not admissible: a finite number > 0");
  CHECK(message([] {
          Sphere<double> s(Point{0, 0, 0}, 2, -3);
        }).find("sphere.radius + offset = -1") == 0);
  CHECK(message([] {
          Cylinder<double> c(Point{0, 0, 0}, Point{0, 0, 0}, 2);
        }).find("cylinder.axis = (0, 0, 0)") == 0);
  CHECK(message([&] {
          Cylinder<double> c(Point{0, 0, 0}, Point{0, 1, nan}, 2);
        }).find("cylinder.axis.z = nan") == 0);

  const auto ring = [](double opening, double y_c, double edge, double offset) {
    return [=] { StadiumRing<double> r({opening, y_c, edge}, offset); };
  };
  CHECK(message(ring(90, 100, 5, 0.5)) == "accepted");  // premise
  CHECK(message(ring(-90, 100, 5, 0)).find("ring.opening_radius = -90 [mm]") == 0);
  CHECK(message(ring(90, -1, 5, 0)).find("ring.centre_distance = -1 [mm]") == 0);
  CHECK(message(ring(90, 100, 0, 0)).find("ring.edge_radius = 0 [mm]") == 0);
  CHECK(message(ring(90, 100, 5, -6)).find("ring.edge_radius + offset = -1 [mm]") == 0);
  CHECK(message(ring(90, 100, 5, 95)).find("ring.opening_radius - offset = -5 [mm]") == 0);
}

TEST_SUITE_END();
