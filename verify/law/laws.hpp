#pragma once
/// @file
/// The shear layers, fibre angles and states that the tests of the law share.

#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/verification/strains.hpp"

#include "support/random.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace verify {

template <class R>
R radians(int degrees) {
  return R(degrees) * (crossbeam::detail::half_pi<R>() / R(90));
}

template <class R>
crossbeam::FibreAngle<R> fibre_angle(int degrees) {
  return degrees == 90 ? crossbeam::FibreAngle<R>::right()
                       : crossbeam::FibreAngle<R>(radians<R>(degrees));
}

/// Tangent modulus of the fabric of the double dome, G = sum a_k |gamma|^k: two published fits in
/// MPa.
inline const std::vector<double> law_A{0.051, -0.83, 6.1275, -12.0972, 8.48};
inline const std::vector<double> law_B{0.1948, -1.5928, 6.3822, -9.8228, 6.7135};

template <class R>
crossbeam::PolynomialShear<R> polynomial_shear(const std::vector<double>& in_MPa,
                                               const crossbeam::FibreAngle<R>& reference) {
  std::vector<R> coefficients;
  for (const double a : in_MPa) coefficients.push_back(R(a) / 1000);  // kN/mm^2
  return crossbeam::between_yarns(
      crossbeam::PolynomialShear<R>(crossbeam::PolynomialCurve<R>(coefficients)), reference);
}

/// A locking curve of three straight lines; its knots are kinks of the tangent.
inline const std::vector<double> knots{0, 0.35, 0.7};
template <class R>
crossbeam::TabulatedShear<R> tabulated_shear(const crossbeam::FibreAngle<R>& reference) {
  return crossbeam::between_yarns(crossbeam::TabulatedShear<R>(crossbeam::TabulatedCurve<R>(
                                      {R(0), R(0.35), R(0.7)}, {R(0), R(2e-5), R(9e-5)})),
                                  reference);
}

/// Calls visit(name, shear) for every shear layer of the library.
template <class R, class Visit>
void for_each_shear(int degrees, Visit visit) {
  using namespace crossbeam;
  const FibreAngle<R> angle = fibre_angle<R>(degrees);
  visit("none", NoShear<R>{});
  for (const auto measure : {ShearMeasure::tensor, ShearMeasure::engineering})
    for (const auto frame : {ShearFrame::cartesian, ShearFrame::fibre})
      visit(std::string("constant, ") +
                (measure == ShearMeasure::tensor ? "tensor, " : "engineering, ") +
                (frame == ShearFrame::cartesian ? "Cartesian" : "fibre"),
            between_yarns(ConstantShear<R>(R(0.001), measure, frame), angle));
  visit("polynomial A", polynomial_shear<R>(law_A, angle));
  visit("polynomial B", polynomial_shear<R>(law_B, angle));
  visit("tabulated", tabulated_shear<R>(angle));
}

template <class R, class Shear>
auto woven(const crossbeam::CellParameters<R>& parameters, const Shear& shear, int degrees,
           crossbeam::YarnWidth width = crossbeam::YarnWidth::corrected) {
  using Cell = crossbeam::CrossedBeamCell<R>;
  return crossbeam::WovenMembrane<Cell, Shear>(Cell(parameters), shear, fibre_angle<R>(degrees),
                                               width);
}

inline crossbeam::Matrix2<double> strain_of(double stretch1, double stretch2, double shear,
                                            int degrees) {
  return crossbeam::verification::strain_of(stretch1, stretch2, shear,
                                            fibre_angle<double>(degrees));
}

/// A strain of a drape: fibres -2..3 %, shear up to 0.6 rad, fibres never closer than 20 deg, the
/// angle at least `margin` away from the knots of the tabulated law and from zero.
inline crossbeam::Matrix2<double> random_strain(Random& random, int degrees, double margin) {
  for (;;) {
    const double shear = random.uniform(-0.6, 0.6);
    const double remaining = radians<double>(degrees) - shear;
    if (remaining < 0.35 || remaining > std::numbers::pi - 0.35) continue;
    bool clear = true;
    for (const double knot : knots) clear = clear && std::abs(std::abs(shear) - knot) > margin;
    if (!clear) continue;
    return strain_of(random.uniform(0.98, 1.03), random.uniform(0.98, 1.03), shear, degrees);
  }
}

}  // namespace verify
