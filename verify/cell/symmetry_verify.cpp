// What the energy cell must keep whatever its numbers are: exchange of warp and weft, units, energy
// around closed loops, convexity, and the consistency of the optional compressive stiffness.

#include "cell/states.hpp"

#include "support/claim.hpp"
#include "support/taylor_test.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace {

using verify::Answer;
using verify::answer;
using verify::Cell;
using verify::converged;
using verify::Parameters;

/// Lengths times `length`, moduli times `modulus`.
Parameters in_other_units(const Parameters& p, double length, double modulus) {
  Parameters q = p;
  for (auto* yarn : {&q.warp, &q.weft}) {
    yarn->youngs_modulus *= modulus;
    yarn->cross_section *= length * length;
    yarn->second_moment_of_area *= length * length * length * length;
    yarn->length *= length;
  }
  q.contact_modulus *= modulus;
  q.contact_area *= length * length;
  q.contact_length *= length;
  q.residual_compression_stiffness *= modulus * length;
  return q;
}

/// Largest deviation of an answer in other units, relative to EA/l0 L and L3.
double deviation(const Cell& cell, const Answer& a, const Answer& b, double length,
                 double modulus) {
  const double ka = std::max(cell.warp().ka, cell.weft().ka);
  const double force = modulus * length * length, stiffness = modulus * length;
  const double F = ka * cell.parameters().contact_length * force;
  return std::max({std::abs(b.forces.F1 - force * a.forces.F1) / F,
                   std::abs(b.forces.F2 - force * a.forces.F2) / F,
                   std::abs(b.forces.q - force * a.forces.q) / F,
                   std::abs(b.tangent.K11 - stiffness * a.tangent.K11) / (ka * stiffness),
                   std::abs(b.tangent.K12 - stiffness * a.tangent.K12) / (ka * stiffness),
                   std::abs(b.tangent.K22 - stiffness * a.tangent.K22) / (ka * stiffness),
                   std::abs(b.energy - force * length * a.energy) /
                       (F * length * cell.parameters().contact_length)});
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-13 exchanging warp and weft exchanges the answers") {
  VERIFY_RANDOM(random, 2013);
  verify::Worst worst;
  for (int sample = 0; sample < 5000; ++sample) {
    const Parameters p = verify::random_fabric(random);
    Parameters q = p;
    std::swap(q.warp, q.weft);
    q.warp_height_fraction = 1 - p.warp_height_fraction;
    const Cell cell(p), exchanged(q);
    const double u1 = p.warp.length * random.uniform(-0.1, 0.1);
    const double u2 = p.weft.length * random.uniform(-0.1, 0.1);
    const Answer a = answer(cell, u1, u2);
    Answer b = answer(exchanged, u2, u1);
    REQUIRE(converged(a));
    REQUIRE(converged(b));
    if (!verify::contact_is_constant(cell, u1, u2, 1e-9)) continue;
    std::swap(b.forces.F1, b.forces.F2);
    std::swap(b.tangent.K11, b.tangent.K22);
    worst.see(deviation(cell, a, b, 1, 1), "sample", sample);
  }
  REQUIRE(worst.seen() > 4900);
  // H2 = L3 - H1 rounds differently; a few roundings of EA/l0 L3.
  worst.claim("V-CELL-13", 1e-13, "F, q, K, U of the exchanged cell, relative to EA/l0 L3");
}

TEST_CASE("V-CELL-14 the answer does not depend on the units") {
  VERIFY_RANDOM(random, 2014);
  verify::Worst decimal;
  int bits = 0;
  for (int sample = 0; sample < 5000; ++sample) {
    Parameters p = verify::random_fabric(random);
    p.residual_compression_stiffness = random.uniform(0, 1);
    const Cell cell(p);
    const double u1 = p.warp.length * random.uniform(-0.1, 0.1);
    const double u2 = p.weft.length * random.uniform(-0.1, 0.1);
    const Answer a = answer(cell, u1, u2);
    REQUIRE(converged(a));
    if (!verify::contact_is_constant(cell, u1, u2, 1e-9)) continue;
    // mm -> m, kN/mm^2 -> N/m^2: powers of ten round.
    const Answer si = answer(Cell(in_other_units(p, 1e-3, 1e9)), u1 * 1e-3, u2 * 1e-3);
    decimal.see(deviation(cell, a, si, 1e-3, 1e9), "sample", sample);
    // Powers of two do not: the answers must agree in every bit, so that no absolute number hides
    // in the kernel.
    const Answer binary = answer(Cell(in_other_units(p, 0x1p-8, 0x1p12)), u1 * 0x1p-8, u2 * 0x1p-8);
    bits += binary.forces.F1 != a.forces.F1 * 0x1p-4 || binary.forces.F2 != a.forces.F2 * 0x1p-4 ||
            binary.energy != a.energy * 0x1p-12 || binary.sweeps != a.sweeps ||
            binary.tangent.K12 != a.tangent.K12 * 0x1p4;
    // Units of force far from 1, so that no guard against zero is an absolute number.
    for (const double unit : {0x1p-120, 0x1p120}) {
      const Answer far = answer(Cell(in_other_units(p, 1, unit)), u1, u2);
      bits += far.forces.F1 != a.forces.F1 * unit || far.forces.F2 != a.forces.F2 * unit ||
              far.forces.w1 != a.forces.w1 || far.forces.w2 != a.forces.w2 ||
              far.sweeps != a.sweeps || far.tangent.K12 != a.tangent.K12 * unit;
    }
  }
  decimal.claim("V-CELL-14", 1e-13, "kN, mm against N, m, relative to EA/l0 L3");
  verify::claim("V-CELL-14", bits, 0, "states that differ in any bit after powers of two");
}

namespace {

/// Work of the cell along a closed polygon of strains [%] by ten-point Gauss rules.
template <class ForcesAt>
double work_around(const std::vector<std::array<double, 2>>& corners, double L, ForcesAt forces_at,
                   int panels = 50) {
  constexpr std::array<double, 5> point{0.1488743389816312, 0.4333953941292472, 0.6794095682990244,
                                        0.8650633666889845, 0.9739065285171717};
  constexpr std::array<double, 5> weight{0.2955242247147529, 0.2692667193099963, 0.2190863625159820,
                                         0.1494513491505806, 0.0666713443086881};
  double work = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto& from = corners[k];
    const auto& to = corners[(k + 1) % corners.size()];
    const double d1 = (to[0] - from[0]) / 100 * L / panels;
    const double d2 = (to[1] - from[1]) / 100 * L / panels;
    for (int panel = 0; panel < panels; ++panel)
      for (int g = 0; g < 10; ++g) {
        const double x = g < 5 ? point[g] : -point[g - 5];
        const double s = panel + 0.5 * (1 + x);
        const auto F = forces_at(from[0] / 100 * L + s * d1, from[1] / 100 * L + s * d2);
        work += 0.5 * weight[g % 5] * (F[0] * d1 + F[1] * d2);
      }
  }
  return work;
}

}  // namespace

TEST_CASE("V-CELL-15 closed loops of strain do no work on the energy cell") {
  VERIFY_RANDOM(random, 2015);
  const auto loop_work = [](const Cell& cell, const std::vector<std::array<double, 2>>& corners) {
    double peak = 0;
    const double work = work_around(corners, cell.warp().L, [&](double u1, double u2) {
      const Answer a = answer(cell, u1, u2);
      REQUIRE(converged(a));
      peak = std::max(peak, a.energy);
      return std::array<double, 2>{a.forces.F1, a.forces.F2};
    });
    REQUIRE(peak > 0);
    return std::abs(work) / peak;
  };
  const Cell table_1(verify::table_1());
  verify::Worst taut, crossing;
  taut.see(loop_work(table_1, {{0, 0}, {2, 0}, {2, 1}, {0, 1}}), "the loop of V-CELL-16");
  for (int sample = 0; sample < 20; ++sample) {
    const auto corner = [&](double low) {
      return std::array<double, 2>{random.uniform(low, 3), random.uniform(low, 3)};
    };
    taut.see(loop_work(table_1, {corner(0.1), corner(0.1), corner(0.1)}), "taut loop", sample);
    crossing.see(loop_work(table_1, {corner(-3), corner(-3), corner(-3)}), "loop", sample);
  }
  // Forces are smooth in the taut region: the quadrature is exact to rounding, 3000 terms.
  taut.claim("V-CELL-15", 1e-13, "work of loops in the taut region over their peak energy");
  // At the slack boundary the forces have a kink, which costs the panel that holds it the square of
  // its width.
  crossing.claim("V-CELL-15", 1e-4, "work of loops across the slack boundary over the peak energy");
}

TEST_CASE("V-CELL-26 without bending the energy is convex and taut states are stable") {
  VERIFY_RANDOM(random, 2026);
  verify::Worst convexity, eigenvalue, beams, compression;
  long taut_states = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    Parameters p = sample % 4 == 0 ? verify::table_1() : verify::random_fabric(random);
    const Cell with_bending(p);
    p.warp.second_moment_of_area = p.weft.second_moment_of_area = 0;
    const Cell cell(p);
    const double ka = std::max(cell.warp().ka, cell.weft().ka);
    const auto strain = [&](double length) { return length * random.uniform(-0.1, 0.1); };
    const double u1 = strain(cell.warp().L), u2 = strain(cell.weft().L);
    const double v1 = strain(cell.warp().L), v2 = strain(cell.weft().L);
    const Answer a = answer(cell, u1, u2), b = answer(cell, v1, v2);
    const Answer middle = answer(cell, 0.5 * (u1 + v1), 0.5 * (u2 + v2));
    REQUIRE(converged(a));
    REQUIRE(converged(b));
    REQUIRE(converged(middle));
    // Convex: below its chord. Monotone: no compression anywhere.
    convexity.see(
        (middle.energy - 0.5 * (a.energy + b.energy)) / (ka * cell.warp().L * cell.warp().L),
        "sample", sample);
    compression.see(-std::min(a.forces.F1, a.forces.F2) / (ka * cell.warp().L), "sample", sample);
    const auto smallest = [](const crossbeam::CellTangent<double>& K) {
      return (K.K11 + K.K22) / 2 - std::hypot((K.K11 - K.K22) / 2, K.K12);
    };
    eigenvalue.see(-smallest(a.tangent) / ka, "sample", sample);
    const Answer stiff = answer(with_bending, u1, u2);
    if (stiff.closed && stiff.forces.F1 > 0 && stiff.forces.F2 > 0) {
      ++taut_states;
      beams.see(-smallest(stiff.tangent) / ka, "sample", sample);
    }
  }
  REQUIRE(taut_states > 3000);
  // Round-off of numbers of the size of EA/l0 L^2, EA/l0 L and EA/l0.
  convexity.claim("V-CELL-26", 1e-15, "energy above its chord, I = 0");
  compression.claim("V-CELL-26", 1e-14, "compression of a yarn, I = 0");
  eigenvalue.claim("V-CELL-26", 1e-13, "negative eigenvalue of the tangent over EA/l0, I = 0");
  beams.claim("V-CELL-26", 1e-13, "the same with bending, both yarns in tension");
}

TEST_CASE("V-CELL-19 the residual compressive stiffness is an energy of its own") {
  VERIFY_RANDOM(random, 2019);
  verify::Worst exact, second, third;
  for (int sample = 0; sample < 40; ++sample) {
    Parameters p = sample % 2 == 0 ? verify::table_1() : verify::random_fabric(random);
    const Cell without(p);
    const double kres = random.log_uniform(1e-3, 10);
    p.residual_compression_stiffness = kres;
    const Cell with(p);
    // Away from the kinks: of the contact, and of the residual law at u = 0.
    double u1, u2;
    do {
      u1 = p.warp.length * random.uniform(-0.05, 0.05);
      u2 = p.weft.length * random.uniform(-0.05, 0.05);
    } while (!verify::contact_is_constant(without, u1, u2, 2e-3) ||
             std::abs(u1) < 0.003 * p.warp.length || std::abs(u2) < 0.003 * p.weft.length);
    const Answer a = answer(without, u1, u2), b = answer(with, u1, u2);
    const double s1 = std::min(u1, 0.0), s2 = std::min(u2, 0.0);
    const double F = std::max(kres, with.warp().ka) * 0.125;
    exact.see(std::abs(b.forces.F1 - a.forces.F1 - kres * s1) / F, "F1", sample);
    exact.see(std::abs(b.forces.F2 - a.forces.F2 - kres * s2) / F, "F2", sample);
    exact.see(std::abs(b.energy - a.energy - kres * (s1 * s1 + s2 * s2) / 2) / (F * 0.125), "U",
              sample);
    exact.see(std::abs(b.tangent.K11 - a.tangent.K11 - (u1 < 0 ? kres : 0)) / F, "K11", sample);
    exact.see(std::abs(b.tangent.K22 - a.tangent.K22 - (u2 < 0 ? kres : 0)) / F, "K22", sample);
    CHECK(b.forces.q == a.forces.q);
    CHECK(b.tangent.K12 == a.tangent.K12);

    // And by rate, for the sum. (Table 1: a random fabric may have no third derivative to see.)
    if (sample % 2 != 0) continue;
    const crossbeam::CrossedBeamCell<long double> cell(verify::converted<long double>(p));
    const auto at = answer(cell, u1, u2);
    const double h1 = 2e-3 * p.warp.length * random.uniform(0.5, 1);
    const double h2 = 2e-3 * p.weft.length * random.uniform(0.5, 1);
    const double ka = std::max({with.warp().ka, with.weft().ka, kres});
    const double u = std::max(std::abs(u1), std::abs(u2));
    const double noise =
        0.02 * static_cast<double>(std::numeric_limits<long double>::epsilon()) * ka * u * u;
    const auto remainder = [&](double eps, bool tangent) {
      const long double x = static_cast<long double>(eps) * h1,
                        y = static_cast<long double>(eps) * h2;
      const auto moved = answer(cell, u1 + x, u2 + y);
      long double r = moved.energy - at.energy - at.forces.F1 * x - at.forces.F2 * y;
      if (tangent)
        r -= (at.tangent.K11 * x * x + 2 * at.tangent.K12 * x * y + at.tangent.K22 * y * y) / 2;
      return r;
    };
    const auto slope_2 = verify::taylor_test(
        2, [&](double e) { return remainder(e, false); }, 1, noise);
    second.see(slope_2.deviation, "sample", sample, slope_2.table);
    const auto slope_3 = verify::taylor_test(
        3, [&](double e) { return remainder(e, true); }, 1, noise);
    third.see(slope_3.deviation, "sample", sample, slope_3.table);
  }
  // A yarn at its own length is not shortened: the virgin tangent is that of the taut yarn.
  Parameters p = verify::table_1();
  const Answer without = answer(Cell(p), 0, 0);
  p.residual_compression_stiffness = 3;
  const Answer with = answer(Cell(p), 0, 0);
  CHECK(with.tangent.K11 == without.tangent.K11);
  CHECK(with.tangent.K22 == without.tangent.K22);
  exact.claim("V-CELL-19", 1e-15, "F, U and K against kres min(u, 0), relative");
  // As in V-CELL-03.
  second.claim("V-CELL-19", 0.02, "|slope - 2| of the energy with its forces");
  third.claim("V-CELL-19", 0.1, "|slope - 3| with its tangent");
}

TEST_SUITE_END();
