// Cartesian axes, strains and area ratio from arbitrary element bases (paper, Eq. 1-7, 22-23)
// against vector geometry that uses none of those formulas.

#include "crossbeam/kinematics/convected.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"

#include "support/claim.hpp"
#include "support/random.hpp"
#include "support/reference_states.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace {

using crossbeam::Base;
using crossbeam::Matrix2;
using crossbeam::Vector3;
using std::numbers::pi;

/// Sine of the angle between the base vectors.
double skewness(const Base<double>& base) {
  return base.col(0).normalized().cross(base.col(1).normalized()).norm();
}

/// A base of unequal lengths, not closer to degenerate than 10 deg.
Base<double> random_base(verify::Random& random) {
  Base<double> base;
  do {
    base.col(0) = random.vector(1);
    base.col(1) = random.log_uniform(0.1, 10) * random.vector(1);
  } while (skewness(base) < 0.17 || base.col(0).norm() < 0.1);
  return base;
}

}  // namespace

TEST_SUITE_BEGIN("kinematics");

TEST_CASE("V-KIN-01 Eq. 5 turns any skew element base into orthonormal axes") {
  VERIFY_RANDOM(random, 1001);
  verify::Worst orthonormal, turned;
  for (int sample = 0; sample < 2000; ++sample) {
    const Base<double> A = random_base(random);
    const double alpha = random.uniform(-pi, pi);
    REQUIRE(skewness(A) >= 0.17);
    const Base<double> Y =
        crossbeam::cartesian_axes(A, crossbeam::cartesian_from_convected(A, alpha));
    orthonormal.see((Y.transpose() * Y - Matrix2<double>::Identity()).cwiseAbs().maxCoeff(),
                    "sample", sample);
    // Independent route: Gram-Schmidt on the base, then a turn by alpha towards A2.
    const Vector3<double> e1 = A.col(0).normalized();
    const Vector3<double> e2 = (A.col(1) - A.col(1).dot(e1) * e1).normalized();
    const Vector3<double> Y1 = std::cos(alpha) * e1 + std::sin(alpha) * e2;
    const Vector3<double> Y2 = -std::sin(alpha) * e1 + std::cos(alpha) * e2;
    turned.see(std::max((Y.col(0) - Y1).norm(), (Y.col(1) - Y2).norm()), "sample", sample);
  }
  // Eq. 5 divides by the sine of the base's angle (>= 0.17 here): 16 roundings / 0.17^2 is 1e-13.
  orthonormal.claim("V-KIN-01", 1e-13, "largest entry of Y^T Y - 1, 2000 random bases");
  turned.claim("V-KIN-01", 1e-13, "distance from Gram-Schmidt axes turned by alpha_bar");

  verify::Worst table;
  for (const verify::Json& state : verify::reference_states()) {
    const auto A = verify::reference_base<double>(state, "A1", "A2");
    const auto Y =
        crossbeam::cartesian_axes(A, crossbeam::cartesian_from_convected(
                                         A, verify::reference_angle<double>(state, "alpha_deg")));
    const auto reference = verify::reference_base<double>(state, "Y1", "Y2");
    table.see((Y - reference).cwiseAbs().maxCoeff(), state.at("name"));
  }
  // Unit vectors from well-conditioned bases: some 10 roundings.
  table.claim("V-KIN-01", 5e-15, "axes of the 20 reference states");
}

TEST_CASE("V-KIN-02 strains follow the lengths of fibres drawn on the element") {
  VERIFY_RANDOM(random, 1002);
  verify::Worst stretch_error, strain_error, elongation_error, form_error;
  for (int degrees = 30; degrees <= 150; degrees += 5) {
    const double delta = degrees * pi / 180;
    const crossbeam::FibreAngle<double> angle(delta);
    const Matrix2<double> c = crossbeam::fibre_from_cartesian(angle);
    for (int sample = 0; sample < 40; ++sample) {
      const Base<double> A = random_base(random);
      const double alpha = random.uniform(-pi, pi);
      // Current base: a random homogeneous map of space with up to 30 % strain, and a rotation.
      Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
      for (int i = 0; i < 3; ++i) map.col(i) += random.vector(0.15);
      map = random.rotation() * map;
      REQUIRE(map.determinant() > 0.1);
      const Base<double> a = map * A;

      // The paper's chain: Eq. 3, 5, 6, 10, 13, 14.
      const Matrix2<double> d = crossbeam::cartesian_from_convected(A, alpha);
      const Matrix2<double> E =
          crossbeam::to_cartesian(crossbeam::convected_strain<double>(a, A), d);
      const auto beta = crossbeam::fibre_strain<double>(E, c);

      // Vector geometry: directions drawn on the element, mapped and measured.
      const Vector3<double> normal = A.col(0).cross(A.col(1)).normalized();
      const auto turned = [&](double by) -> Vector3<double> {
        const Vector3<double> e1 = A.col(0).normalized();
        return std::cos(by) * e1 + std::sin(by) * normal.cross(e1);
      };
      const Vector3<double> F1 = turned(alpha), F2 = turned(alpha + delta);
      const Vector3<double> f1 = map * F1, f2 = map * F2;

      // Strains of order one from metrics that carry the skewness once: 1e-13 as above.
      const double lambda1 = crossbeam::stretch(beta.b11), lambda2 = crossbeam::stretch(beta.b22);
      stretch_error.see(std::abs(lambda1 - f1.norm()), degrees, "deg, sample", sample);
      stretch_error.see(std::abs(lambda2 - f2.norm()), degrees, "deg, sample", sample);
      strain_error.see(std::abs(beta.b12 - 0.5 * (f1.dot(f2) - F1.dot(F2))), degrees, "deg, sample",
                       sample);
      elongation_error.see(
          std::abs(crossbeam::relative_elongation(beta.b11, lambda1) - (f1.norm() - 1)), degrees,
          "deg, sample", sample);
      // Every other way into the fibre strains gives the same numbers.
      using crossbeam::Vec3;
      const Vec3<double> v1{f1.x(), f1.y(), f1.z()}, v2{f2.x(), f2.y(), f2.z()};
      const Vec3<double> V1{F1.x(), F1.y(), F1.z()}, V2{F2.x(), F2.y(), F2.z()};
      const auto from_vectors = crossbeam::fibre_strain(v1, v2, angle.cosine);
      const auto from_increments =
          crossbeam::fibre_strain_from_increment<double>(v1 - V1, v2 - V2, V1, V2);
      const auto from_base_increments = crossbeam::fibre_strain<double>(
          crossbeam::to_cartesian(crossbeam::convected_strain_from_increment<double>(a - A, A), d),
          c);
      for (const auto& other : {from_vectors, from_increments, from_base_increments})
        form_error.see(std::max({std::abs(other.b11 - beta.b11), std::abs(other.b22 - beta.b22),
                                 std::abs(other.b12 - beta.b12)}),
                       degrees, "deg, sample", sample);
      // Eq. 22: the surface gradient carries the axes along; F1 = Y1.
      const Base<double> F = crossbeam::surface_gradient<double>(a, d);
      form_error.see((F.col(0) - f1).norm(), degrees, "deg, sample", sample, "(Eq. 22)");
    }
  }
  stretch_error.claim("V-KIN-02", 1e-13, "fibre stretches, delta_bar 30..150 deg");
  strain_error.claim("V-KIN-02", 1e-13, "beta12 against the dot product of the mapped fibres");
  elongation_error.claim("V-KIN-02", 1e-13, "elongation of Eq. 14");
  form_error.claim("V-KIN-02", 1e-13, "all forms of the fibre strain, and Eq. 22, agree");

  verify::Worst table;
  for (const verify::Json& state : verify::reference_states()) {
    const auto A = verify::reference_base<double>(state, "A1", "A2");
    const auto a = verify::reference_base<double>(state, "a1", "a2");
    const double alpha = verify::reference_angle<double>(state, "alpha_deg");
    const double delta = verify::reference_angle<double>(state, "delta_deg");
    const auto d = crossbeam::cartesian_from_convected(A, alpha);
    const auto E =
        crossbeam::to_cartesian(crossbeam::convected_strain_from_increment<double>(a - A, A), d);
    const auto c = crossbeam::fibre_from_cartesian(crossbeam::FibreAngle<double>(delta));
    const auto beta = crossbeam::fibre_strain<double>(E, c);
    const auto E0 = verify::matrix2<double>(state.at("E"));
    const auto b0 = verify::matrix2<double>(state.at("beta"));
    table.see((E - E0).cwiseAbs().maxCoeff(), state.at("name"), "E");
    table.see(std::max({std::abs(beta.b11 - b0(0, 0)), std::abs(beta.b22 - b0(1, 1)),
                        std::abs(beta.b12 - b0(0, 1))}),
              state.at("name"), "beta");
    table.see(std::abs(crossbeam::area_ratio(a, A) - verify::number<double>(state.at("J"))),
              state.at("name"), "J");
  }
  // The base vectors (5 mm) reach the test rounded: 5 eps / 5 mm, some ten times.
  table.claim("V-KIN-02", 5e-15, "E, beta and J of the 20 reference states, absolute");
}

namespace {

/// A strain of 1e-8 through every step of the chain in scalar S, compared with long double on the
/// same input; relative error of (beta11, beta22, beta12, elongation 1, elongation 2).
template <class S>
void measure_small_strain(verify::Random& random, verify::Worst& careful, verify::Worst& naive) {
  using X = long double;
  const S size = S(1e-8);
  for (int sample = 0; sample < 500; ++sample) {
    const Base<S> A = random_base(random).cast<S>();
    Base<S> increment;
    for (int i = 0; i < 2; ++i) {
      const Vector3<double> v = random.vector(1);
      increment.col(i) = size * v.cast<S>();
    }
    const S alpha = S(random.uniform(-pi, pi));
    const crossbeam::FibreAngle<S> angle(S(random.uniform(pi / 6, 5 * pi / 6)));

    const auto chain = [&](auto strain_of, auto zero) {
      using T = decltype(zero);
      const Base<T> reference = A.template cast<T>(), by = increment.template cast<T>();
      const Matrix2<T> d = crossbeam::cartesian_from_convected(reference, T(alpha));
      const Matrix2<T> E = crossbeam::to_cartesian<T>(strain_of(by, reference), d);
      const crossbeam::FibreAngle<T> delta(T(angle.delta));
      const auto beta = crossbeam::fibre_strain<T>(E, crossbeam::fibre_from_cartesian(delta));
      return std::array<T, 5>{
          beta.b11, beta.b22, beta.b12,
          crossbeam::relative_elongation(beta.b11, crossbeam::stretch(beta.b11)),
          crossbeam::relative_elongation(beta.b22, crossbeam::stretch(beta.b22))};
    };
    const auto from_increment = [](const auto& by, const auto& reference) {
      using T = typename std::decay_t<decltype(by)>::Scalar;
      return crossbeam::convected_strain_from_increment<T>(by, reference);
    };
    const auto from_metrics = [](const auto& by, const auto& reference) {
      using T = typename std::decay_t<decltype(by)>::Scalar;
      return crossbeam::convected_strain<T>(reference + by, reference);
    };
    const auto exact = chain(from_increment, X(0));
    const auto tested = chain(from_increment, S(0));
    const auto cancelling = chain(from_metrics, S(0));
    // Scale: the largest strain of the state. A single component may be a small difference of the
    // others, whose own digits it cannot have.
    X scale = 0;
    for (const X& x : exact) scale = std::max(scale, std::abs(x));
    REQUIRE(scale > X(1e-10L));
    REQUIRE(scale < X(1e-6L));
    for (int k = 0; k < 5; ++k) {
      careful.see(static_cast<double>(std::abs(X(tested[k]) - exact[k]) / scale), "sample", sample,
                  "component", k);
      naive.see(static_cast<double>(std::abs(X(cancelling[k]) - exact[k]) / scale), "sample",
                sample, "component", k);
    }
  }
}

}  // namespace

TEST_CASE("V-KIN-03 a strain of 1e-8 keeps its digits, in double and in float") {
  VERIFY_RANDOM(random, 1003);
  verify::Worst careful_double, naive_double, careful_float, naive_float;
  measure_small_strain<double>(random, careful_double, naive_double);
  measure_small_strain<float>(random, careful_float, naive_float);
  // Eq. 5 of a base as flat as 10 deg multiplies a rounding by up to 1/0.17^2 = 35; ten of them.
  constexpr double roundings = 400;
  careful_double.claim("V-KIN-03", roundings * std::numeric_limits<double>::epsilon(),
                       "relative error of the chain at 1e-8, double");
  careful_float.claim("V-KIN-03", roundings * std::numeric_limits<float>::epsilon(),
                      "relative error of the chain at 1e-8, float");
  // What the forms avoid: differences of metrics keep 8 digits in double and none in float.
  verify::claim("V-KIN-03", naive_double.value(), 1e-9,
                "the difference of metrics loses digits, double", verify::Bound::lower);
  verify::claim("V-KIN-03", naive_float.value(), 1.0,
                "the difference of metrics loses all digits, float", verify::Bound::lower);
}

TEST_CASE("V-KIN-05 bad kinematic input is refused by name, value and range") {
  using crossbeam::InputError;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  int refused = 0, asked = 0;
  const auto must_refuse = [&](auto action, const std::string& field) {
    ++asked;
    try {
      action();
    } catch (const InputError& error) {
      const std::string what = error.what();
      CAPTURE(what);
      CHECK(error.field() == field);
      CHECK(what.find(field + " = ") == 0);
      CHECK(what.find("is not admissible: ") != std::string::npos);
      refused += error.field() == field;
    }
  };
  for (const double delta : {0.0, -0.1, 0.9e-4, pi - 0.9e-4, pi, 3.5, nan, inf, -inf})
    must_refuse([&] { crossbeam::FibreAngle<double>{delta}; }, "delta_bar");

  Base<double> good;
  good << 5, 0, 0, 5, 0, 0;
  REQUIRE_NOTHROW(static_cast<void>(crossbeam::cartesian_from_convected(good, 0.3)));
  for (const double alpha : {nan, inf, -inf})
    must_refuse([&] { static_cast<void>(crossbeam::cartesian_from_convected(good, alpha)); },
                "alpha_bar");

  Base<double> parallel = good, zero = good, empty = good, infinite = good, huge = good;
  parallel.col(1) = -2 * parallel.col(0);
  zero.col(0).setZero();
  empty(1, 1) = nan;
  infinite(0, 0) = inf;
  huge *= 1e160;
  // Of square bases: the squared area, edge^4, is to be at least min/eps^2.
  const double eps = std::numeric_limits<double>::epsilon();
  const double least_edge = std::pow(std::numeric_limits<double>::min() / (eps * eps), 0.25);
  const Base<double> small = 1.001 * least_edge / 5 * good, tiny = 0.999 * least_edge / 5 * good;
  CHECK_NOTHROW(static_cast<void>(crossbeam::cartesian_from_convected(small, 0.3)));
  for (const Base<double>& bad : {parallel, zero, empty, infinite, huge, tiny})
    must_refuse([&] { static_cast<void>(crossbeam::cartesian_from_convected(bad, 0.3)); },
                "element base");
  // The edge of the admissible range stays open: nearly parallel fibres are legal.
  CHECK_NOTHROW(crossbeam::FibreAngle<double>{1.1e-4});
  CHECK_NOTHROW(crossbeam::FibreAngle<double>{pi - 1.1e-4});
  // A count: every one of them or the claim is false.
  verify::claim("V-KIN-05", asked - refused, 0, "bad inputs that were not refused by name");
}

TEST_CASE("V-KIN-06 the area ratio is that of triangles measured by Heron's formula") {
  VERIFY_RANDOM(random, 1006);
  // Kahan's form of Heron's formula: lengths alone, no cross product.
  const auto area = [](const Base<double>& base) {
    std::array<double, 3> s{base.col(0).norm(), base.col(1).norm(),
                            (base.col(0) - base.col(1)).norm()};
    std::sort(s.begin(), s.end());
    const double a = s[2], b = s[1], c = s[0];
    return std::sqrt((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))) / 4;
  };
  verify::Worst worst;
  for (int sample = 0; sample < 2000; ++sample) {
    const Base<double> A = random_base(random), a = random_base(random);
    const double expected = area(a) / area(A);
    worst.see(std::abs(crossbeam::area_ratio(a, A) / expected - 1), "sample", sample);
  }
  // Heron's side loses digits when one side is 1/60 of the others, as these bases allow: 1e-12.
  worst.claim("V-KIN-06", 1e-12, "relative error of sqrt(det a / det A)");
}

TEST_SUITE_END();
