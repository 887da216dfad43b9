// S = 2 dW/dC and its tangent, for every shear layer and oblique fibres: by the rate of Taylor
// remainders and by dual numbers.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/law/woven_membrane.hpp"

#include "law/laws.hpp"
#include "support/claim.hpp"
#include "support/plots.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace {

using crossbeam::Dual;
using crossbeam::Matrix2;
using crossbeam::Matrix3;
using crossbeam::Tangent;
using crossbeam::Vector3;

/// Strain tensor from (E11, E22, 2 E12).
template <class T>
Matrix2<T> tensor(const T& e11, const T& e22, const T& gamma12) {
  Matrix2<T> E;
  E(0, 0) = e11;
  E(1, 1) = e22;
  E(0, 1) = E(1, 0) = T(0.5) * gamma12;
  return E;
}

template <class R>
Vector3<R> stress_voigt(const Matrix2<R>& S) {
  return {S(0, 0), S(1, 1), S(0, 1)};
}

template <class Law, class T>
[[gnu::noinline]] crossbeam::MembraneResponse<T> response(const Law& law, const Matrix2<T>& E,
                                                          Tangent want = Tangent::no) {
  return crossbeam::membrane_response(law, E, want);
}

/// The cell's contact is the same at E and at E + every direction of size `margin`.
template <class Law>
bool contact_is_constant(const Law& law, const Matrix2<double>& E, double margin) {
  const auto c = crossbeam::fibre_from_cartesian(law.reference());
  const auto closed = [&](const Matrix2<double>& at) {
    return law.evaluate(crossbeam::fibre_strain<double>(at, c)).cell.contact_stiffness > 0;
  };
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        if (closed(E + margin * tensor<double>(i, j, k)) != closed(E)) return false;
  return true;
}

constexpr double margin = 1e-3;

}  // namespace

TEST_SUITE_BEGIN("law");

TEST_CASE("V-LAW-03 S is the energy's gradient and dS/dE its Hessian, by rate") {
  VERIFY_RANDOM(random, 3003);
  verify::Worst second, third, spoiled;
  verify::Plot plot{"V-LAW-03",
                    "",
                    "step, as a share of H",
                    "remainder of W [kN/mm]",
                    true,
                    true,
                    {},
                    "S is the derivative of W when the remainder falls with slope 2, dS/dE the "
                    "second one when it falls with slope 3; with an S12 wrong by 1 % the slope "
                    "turns from 2 to 1."};
  using X = long double;
  for (const int degrees : {60, 90, 120})
    verify::for_each_shear<X>(degrees, [&](const std::string& name, const auto& shear) {
      const auto law = verify::woven(crossbeam::CellParameters<X>{}, shear, degrees);
      const auto locator =
          verify::woven(crossbeam::CellParameters<double>{}, crossbeam::NoShear<double>{}, degrees);
      for (int sample = 0; sample < 6; ++sample) {
        Matrix2<double> at;
        do {
          at = verify::random_strain(random, degrees, 0.05);
        } while (!contact_is_constant(locator, at, margin));
        const Matrix2<X> E = at.cast<X>();
        const Matrix2<X> H = X(margin) * tensor<X>(random.uniform(0.3, 1), random.uniform(0.3, 1),
                                                   random.uniform(-1, 1));
        const auto r = response(law, E, Tangent::yes);
        REQUIRE(r.status == crossbeam::CellStatus::converged);
        REQUIRE(r.S.cwiseAbs().maxCoeff() > 0);
        const Vector3<X> h = crossbeam::strain_to_voigt(H), s = stress_voigt(r.S);
        const auto remainder = [&](double eps, bool tangent, X spoil) {
          const auto moved = response<decltype(law), X>(law, E + X(eps) * H);
          X rest =
              moved.energy - r.energy - X(eps) * (s(0) * h(0) + s(1) * h(1) + spoil * s(2) * h(2));
          if (tangent) rest -= X(eps) * X(eps) / 2 * h.dot(r.dS_dE * h);
          return rest;
        };
        // Roundings of energies EA/l0 strain^2 / A0.
        const double noise = 0.05 * static_cast<double>(std::numeric_limits<X>::epsilon());
        const auto slope_2 = verify::taylor_test(
            2, [&](double e) { return remainder(e, false, 1); }, 1, noise);
        second.see(slope_2.deviation, name, degrees, "deg, sample", sample, slope_2.table);
        const auto slope_3 = verify::taylor_test(
            3, [&](double e) { return remainder(e, true, 1); }, 1, noise);
        third.see(slope_3.deviation, name, degrees, "deg, sample", sample, slope_3.table);
        if (std::abs(s(2) * h(2)) > 1e-8) {
          const auto spoilt = [&](double e) { return remainder(e, false, 1.01L); };
          const auto wrong = verify::taylor_test(2, spoilt, 1, noise);
          spoiled.see(wrong.deviation);
          if (plot.curves.empty() && name == "polynomial B") {
            plot.title = "Taylor remainders of the membrane energy: " + name + ", " +
                         std::to_string(degrees) + " deg";
            plot.curves = {verify::remainders("with S", slope_2),
                           verify::remainders("with S and dS/dE", slope_3),
                           verify::remainders("S12 wrong by 1 %", wrong)};
            plot.curves.push_back(verify::guide("slope 2", 2, plot.curves[0]));
            plot.curves.push_back(verify::guide("slope 3", 3, plot.curves[1]));
          }
        }
      }
    });
  REQUIRE(second.seen() == 3 * 8 * 6);
  verify::show(plot);
  // The next term of the series at the last steps of the table; a wrong term shows as 1.
  second.claim("V-LAW-03", 0.02, "|slope - 2| of W with S, 8 shear layers, 60/90/120 deg");
  // Some states have next to no third derivative, and the fourth bends the slope.
  third.claim("V-LAW-03", 0.3, "|slope - 3| of W with S and dS/dE");
  verify::claim("V-LAW-03", spoiled.value(), 0.5,
                "an S12 wrong by 1 % is seen (mutation of the test)", verify::Bound::lower);
}

TEST_CASE("V-LAW-04 dS/dE is the derivative of S, by rate") {
  VERIFY_RANDOM(random, 3004);
  verify::Worst worst, spoiled;
  using X = long double;
  for (const int degrees : {60, 90, 120})
    verify::for_each_shear<X>(degrees, [&](const std::string& name, const auto& shear) {
      const auto law = verify::woven(crossbeam::CellParameters<X>{}, shear, degrees);
      const auto locator =
          verify::woven(crossbeam::CellParameters<double>{}, crossbeam::NoShear<double>{}, degrees);
      for (int sample = 0; sample < 6; ++sample) {
        Matrix2<double> at;
        do {
          at = verify::random_strain(random, degrees, 0.05);
        } while (!contact_is_constant(locator, at, margin));
        const Matrix2<X> E = at.cast<X>();
        const Vector3<X> direction(random.uniform(0.3, 1), random.uniform(0.3, 1),
                                   random.uniform(-1, 1));
        const Vector3<X> probe(random.uniform(0.3, 1), random.uniform(0.3, 1),
                               random.uniform(0.3, 1));
        const Vector3<X> h = X(margin) * direction;
        const Matrix2<X> H = tensor<X>(h(0), h(1), h(2));
        const auto r = response(law, E, Tangent::yes);
        REQUIRE(r.status == crossbeam::CellStatus::converged);
        const auto remainder = [&](double eps, X spoil) {
          const auto moved = response<decltype(law), X>(law, E + X(eps) * H);
          const Vector3<X> dS = stress_voigt(moved.S) - stress_voigt(r.S);
          return probe.dot(dS - spoil * X(eps) * (r.dS_dE * h));
        };
        const double noise = 10 * static_cast<double>(std::numeric_limits<X>::epsilon());
        const auto slope_2 = verify::taylor_test(
            2, [&](double e) { return remainder(e, 1); }, 1, noise);
        worst.see(slope_2.deviation, name, degrees, "deg, sample", sample, slope_2.table);
        spoiled.see(verify::taylor_test(
                        2, [&](double e) { return remainder(e, 1.001L); }, 1, noise)
                        .deviation);
      }
    });
  // As in V-LAW-03.
  worst.claim("V-LAW-04", 0.02, "|slope - 2| of S with dS/dE, 8 shear layers, 60/90/120 deg");
  verify::claim("V-LAW-04", spoiled.value(), 0.5,
                "a tangent wrong by 1e-3 is seen (mutation of the test)", verify::Bound::lower);
}

TEST_CASE("V-LAW-05 dual numbers agree with S and dS/dE to round-off") {
  VERIFY_RANDOM(random, 3005);
  verify::Worst stress, tangent, symmetry;
  using D = Dual<double, 3>;
  for (const int degrees : {60, 90, 120})
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      for (const bool bending : {true, false}) {
        crossbeam::CellParameters<double> p;
        if (!bending) p.warp.second_moment_of_area = p.weft.second_moment_of_area = 0;
        const auto law = verify::woven(p, shear, degrees);
        const double stiffness = law.stiffness_bound();
        for (int sample = 0; sample < 20; ++sample) {
          Matrix2<double> E;
          do {
            E = verify::random_strain(random, degrees, 1e-3);
          } while (!contact_is_constant(law, E, 1e-6));
          const auto r = response(law, E, Tangent::yes);
          REQUIRE(r.status == crossbeam::CellStatus::converged);
          const auto by_dual =
              response(law, tensor(D::variable(E(0, 0), 0), D::variable(E(1, 1), 1),
                                   D::variable(E(0, 1) + E(1, 0), 2)));
          const Vector3<double> S = stress_voigt(r.S);
          const D dual_S[3] = {by_dual.S(0, 0), by_dual.S(1, 1), by_dual.S(0, 1)};
          for (int i = 0; i < 3; ++i) {
            // Roundings of the yarns' stiffness times a strain of 3 %, and of the stiffness itself.
            stress.see(std::abs(by_dual.energy.d[i] - S(i)) / (0.03 * stiffness), name, degrees);
            for (int j = 0; j < 3; ++j) {
              tangent.see(std::abs(dual_S[i].d[j] - r.dS_dE(i, j)) / stiffness, name, degrees);
              symmetry.see(std::abs(dual_S[i].d[j] - dual_S[j].d[i]) / stiffness, name, degrees);
            }
          }
        }
      }
    });
  stress.claim("V-LAW-05", 1e-12, "dual derivative of W against S");
  tangent.claim("V-LAW-05", 1e-12, "dual derivative of S against dS/dE");
  symmetry.claim("V-LAW-05", 1e-12, "asymmetry of the dual derivative of S");
}

TEST_CASE("V-LAW-08 the tangent has major symmetry, and loses it with the second-order cell") {
  VERIFY_RANDOM(random, 3008);
  verify::Worst closed_form;
  for (const int degrees : {60, 90, 120})
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      const auto law = verify::woven(crossbeam::CellParameters<double>{}, shear, degrees);
      for (int sample = 0; sample < 50; ++sample) {
        const Matrix2<double> E = verify::random_strain(random, degrees, 1e-3);
        const Matrix3<double> K = response(law, E, Tangent::yes).dS_dE;
        closed_form.see((K - K.transpose()).cwiseAbs().maxCoeff() / law.stiffness_bound(), name,
                        degrees);
      }
    });
  // The product V^T H V is summed in another order above and below the diagonal.
  closed_form.claim("V-LAW-08", 1e-15, "K - K^T, relative to the straight yarn's stiffness");

  // The test can fail: the cell without a potential, by differences of its stress.
  using Law =
      crossbeam::WovenMembrane<crossbeam::SecondOrderCell<double>, crossbeam::NoShear<double>>;
  const Law law(crossbeam::SecondOrderCell<double>(crossbeam::CellParameters<double>{}),
                crossbeam::NoShear<double>{});
  const auto stress = [&](double e11, double e22) {
    return crossbeam::membrane_response(law, tensor<double>(e11, e22, 0)).S;
  };
  constexpr double h = 1e-6;
  const double d12 = stress(0.02, h)(0, 0) - stress(0.02, -h)(0, 0);
  const double d21 = stress(0.02 + h, 0)(1, 1) - stress(0.02 - h, 0)(1, 1);
  verify::claim("V-LAW-08", std::abs(d12 - d21) / std::abs(d12 + d21) * 2, 0.4,
                "asymmetry with the second-order cell at E = (2, 0) %", verify::Bound::lower);
}

TEST_SUITE_END();
