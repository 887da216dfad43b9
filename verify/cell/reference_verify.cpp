// The three cells against the reference table (42 digits, verify/reference).

#include "cell/states.hpp"
#include "crossbeam/cell/second_order.hpp"

#include "support/claim.hpp"
#include "support/reference_states.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>

namespace {

using crossbeam::CellStatus;
using verify::Json;
using verify::number;

/// Worst errors over the states, each relative to the scale that its comment in the test justifies.
struct Errors {
  verify::Worst heights, forces, tangent, energy;
};

template <class R>
void measure_energy_cell(Errors& worst) {
  for (const Json& state : verify::reference_states()) {
    const std::string name = state.at("name");
    CAPTURE(name);
    const Json& ref = state.at("EU");
    const crossbeam::CrossedBeamCell<R> cell(verify::reference_parameters<R>(state));
    const R u1 = number<R>(state["u1"]), u2 = number<R>(state["u2"]);
    const auto s = cell.solve(u1, u2);
    REQUIRE(s.status == CellStatus::converged);
    CHECK((s.contact_stiffness > R(0)) == ref["contact_closed"].get<bool>());

    const R F1 = number<R>(ref["F_warp"]), F2 = number<R>(ref["F_weft"]);
    const R w1 = number<R>(ref["u3"]), w2 = -number<R>(ref["u4"]);
    const bool at_rest = u1 == R(0) && u2 == R(0);
    // A state's own largest height increment and force: exactly zero in the unstrained state.
    const R w_scale = at_rest ? R(1) : std::max(std::abs(w1), std::abs(w2));
    const R F_scale = at_rest ? R(1) : std::max(std::abs(F1), std::abs(F2));
    const auto relative = [](R a, R b, R scale) {
      return static_cast<double>(std::abs(a - b) / scale);
    };
    worst.heights.see(relative(s.forces.w1, w1, w_scale), name, "w1");
    worst.heights.see(relative(s.forces.w2, w2, w_scale), name, "w2");
    worst.forces.see(relative(s.forces.F1, F1, F_scale), name, "F_warp");
    worst.forces.see(relative(s.forces.F2, F2, F_scale), name, "F_weft");
    worst.forces.see(relative(s.forces.q, number<R>(ref["q"]), F_scale), name, "q");
    const crossbeam::YarnState<R> y1(cell.warp(), u1, s.forces.w1),
        y2(cell.weft(), u2, s.forces.w2);
    worst.forces.see(relative(y1.N, number<R>(ref["N1"]), F_scale), name, "N1");
    worst.forces.see(relative(y2.N, number<R>(ref["N2"]), F_scale), name, "N2");
    // The condensed tangent is a difference of terms of the size of EA/l0.
    const auto K = cell.tangent(u1, u2, s);
    const R k_scale = std::max(cell.warp().ka, cell.weft().ka);
    worst.tangent.see(relative(K.K11, number<R>(ref["K11"]), k_scale), name, "K11");
    worst.tangent.see(relative(K.K12, number<R>(ref["K12"]), k_scale), name, "K12");
    worst.tangent.see(relative(K.K22, number<R>(ref["K22"]), k_scale), name, "K22");
    const R U = number<R>(ref["U_cell"]);
    worst.energy.see(relative(cell.energy(u1, u2, s), U, at_rest ? R(1) : U), name, "U");
  }
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-01 the energy cell reproduces the reference table") {
  REQUIRE(verify::reference_states().size() == 20);
  Errors worst;
  measure_energy_cell<double>(worst);
  // 1e-12 is asked for; the forces of a slack state are 1e-3 of the terms they are made of, so that
  // three of double's sixteen digits are lost before the first operation.
  worst.heights.claim("V-CELL-01", 1e-12, "crimp heights, relative to the state's largest");
  worst.forces.claim("V-CELL-01", 1e-12, "F, q and N, relative to the state's largest force");
  worst.tangent.claim("V-CELL-01", 1e-14, "condensed tangent, relative to EA/l0");
  worst.energy.claim("V-CELL-01", 1e-12, "stored energy, relative to itself");

  Errors extended;
  measure_energy_cell<long double>(extended);
  // The same losses counted in roundings of long double (11 bits more on x86).
  constexpr auto eps = static_cast<double>(std::numeric_limits<long double>::epsilon());
  extended.forces.claim("V-CELL-01", 1e4 * eps, "the same in long double, F, q and N");
  extended.tangent.claim("V-CELL-01", 50 * eps, "the same in long double, tangent");
}

TEST_CASE("V-CELL-02 the bilateral cell and the second-order cell reproduce their rows") {
  verify::Worst bilateral_error, second_order_error;
  std::set<std::string> other_branch, unstable, fell_back;
  for (const Json& state : verify::reference_states()) {
    const std::string name = state.at("name");
    const auto parameters = verify::reference_parameters<double>(state);
    const double u1 = number<double>(state["u1"]), u2 = number<double>(state["u2"]);
    const bool at_rest = u1 == 0 && u2 == 0;

    REQUIRE(!state["EB"].is_null());
    const Json& eb = state["EB"];
    const crossbeam::BilateralCell<double> bilateral(parameters);
    const auto b = verify::answer(bilateral, u1, u2);
    const double F1 = number<double>(eb["F_warp"]), F2 = number<double>(eb["F_weft"]);
    const double F = at_rest ? 1 : std::max(std::abs(F1), std::abs(F2));
    const double w1 = number<double>(eb["u3"]), w2 = -number<double>(eb["u4"]);
    const double w = at_rest ? 1 : std::max(std::abs(w1), std::abs(w2));
    if (!verify::converged(b)) {
      unstable.insert(name);
    } else if (std::abs(b.forces.w1 - w1) > 1e-3 * parameters.contact_length) {
      other_branch.insert(name);
    } else {
      bilateral_error.see(std::abs(b.forces.F1 - F1) / F, name, "F_warp");
      bilateral_error.see(std::abs(b.forces.F2 - F2) / F, name, "F_weft");
      bilateral_error.see(std::abs(b.forces.q - number<double>(eb["contact_force"])) / F, name,
                          "q");
      bilateral_error.see(std::abs(b.forces.w1 - w1) / w, name, "w1");
      bilateral_error.see(std::abs(b.forces.w2 - w2) / w, name, "w2");
      const double U = number<double>(eb["U_cell"]);
      bilateral_error.see(std::abs(b.energy - U) / (at_rest ? 1 : U), name, "U");
    }

    const crossbeam::SecondOrderCell<double> second_order(parameters);
    const auto p = second_order.solve(u1, u2);
    if (p.fallback > 0) {
      fell_back.insert(name);
      CHECK(p.status != CellStatus::converged);
      CHECK((state["P"].is_null() || !state["P"]["K_hh_positive_definite"].get<bool>()));
      continue;
    }
    CHECK(p.status == CellStatus::converged);
    REQUIRE(!state["P"].is_null());
    const Json& row = state["P"];
    REQUIRE(row["K_hh_positive_definite"].get<bool>());
    const double P1 = number<double>(row["F_warp"]), P2 = number<double>(row["F_weft"]);
    // The axial and the geometric part of F cancel: its digits are those of EA/l0 u. This matters
    // in the state 1:-1 %, whose force is 2e-3 of it.
    const double P_scale = at_rest ? 1
                                   : std::max(std::abs(u1), std::abs(u2)) *
                                         parameters.warp.youngs_modulus *
                                         parameters.warp.cross_section / parameters.warp.length;
    second_order_error.see(std::abs(p.forces.F1 - P1) / P_scale, name, "F_warp");
    second_order_error.see(std::abs(p.forces.F2 - P2) / P_scale, name, "F_weft");
    second_order_error.see(
        std::abs(p.forces.w1 - number<double>(row["u3"])) / parameters.contact_length, name, "w1");
    second_order_error.see(
        std::abs(p.forces.w2 + number<double>(row["u4"])) / parameters.contact_length, name, "w2");
  }
  CHECK(unstable.empty());
  CHECK(other_branch.empty());
  // Where the fixed point of Eq. 25 does not exist or is not a stable state, the second-order cell
  // says so and hands over to the energy cell.
  CHECK(fell_back == std::set<std::string>{"comp_-5_0", "unbalanced_comp"});
  bilateral_error.claim("V-CELL-02", 1e-12, "bilateral cell: F, q, heights, energy");
  second_order_error.claim("V-CELL-02", 1e-12, "second-order cell: F and heights");
}

TEST_SUITE_END();
