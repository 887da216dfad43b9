// Compiled with -ffast-math, where compilers take it that no number is NaN or infinite: bad input is
// refused, no NaN is answered as converged, a run with one stops; and a good answer stays what it is
// (docs/embedding.md). Returns 0, or 1 with what failed.

#include "crossbeam/contact/rigid_tool_contact.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/tools/primitives.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace crossbeam;

int failures = 0;

void expect(bool holds, const char* what) {
  if (holds) return;
  ++failures;
  std::printf("fast math: %s\n", what);
}

template <class Call>
void expect_refused(const char* what, const Call& call) {
  try {
    call();
  } catch (const InputError&) {
    return;
  }
  expect(false, what);
}

MembraneResponse<double> respond(double e11, double e22, double e12) {
  const auto angle = FibreAngle<double>::right();
  const WovenMembrane law(CrossedBeamCell<double>(CellParameters<double>{}),
                          ConstantShear<double>(1e-3, angle), angle);
  Matrix2<double> E;
  E << e11, e12, e12, e22;
  return membrane_response(law, E, Tangent::yes);
}

}  // namespace

int main() {
  // From text, so that no compiler knows them.
  const double nan = std::strtod("nan", nullptr), infinity = std::strtod("inf", nullptr);
  for (const double bad : {nan, infinity, -infinity}) {
    expect(!is_finite(bad) && !is_finite(static_cast<float>(bad)), "a NaN or infinity is finite");
    CellParameters<double> p;
    p.warp.youngs_modulus = bad;
    expect_refused("a modulus that is no number is accepted",
                   [&] { const CrossedBeamCell<double> cell(p); });
    p = {};
    p.contact_length = bad;
    expect_refused("a contact length that is no number is accepted",
                   [&] { const CrossedBeamCell<double> cell(p); });
    expect_refused("a shear modulus that is no number is accepted",
                   [&] { const ConstantShear<double> shear(bad, FibreAngle<double>::right()); });
    ContactParameters contact;
    contact.friction = bad;
    expect_refused("a coefficient of friction that is no number is accepted",
                   [&] { validate(contact); });
    expect_refused("a radius that is no number is accepted", [&] {
      const Sphere<double> sphere({0, 0, 0}, bad);
    });
    for (const auto& r : {respond(bad, 0, 0.002), respond(0, bad, 0.002), respond(0, 0, bad)})
      expect(r.status != CellStatus::converged,
             "a strain that is no number has a converged answer");
  }
  expect(respond(-0.6, 0, 0).status == CellStatus::outside_kinematics,
         "a strain of -0.6 has an answer");
  expect(respond(0, 0, 0.6).status == CellStatus::outside_kinematics,
         "a shear beyond 90 deg has an answer");

  // What the same strain gives without -ffast-math.
  const auto r = respond(0.01, 0, 0.002);
  expect(r.status == CellStatus::converged, "a good strain has no answer");
  const double S11 = 0.0832940355017, S22 = 0.0599054779877;
  expect(std::abs(r.S(0, 0) - S11) < 1e-11 && std::abs(r.S(1, 1) - S22) < 1e-11,
         "a good answer differs");
  std::printf("fast math: S = %.12g, %.12g kN/mm; %d failures\n", r.S(0, 0), r.S(1, 1), failures);
  return failures == 0 ? 0 : 1;
}
