// The signed shear angle and the arcsine that carries it.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"

#include "support/claim.hpp"
#include "support/random.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace {

using std::numbers::pi;

/// A number of the user's own, as a multiprecision type is: pi comes from its arctangent.
struct OwnNumber {
  long double value;
  explicit OwnNumber(int x) : value(x) {}
  friend OwnNumber atan(OwnNumber x) {
    x.value = std::atan(x.value);
    return x;
  }
  friend OwnNumber operator*(int a, OwnNumber b) {
    b.value *= a;
    return b;
  }
};

/// Angle between two plane vectors of directions a and b after stretches, through the public chain.
template <class S>
S shear_of(S delta_bar, S opening, S stretch1, S stretch2, S turn) {
  using crossbeam::Vec3;
  const crossbeam::FibreAngle<S> reference(delta_bar);
  const S delta = delta_bar - opening;
  const Vec3<S> f1{stretch1 * std::cos(turn), stretch1 * std::sin(turn), S(0)};
  const Vec3<S> f2{stretch2 * std::cos(turn + delta), stretch2 * std::sin(turn + delta), S(0)};
  const auto beta = crossbeam::fibre_strain(f1, f2, reference.cosine);
  const S l1 = crossbeam::stretch(beta.b11), l2 = crossbeam::stretch(beta.b22);
  return crossbeam::shear_angle(crossbeam::fibre_cosine(beta, l1, l2, reference.cosine), reference);
}

/// Distance from the long double value in units of the last place of S at that value.
template <class S>
double ulps(S value, long double exact) {
  const S near = static_cast<S>(exact);
  const S next = std::nextafter(std::abs(near), std::numeric_limits<S>::infinity());
  const long double ulp = static_cast<long double>(next) - std::abs(near);
  return static_cast<double>(std::abs(static_cast<long double>(value) - exact) / ulp);
}

template <class S, int Lanes>
void measure_arcsine(verify::Random& random, verify::Worst& below, verify::Worst& above,
                     verify::Worst& seam, verify::Worst& octant, verify::Worst& lanes) {
  using P = crossbeam::Pack<S, Lanes>;
  const auto see = [&](S x, verify::Worst& worst) {
    const S y = crossbeam::arcsine(x);
    worst.see(ulps(y, std::asin(static_cast<long double>(x))), "x =", x);
    CHECK(crossbeam::arcsine(-x) == -y);
    const P pack = crossbeam::arcsine(P(x));
    for (int i = 0; i < Lanes; ++i) lanes.see(pack[i] == y ? 0 : 1, "x =", x);
  };
  for (int sample = 0; sample < 20000; ++sample) {
    see(S(random.uniform(0, 0.5)), below);
    see(S(random.log_uniform(1e-12, 0.5)), below);
    see(S(random.uniform(0.5, 1)), above);
    see(S(1) - S(random.log_uniform(1e-7, 0.5)), above);
  }
  // The seam itself and its neighbours on both sides; the ends of the range.
  S low = S(0.5), high = S(0.5);
  for (int k = 0; k < 64; ++k) {
    see(low, seam);
    see(high, seam);
    low = std::nextafter(low, S(0));
    high = std::nextafter(high, S(1));
  }
  see(S(0), below);
  see(std::numeric_limits<S>::min(), below);
  see(S(1), above);
  // Mixed lanes: each branch in another lane.
  std::array<S, Lanes> x;
  for (int i = 0; i < Lanes; ++i) x[i] = S(-1) + S(2) * S(i) / S(Lanes - 1);
  const P mixed = crossbeam::arcsine(P::load(x.data()));
  for (int i = 0; i < Lanes; ++i)
    lanes.see(mixed[i] == crossbeam::arcsine(x[i]) ? 0 : 1, "mixed lane", i);
  // With the cosine of the answer given: turned into the octant about zero.
  for (int sample = 0; sample < 20000; ++sample) {
    const S angle_drawn = S(random.uniform(-pi / 2, pi / 2));
    const S c = std::sin(angle_drawn), root = std::sqrt((S(1) - c) * (S(1) + c));
    const S y = crossbeam::arcsine(c, root);
    const long double exact = std::asin(static_cast<long double>(c));
    octant.see(static_cast<double>(std::abs(static_cast<long double>(y) - exact)) /
                   static_cast<double>(std::numeric_limits<S>::epsilon()),
               "x =", c);
    CHECK(crossbeam::arcsine(-c, root) == -y);
    const P both = crossbeam::arcsine(P(c), P(root));
    for (int i = 0; i < Lanes; ++i) lanes.see(both[i] == y ? 0 : 1, "octant, x =", c);
  }
  // Beyond +-1 (rounding of a cosine) the answer is the end of the range, and NaN stays NaN.
  CHECK(crossbeam::arcsine(S(1.5)) == crossbeam::arcsine(S(1)));
  CHECK(crossbeam::arcsine(S(-1.5)) == -crossbeam::arcsine(S(1)));
  CHECK(std::isnan(crossbeam::arcsine(std::numeric_limits<S>::quiet_NaN())));
}

}  // namespace

TEST_SUITE_BEGIN("kinematics");

TEST_CASE("V-KIN-04 the shear angle is signed, blind to stretch and turn, and exact when small") {
  VERIFY_RANDOM(random, 1004);
  verify::Worst error;
  for (int degrees = 30; degrees <= 150; degrees += 10) {
    for (int sample = 0; sample < 100; ++sample) {
      const double delta = degrees * pi / 180;
      // Current angles between the yarns of 15..165 deg: away from the arcsine's infinite slope.
      const double opening = delta - random.uniform(pi / 12, 11 * pi / 12);
      const double gamma = shear_of(delta, opening, random.uniform(0.9, 1.1),
                                    random.uniform(0.9, 1.1), random.uniform(-pi, pi));
      CHECK((gamma > 0) == (opening > 0));
      error.see(std::abs(gamma - opening), degrees, "deg, opening", opening);
    }
  }
  // Slope of the arcsine <= 1/sin(15 deg) = 4 times some ten roundings of numbers near one.
  error.claim("V-KIN-04", 2e-14, "shear angle against the angle that was drawn [rad]");

  // Small shear of perpendicular yarns: the sine form keeps relative digits down to any angle,
  // where the arc cosine would answer 0 below 1e-8.
  verify::Worst small;
  const auto right = crossbeam::FibreAngle<double>::right();
  const auto right_float = crossbeam::FibreAngle<float>::right();
  for (double gamma = 1e-15; gamma < 0.1; gamma *= 7) {
    small.see(std::abs(crossbeam::shear_angle(std::sin(gamma), right) / gamma - 1), gamma);
    const float g = static_cast<float>(gamma);
    CHECK(std::abs(crossbeam::shear_angle(std::sin(g), right_float) / g - 1) < 4e-7f);
  }
  small.claim("V-KIN-04", 5e-16, "relative error of angles from 1e-15 rad, perpendicular yarns");
  CHECK(crossbeam::shear_angle(0.0, right) == 0.0);
  CHECK_FALSE(std::signbit(crossbeam::arcsine(0.0)));
  // The half circle of a number type that std does not know.
  CHECK(std::abs(crossbeam::detail::half_pi<OwnNumber>().value -
                 std::numbers::pi_v<long double> / 2) < 1e-18L);
  CHECK(pi / 2 - std::acos(1e-17) == 0.0);  // the form that was not taken
}

TEST_CASE("V-KIN-07 the arcsine polynomial is good to 2.5 ulps and the same in every lane") {
  VERIFY_RANDOM(random, 1007);
  verify::Worst below, above, seam, octant, lanes;
  measure_arcsine<double, 2>(random, below, above, seam, octant, lanes);
  measure_arcsine<double, 4>(random, below, above, seam, octant, lanes);
  measure_arcsine<double, 8>(random, below, above, seam, octant, lanes);
  measure_arcsine<float, 4>(random, below, above, seam, octant, lanes);
  measure_arcsine<float, 8>(random, below, above, seam, octant, lanes);
  measure_arcsine<float, 16>(random, below, above, seam, octant, lanes);
  // Up to 1/2 the last addition rounds once (1/2 ulp) and what it adds is at most 5 % of the sum.
  // Above, just behind the seam, in ulps of the result: 0.55 for the stored pi/2, twice 0.6 for the
  // small angle, 1/2 for the difference.
  below.claim("V-KIN-07", 0.75, "ulps, |x| <= 1/2, float and double");
  above.claim("V-KIN-07", 2.5, "ulps, |x| > 1/2, float and double");
  seam.claim("V-KIN-07", 2.5, "ulps, the 64 neighbours of 1/2 on either side");
  // Roundings of the stored pi/2, of the sum, and of the root through the slope of the octant.
  octant.claim("V-KIN-07", 2, "roundings of one, with the cosine of the answer given");
  // Bit for bit: both run the same correctly rounded operations in the same order.
  lanes.claim("V-KIN-07", 0, "lanes that differ from the scalar");
}

TEST_SUITE_END();
