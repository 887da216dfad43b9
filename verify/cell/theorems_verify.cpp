// The theorems of the cell, scanned over fabrics far beyond those that are woven: one counter each.

#include "cell/states.hpp"
#include "crossbeam/base/dual.hpp"

#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

using crossbeam::Dual;
using verify::Answer;
using verify::answer;
using verify::Cell;
using verify::Parameters;

constexpr double eps = std::numeric_limits<double>::epsilon();

/// A random fabric, one in four with some of its numbers at the very end of their range, and one in
/// seven with a weft that does not bend.
Parameters any_fabric(verify::Random& random) {
  Parameters p = verify::random_fabric(random);
  const auto end = [&](double& x, double low, double high) {
    const double at = random.uniform(0, 4);
    if (at < 1) x = at < 0.5 ? low : high;
  };
  if (random.uniform(0, 4) < 1) {
    const double E = p.warp.youngs_modulus;
    end(p.weft.youngs_modulus, 1e-3 * E, 1e3 * E);
    end(p.contact_modulus, 1e-4 * E, 10 * E);
    end(p.warp.second_moment_of_area, 0, 0.1);
    end(p.weft.second_moment_of_area, 0, 0.1);
    end(p.contact_length, 0.05, 1.5);
    end(p.warp_height_fraction, 0.05, 0.95);
  }
  if (random.uniform(0, 7) < 1) p.weft.second_moment_of_area = 0;
  return p;
}

template <class R>
R smallest_eigenvalue(const crossbeam::CellTangent<R>& K) {
  return (K.K11 + K.K22) / 2 - std::hypot((K.K11 - K.K22) / 2, K.K12);
}

/// Height at which a yarn is as long as unstressed; zero where even the straight one is stretched.
long double slack_height(const crossbeam::YarnConstants<double>& y, double u) {
  const long double a =
      static_cast<long double>(y.H) * y.H - u * (2 * static_cast<long double>(y.L) + u);
  return std::sqrt(std::max(a, 0.0L));
}

/// What a scan finds about each theorem: states, failures, and the worst of what is bounded.
struct Scan {
  static constexpr int limit = 50;  // of the solver
  struct One {                      // T1
    long states = 0, not_converged = 0, below_zero = 0, not_increasing = 0;
    verify::Worst residual;
    std::vector<double> sweeps = std::vector<double>(limit + 1, 0), residual_at = sweeps;
    int most = 0;
  } one;
  struct Two {
    long states = 0, wrong_side = 0, forces = 0;
    verify::Worst straight;
  } two;
  struct Three {
    verify::Worst gradient, symmetry;
  } three;
  struct Four {
    long chords = 0, taut_chords = 0, compressed = 0;
    verify::Worst convexity, eigenvalue;
  } four;
  struct Five {
    long taut = 0, indefinite = 0, pressed = 0, pressed_indefinite = 0;
    verify::Worst eigenvalue;
  } five;
};

void scan_state(Scan& scan, const Cell& cell, double u1, double u2, const Answer& a) {
  const auto& p = cell.parameters();
  const auto& f = a.forces;
  const double ka = std::max(cell.warp().ka, cell.weft().ka);
  const double u = std::max(std::abs(u1), std::abs(u2));
  const bool plain = p.warp.second_moment_of_area == 0 && p.weft.second_moment_of_area == 0;
  const auto see = [&](verify::Worst& worst, double error) {
    worst.see(error, "u =", u1, u2, "E2 =", p.weft.youngs_modulus, "E3 =", p.contact_modulus,
              "I =", p.warp.second_moment_of_area, p.weft.second_moment_of_area,
              "L3 =", p.contact_length, "chi =", p.warp_height_fraction, "L =", p.warp.length,
              p.weft.length);
  };

  // T1: an equilibrium, with heights h >= 0 on the branches where g increases.
  ++scan.one.states;
  scan.one.not_converged += !verify::converged(a);
  const auto residual = static_cast<double>(verify::violation<long double>(cell, u1, u2, a));
  see(scan.one.residual, residual);
  const auto sweeps = static_cast<std::size_t>(a.sweeps);
  ++scan.one.sweeps[sweeps];
  scan.one.residual_at[sweeps] = std::max(scan.one.residual_at[sweeps], residual);
  scan.one.most = std::max(scan.one.most, a.sweeps);
  const crossbeam::YarnState<double> y1(cell.warp(), u1, f.w1), y2(cell.weft(), u2, f.w2);
  scan.one.below_zero += cell.warp().H + f.w1 < 0 || cell.weft().H + f.w2 < 0;
  scan.one.not_increasing += !(y1.k_hh(cell.warp()) > 0 && y2.k_hh(cell.weft()) > 0);

  // T2: without bending, open if and only if the unstretched yarns have room; then without force.
  if (plain) {
    const long double hs1 = slack_height(cell.warp(), u1), hs2 = slack_height(cell.weft(), u2);
    const double room = static_cast<double>(hs1 + hs2 - p.contact_length) / p.contact_length;
    if (std::abs(room) > 1e-12) {
      ++scan.two.states;
      scan.two.wrong_side += (room > 0) == a.closed;
    }
    if (room > 1e-12) {
      const auto force = [&](const crossbeam::YarnConstants<double>& y, double ui, long double h,
                             double F) {
        if (h > 0)
          scan.two.forces += F != 0;
        else
          see(scan.two.straight, std::abs(F - y.ka * (y.L + ui - y.l0)) / (y.ka * y.L));
      };
      force(cell.warp(), u1, hs1, f.F1);
      force(cell.weft(), u2, hs2, f.F2);
    }
  }

  // T3: forces are the gradient of the energy, their own gradient is symmetric.
  using D = Dual<double, 2>;
  const D d1 = D::variable(u1, 0), d2 = D::variable(u2, 1);
  const auto s = cell.solve(d1, d2);
  const D U = cell.energy(d1, d2, s);
  see(scan.three.gradient, std::max(std::abs(U.d[0] - f.F1), std::abs(U.d[1] - f.F2)) / (ka * u));
  see(scan.three.symmetry, std::abs(s.forces.F1.d[1] - s.forces.F2.d[0]) / ka);

  // T4 and T5: stability of the tangent.
  const double least = smallest_eigenvalue(a.tangent);
  if (plain) {
    scan.four.compressed += std::min(f.F1, f.F2) < -4 * eps * ka * u;
    if (least >= 0) return;
    // Singular tangents round to either side of zero. Judged with eleven bits more.
    const crossbeam::CrossedBeamCell<long double> wide(verify::converted<long double>(p));
    const auto K = answer(wide, static_cast<long double>(u1), static_cast<long double>(u2)).tangent;
    see(scan.four.eigenvalue, static_cast<double>(-smallest_eigenvalue(K)) / ka);
  } else if (a.closed && f.F1 > 0 && f.F2 > 0) {
    ++scan.five.taut;
    scan.five.indefinite += least <= 0;
    see(scan.five.eigenvalue, -least / ka);
  } else if (a.closed) {
    ++scan.five.pressed;
    scan.five.pressed_indefinite += least <= 0;
  }
}

/// T4 at its full width: the energy without bending is a convex function of the 3x2 gradient.
void scan_chord(Scan& scan, const Cell& cell, verify::Random& random) {
  using Gradient = Eigen::Matrix<double, 3, 2>;
  const auto gradient = [&] {
    Gradient F = random.rotation().leftCols<2>();
    for (int i = 0; i < 2; ++i)
      F.col(i) = (F.col(i) + random.vector(0.3)).normalized() * random.uniform(0.8, 1.1);
    return F;
  };
  const Gradient F = gradient(), G = random.uniform(0, 1) < 0.5 ? gradient() : [&] {
    Gradient near = F;
    for (int i = 0; i < 2; ++i) near.col(i) += random.vector(random.log_uniform(1e-3, 0.1));
    return near;
  }();
  const auto energy = [&](const Gradient& A) {
    const Answer a =
        answer(cell, cell.warp().L * (A.col(0).norm() - 1), cell.weft().L * (A.col(1).norm() - 1));
    scan.one.not_converged += !verify::converged(a);
    return a.energy;
  };
  const double U = energy(F), V = energy(G), M = energy((F + G) / 2);
  const double size = std::max(cell.warp().ka * cell.warp().L * cell.warp().L,
                               cell.weft().ka * cell.weft().L * cell.weft().L);
  ++scan.four.chords;
  scan.four.taut_chords += M > 1e-6 * size;
  scan.four.convexity.see((M - (U + V) / 2) / size, "U =", U, V, M, "size", size);
}

Scan scan_theorems(verify::Random& random, int fabrics) {
  Scan scan;
  constexpr int strains = 16;
  for (int k = 0; k < fabrics; ++k) {
    const Parameters p = k % 20 == 0 ? verify::table_1() : any_fabric(random);
    const Cell cell(p);
    for (int i = 0; i < strains; ++i) {
      // Half of the states in the whole range, half where a drape is.
      const double low = i % 2 == 0 ? -0.2 : -0.02, high = i % 2 == 0 ? 0.1 : 0.03;
      const double u1 = cell.warp().L * random.uniform(low, high);
      const double u2 = cell.weft().L * random.uniform(low, high);
      scan_state(scan, cell, u1, u2, answer(cell, u1, u2));
    }
    if (p.warp.second_moment_of_area == 0 && p.weft.second_moment_of_area == 0)
      for (int i = 0; i < strains; ++i) scan_chord(scan, cell, random);
  }
  return scan;
}

void claim_theorems(const Scan& scan) {
  const auto count = [](long failures, const std::string& note) {
    verify::claim("V-CELL-30", static_cast<double>(failures), 0, note);
  };
  const auto number = [](long n) { return std::to_string(n); };

  const auto& t1 = scan.one;
  const std::string of_states = " of " + number(t1.states) + " states";
  count(t1.not_converged, "T1: without an equilibrium found," + of_states);
  count(t1.below_zero, "T1: height below zero," + of_states);
  count(t1.not_increasing, "T1: vertical force not increasing at the answer," + of_states);
  // Some twenty roundings, as V-CELL-11.
  t1.residual.claim("V-CELL-30", 5e-15, "T1: violation of the equilibrium, relative to EA/l0 L3");
  // The iteration gives up at 50.
  verify::claim("V-CELL-30", t1.most, 15, "T1: most sweeps");

  const auto& t2 = scan.two;
  REQUIRE(t2.states > t1.states / 20);
  count(t2.wrong_side, "T2: open without room or closed with it, of " + number(t2.states) +
                           " states without bending");
  count(t2.forces, "T2: a crimped yarn of an open contact that carries a force");
  // A rounding of l0 and one of L + u.
  t2.straight.claim("V-CELL-30", 1e-15,
                    "T2: force of a straight yarn against EA (Lc - l0)/l0, "
                    "relative to EA/l0 L");

  // The same formulas from the same heights (V-CELL-05): some roundings.
  scan.three.gradient.claim("V-CELL-30", 4e-15, "T3: F against dU/du, relative to EA/l0 u");
  scan.three.symmetry.claim("V-CELL-30", 4e-15, "T3: dF1/du2 - dF2/du1, relative to EA/l0");

  const auto& t4 = scan.four;
  REQUIRE(t4.taut_chords > t4.chords / 20);
  count(t4.compressed, "T4: yarns in compression, I = 0");
  // A rounding of the energy at the middle.
  t4.convexity.claim("V-CELL-30", 1e-16,
                     "T4: energy above its chord between two 3x2 gradients, of " +
                         number(t4.chords) + ", relative to EA/l0 L^2");
  // Round-off of long double, times EA/l0 over the vertical stiffness of a yarn all but straight.
  t4.eigenvalue.claim("V-CELL-30", 1e-15,
                      "T4: negative eigenvalue of the tangent, I = 0, over EA/l0");

  const auto& t5 = scan.five;
  REQUIRE(t5.taut > t1.states / 10);
  count(t5.indefinite, "T5: tangent not positive definite, of " + number(t5.taut) +
                           " states with both yarns in tension, I > 0");
  verify::claim("V-CELL-30", -t5.eigenvalue.value(), 0,
                "T5: least eigenvalue found among them, over EA/l0", verify::Bound::lower);
  // Negative result: stout beams with a pressed contact and a yarn in compression can be unstable.
  const double share = static_cast<double>(t5.pressed_indefinite) / static_cast<double>(t5.pressed);
  verify::claim("V-CELL-30", share, 1e-3,
                "T5: share of unstable states where the contact presses "
                "but a yarn is compressed: tension is needed",
                verify::Bound::lower);

  std::vector<double> sweeps, residual, counted;
  for (int k = 0; k <= t1.most; ++k) {
    const auto i = static_cast<std::size_t>(k);
    sweeps.push_back(k);
    counted.push_back(t1.sweeps[i]);
    residual.push_back(t1.residual_at[i]);
  }
  verify::show(verify::Plot{
      "V-CELL-30",
      "Newton sweeps to convergence," + of_states,
      "sweeps",
      "states",
      false,
      true,
      {{"states", sweeps, counted}},
      "Random fabrics: none fails, most states need three to five sweeps; zero means slack without "
      "bending.",
      true});
  verify::show(verify::Plot{
      "V-CELL-30",
      "Worst violation of the equilibrium," + of_states,
      "sweeps",
      "violation relative to EA/l0 L3 [-]",
      false,
      true,
      {{"worst of all states with that many sweeps", sweeps, residual,
        verify::Curve::Style::points}},
      "Twenty roundings at most, however many sweeps a state took: nothing is left unconverged."});
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-30 theorems T1 to T5 hold on 320000 random states") {
  VERIFY_RANDOM(random, 2030);
  claim_theorems(scan_theorems(random, 20000));
}

TEST_CASE("V-CELL-30 theorems T1 to T5 hold on 32 million random states (long)") {
  VERIFY_RANDOM(random, 20300);
  claim_theorems(scan_theorems(random, 2000000));
}

TEST_SUITE_END();
