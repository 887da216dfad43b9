// Kinematics and law under any strain: finite or refused, never a stress of a strain that cannot
// be.

#include "fuzz/properties.hpp"
#include "law/laws.hpp"
#include "support/claim.hpp"

#include "crossbeam/base/simd.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace crossbeam;
using verify::claim;

const double not_a_number = std::numeric_limits<double>::quiet_NaN();
const double inf = std::numeric_limits<double>::infinity();

/// Both signs of every special number.
std::vector<double> special_values() {
  std::vector<double> out;
  for (const double x : fuzz::special_numbers) {
    out.push_back(x);
    out.push_back(-x);
  }
  return out;
}

/// A component of a vector: mostly moderate, sometimes special.
double component(verify::Random& random, double scale) {
  static const std::vector<double> special = special_values();
  if (random.uniform(0, 1) < 0.1)
    return special[static_cast<std::size_t>(random.uniform(0, special.size()))];
  return scale * random.uniform(-1, 1);
}

Base<double> base(verify::Random& random) {
  const double scale =
      std::exp2(std::floor(random.uniform(-600, 600)) * (random.uniform(0, 1) < 0.5 ? 1 : 0));
  Base<double> A;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) A(i, j) = component(random, scale);
  return A;
}

}  // namespace

TEST_SUITE_BEGIN("stress");

TEST_CASE("V-STRESS-03 every law under every strain: finite, or a status") {
  const std::vector<double> values{0,    -0.0,  1e-310, -1e-310, 1e-16,        -1e-16, 0.02, -0.02,
                                   0.3,  -0.3,  -0.49,  -0.5,    -0.6,         1,      1e16, -1e16,
                                   1e75, 1e150, 1e300,  -1e300,  not_a_number, inf,    -inf};
  long broken = 0, answered = 0, no_answer = 0, missed = 0;
  for (const int degrees : {60, 90, 150})
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      using Shear = std::decay_t<decltype(shear)>;
      const bool hardens = name.find("polynomial") == std::string::npos;
      const auto angle = verify::fibre_angle<double>(degrees);
      const auto energy = verify::woven<double>(CellParameters<double>{}, shear, degrees);
      const WovenMembrane<SecondOrderCell<double>, Shear> second_order(
          SecondOrderCell<double>(CellParameters<double>{}), shear, angle);
      Matrix2<double> E;
      const auto ask = [&](const auto& law) {
        try {
          const auto outcome = fuzz::check_law(law, E, hardens);
          answered += outcome == fuzz::Outcome::answered;
          no_answer += outcome == fuzz::Outcome::no_answer;
        } catch (const fuzz::Broken& error) {
          FAIL_CHECK(name << ", " << degrees << " deg: " << std::string(error.what()));
          ++broken;
        }
      };
      for (const double E11 : values)
        for (const double E22 : values)
          for (const double E12 : values) {
            E << E11, E12, E12, E22;
            ask(energy);
            ask(second_order);
          }
      // What has no answer says so; small strains have one.
      const auto status = [&](double E11, double E22, double E12) {
        E << E11, E12, E12, E22;
        return membrane_response(energy, E, Tangent::yes).status;
      };
      for (const double none : {-0.5, -0.6, -1e16, not_a_number, inf, -inf})
        missed += status(none, 0, 0) == CellStatus::converged;
      for (const double shear_strain :
           {0.5, -0.5, 0.6, 1e16, not_a_number, inf})  // yarns on one line
        missed += status(0, 0, shear_strain) == CellStatus::converged;
      missed += status(0.01, 0.01, 0.02) != CellStatus::converged;
    });
  CAPTURE(no_answer);
  REQUIRE(answered > 50000);
  REQUIRE(no_answer > 50000);
  claim("V-STRESS-03", static_cast<double>(broken), 0,
        "answers called converged that are not finite, or of a strain that cannot be");
  claim("V-STRESS-03", static_cast<double>(missed), 0,
        "yarns without length, yarns on one line and NaN not noticed, or a good strain refused");
}

TEST_CASE("V-STRESS-04 kinematics: refused, or right and finite") {
  VERIFY_RANDOM(random, 7004);
  // Bases that span an area give orthonormal axes, the others are refused.
  long wrong = 0, answered = 0, refused = 0;
  for (int k = 0; k < 100000; ++k) {
    const Base<double> A = base(random), a = base(random);
    const double alpha = component(random, 3);
    try {
      const Matrix2<double> d = cartesian_from_convected(A, alpha);
      const Base<double> Y = cartesian_axes(A, d);
      // A base as flat as a thousand roundings keeps three digits.
      const bool good = (Y.transpose() * Y - Matrix2<double>::Identity()).norm() < 1e-2;
      CHECK_MESSAGE(good, A, " at ", alpha, " gives ", Y);
      wrong += !good;
      ++answered;
    } catch (const InputError&) {
      ++refused;
    }
    try {
      const double J = area_ratio(a, A);
      const bool good = std::isfinite(J) && J >= 0;
      CHECK_MESSAGE(good, "area ratio ", J, " of ", a, " over ", A);
      wrong += !good;
      Matrix2<double> S;
      S << 2, 1, 1, -1;
      const Matrix3<double> sigma = cauchy_stress<double>(S, Base<double>::Identity(), J);
      const bool stress = sigma.allFinite() || J < 1e-300;  // else the quotient is NaN
      CHECK_MESSAGE(stress, "Cauchy stress ", sigma, " for J = ", J);
      wrong += !stress;
    } catch (const InputError&) {
      ++refused;
    }
  }
  REQUIRE(answered > 10000);
  REQUIRE(refused > 10000);
  claim("V-STRESS-04", static_cast<double>(wrong), 0,
        "bases accepted whose axes are not orthonormal or whose area ratio is not finite");

  // Fibre angles: refused at 0 and 180 deg, otherwise with a sine to divide by.
  long bad = 0;
  for (const double x : special_values()) {
    try {
      const FibreAngle<double> angle(x);
      bad += !(angle.sine > 9e-5 && std::abs(angle.cosine) < 1);
    } catch (const InputError&) {
    }
    // The arcsine is clamped and keeps a NaN.
    const double angle = arcsine(x);
    bad += std::isnan(x) ? !std::isnan(angle) : !(std::abs(angle) <= 1.5707963267948968);
    const Pack<double, 4> lanes = arcsine(Pack<double, 4>(x));
    bad += !(lanes[2] == angle || (std::isnan(lanes[2]) && std::isnan(angle)));
    // The stretch of beta: what has no root is a NaN, which no cell calls converged.
    const double lambda = stretch(x);
    bad += x >= -0.5 && x < 1e307 ? !std::isfinite(lambda) : std::isfinite(lambda);
    // Polynomials of the strain do not fail below the square root of the largest number.
    if (!(std::abs(x) <= 1e75)) continue;
    Matrix2<double> E;
    E << x, x, x, -x;
    Base<double> A;
    A << x, 1, 2, x, 0, 3;
    bad += !fibre_from_cartesian(FibreAngle<double>(1)).allFinite();
    const auto beta = fibre_strain<double>(E, fibre_from_cartesian(FibreAngle<double>(1)));
    bad += !(std::isfinite(beta.b11) && std::isfinite(beta.b22) && std::isfinite(beta.b12));
    bad += !(metric(A).allFinite() && convected_strain(A, A).isZero() &&
             convected_strain_from_increment(A, A).allFinite() && to_cartesian(E, E).allFinite() &&
             surface_gradient(A, E).allFinite());
  }
  claim("V-STRESS-04", static_cast<double>(bad), 0,
        "fibre angles, arcsines, stretches and strains that are not finite where they have to be");
}

TEST_SUITE_END();
