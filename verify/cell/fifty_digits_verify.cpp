// The cell's own templates in fifty digits: what double loses of the same formulas, and whether the
// formulas hold where round-off cannot hide an error.

#include "support/fifty_digits.hpp"

#include "cell/states.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

namespace {

using crossbeam::maximum;
using verify::absolute;
using verify::Cell;
using verify::Fifty;
using verify::roundings;

using WideCell = crossbeam::CrossedBeamCell<Fifty>;

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-29 the templates in fifty digits: what double loses, and the reference table") {
  VERIFY_RANDOM(random, 2029);
  verify::Worst heights, forces, energies, tangents;
  verify::Digits force_digits, energy_digits, tangent_digits;
  Fifty unbalanced = 0;
  int closed = 0, most_sweeps = 0;
  constexpr int samples = 4000;
  for (int sample = 0; sample < samples; ++sample) {
    const auto p = sample % 10 == 0 ? verify::table_1() : verify::random_fabric(random);
    const Cell cell(p);
    const WideCell wide(verify::converted<Fifty>(p));
    double u1, u2;
    do {  // off the kink of the tangent: an answer on its other side is right, and no rounding
      const double least = sample % 2 == 0 ? -0.2 : 0.0;
      u1 = p.warp.length * random.uniform(least, 0.1);
      u2 = p.weft.length * random.uniform(least, 0.1);
    } while (!verify::contact_is_constant(cell, u1, u2, 1e-9));
    const auto a = verify::answer(cell, u1, u2);
    const auto b = verify::answer(wide, Fifty(u1), Fifty(u2));
    REQUIRE(verify::converged(a));
    REQUIRE(verify::converged(b));
    REQUIRE(a.closed == b.closed);
    unbalanced = maximum(unbalanced, verify::violation<Fifty>(wide, Fifty(u1), Fifty(u2), b));
    closed += b.closed;
    most_sweeps = std::max(most_sweeps, b.sweeps);

    const Fifty L3 = wide.parameters().contact_length;
    const Fifty ka = maximum(wide.warp().ka, wide.weft().ka);
    const Fifty u = maximum(absolute(u1), absolute(u2));
    const auto where = [&](verify::Worst& worst, double error, const char* what) {
      worst.see(error, what, "sample", sample, "u =", u1, u2, "I1 =", p.warp.second_moment_of_area,
                "E2 =", p.weft.youngs_modulus, "L3 =", p.contact_length,
                "chi =", p.warp_height_fraction);
    };
    where(heights, roundings(a.forces.w1, b.forces.w1, L3), "w1");
    where(heights, roundings(a.forces.w2, b.forces.w2, L3), "w2");
    where(forces, roundings(a.forces.F1, b.forces.F1, ka * u), "F1");
    where(forces, roundings(a.forces.F2, b.forces.F2, ka * u), "F2");
    where(forces, roundings(a.forces.q, b.forces.q, ka * u), "q");
    where(energies, roundings(a.energy, b.energy, ka * u * u), "U");
    where(tangents, roundings(a.tangent.K11, b.tangent.K11, ka), "K11");
    where(tangents, roundings(a.tangent.K12, b.tangent.K12, ka), "K12");
    where(tangents, roundings(a.tangent.K22, b.tangent.K22, ka), "K22");

    // Relative to the number itself; what is zero but for fifty digits' rounding has no digits.
    const auto count = [](verify::Digits& digits, double x, const Fifty& exact,
                          const Fifty& scale) {
      if (absolute(exact) > Fifty(1e-40) * scale)
        digits.see(static_cast<double>(absolute((Fifty(x) - exact) / exact)));
    };
    count(force_digits, a.forces.F1, b.forces.F1, ka * u);
    count(force_digits, a.forces.F2, b.forces.F2, ka * u);
    count(energy_digits, a.energy, b.energy, ka * u * u);
    count(tangent_digits, a.tangent.K11, b.tangent.K11, ka);
    count(tangent_digits, a.tangent.K22, b.tangent.K22, ka);
  }
  REQUIRE(closed > samples / 4);
  REQUIRE(closed < 3 * samples / 4);
  // The premise of all that follows: fifty digits are in equilibrium to 45 and more.
  REQUIRE(unbalanced < Fifty(1e-45));
  verify::claim("V-CELL-29", static_cast<double>(unbalanced), 1e-45,
                "equilibrium conditions violated by the answer in fifty digits");
  // Forces and energies are short sums of terms of the scale, two or three roundings each. Heights
  // are roots of differences of squares: in a slack yarn of 2 mm and 0.02 mm crimp l/h = 100 of
  // them. The tangent near straightness changes by EA/l0 within a strain of 1e-3 and inherits the
  // rounding of the heights. (Largest over 32000 states: 25, 3.6, 2.6, 78.)
  heights.claim("V-CELL-29", 100, "crimp heights, in roundings of L3");
  forces.claim("V-CELL-29", 8, "F and q, in roundings of EA/l0 u");
  energies.claim("V-CELL-29", 8, "energy, in roundings of EA/l0 u^2");
  tangents.claim("V-CELL-29", 200, "tangent, in roundings of EA/l0");
  verify::show(verify::Plot{
      "V-CELL-29",
      "Right decimal digits in double",
      "right digits of the number itself",
      "results",
      false,
      false,
      {{"force of a yarn", force_digits.at(), force_digits.count()},
       {"energy", energy_digits.at(), energy_digits.count()},
       {"tangent", tangent_digits.at(), tangent_digits.count()}},
      "4000 random states in double against fifty digits, half-digit bins: the energy keeps all "
      "its "
      "digits; forces and tangents below 14 digits are those of slack yarns, 1e-3 to 1e-9 of the "
      "terms that cancel in them."});
}

TEST_CASE("V-CELL-29 fifty digits reproduce the 42 of the reference table") {
  REQUIRE(verify::reference_states().size() == 20);
  verify::Worst worst;
  for (const verify::Json& state : verify::reference_states()) {
    const std::string name = state.at("name");
    const verify::Json& row = state.at("EU");
    const auto value = [&](const char* field) { return verify::number<Fifty>(row.at(field)); };
    const WideCell cell(verify::reference_parameters<Fifty>(state));
    const auto u1 = verify::number<Fifty>(state.at("u1")),
               u2 = verify::number<Fifty>(state.at("u2"));
    const auto s = verify::answer(cell, u1, u2);
    REQUIRE(verify::converged(s));
    const Fifty L3 = cell.parameters().contact_length;
    const Fifty ka = maximum(cell.warp().ka, cell.weft().ka);
    const Fifty u = maximum(maximum(absolute(u1), absolute(u2)), Fifty(1e-3));
    const auto see = [&](const Fifty& a, const Fifty& b, const Fifty& scale, const char* what) {
      worst.see(static_cast<double>(absolute(a - b) / scale), name, what);
    };
    see(s.forces.w1, value("u3"), L3, "w1");
    see(s.forces.w2, -value("u4"), L3, "w2");
    see(s.forces.F1, value("F_warp"), ka * u, "F_warp");
    see(s.forces.F2, value("F_weft"), ka * u, "F_weft");
    see(s.forces.q, value("q"), ka * u, "q");
    see(s.energy, value("U_cell"), ka * u * u, "U");
    see(s.tangent.K11, value("K11"), ka, "K11");
    see(s.tangent.K12, value("K12"), ka, "K12");
    see(s.tangent.K22, value("K22"), ka, "K22");
  }
  // Half a unit of the 42nd digit of inputs and answers, three or four times.
  worst.claim("V-CELL-29", 1e-41, "20 states against their 42 printed digits, relative");
}

TEST_SUITE_END();
