#pragma once
/// @file
/// Membrane strains drawn from what a fabric does: stretch of its yarns and shear between them.

#include "crossbeam/base/linalg.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"
#include "crossbeam/verification/random.hpp"

#include <cmath>
#include <numbers>

namespace crossbeam::verification {

/// Cartesian strain of given fibre stretches and a shear angle.
inline Matrix2<double> strain_of(double stretch1, double stretch2, double shear,
                                 const FibreAngle<double>& reference) {
  // Columns: images of Y1 = F1 and of F2, then of Y2 by linearity.
  Matrix2<double> f, inverse;
  const double delta = reference.delta;
  f << stretch1, stretch2 * std::cos(delta - shear), 0, stretch2 * std::sin(delta - shear);
  inverse << 1, -reference.cosine / reference.sine, 0, 1 / reference.sine;
  const Matrix2<double> gradient = f * inverse;
  return (gradient.transpose() * gradient - Matrix2<double>::Identity()) / 2;
}

/// Fibres -2..3 %, shear up to 0.5 rad, fibres at least 0.4 rad from falling together.
inline FibreStrain<double> random_fibre_strain(Random& random,
                                               const FibreAngle<double>& reference) {
  using std::numbers::pi;
  double shear = 0;
  do {
    shear = random.uniform(-0.5, 0.5);
  } while (reference.delta - shear < 0.4 || reference.delta - shear > pi - 0.4);
  const double a = random.uniform(0.98, 1.03), b = random.uniform(0.98, 1.03);
  return fibre_strain<double>(strain_of(a, b, shear, reference), fibre_from_cartesian(reference));
}

}  // namespace crossbeam::verification
