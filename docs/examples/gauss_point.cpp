// The woven membrane at one Gauss point: strain in, stress, tangent and yarn state out.

// [begin:law]
#include <crossbeam/crossbeam.hpp>

#include <cstdio>

int main() {
  using namespace crossbeam;
  const CellParameters<double> table1;              // Table 1 of the paper; kN, mm
  const auto fibres = FibreAngle<double>::right();  // warp and weft perpendicular
  const WovenMembrane law(CrossedBeamCell<double>(table1), ConstantShear<double>(0.001), fibres);

  Matrix2<double> E;  // Green-Lagrange strain in the axes Y1 = warp, Y2
  E << 0.010, 0.002,  //
      0.002, 0.000;
  const auto response = membrane_response(law, E, Tangent::yes);
  if (response.status != CellStatus::converged) return 1;
  std::printf("S11 %.6f  S22 %.6f  S12 %.6f kN/mm\n", response.S(0, 0), response.S(1, 1),
              response.S(0, 1));
  std::printf("dS11/dE11 %.4f  dS11/dE22 %.4f kN/mm\n", response.dS_dE(0, 0), response.dS_dE(0, 1));

  const auto state = law.evaluate(fibre_strain(E, fibre_from_cartesian(fibres)));
  const auto& cell = state.cell.forces;
  std::printf("warp %.5f kN, weft %.5f kN, contact %.5f kN\n", cell.F1, cell.F2, cell.q);
  std::printf("crimp heights change by %.5f and %.5f mm\n", cell.w1, cell.w2);
}
// [end:law]
