// Stress and tangent of the law by the complex step.

#include "support/complex_step.hpp"

#include "law/laws.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

TEST_SUITE_BEGIN("law");

TEST_CASE("V-LAW-20 the complex step gives S from the energy and dS/dE from S") {
  using crossbeam::Matrix2;
  using verify::ComplexStep;
  VERIFY_RANDOM(random, 3020);
  verify::Worst stress, tangent;
  for (const int degrees : {60, 90, 120})
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      for (const bool bending : {true, false}) {
        crossbeam::CellParameters<double> p;
        if (!bending) p.warp.second_moment_of_area = p.weft.second_moment_of_area = 0;
        const auto angle = verify::fibre_angle<double>(degrees);
        using Cell = crossbeam::CrossedBeamCell<double>;
        const auto law_with = [&](crossbeam::SolverControl control) {
          return crossbeam::WovenMembrane(Cell(p), shear, angle, crossbeam::YarnWidth::corrected,
                                          control);
        };
        const auto law = law_with(crossbeam::SolverControl::converged());
        const auto closed = [&](const Matrix2<double>& E) {
          const auto c = crossbeam::fibre_from_cartesian(angle);
          return law.evaluate(crossbeam::fibre_strain<double>(E, c)).cell.contact_stiffness > 0;
        };
        for (int sample = 0; sample < 20; ++sample) {
          Matrix2<double> E;
          bool steady;
          do {  // off the kink of the contact
            E = verify::random_strain(random, degrees, 1e-3);
            const Matrix2<double> d = 1e-6 * Matrix2<double>::Identity();
            steady = closed(E + d) == closed(E - d);
          } while (!steady);
          const auto r = crossbeam::membrane_response(law, E, crossbeam::Tangent::yes);
          REQUIRE(r.status == crossbeam::CellStatus::converged);
          // More sweeps than the solver needs: derivatives have to converge too (V-CELL-31).
          const auto fixed = law_with(crossbeam::SolverControl::fixed(10));
          for (int j = 0; j < 3; ++j) {
            // Column j of (E11, E22, 2 E12).
            Matrix2<ComplexStep> z = E.cast<ComplexStep>();
            const ComplexStep i(
                std::complex<double>(0, j < 2 ? ComplexStep::h : ComplexStep::h / 2));
            z(j == 1, j != 0) += i;
            if (j == 2) z(1, 0) += i;
            const auto by_step = crossbeam::membrane_response(fixed, z);
            const double S[3] = {r.S(0, 0), r.S(1, 1), r.S(0, 1)};
            const ComplexStep by[3] = {by_step.S(0, 0), by_step.S(1, 1), by_step.S(0, 1)};
            stress.see(
                std::abs(by_step.energy.derivative() - S[j]) / (0.03 * law.stiffness_bound()), name,
                degrees, bending, j);
            for (int row = 0; row < 3; ++row)
              tangent.see(std::abs(by[row].derivative() - r.dS_dE(row, j)) / law.stiffness_bound(),
                          name, degrees, bending, row, j);
          }
        }
      }
    });
  // Some roundings of the stiffness times a strain of 3 %, and of the stiffness.
  stress.claim("V-LAW-20", 1e-14, "dW/dE against S, 8 shear layers, 60/90/120 deg, relative");
  tangent.claim("V-LAW-20", 1e-14, "dS/dE against the tangent, relative");
}

TEST_SUITE_END();
