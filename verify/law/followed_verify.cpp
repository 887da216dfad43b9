// The law that follows its cells: elongations, yarns and shear layer in three parts.

#include "law/laws.hpp"

#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace crossbeam;

/// A fabric whose yarns have nothing in common.
CellParameters<double> unequal_fabric() {
  CellParameters<double> p;
  p.weft.length *= 1.2;
  p.weft.cross_section *= 1.5;
  p.weft.second_moment_of_area *= 1.3;
  p.warp_height_fraction = 0.4;
  return p;
}

}  // namespace

TEST_SUITE_BEGIN("law");

TEST_CASE("V-LAW-24 a followed law has, at the heights of the equilibrium, the stress of the law") {
  VERIFY_RANDOM(random, 2024);
  verify::Worst elongations, stresses;
  double largest_shear = 0, least_yarn = 1;
  const auto check = [&](const std::string& name, const auto& law, int degrees) {
    const double L1 = law.cell().warp().L, L2 = law.cell().weft().L;
    for (int k = 0; k < 60; ++k) {
      const FibreStrain<double> beta = fibre_strain(verify::random_strain(random, degrees, 1e-3),
                                                    fibre_from_cartesian(law.reference()));
      const auto at = law.evaluate(beta);
      const FibreStress<double> exact = law.stress(at);
      double u1, u2, inv1, inv2, m11, m22;
      law.elongate(beta.b11, beta.b22, u1, u2, inv1, inv2);
      elongations.see(std::abs(u1 - at.u1) / L1, name, degrees, "u1");
      elongations.see(std::abs(u2 - at.u2) / L2, name, degrees, "u2");
      elongations.see(std::abs(inv1 * at.fibres.lambda1 - 1), name, degrees, "1/lambda1");
      elongations.see(std::abs(inv2 * at.fibres.lambda2 - 1), name, degrees, "1/lambda2");
      CrimpHeights<double> heights{at.cell.forces.w1, at.cell.forces.w2};
      law.follow(u1, u2, inv1, inv2, law.cell().evaluate_yarn(law.cell().warp(), u1, heights.w1),
                 law.cell().evaluate_yarn(law.cell().weft(), u2, heights.w2), heights, m11, m22);
      const FibreStress<double> m = law.with_shear(beta, inv1, inv2, m11, m22);
      const double error = std::max(
          {std::abs(m.m11 - exact.m11), std::abs(m.m22 - exact.m22), std::abs(m.m12 - exact.m12)});
      stresses.see(error / law.stiffness_bound(), name, degrees, "state", k);
      largest_shear = std::max(largest_shear, std::abs(exact.m12) / law.stiffness_bound());
      least_yarn = std::min(least_yarn, std::abs(exact.m11 - exact.m22) / law.stiffness_bound());
    }
  };
  for (const int degrees : {60, 90, 120}) {
    verify::for_each_shear<double>(degrees, [&](const std::string& name, const auto& shear) {
      check(name, verify::woven(unequal_fabric(), shear, degrees), degrees);
    });
    // As many terms as a polynomial may have.
    const std::vector<double> eight{0.05, 0.02, 0.1, -0.1, 0.3, 0.2, -0.1, 0.4};
    check(
        "polynomial of eight",
        verify::woven(unequal_fabric(),
                      verify::polynomial_shear<double>(eight, verify::fibre_angle<double>(degrees)),
                      degrees),
        degrees);
  }
  REQUIRE(largest_shear > 1e-6);  // far above the tolerance
  REQUIRE(least_yarn > 0);        // warp and weft are never the same
  // A few roundings each.
  elongations.claim("V-LAW-24", 2e-15, "elongations over the lengths, reciprocal stretches");
  stresses.claim("V-LAW-24", 1e-16,
                 "stress over the stiffness of the membrane: of strains of 0.03");
}

TEST_SUITE_END();
