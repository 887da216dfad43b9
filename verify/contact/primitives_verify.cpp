// Plane, sphere, cylinder and blank holder: signed distances against a plain search for the closest
// point on an independent parametrisation of the same body.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/tools/primitives.hpp"
#include "crossbeam/tools/stadium_ring.hpp"

#include "contact/closest_point.hpp"

#include <doctest/doctest.h>

#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace crossbeam;
using closest_point::Point;
using closest_point::search;
using std::numbers::pi;

// The search ends on a grid of 1e-8 (mm or rad, arms below 100 mm): (1e-6 mm)^2 / (8 * 0.01 mm) for
// the smallest distance asked about.
constexpr double search_tolerance = 2e-11;

// Coordinates up to 300 mm carry a rounding of 6e-14; a few of them add up in a distance.
constexpr double rounding = 1e-12;

double norm(const Point& v) { return std::hypot(v.x, v.y, v.z); }

std::vector<Point> random_points(int count, Point low, Point high, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    const double a = unit(random), b = unit(random), c = unit(random);
    points.push_back(
        {low.x + a * (high.x - low.x), low.y + b * (high.y - low.y), low.z + c * (high.z - low.z)});
  }
  return points;
}

/// A distance has a gradient of length 1, which is the normal, and walking back by the gap ends on
/// the surface. The gradient comes from dual numbers, which know nothing of the normal's formula.
template <class S>
void check_foot_point(const S& surface, const Point& p) {
  const auto at = surface.gap(p);
  CHECK(std::abs(norm(at.normal) - 1) < 1e-14);  // a handful of roundings of 1
  CHECK(at.clearance == at.gap);
  using Number = Dual<double, 3>;
  const Number gap = surface
                         .gap(Vec3<Number>{Number::variable(p.x, 0), Number::variable(p.y, 1),
                                           Number::variable(p.z, 2)})
                         .gap;
  CHECK(gap.value == at.gap);
  CHECK(norm(Point{gap.d[0], gap.d[1], gap.d[2]} - at.normal) < 1e-14);
  CHECK(std::abs(surface.gap(p - at.gap * at.normal).gap) < rounding);
}

template <class S>
void check_parallel(const S& surface, const Point& p, double d) {
  const auto at = surface.gap(p), beside = surface.offset(d).gap(p);
  CHECK(std::abs(at.gap - d - beside.gap) < rounding);
  CHECK(norm(at.normal - beside.normal) < 1e-14);
}

/// Two unit vectors square to e and to each other.
void frame_across(const Point& e, Point& a, Point& b) {
  const Point other = std::abs(e.x) < 0.5 ? Point{1, 0, 0} : Point{0, 1, 0};
  a = cross(e, other);
  a = (1 / norm(a)) * a;
  b = cross(e, a);
}

/// Surface of the blank holder by arc lengths: `s` once around the opening, `t` < 0 down the inner
/// wall, 0..r_e pi/2 over the rounded edge, beyond on the flat.
Point ring_point(const StadiumRingParameters<double>& r, double s, double t) {
  const double straight = 2 * r.centre_distance, arc = pi * r.opening_radius;
  double inner_x, inner_y, out_x, out_y;
  if (s < straight) {
    inner_x = r.opening_radius, inner_y = s - r.centre_distance, out_x = 1, out_y = 0;
  } else if (s < straight + arc) {
    const double angle = (s - straight) / r.opening_radius;
    out_x = std::cos(angle), out_y = std::sin(angle);
    inner_x = r.opening_radius * out_x, inner_y = r.centre_distance + r.opening_radius * out_y;
  } else if (s < 2 * straight + arc) {
    inner_x = -r.opening_radius, inner_y = r.centre_distance - (s - straight - arc);
    out_x = -1, out_y = 0;
  } else {
    const double angle = pi + (s - 2 * straight - arc) / r.opening_radius;
    out_x = std::cos(angle), out_y = std::sin(angle);
    inner_x = r.opening_radius * out_x, inner_y = -r.centre_distance + r.opening_radius * out_y;
  }
  const double quarter = r.edge_radius * pi / 2;
  double out, z;
  if (t < 0) {
    out = 0, z = -r.edge_radius + t;
  } else if (t < quarter) {
    out = r.edge_radius * (1 - std::cos(t / r.edge_radius));
    z = -r.edge_radius * (1 - std::sin(t / r.edge_radius));
  } else {
    out = r.edge_radius + t - quarter, z = 0;
  }
  return {inner_x + out * out_x, inner_y + out * out_y, z};
}

double ring_distance(const StadiumRingParameters<double>& r, const Point& p) {
  const double around = 4 * r.centre_distance + 2 * pi * r.opening_radius;
  // Pieces by hand: the search must not straddle the seam of a piece.
  double best = HUGE_VAL;
  const double straight = 2 * r.centre_distance, arc = pi * r.opening_radius;
  const double quarter = r.edge_radius * pi / 2;
  const double cuts_s[] = {0, straight, straight + arc, 2 * straight + arc, around};
  const double cuts_t[] = {-120, 0, quarter, quarter + 200};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j)
      best = std::fmin(best, search(
                                 p, {cuts_s[i], cuts_s[i + 1]}, {cuts_t[j], cuts_t[j + 1]},
                                 [&](double s, double t) { return ring_point(r, s, t); }, 24));
  return best;
}

}  // namespace

TEST_SUITE_BEGIN("contact");

TEST_CASE("V-CONT-01 plane, sphere and cylinder give the exact signed distance and its gradient") {
  const auto points = random_points(40, {-30, -40, -35}, {40, 30, 45}, 11);
  int outside = 0, inside = 0;

  SUBCASE("plane") {
    const Point at{3, -2, 5}, normal{1, -2, 2.5};
    const Plane<double> plane(at, normal);
    Point a, b;
    const Point n = (1 / norm(normal)) * normal;
    frame_across(n, a, b);
    for (const Point& p : points) {
      const double expected = search(p, {-150, 150}, {-150, 150},
                                     [&](double s, double t) { return at + s * a + t * b; });
      const auto answer = plane.gap(p);
      ++(answer.gap > 0 ? outside : inside);
      CHECK(std::abs(std::abs(answer.gap) - expected) < search_tolerance);
      CHECK((dot(p - at, n) > 0) == (answer.gap > 0));
      check_foot_point(plane, p);
      check_parallel(plane, p, 1.25);
    }
  }
  SUBCASE("sphere") {
    const Point centre{4, 1, 2};
    const double radius = 25;
    const Sphere<double> sphere(centre, radius);
    for (const Point& p : points) {
      const double expected = search(p, {0, pi}, {0, 2 * pi}, [&](double s, double t) {
        return centre + Point{radius * std::sin(s) * std::cos(t),
                              radius * std::sin(s) * std::sin(t), radius * std::cos(s)};
      });
      const auto answer = sphere.gap(p);
      ++(answer.gap > 0 ? outside : inside);
      CHECK(std::abs(std::abs(answer.gap) - expected) < search_tolerance);
      CHECK((norm(p - centre) > radius) == (answer.gap > 0));
      check_foot_point(sphere, p);
      check_parallel(sphere, p, -3.5);
    }
    const auto centre_answer = sphere.gap(centre);
    CHECK(centre_answer.gap == -radius);
    CHECK(norm(centre_answer.normal) == 1);
  }
  SUBCASE("cylinder") {
    const Point on_axis{-2, 3, 1}, axis{2, 1, -0.5};
    const double radius = 18;
    const Cylinder<double> cylinder(on_axis, axis, radius);
    const Point e = (1 / norm(axis)) * axis;
    Point a, b;
    frame_across(e, a, b);
    for (const Point& p : points) {
      const double expected = search(p, {0, 2 * pi}, {-150, 150}, [&](double s, double t) {
        return on_axis + t * e + (radius * std::cos(s)) * a + (radius * std::sin(s)) * b;
      });
      const auto answer = cylinder.gap(p);
      ++(answer.gap > 0 ? outside : inside);
      CHECK(std::abs(std::abs(answer.gap) - expected) < search_tolerance);
      CHECK((norm(cross(p - on_axis, e)) > radius) == (answer.gap > 0));
      check_foot_point(cylinder, p);
      check_parallel(cylinder, p, 2.75);
    }
    const Cylinder<double> along_z({0, 0, 0}, {0, 0, 3}, 4);
    const auto axis_answer = along_z.gap(Point{0, 0, 7});
    CHECK(axis_answer.gap == -4);
    CHECK(norm(axis_answer.normal) == 1);
    CHECK(axis_answer.normal.z == 0);
  }
  // Premise: both signs were met.
  CHECK(outside >= 4);
  CHECK(inside >= 4);
}

TEST_CASE("V-CONT-02 the blank holder's gap is the exact signed distance in all four quadrants") {
  const StadiumRingParameters<double> r;
  const StadiumRing<double> ring(r);
  int quadrants[4] = {};

  SUBCASE("distance by search") {
    for (const Point& p : random_points(60, {-130, -240, -14}, {130, 240, 30}, 5)) {
      INFO("point ", p.x, " ", p.y, " ", p.z);
      const double expected = ring_distance(r, p);
      REQUIRE(expected > 0.01);
      CHECK(std::abs(std::abs(ring.gap(p).gap) - expected) < search_tolerance);
      check_foot_point(ring, p);
      ++quadrants[(p.x < 0) + 2 * (p.y < 0)];
    }
  }
  SUBCASE("sign and normal on both sides of every piece") {
    const double around = 4 * r.centre_distance + 2 * pi * r.opening_radius;
    const double quarter = r.edge_radius * pi / 2;
    const double probe = 1e-4;
    for (int i = 0; i < 37; ++i)
      for (double t :
           {-7.0, -1.0, 0.2 * quarter, 0.5 * quarter, 0.9 * quarter, quarter + 2, quarter + 30}) {
        const double s = around * (i + 0.5) / 37;
        const Point p = ring_point(r, s, t);
        // Tangents by central differences of the parametrisation, error O(probe^2) ~ 1e-8 / r_e.
        const Point along = ring_point(r, s + probe, t) - ring_point(r, s - probe, t);
        const Point over = ring_point(r, s, t + probe) - ring_point(r, s, t - probe);
        Point n = cross(over, along);
        n = (1 / norm(n)) * n;
        // Everywhere on the ring the fabric lies upwards or towards the opening's middle line.
        const double middle_y = std::fmax(-r.centre_distance, std::fmin(r.centre_distance, p.y));
        const double width = std::hypot(p.x, p.y - middle_y);
        if (dot(n, Point{-p.x / width, (middle_y - p.y) / width, 1}) < 0) n = -1.0 * n;
        for (double d : {-0.8 * r.edge_radius, -0.1, 0.1, 20.0}) {
          const Point q = p + d * n;
          INFO("arc lengths ", s, " ", t, ", distance ", d);
          const auto answer = ring.gap(q);
          CHECK(std::abs(answer.gap - d) < 1e-7);  // d times the tangents' error, squared
          CHECK(norm(answer.normal - n) < 1e-6);   // the tangents' error
          check_foot_point(ring, q);
        }
        ++quadrants[(p.x < 0) + 2 * (p.y < 0)];
      }
  }
  for (int q : quadrants) CHECK(q > 5);  // premise: every quadrant was met
}

TEST_CASE("V-CONT-03 the blank holder is C1 and its parallel surface is exact") {
  const StadiumRingParameters<double> r;
  const StadiumRing<double> ring(r);

  SUBCASE("the normal turns continuously across every border") {
    // Two points 2 eps apart, straddling a border: the change of normal may only be curvature
    // times distance, at most 2 eps / r_e on the surface, and 2 eps / (r_e + gap) off it.
    struct Border {
      Point at, across;
    };
    const double y_c = r.centre_distance, b = r.opening_radius, e = r.edge_radius;
    const std::vector<Border> borders = {
        {{b + e, 30, 0}, {1, 0, 0}},            // rounding to flat
        {{b + e, 30, 2}, {1, 0, 0}},            // the same, above the surface
        {{b, 30, -e}, {0, 0, 1}},               // wall to rounding
        {{b + 0.6 * e, y_c, -0.2}, {0, 1, 0}},  // straight side to half circle
        {{-b - 0.6 * e, -y_c, -0.2}, {0, 1, 0}},
        {{b + 9, y_c, 0}, {0, 1, 0}},
        {{0, y_c + b + 2, 0}, {1, 0, 0}},  // the y axis, on the half circle
        {{b + 2, 0, 0}, {0, 1, 0}},        // the x axis
    };
    for (const Border& border : borders) {
      double previous = 0;
      for (double eps : {1e-2, 1e-3, 1e-4, 1e-5}) {
        const auto plus = ring.gap(border.at + eps * border.across);
        const auto minus = ring.gap(border.at - eps * border.across);
        const double turn = norm(plus.normal - minus.normal);
        INFO("at ", border.at.x, " ", border.at.y, " ", border.at.z, ", eps ", eps);
        CHECK(std::abs(plus.gap - minus.gap) <= 2 * eps * (1 + 1e-9));
        CHECK(turn <= 2.1 * eps / e + 1e-14);
        // Rate 1: a tenth of the distance, a tenth of the turn (or none, where both are flat).
        if (previous > 1e-12) CHECK(turn < 0.11 * previous);
        previous = turn;
      }
    }
  }
  SUBCASE("parallel surface") {
    for (double d : {-4.0, 0.5, 2.0})
      for (const Point& p : random_points(40, {-130, -240, -3}, {130, 240, 30}, 6)) {
        check_parallel(ring, p, d);
        // The same surface built from its own dimensions: opening r - d, edge r_e + d, flat at d.
        const StadiumRing<double> direct(
            {r.opening_radius - d, r.centre_distance, r.edge_radius + d});
        CHECK(std::abs(direct.gap(p - Point{0, 0, d}).gap - ring.offset(d).gap(p).gap) < rounding);
      }
  }
}

TEST_SUITE_END();
