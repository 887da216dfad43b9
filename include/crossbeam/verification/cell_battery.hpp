#pragma once
/// @file
/// What every energy cell and every yarn law must satisfy, measured on one of them.

#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"
#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/verification/battery.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace crossbeam::verification {

namespace claims {

inline constexpr Claim cell_rest{"B-CELL-01", "Cell", "The unstressed cell carries nothing",
                                 "definition", "1e-13 of the stiffness: rounding"};
inline constexpr Claim cell_forces{
    "B-CELL-02", "Cell", "Forces are the gradient of the energy, the tangent its second derivative",
    "Taylor remainders, slopes 2 and 3", "0.1 of slope 2, 0.2 of slope 3: next term of the series"};
inline constexpr Claim cell_tangent{"B-CELL-03", "Cell",
                                    "The tangent is the derivative of the forces",
                                    "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim cell_duals{"B-CELL-04", "Cell", "Dual numbers agree with forces and tangent",
                                  "forward differentiation of the solver",
                                  "1e-10 of the stiffness: rounding of a condensed system"};
inline constexpr Claim cell_loops{"B-CELL-05", "Cell", "Closed loops of strain do no work",
                                  "Gauss quadrature around taut rectangles",
                                  "1e-9 of the peak energy: quadrature"};
inline constexpr Claim cell_solver{"B-CELL-06", "Cell",
                                   "The solver answers every state between -20 and 10 % strain",
                                   "status, and numbers that are finite", "a count: 0"};
inline constexpr Claim cell_input{"B-CELL-07", "Cell",
                                  "Input without an answer gets a status, not a silent NaN",
                                  "adversarial list", "a count: 0"};
inline constexpr Claim cell_lanes{"B-CELL-08", "Cell", "Every lane of a pack answers as the scalar",
                                  "scalar run", "1e-11 of the stiffness: a lane may sweep on"};
inline constexpr Claim cell_bound{
    "B-CELL-09", "Cell", "The stiffness bound holds: the critical time step is safe",
    "eigenvalues of the membrane tangent, -5 to 5 % strain",
    "1e-3 for bending, and the string stiffness of the tension at hand"};
inline constexpr Claim cell_taut{"B-CELL-10", "Cell", "A cell with both yarns in tension is stable",
                                 "eigenvalues of the tangent", "1e-4 of the stiffness"};

inline constexpr Claim yarn_rest{"B-YARN-01", "Yarn law", "The unstretched yarn carries nothing",
                                 "definition", "exact"};
inline constexpr Claim yarn_tension{"B-YARN-02", "Yarn law",
                                    "The tension is the derivative of the energy",
                                    "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim yarn_modulus{"B-YARN-03", "Yarn law",
                                    "The modulus is the derivative of the tension",
                                    "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim yarn_convex{
    "B-YARN-04", "Yarn law",
    "The tension does not decrease, and is convex where positive: the solver's theorem holds",
    "moduli of neighbouring elongations", "1e-12: rounding"};
inline constexpr Claim yarn_bound{"B-YARN-05", "Yarn law", "No modulus is above the bound",
                                  "moduli, -10 to 10 % strain", "1e-12: rounding"};
inline constexpr Claim yarn_lanes{"B-YARN-06", "Yarn law",
                                  "Every lane of a pack answers as the scalar", "scalar run",
                                  "1e-15 of the length: one rounding"};

}  // namespace claims

/// A cell with an energy and a tangent, as CrossedBeamCell is: what the battery needs.
template <class C>
concept EnergyCell = UnitCell<C, double> && requires(const C& cell, double u) {
  { cell.energy(u, u, cell.solve(u, u)) } -> std::convertible_to<double>;
  { cell.tangent(u, u, cell.solve(u, u)) } -> std::convertible_to<CellTangent<double>>;
  { cell.solve(u, u).status } -> std::convertible_to<CellStatus>;
  { cell.parameters() } -> std::convertible_to<CellParameters<typename C::Real>>;
};

namespace detail {

/// The sizes a cell's errors are measured in.
struct CellScale {
  double L1, L2, width, stiffness;  ///< [mm], [mm], [mm^2], [kN/mm]

  template <class Cell>
  explicit CellScale(const Cell& cell)
      : L1(static_cast<double>(cell.parameters().warp.length)),
        L2(static_cast<double>(cell.parameters().weft.length)),
        width(cell.parameters().symmetry * L1 * L2),
        stiffness(static_cast<double>(cell.membrane_stiffness_bound()) * width /
                  (minimum(L1, L2) * minimum(L1, L2))) {}
  [[nodiscard]] double force() const { return stiffness * maximum(L1, L2); }
  [[nodiscard]] double energy() const { return force() * maximum(L1, L2); }
};

template <class Cell>
void verify_cell_derivatives(Battery& battery, const Cell& cell, const CellScale& scale) {
  Random random(5001);
  TaylorSlopes one(2), two(3), tangent(2);
  Worst duals;
  for (int sample = 0; sample < 60; ++sample) {
    const double u1 = scale.L1 * random.uniform(-0.05, 0.05);
    const double u2 = scale.L2 * random.uniform(-0.05, 0.05);
    const double h1 = scale.L1 * random.uniform(-1, 1), h2 = scale.L2 * random.uniform(-1, 1);
    const auto at = cell.solve(u1, u2);
    const double W = cell.energy(u1, u2, at);
    const CellForces<double> F = at.forces;
    const CellTangent<double> K = cell.tangent(u1, u2, at);
    const auto remainder = [&](bool second) {
      return [&, second](double eps) {
        const double a = eps * h1, b = eps * h2;
        double r =
            cell.energy(u1 + a, u2 + b, cell.solve(u1 + a, u2 + b)) - W - F.F1 * a - F.F2 * b;
        if (second) r -= (K.K11 * a * a + 2 * K.K12 * a * b + K.K22 * b * b) / 2;
        return r;
      };
    };
    // Energies of this size are sums of terms that a rounding each moves.
    const double round_off = 2e-15 * scale.energy() * 0.05 * 0.05;
    one.see(remainder(false), 1e-3, round_off);
    two.see(remainder(true), 1e-3, round_off);
    tangent.see(
        [&](double eps) {
          const double a = eps * h1, b = eps * h2;
          const auto moved = cell.solve(u1 + a, u2 + b).forces;
          return std::hypot(moved.F1 - F.F1 - K.K11 * a - K.K12 * b,
                            moved.F2 - F.F2 - K.K12 * a - K.K22 * b);
        },
        1e-3, 2e-15 * scale.force() * 0.05);

    using D = Dual<double, 2>;
    const D a = D::variable(u1, 0), b = D::variable(u2, 1);
    const auto dual = cell.solve(a, b);
    const D energy = cell.energy(a, b, dual);
    duals.see(maximum(std::abs(energy.d[0] - F.F1), std::abs(energy.d[1] - F.F2)) / scale.force());
    duals.see(
        (std::max)({std::abs(dual.forces.F1.d[0] - K.K11), std::abs(dual.forces.F1.d[1] - K.K12),
                    std::abs(dual.forces.F2.d[0] - K.K12), std::abs(dual.forces.F2.d[1] - K.K22)}) /
        scale.stiffness);
  }
  one.measure(battery, claims::cell_forces, 0.1, "energy less its linear part: slope off 2");
  two.measure(battery, claims::cell_forces, 0.2, "energy less its quadratic part: slope off 3");
  tangent.measure(battery, claims::cell_tangent, 0.1, "forces less their linear part: slope off 2");
  battery.measure(claims::cell_duals, duals, 1e-10, "forces and tangent, relative");
  battery.show(Plot{claims::cell_forces.id,
                    "Taylor remainders of the cell",
                    "step [strain]",
                    "remainder [kN mm], [kN]",
                    true,
                    true,
                    {one.curve("energy, slope 2"), two.curve("energy, slope 3"),
                     tangent.curve("forces, slope 2")},
                    "Straight lines of slope 2, 3 and 2 down to round-off.",
                    false});
}

template <class Cell>
void verify_cell_loops(Battery& battery, const Cell& cell, const CellScale& scale) {
  // Ten-point Gauss-Legendre rule on [-1, 1].
  static constexpr std::array<double, 5> at{0.1488743389816312, 0.4333953941292472,
                                            0.6794095682990244, 0.8650633666889845,
                                            0.9739065285171717};
  static constexpr std::array<double, 5> weight{0.2955242247147529, 0.2692667193099963,
                                                0.2190863625159820, 0.1494513491505806,
                                                0.0666713443086881};
  Random random(5002);
  Worst work;
  for (int sample = 0; sample < 10; ++sample) {
    std::array<double, 4> corner;  // [low, high] of both strains, taut
    for (double& c : corner) c = random.uniform(0.004, 0.03);
    const std::array<std::array<double, 2>, 5> path{{{corner[0], corner[1]},
                                                     {corner[2], corner[1]},
                                                     {corner[2], corner[3]},
                                                     {corner[0], corner[3]},
                                                     {corner[0], corner[1]}}};
    double sum = 0, peak = 0;
    for (int side = 0; side < 4; ++side) {
      constexpr int panels = 8;
      for (int p = 0; p < panels; ++p)
        for (int k = 0; k < 10; ++k) {
          const double x = k < 5 ? -at[k] : at[k - 5], w = weight[k % 5] / 2 / panels;
          const double s = (p + 0.5 * (1 + x)) / panels;
          const double d1 = path[side + 1][0] - path[side][0];
          const double d2 = path[side + 1][1] - path[side][1];
          const double u1 = scale.L1 * (path[side][0] + s * d1);
          const double u2 = scale.L2 * (path[side][1] + s * d2);
          const auto answer = cell.solve(u1, u2);
          sum += w * (answer.forces.F1 * scale.L1 * d1 + answer.forces.F2 * scale.L2 * d2);
          peak = maximum(peak, cell.energy(u1, u2, answer));
        }
    }
    work.see(peak > 0 ? std::abs(sum) / peak : std::numeric_limits<double>::quiet_NaN(), sample);
  }
  battery.measure(claims::cell_loops, work, 1e-9, "work of a loop over its peak energy");
}

template <class Cell>
void verify_cell_solver(Battery& battery, const Cell& cell, const CellScale& scale) {
  Random random(5003);
  const auto finite = [](const CellForces<double>& f) {
    return is_finite(f.F1) && is_finite(f.F2) && is_finite(f.w1) && is_finite(f.w2) &&
           is_finite(f.q);
  };
  double failures = 0;
  Curve sweeps{"states", {}, {}, Curve::Style::line};
  for (int sample = 0; sample < 20000; ++sample) {
    const auto s =
        cell.solve(scale.L1 * random.uniform(-0.2, 0.1), scale.L2 * random.uniform(-0.2, 0.1));
    failures += s.status != CellStatus::converged || !finite(s.forces);
    if constexpr (requires { s.sweeps; }) {
      while (static_cast<int>(sweeps.y.size()) <= s.sweeps) {
        sweeps.x.push_back(static_cast<double>(sweeps.y.size()));
        sweeps.y.push_back(0);
      }
      ++sweeps.y[static_cast<std::size_t>(s.sweeps)];
    }
  }
  battery.measure(claims::cell_solver, failures, 0, "failures in 20000 random states");
  if (!sweeps.y.empty())
    battery.show(Plot{claims::cell_solver.id,
                      "Newton sweeps to convergence",
                      "sweeps",
                      "states",
                      false,
                      true,
                      {sweeps},
                      "No tail: the solver does not struggle anywhere.",
                      true});

  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  double silent = 0;
  for (const double a :
       {0.0, -0.0, 1e-320, 1e-300, 0.02, 10.0, 1e150, 1e308, -1.0, -1.1, -1e308, nan, inf, -inf})
    for (const double b : {0.0, 1e-320, -0.02, 1e150, -1.0, -10.0, nan, inf, -inf}) {
      const auto s = cell.solve(scale.L1 * a, scale.L2 * b);
      const bool impossible = !(a > -1 && b > -1 && a < inf && b < inf);
      silent += s.status == CellStatus::converged && (impossible || !finite(s.forces));
    }
  battery.measure(claims::cell_input, silent, 0, "wrong or non-finite answers called converged");

  using P = Pack<double, 4>;
  Worst lanes;
  for (int sample = 0; sample < 500; ++sample) {
    P u1, u2;
    for (int i = 0; i < 4; ++i) {
      u1.set(i, scale.L1 * random.uniform(-0.05, 0.05));
      u2.set(i, scale.L2 * random.uniform(-0.05, 0.05));
    }
    const auto packed = cell.solve(u1, u2).forces;
    for (int i = 0; i < 4; ++i) {
      const auto alone = cell.solve(u1[i], u2[i]).forces;
      lanes.see(maximum(std::abs(packed.F1[i] - alone.F1), std::abs(packed.F2[i] - alone.F2)) /
                scale.force());
    }
  }
  battery.measure(claims::cell_lanes, lanes, 1e-11, "forces of the lanes, relative");
}

template <class Cell>
void verify_cell_stiffness(Battery& battery, const Cell& cell, const CellScale& scale) {
  double above = 0, unstable = 0;
  const auto bound = static_cast<double>(cell.membrane_stiffness_bound());
  const auto least_and_most = [](double a, double b, double c) {
    const double mean = (a + b) / 2, radius = std::hypot((a - b) / 2, c);
    return std::array<double, 2>{mean - radius, mean + radius};
  };
  for (int i = -25; i <= 25; ++i)
    for (int j = -25; j <= 25; ++j) {
      const double u1 = 0.002 * i * scale.L1, u2 = 0.002 * j * scale.L2;
      const auto s = cell.solve(u1, u2);
      const CellTangent<double> K = cell.tangent(u1, u2, s);
      const auto most = least_and_most(K.K11 * scale.L1 * scale.L1 / scale.width,
                                       K.K22 * scale.L2 * scale.L2 / scale.width,
                                       K.K12 * scale.L1 * scale.L2 / scale.width)[1];
      const double tension =
          (std::max)({s.forces.F1 * scale.L1, s.forces.F2 * scale.L2, 0.0}) / scale.width;
      above = maximum(above, (most - tension) / bound);
      if (s.forces.F1 > 1e-3 * scale.force() && s.forces.F2 > 1e-3 * scale.force())
        unstable = maximum(unstable, -least_and_most(K.K11, K.K22, K.K12)[0] / scale.stiffness);
    }
  battery.measure(claims::cell_bound, above, 1.001,
                  "largest eigenvalue less tension, over the bound");
  battery.measure(claims::cell_taut, unstable, 1e-4, "most negative eigenvalue, relative");

  Plot plot{claims::cell_bound.id,
            "Forces of the cell",
            "warp strain [%]",
            "force [kN]",
            false,
            false,
            {},
            "Stiffening by decrimping; no jump, no negative slope in tension.",
            false};
  Curve balanced{"warp, both strained", {}, {}}, single{"warp, weft held", {}, {}},
      other{"weft, weft held", {}, {}};
  for (int k = -100; k <= 150; ++k) {
    const double strain = 0.0002 * k;
    const auto both = cell.solve(scale.L1 * strain, scale.L2 * strain).forces;
    const auto one = cell.solve(scale.L1 * strain, scale.L2 * 0.0).forces;
    for (auto* curve : {&balanced, &single, &other}) curve->x.push_back(100 * strain);
    balanced.y.push_back(both.F1);
    single.y.push_back(one.F1);
    other.y.push_back(one.F2);
  }
  plot.curves = {balanced, single, other};
  battery.show(plot);
}

}  // namespace detail

/// The claims B-CELL on one cell.
template <EnergyCell Cell>
void verify_cell(Battery& battery, const Cell& cell) {
  const detail::CellScale scale(cell);
  const auto rest = cell.solve(0.0, 0.0);
  battery.measure(claims::cell_rest,
                  maximum(std::abs(rest.forces.F1), std::abs(rest.forces.F2)) / scale.force(),
                  1e-13, "forces at rest, relative");
  battery.measure(claims::cell_rest, std::abs(cell.energy(0.0, 0.0, rest)) / scale.energy(), 1e-13,
                  "energy at rest, relative");
  detail::verify_cell_derivatives(battery, cell, scale);
  detail::verify_cell_loops(battery, cell, scale);
  detail::verify_cell_solver(battery, cell, scale);
  detail::verify_cell_stiffness(battery, cell, scale);
}

namespace detail {

/// The claims B-YARN on one axial law, at an unstressed length of 1.
template <YarnLaw<double> Law>
void verify_axial_law(Battery& battery, const Law& law) {
  battery.measure(claims::yarn_rest, std::abs(law.tension(0.0, 1.0)), 0, "tension at e = 0");
  battery.measure(claims::yarn_rest, std::abs(law.energy(0.0, 1.0)), 0, "energy at e = 0");
  Random random(5004);
  TaylorSlopes energy(2), tension(2);
  for (int sample = 0; sample < 60; ++sample) {
    const double e = random.uniform(-0.05, 0.05);
    const double W = law.energy(e, 1.0), N = law.tension(e, 1.0), k = law.modulus(e, 1.0);
    energy.see([&](double eps) { return law.energy(e + eps, 1.0) - W - N * eps; }, 1e-3, 1e-17);
    tension.see([&](double eps) { return law.tension(e + eps, 1.0) - N - k * eps; }, 1e-3, 1e-15);
  }
  energy.measure(battery, claims::yarn_tension, 0.1, "energy less its linear part: slope off 2");
  tension.measure(battery, claims::yarn_modulus, 0.1, "tension less its linear part: slope off 2");

  Curve curve{"tension", {}, {}};
  Worst decrease, concave, above;
  double before = 0;
  for (int k = -1000; k <= 1000; ++k) {
    const double e = 1e-4 * k, modulus = law.modulus(e, 1.0);
    decrease.see(-modulus, e);
    above.see(modulus - law.modulus_bound(), e);
    if (k > 1 && law.tension(e, 1.0) > 0) concave.see(before - modulus, e);
    before = modulus;
    if (std::abs(k) <= 300) {
      curve.x.push_back(100 * e);
      curve.y.push_back(100 * law.tension(e, 1.0));
    }
  }
  battery.measure(claims::yarn_convex, decrease, 1e-12, "most negative modulus");
  battery.measure(claims::yarn_convex, concave, 1e-12, "largest loss of modulus, 1e-4 strain on");
  battery.measure(claims::yarn_bound, above, 1e-12, "largest modulus above the bound");
  battery.show(Plot{claims::yarn_tension.id,
                    "Axial law of the yarn",
                    "strain [%]",
                    "tension / EA [%]",
                    false,
                    false,
                    {curve},
                    "Through zero, rising, convex.",
                    false});

  using P = Pack<double, 4>;
  Worst lanes;
  for (int sample = 0; sample < 200; ++sample) {
    P e;
    for (int i = 0; i < 4; ++i) e.set(i, random.uniform(-0.05, 0.05));
    const P N = law.tension(e, P(1.0)), k = law.modulus(e, P(1.0)), W = law.energy(e, P(1.0));
    for (int i = 0; i < 4; ++i)
      lanes.see((std::max)({std::abs(N[i] - law.tension(e[i], 1.0)),
                            std::abs(k[i] - law.modulus(e[i], 1.0)),
                            std::abs(W[i] - law.energy(e[i], 1.0))}));
  }
  battery.measure(claims::yarn_lanes, lanes, 1e-15, "tension, modulus and energy of the lanes");
}

}  // namespace detail
}  // namespace crossbeam::verification
