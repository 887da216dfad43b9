// The cell in any units, at any elongation, in any number type: the right answer or none, never a
// wrong or an infinite one that is called converged.

#include "cell/states.hpp"
#include "fuzz/properties.hpp"
#include "support/claim.hpp"

#include "crossbeam/base/dual.hpp"
#include "crossbeam/base/simd.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace crossbeam;
using verify::Parameters;

/// Random elongations, most of them moderate, in the lanes of a pack.
template <class T>
T lanes_of(fuzz::Bytes& bytes, double length) {
  T u;
  for (int l = 0; l < lanes_v<T>; ++l)
    u.set(l, static_cast<real_t<T>>(bytes.below(4) == 0 ? fuzz::elongation(bytes, length)
                                                        : length * bytes.uniform(-0.05, 0.05)));
  return u;
}

std::vector<std::uint8_t> random_bytes(verify::Random& random, int count) {
  std::vector<std::uint8_t> data(static_cast<std::size_t>(count));
  for (auto& b : data) b = static_cast<std::uint8_t>(random.uniform(0, 256));
  return data;
}

}  // namespace

TEST_SUITE_BEGIN("stress");

TEST_CASE("V-STRESS-01 in any units a cell has the same answer, or is refused") {
  VERIFY_RANDOM(random, 7001);
  struct Fabric {
    Parameters p;
    double u1, u2;
  };
  std::vector<Fabric> fabrics;
  for (int k = 0; k < 20; ++k) {
    Parameters p = k == 0 ? verify::table_1() : verify::random_fabric(random);
    if (k % 3 == 1) p.residual_compression_stiffness = 1e-3;
    fabrics.push_back({p, p.warp.length * random.uniform(-0.1, 0.05),
                       p.weft.length * random.uniform(-0.1, 0.05)});
  }
  // One cell of the picture is one scale; -1 where an answer was wrong, 0 refused, 1 right.
  verify::Map map;
  map.claim = "V-STRESS-01";
  map.title = "Units in which a cell answers";
  map.x_label = "lengths times 10^";
  map.y_label = "forces times 10^";
  map.value_label = "1: the same answer, bit for bit; 0: refused; -1: a wrong answer";
  map.caption = "No unit may be red: around the usable ones the parameters are refused.";
  long wrong = 0, answered = 0, refused = 0, refused_near = 0;
  constexpr int step = 50;
  for (int force = -1000; force <= 1000; force += step) map.at_y.push_back(0.30103 * force);
  for (int length = -500; length <= 500; length += step / 2) map.at_x.push_back(0.30103 * length);
  for (int force = -1000; force <= 1000; force += step) {
    map.values.emplace_back();
    for (int length = -500; length <= 500; length += step / 2) {
      double shown = 1;
      for (const Fabric& f : fabrics) {
        const auto here = verify::answer(verify::Cell(f.p), f.u1, f.u2);
        REQUIRE(verify::converged(here));
        try {
          const verify::Cell cell(verify::in_other_units(f.p, force, length));
          const auto there =
              verify::answer(cell, std::ldexp(f.u1, length), std::ldexp(f.u2, length));
          // A status is no answer, and no wrong one either.
          const auto same = [](double a, double b, int exponent) {
            return a == std::ldexp(b, exponent);
          };
          const bool right = !verify::converged(there) ||
                             (same(there.forces.F1, here.forces.F1, force) &&
                              same(there.forces.F2, here.forces.F2, force) &&
                              same(there.forces.q, here.forces.q, force) &&
                              same(there.energy, here.energy, force + length) &&
                              same(there.tangent.K11, here.tangent.K11, force - length) &&
                              same(there.tangent.K12, here.tangent.K12, force - length));
          wrong += !right;
          answered += verify::converged(there);
          if (!right) shown = -1;
        } catch (const InputError&) {
          ++refused;
          refused_near += std::abs(force) <= 200 && std::abs(length) <= 75;
          shown = std::min(shown, 0.0);
        }
      }
      map.values.back().push_back(shown);
    }
  }
  verify::show(map);
  REQUIRE(answered > 2000);
  REQUIRE(refused > 2000);
  verify::claim("V-STRESS-01", static_cast<double>(wrong), 0,
                "answers that differ from those in kN, mm in any bit, forces 1e+-300, lengths "
                "1e+-150");
  verify::claim(
      "V-STRESS-01", static_cast<double>(refused_near), 0,
      "fabrics refused although their forces are within 1e+-60 and lengths within 1e+-22");
}

TEST_CASE("V-STRESS-02 packs, float and dual numbers under any input: finite or a status") {
  VERIFY_RANDOM(random, 7002);
  long broken = 0, answered = 0, refused = 0, no_answer = 0;
  const auto tell = [&](bool good, const std::string& what, const Parameters& p) {
    CHECK_MESSAGE(good, what, " of ", fuzz::text_of(p));
    broken += !good;
  };
  const auto ask = [&](const auto& cell, auto u1, auto u2, const Parameters& p,
                       const std::string& type) {
    using T = decltype(u1);
    const auto s = cell.solve(u1, u2);
    if (s.status != CellStatus::converged) {
      ++no_answer;
      return;
    }
    ++answered;
    for (int l = 0; l < lanes_v<T>; ++l) {
      const CellForces<double> f{s.forces.F1[l], s.forces.F2[l], s.forces.w1[l], s.forces.w2[l],
                                 s.forces.q[l]};
      const double a = u1[l], b = u2[l];
      tell(a > -p.warp.length && b > -p.weft.length && fuzz::finite(f), type, p);
      // The float cell knows the parameters as floats.
      const double off = fuzz::imbalance(
          CellParameters<double>(cell.parameters().template cast<double>()), a, b, f, true);
      tell(off <= (std::is_same_v<real_t<T>, float> ? 1e-3 : fuzz::allowed_imbalance),
           type + " imbalance " + std::to_string(off) + " at " + std::to_string(a) + ", " +
               std::to_string(b),
           p);
      const auto energy = cell.energy(u1, u2, s);
      tell(std::isfinite(energy[l]) && energy[l] >= 0, type + " energy", p);
    }
  };
  for (int k = 0; k < 40000; ++k) {
    const auto data = random_bytes(random, 160);
    fuzz::Bytes bytes(data);
    Parameters p = fuzz::parameters(bytes);
    try {
      const CrossedBeamCell<double> cell(p);
      using Wide = Pack<double, 4>;
      ask(cell, lanes_of<Wide>(bytes, p.warp.length), lanes_of<Wide>(bytes, p.weft.length), p,
          "double x 4");
      using Variable = Dual<double, 2>;
      const double a = fuzz::elongation(bytes, p.warp.length),
                   b = fuzz::elongation(bytes, p.weft.length);
      const auto s = cell.solve(Variable::variable(a, 0), Variable::variable(b, 1));
      if (s.status == CellStatus::converged)
        tell(std::isfinite(s.forces.F1.d[0]) && std::isfinite(s.forces.F1.d[1]) &&
                 std::isfinite(s.forces.F2.d[1]),
             "dual " + std::to_string(a) + " " + std::to_string(b), p);
    } catch (const InputError&) {
      ++refused;
    }
    try {
      using Floats = Pack<float, 8>;
      const CrossedBeamCell<float> cell(p.cast<float>());
      ask(cell, lanes_of<Floats>(bytes, p.warp.length), lanes_of<Floats>(bytes, p.weft.length),
          p.cast<float>().cast<double>(), "float x 8");
    } catch (const InputError&) {
      ++refused;
    }
  }
  CAPTURE(answered);
  CAPTURE(refused);
  CAPTURE(no_answer);
  REQUIRE(answered > 10000);
  REQUIRE(refused > 1000);
  REQUIRE(no_answer > 1000);
  verify::claim("V-STRESS-02", static_cast<double>(broken), 0,
                "converged lanes that are not finite, not in equilibrium or without energy");
}

TEST_SUITE_END();
