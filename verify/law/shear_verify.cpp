// Shear layers: their tractions and moduli against independent integration, their measures and
// frames, their derivatives by nested dual numbers, and what they refuse.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"
#include "crossbeam/law/woven_membrane.hpp"

#include "law/laws.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

using crossbeam::Dual;
using crossbeam::FibreState;
using crossbeam::FibreStrain;
using crossbeam::InputError;

template <class T>
FibreState<T> fibre_state(const T& b11, const T& b22, const T& b12) {
  return {{b11, b22, b12}, crossbeam::stretch(b11), crossbeam::stretch(b22)};
}

/// Pure shear by gamma of fibres of constant length: beta12 = (cos(delta - gamma) - cos delta) / 2.
FibreState<double> pure_shear(double gamma, int degrees) {
  const double delta = verify::radians<double>(degrees);
  return fibre_state(0.0, 0.0, 0.5 * (std::cos(delta - gamma) - std::cos(delta)));
}

/// The traction conjugate to gamma in pure shear, from the law's gradient: dW/dbeta12
/// dbeta12/dgamma.
template <class Shear>
double traction(const Shear& shear, double gamma, int degrees) {
  const double delta = verify::radians<double>(degrees);
  return shear.gradient(pure_shear(gamma, degrees)).g3 * 0.5 * std::sin(delta - gamma);
}

double horner(const std::vector<double>& a, double x) {
  double sum = 0;
  for (std::size_t k = a.size(); k-- > 0;) sum = sum * x + a[k];
  return sum;
}

}  // namespace

TEST_SUITE_BEGIN("law");

TEST_CASE(
    "V-LAW-10 the traction of every shear layer is the integral of its modulus, odd in gamma") {
  // Three-point Gauss rules, exact for the quartic modulus and its integral.
  const auto integral = [](const auto& f, double to) {
    const double d = std::sqrt(0.15) * to, middle = 0.5 * to;
    return to / 18 * (5 * f(middle - d) + 8 * f(middle) + 5 * f(middle + d));
  };
  verify::Worst polynomial, energy, table, oddness;
  for (const int degrees : {60, 90, 120}) {
    const auto angle = verify::fibre_angle<double>(degrees);
    for (const auto& coefficients : {verify::law_A, verify::law_B}) {
      const auto shear = verify::polynomial_shear<double>(coefficients, angle);
      const auto modulus = [&](double g) { return 1e-3 * horner(coefficients, std::abs(g)); };
      const auto tau = [&](double g) { return integral(modulus, g); };
      for (double gamma = 0.02; gamma < 0.9; gamma += 0.06) {
        const double expected = tau(gamma);
        polynomial.see(std::abs(traction(shear, gamma, degrees) / expected - 1), degrees, gamma);
        energy.see(std::abs(shear.energy(pure_shear(gamma, degrees)) / integral(tau, gamma) - 1),
                   degrees, gamma);
        oddness.see(std::abs(traction(shear, -gamma, degrees) / expected + 1), degrees, gamma);
      }
      CHECK(traction(shear, 0.0, degrees) == doctest::Approx(0.0));
    }
    // The tabulated law passes through its points, is straight between and beyond them.
    const auto shear = verify::tabulated_shear<double>(angle);
    const auto curve = [](double g) {
      return g < 0.35 ? 2e-5 / 0.35 * g : 2e-5 + 7e-5 / 0.35 * (g - 0.35);
    };
    for (const double gamma : {0.1, 0.35, 0.5, 0.7, 0.8, 0.95}) {
      table.see(std::abs(traction(shear, gamma, degrees) / curve(gamma) - 1), degrees, gamma);
      oddness.see(std::abs(traction(shear, -gamma, degrees) / curve(gamma) + 1), degrees, gamma);
    }
  }
  // The angle comes from a cosine: 1e-16 / (sin delta gamma) with gamma >= 0.02 is 1e-14, which the
  // laws' powers of gamma may triple.
  polynomial.claim("V-LAW-10", 1e-13, "polynomial laws A and B against Gauss' rule");

  const auto right = verify::fibre_angle<double>(90);
  const auto drawn = [&](const char* name, const auto& shear) {
    verify::Curve curve{name, {}, {}};
    for (int k = -45; k <= 45; ++k) {
      curve.x.push_back(0.02 * k);
      curve.y.push_back(1e3 * traction(shear, 0.02 * k, 90));
    }
    return curve;
  };
  verify::Plot plot{"V-LAW-10",
                    "Shear laws",
                    "shear angle gamma [rad]",
                    "shear traction [N/mm]",
                    false,
                    false,
                    {drawn("law A", verify::polynomial_shear<double>(verify::law_A, right)),
                     drawn("law B", verify::polynomial_shear<double>(verify::law_B, right)),
                     drawn("tabulated", verify::tabulated_shear<double>(right))},
                    "Odd in gamma, from small to locking angles; dots: modulus integrated by "
                    "Gauss' rule."};
  verify::Curve dots{"by Gauss' rule", {}, {}, verify::Curve::Style::points};
  for (const auto& coefficients : {verify::law_A, verify::law_B})
    for (int k = -4; k <= 4; ++k) {
      dots.x.push_back(0.2 * k);
      const auto modulus = [&](double g) { return horner(coefficients, std::abs(g)); };
      dots.y.push_back(integral(modulus, 0.2 * k));
    }
  plot.curves.push_back(dots);
  verify::show(plot);
  energy.claim("V-LAW-10", 1e-13, "their energy against Gauss' rule applied twice");
  table.claim("V-LAW-10", 1e-13, "tabulated law at and between its points");
  oddness.claim("V-LAW-10", 1e-13, "tau(-gamma) = -tau(gamma)");

  // The bound of the modulus that the critical time step needs is its largest value up to 1 rad: at
  // the end, at the beginning or between. Scanned by differences of the traction.
  verify::Worst bounds;
  using crossbeam::PolynomialCurve;
  for (const std::vector<double>& a :
       {std::vector<double>{1e-3, 2e-3}, {3e-3, -1e-3}, {1e-3, 0.0, 5e-3, -4e-3}, verify::law_A}) {
    const PolynomialCurve<double> curve(a);
    double largest = 0;
    for (int k = 0; k <= 4000; ++k) {
      const double g = k / 4000.0, h = 1e-5;
      largest = std::max(largest, (curve.traction(g + h) - curve.traction(g - h)) / (2 * h));
    }
    const crossbeam::PolynomialShear<double> shear(curve);
    bounds.see(std::abs(shear.modulus_bound() / largest - 1), "polynomial of", a.size(), "terms");
  }
  bounds.see(std::abs(verify::tabulated_shear<double>(right).modulus_bound() / 2e-4 - 1), "table");
  // Eq. 26 in pure shear: E12 = beta12 / sin delta, dtau/dgamma = d2W/dgamma2 at rest = G.
  for (const int degrees : {60, 90, 120})
    for (const auto frame : {crossbeam::ShearFrame::cartesian, crossbeam::ShearFrame::fibre}) {
      const double sine = std::sin(verify::radians<double>(degrees));
      const auto shear = crossbeam::between_yarns(
          crossbeam::ConstantShear<double>(0.003, crossbeam::ShearMeasure::tensor, frame),
          verify::fibre_angle<double>(degrees));
      const double b = frame == crossbeam::ShearFrame::cartesian ? 1 / sine : 1;
      bounds.see(std::abs(shear.modulus_bound() / (0.003 * b * b) - 1), "constant", degrees);
      // And the law: the yarns' bound plus four shear moduli, [C-10].
      const auto law = verify::woven(crossbeam::CellParameters<double>{}, shear, degrees);
      const double expected = law.cell().membrane_stiffness_bound(sine) + 4 * shear.modulus_bound();
      bounds.see(std::abs(law.stiffness_bound() / expected - 1), "law", degrees);
    }
  // Steps of 0.01 rad beside the largest value of the cubic: half a step squared times 12.
  bounds.claim("V-LAW-10", 1e-4, "bound of the modulus against its largest value up to 1 rad");
  CHECK(crossbeam::NoShear<double>{}.modulus_bound() == 0);
  // The modulus at a point of the table is that of the line that begins there.
  const crossbeam::TabulatedCurve<double> curve({0, 0.35, 0.7}, {0, 2e-5, 9e-5});
  CHECK(curve.modulus(0.0) == doctest::Approx(2e-5 / 0.35).epsilon(1e-14));
  CHECK(curve.modulus(0.35) == doctest::Approx(7e-5 / 0.35).epsilon(1e-14));
}

TEST_CASE("V-LAW-11 the two published moduli of the fabric agree at 0.5 rad, 0.186 MPa") {
  const auto modulus = [](const std::vector<double>& in_MPa) {
    return 1e3 * crossbeam::PolynomialCurve<double>([&] {
                   std::vector<double> a;
                   for (const double x : in_MPa) a.push_back(x / 1000);
                   return a;
                 }())
                     .modulus(0.5);
  };
  // Half a unit of the last printed digit.
  verify::claim("V-LAW-11", std::abs(modulus(verify::law_A) - 0.186), 5e-4,
                "law A at 0.5 rad [MPa]");
  verify::claim("V-LAW-11", std::abs(modulus(verify::law_B) - 0.186), 5e-4,
                "law B at 0.5 rad [MPa]");
}

TEST_CASE("V-LAW-12 shear input that is no elastic law is refused by name") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto angle = verify::fibre_angle<double>(90);
  int asked = 0, refused = 0;
  const auto must_refuse = [&](const std::string& field, auto action) {
    ++asked;
    CAPTURE(field);
    try {
      action();
      FAIL_CHECK("was accepted");
    } catch (const InputError& error) {
      const std::string what = error.what();
      CAPTURE(what);
      const bool named = error.field().find(field) != std::string::npos;
      CHECK(named);
      CHECK(what.find("is not admissible: ") != std::string::npos);
      refused += named;
    }
  };
  using Polynomial = crossbeam::PolynomialCurve<double>;
  using Table = crossbeam::TabulatedCurve<double>;
  using List = std::vector<double>;
  for (const double modulus : {-1e-3, nan, inf})
    must_refuse("shear.modulus", [&] { crossbeam::ConstantShear<double>{modulus}; });
  // A modulus that is negative somewhere below 1.2 rad: at zero, in the middle, at the end.
  // The last two are negative at zero alone, and beyond 1.195 rad alone.
  for (const List& a :
       {List{-1e-3}, List{0.05, -1, 1}, List{1, 0, -1}, List{-1e-3, 1}, List{1.195, -1}})
    must_refuse("shear.coefficients: G(", [&] { Polynomial{a}; });
  must_refuse("shear.coefficients", [&] { Polynomial{List{}}; });
  must_refuse("shear.coefficients", [&] { Polynomial{List(9, 1.0)}; });
  must_refuse("shear.coefficients[1]", [&] { Polynomial(List{1, nan}); });
  must_refuse("shear.coefficients[0]", [&] { Polynomial(List{inf, 1}); });
  must_refuse("shear.angle", [&] { Table({0}, {0}); });
  must_refuse("shear.angle", [&] { Table({0, 1}, {0, 1, 2}); });
  must_refuse("shear.angle[0]", [&] { Table({0.1, 1}, {0, 1}); });
  must_refuse("shear.traction[0]", [&] { Table({0, 1}, {0.1, 1}); });
  must_refuse("shear.angle[0]", [&] { Table({nan, 1}, {0, 1}); });
  must_refuse("shear.traction[0]", [&] { Table({0, 1}, {nan, 1}); });
  must_refuse("shear.traction[1]", [&] { Table({0, 1}, {0, nan}); });
  must_refuse("shear.angle[1]", [&] { Table({0, nan}, {0, 1}); });
  must_refuse("shear.angle[2]", [&] { Table({0, 0.5, 0.5}, {0, 1, 2}); });
  must_refuse("shear.angle[2]", [&] { Table({0, 0.5, 0.4}, {0, 1, 2}); });
  must_refuse("slope of shear.traction", [&] { Table({0, 0.5, 1}, {0, 1, 0.9}); });
  const double least_step = std::cbrt(std::numeric_limits<double>::epsilon());
  must_refuse("shear.angle[1]", [&] { Table({0, 0.99 * least_step}, {0, 1}); });
  CHECK_NOTHROW(Table({0, 1.01 * least_step}, {0, 1}));
  // The published laws and the edges of the ranges are accepted.
  CHECK_NOTHROW(crossbeam::ConstantShear<double>(0.0));
  CHECK_NOTHROW(verify::polynomial_shear<double>(verify::law_A, angle));
  CHECK_NOTHROW(verify::polynomial_shear<double>(verify::law_B, angle));
  CHECK_NOTHROW(Polynomial(List{0}));
  CHECK_NOTHROW(Polynomial(List{1.205, -1}));
  CHECK_NOTHROW(Table({0, 1}, {0, 0}));
  REQUIRE(asked == 24);
  // A count: every one of them or the claim is false.
  verify::claim("V-LAW-12", asked - refused, 0, "bad shear inputs that were not refused by name");
}

TEST_CASE("V-LAW-13 nested dual numbers of the shear energy give its gradient and Hessian") {
  VERIFY_RANDOM(random, 3013);
  verify::Worst gradient, hessian;
  using D = Dual<double, 3>;
  using DD = Dual<D, 3>;
  for (const int degrees : {60, 90, 120}) {
    const auto angle = verify::fibre_angle<double>(degrees);
    const auto c = crossbeam::fibre_from_cartesian(angle);
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      for (int sample = 0; sample < 30; ++sample) {
        const auto beta =
            crossbeam::fibre_strain<double>(verify::random_strain(random, degrees, 1e-3), c);
        const auto s = fibre_state(beta.b11, beta.b22, beta.b12);
        const auto g = shear.gradient(s);
        const auto h = shear.hessian(s);
        const auto variable = [](double v, int k) { return DD::variable(D::variable(v, k), k); };
        const DD W = shear.energy(
            fibre_state(variable(beta.b11, 0), variable(beta.b22, 1), variable(beta.b12, 2)));
        const double closed_g[3] = {g.g1, g.g2, g.g3};
        const double closed_h[3][3] = {
            {h.h11, h.h12, h.h13}, {h.h12, h.h22, h.h23}, {h.h13, h.h23, h.h33}};
        // Moduli of 1e-4 kN/mm times the geometry's factors of up to 1/sin^3(20 deg) = 25.
        constexpr double scale = 1e-3;
        for (int i = 0; i < 3; ++i) {
          gradient.see(std::abs(W.value.d[i] - closed_g[i]) / scale, name, degrees, "component", i);
          for (int j = 0; j < 3; ++j)
            hessian.see(std::abs(W.d[i].d[j] - closed_h[i][j]) / scale, name, degrees, "component",
                        i, j);
        }
      }
    });
  }
  gradient.claim("V-LAW-13", 1e-12, "gradient, relative to 1e-3 kN/mm");
  hessian.claim("V-LAW-13", 1e-12, "Hessian, relative to 1e-3 kN/mm");
}

TEST_CASE(
    "V-LAW-15 measures and frames of Eq. 26: a factor of two, and a difference when oblique") {
  using namespace crossbeam;
  const double G = 0.001;
  verify::Worst factor, frames, tensor;
  const auto at = [](int degrees) {
    const auto c = fibre_from_cartesian(verify::fibre_angle<double>(degrees));
    const Matrix2<double> E = verify::strain_of(1.02, 0.99, 0.25, degrees);
    const auto beta = fibre_strain<double>(E, c);
    return std::pair(fibre_state(beta.b11, beta.b22, beta.b12), E(0, 1));
  };
  for (const int degrees : {60, 90, 120}) {
    const auto angle = verify::fibre_angle<double>(degrees);
    const auto [s, E12] = at(degrees);
    const auto paper = between_yarns(ConstantShear<double>(G), angle);
    const auto engineering =
        between_yarns(ConstantShear<double>(G, ShearMeasure::engineering), angle);
    factor.see(std::abs(engineering.energy(s) / paper.energy(s) - 2), degrees);
    // Eq. 26 literally: S12 = G12 E12 with the tensor component, so W = G12 E12^2 (E12 and E21).
    tensor.see(std::abs(paper.strain(s.beta) / E12 - 1), degrees);
    tensor.see(std::abs(paper.energy(s) / (G * E12 * E12) - 1), degrees);
  }
  const auto [right, E12] = at(90);
  const ConstantShear<double> a(G);
  const ConstantShear<double> b(G, ShearMeasure::tensor, ShearFrame::fibre);
  frames.see(std::abs(a.energy(right) - b.energy(right)) / a.energy(right));
  factor.claim("V-LAW-15", 1e-15, "energy of the engineering measure over the tensor's, less 2");
  // beta12 is a difference of terms of order one times 0.1.
  tensor.claim("V-LAW-15", 1e-14, "W = G12 E12^2 with the Cartesian tensor component");
  frames.claim("V-LAW-15", 0, "Cartesian and fibre frame at 90 deg: the same bits");

  // Oblique yarns: stretching the warp alone leaves beta12 at its value but not the Cartesian E12,
  // so the paper's layer answers to a stretch with shear stress.
  const auto angle = verify::fibre_angle<double>(60);
  const auto stretched = fibre_state(0.01, 0.0, 0.0);
  const auto cartesian = between_yarns(ConstantShear<double>(G), angle);
  const auto fibre =
      between_yarns(ConstantShear<double>(G, ShearMeasure::tensor, ShearFrame::fibre), angle);
  CHECK(fibre.energy(stretched) == 0);
  verify::claim("V-LAW-15", std::abs(cartesian.gradient(stretched).g3) / (G * 0.01), 0.5,
                "spurious shear of a warp stretch at 60 deg, Cartesian frame",
                verify::Bound::lower);
}

namespace {

/// Largest difference between lanes and scalars in stress, energy and Hessian, in bits that differ.
template <class S, int N, class Shear>
int lanes_that_differ(verify::Random& random, const Shear& shear, int degrees) {
  using P = crossbeam::Pack<S, N>;
  using Cell = crossbeam::CrossedBeamCell<S>;
  const auto angle = verify::fibre_angle<S>(degrees);
  const crossbeam::WovenMembrane<Cell, Shear> law(Cell(crossbeam::CellParameters<S>{}), shear,
                                                  angle, crossbeam::YarnWidth::corrected,
                                                  crossbeam::SolverControl::fixed(3));
  const auto c = crossbeam::fibre_from_cartesian(verify::fibre_angle<double>(degrees));
  int different = 0;
  for (int sample = 0; sample < 50; ++sample) {
    FibreStrain<P> pack;
    std::vector<FibreStrain<S>> lanes;
    for (int i = 0; i < N; ++i) {
      const auto b =
          crossbeam::fibre_strain<double>(verify::random_strain(random, degrees, 0.0), c);
      lanes.push_back({S(b.b11), S(b.b22), S(b.b12)});
      pack.b11.set(i, lanes[i].b11);
      pack.b22.set(i, lanes[i].b22);
      pack.b12.set(i, lanes[i].b12);
    }
    const auto p = law.evaluate(pack);
    const auto mp = law.stress(p);
    const auto hp = law.hessian(p);
    const P Wp = law.yarn_energy(p) + law.shear_energy(p);
    for (int i = 0; i < N; ++i) {
      const auto s = law.evaluate(lanes[i]);
      const auto m = law.stress(s);
      const auto h = law.hessian(s);
      different += mp.m11[i] != m.m11 || mp.m22[i] != m.m22 || mp.m12[i] != m.m12 ||
                   Wp[i] != law.yarn_energy(s) + law.shear_energy(s) || hp.h11[i] != h.h11 ||
                   hp.h12[i] != h.h12 || hp.h13[i] != h.h13 || hp.h23[i] != h.h23 ||
                   hp.h33[i] != h.h33 || hp.h22[i] != h.h22;
    }
  }
  return different;
}

}  // namespace

TEST_CASE("V-LAW-19 the law answers in every lane as for the scalar, and in float as in double") {
  VERIFY_RANDOM(random, 3019);
  int different = 0;
  for (const int degrees : {60, 90}) {
    verify::for_each_shear<double>(degrees, [&](const std::string&, const auto& shear) {
      different += lanes_that_differ<double, 4>(random, shear, degrees);
    });
    verify::for_each_shear<float>(degrees, [&](const std::string&, const auto& shear) {
      different += lanes_that_differ<float, 8>(random, shear, degrees);
    });
  }
  // The same correctly rounded operations in the same order.
  verify::claim("V-LAW-19", different, 0,
                "lanes that differ in any bit of stress, energy, Hessian");

  verify::Worst single;
  for (const int degrees : {60, 90, 120}) {
    const auto in_double = verify::woven(
        crossbeam::CellParameters<double>{},
        verify::polynomial_shear<double>(verify::law_A, verify::fibre_angle<double>(degrees)),
        degrees);
    const auto in_float = verify::woven(
        crossbeam::CellParameters<float>{},
        verify::polynomial_shear<float>(verify::law_A, verify::fibre_angle<float>(degrees)),
        degrees);
    for (int sample = 0; sample < 500; ++sample) {
      const auto E = verify::random_strain(random, degrees, 0.01);
      const auto d = crossbeam::membrane_response(in_double, E);
      const auto f =
          crossbeam::membrane_response<decltype(in_float), float>(in_float, E.cast<float>());
      single.see(static_cast<double>((f.S.cast<double>() - d.S).cwiseAbs().maxCoeff()), degrees,
                 "deg, sample", sample);
    }
  }
  // The strains arrive rounded, up to 0.4 with the shear: 20 roundings times 14 / sin^2 kN/mm.
  single.claim("V-LAW-19", 20 * 0.4 * 14 / 0.75 * std::numeric_limits<float>::epsilon(),
               "float against double, S [kN/mm]");
}

TEST_SUITE_END();
