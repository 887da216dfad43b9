#pragma once
/// @file
/// What every membrane law and every shear law must satisfy, measured on one of them; and the whole
/// way of a yarn law: the law itself, the cell it makes, the membrane that cell makes.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/verification/cell_battery.hpp"
#include "crossbeam/verification/strains.hpp"

#include <Eigen/Geometry>

namespace crossbeam::verification {

namespace claims {

inline constexpr Claim shear_rest{"B-SHEAR-01", "Shear law",
                                  "At rest there is no stress and no energy", "definition",
                                  "1e-14 of the modulus: rounding of the angle"};
inline constexpr Claim shear_gradient{"B-SHEAR-02", "Shear law",
                                      "The stress is the derivative of the energy",
                                      "Taylor remainders, slope 2; dual numbers",
                                      "0.1 of the slope: next term; 1e-11 of the modulus"};
inline constexpr Claim shear_hessian{"B-SHEAR-03", "Shear law",
                                     "The Hessian is the derivative of the stress",
                                     "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim shear_energy{"B-SHEAR-04", "Shear law",
                                    "Shearing never costs less than rest", "definition",
                                    "1e-15 of the modulus: rounding"};
inline constexpr Claim shear_bound{
    "B-SHEAR-05", "Shear law", "The modulus bound holds: the critical time step is safe",
    "second differences of the energy over the angle, up to 0.8 rad", "1e-4: the difference"};

inline constexpr Claim law_gradient{"B-LAW-01", "Membrane law",
                                    "The stress is the derivative of the energy",
                                    "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim law_tangent{"B-LAW-02", "Membrane law",
                                   "The tangent is the derivative of the stress",
                                   "Taylor remainders, slope 2", "0.1 of the slope: next term"};
inline constexpr Claim law_objectivity{
    "B-LAW-03", "Membrane law", "A rotation turns the Cauchy stress along and changes nothing else",
    "random rotations of skew elements in space", "1e-12: increments as long as the base"};
inline constexpr Claim law_balance{"B-LAW-04", "Membrane law",
                                   "The Cauchy stress is symmetric and lies in the membrane",
                                   "definition", "1e-13: rounding"};
inline constexpr Claim law_rest{"B-LAW-05", "Membrane law",
                                "At rest no stress, and never less energy", "definition",
                                "1e-13 of the stiffness: rounding"};
inline constexpr Claim law_stability{
    "B-LAW-06", "Membrane law", "The material is stable but for the compression that it carries",
    "acoustic tensor of random taut and slack states", "1e-4 of the stiffness: buckled yarns"};
inline constexpr Claim law_lanes{"B-LAW-07", "Membrane law",
                                 "Every lane of a pack answers as the scalar", "scalar run",
                                 "1e-11 of the stiffness: a lane may sweep on"};

}  // namespace claims

/// A membrane law with an energy, a tangent and a status, as WovenMembrane is.
template <class Law>
concept ElasticMembraneLaw =
    MembraneLaw<Law, double> && requires(const Law& law, const FibreStrain<double>& b) {
      { law.yarn_energy(law.evaluate(b)) } -> std::convertible_to<double>;
      { law.hessian(law.evaluate(b)) } -> std::same_as<StrainHessian<double>>;
      { law.evaluate(b).cell.status } -> std::convertible_to<CellStatus>;
    };

namespace detail {

inline FibreStrain<double> moved(const FibreStrain<double>& b, const Eigen::Vector3d& h,
                                 double eps) {
  return {b.b11 + eps * h(0), b.b22 + eps * h(1), b.b12 + eps * h(2)};
}
inline FibreState<double> fibre_state(const FibreStrain<double>& b) {
  return {b, stretch(b.b11), stretch(b.b22)};
}
inline Eigen::Matrix3d matrix(const StrainHessian<double>& h) {
  Eigen::Matrix3d H;
  H << h.h11, h.h12, h.h13, h.h12, h.h22, h.h23, h.h13, h.h23, h.h33;
  return H;
}

template <class Shear>
void verify_shear_layer(Battery& battery, const Shear& shear, const FibreAngle<double>& reference) {
  const auto gradient_at = [&](const FibreStrain<double>& b) {
    const auto g = shear.gradient(fibre_state(b));
    return Eigen::Vector3d(g.g1, g.g2, g.g3);
  };
  const auto G = static_cast<double>(shear.modulus_bound());
  battery.measure(claims::shear_rest, gradient_at({}).cwiseAbs().maxCoeff() / G, 1e-14,
                  "stress at rest over the modulus");
  battery.measure(claims::shear_rest, std::abs(shear.energy(fibre_state({}))) / G, 1e-14,
                  "energy at rest over the modulus");
  Random random(5011);
  TaylorSlopes energy(2), stress(2);
  Worst duals, deficit;
  for (int sample = 0; sample < 60; ++sample) {
    const FibreStrain<double> b = random_fibre_strain(random, reference);
    const Eigen::Vector3d h = random.vector(1), g = gradient_at(b);
    const double W = shear.energy(fibre_state(b));
    const Eigen::Matrix3d H = matrix(shear.hessian(fibre_state(b)));
    energy.see(
        [&](double eps) {
          return shear.energy(fibre_state(moved(b, h, eps))) - W - eps * g.dot(h);
        },
        1e-3, 1e-15 * G);
    stress.see([&](double eps) { return (gradient_at(moved(b, h, eps)) - g - eps * H * h).norm(); },
               1e-3, 1e-14 * G);
    deficit.see(-W / G, sample);
    using D = Dual<double, 3>;
    const FibreStrain<D> d{D::variable(b.b11, 0), D::variable(b.b22, 1), D::variable(b.b12, 2)};
    const D by_duals = shear.energy(FibreState<D>{d, stretch(d.b11), stretch(d.b22)});
    for (int i = 0; i < 3; ++i) duals.see(std::abs(by_duals.d[i] - g(i)) / G, sample);
  }
  energy.measure(battery, claims::shear_gradient, 0.1, "energy less its linear part: slope off 2");
  battery.measure(claims::shear_gradient, duals, 1e-11,
                  "dual numbers against the stress, relative");
  stress.measure(battery, claims::shear_hessian, 0.1, "stress less its linear part: slope off 2");
  battery.measure(claims::shear_energy, deficit, 1e-15, "largest deficit of energy, relative");

  // Energy over the angle at unit stretches, its first and second differences.
  const auto W = [&](double gamma) {
    return shear.energy(fibre_state(
        fibre_strain<double>(strain_of(1, 1, gamma, reference), fibre_from_cartesian(reference))));
  };
  constexpr double step = 1e-3;
  Curve traction{"traction", {}, {}};
  double modulus = 0;
  for (double gamma = -0.8; gamma <= 0.8; gamma += 0.01) {
    const double remaining = reference.delta - gamma;
    if (remaining < 0.3 || remaining > std::numbers::pi - 0.3) continue;
    const double before = W(gamma - step), at = W(gamma), after = W(gamma + step);
    modulus = maximum(modulus, (after - 2 * at + before) / (step * step));
    traction.x.push_back(gamma * 180 / std::numbers::pi);
    traction.y.push_back((after - before) / (2 * step));
  }
  // [C-10]: the stiffness bound of the time step takes four times the modulus.
  battery.measure(claims::shear_bound, modulus / (4 * G), 1 + 1e-4,
                  "largest modulus over four times the bound");
  battery.show(Plot{claims::shear_gradient.id,
                    "Shear traction",
                    "shear angle [deg]",
                    "traction [kN/mm]",
                    false,
                    false,
                    {traction},
                    "Through zero, rising; odd for a balanced fabric.",
                    false});
}

/// A skew element in space and its image.
struct SkewElement {
  Base<double> reference, current;
  double alpha = 0;
  explicit SkewElement(Random& random) {
    do {
      reference.col(0) = random.vector(5);
      reference.col(1) = random.vector(5);
    } while (reference.col(0).cross(reference.col(1)).norm() < 4);
    Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) map.col(i) += random.vector(0.03);
    current = map * reference;
    alpha = random.uniform(-3, 3);
  }
};

template <class Law>
void verify_law_in_space(Battery& battery, const Law& law) {
  Random random(5012);
  Worst stress, cauchy, symmetry, normal;
  const double S0 = 0.1 * static_cast<double>(law.stiffness_bound());
  for (int sample = 0; sample < 50; ++sample) {
    const SkewElement e(random);
    const Matrix3<double> Q = random.rotation();
    const auto d = cartesian_from_convected(e.reference, e.alpha);
    const auto respond = [&](const Base<double>& current) {
      const auto E = to_cartesian(
          convected_strain_from_increment<double>(current - e.reference, e.reference), d);
      const Matrix2<double> S = membrane_response(law, E).S;
      const Matrix3<double> sigma = cauchy_stress<double>(S, surface_gradient<double>(current, d),
                                                          area_ratio(current, e.reference));
      return std::pair<Matrix2<double>, Matrix3<double>>(S, sigma);
    };
    const auto before = respond(e.current);
    const auto after = respond(Q * e.current);
    stress.see((after.first - before.first).norm() / S0, sample);
    cauchy.see((after.second - Q * before.second * Q.transpose()).norm() / S0, sample);
    symmetry.see((before.second - before.second.transpose()).norm() / S0, sample);
    const Vector3<double> n = e.current.col(0).cross(e.current.col(1)).normalized();
    normal.see((before.second * n).norm() / S0, sample);
  }
  battery.measure(claims::law_objectivity, stress, 1e-12,
                  "second Piola-Kirchhoff stress, relative");
  battery.measure(claims::law_objectivity, cauchy, 1e-12, "sigma against Q sigma Q^T, relative");
  battery.measure(claims::law_balance, symmetry, 1e-13, "sigma - sigma^T, relative");
  battery.measure(claims::law_balance, normal, 1e-13, "sigma n, relative");
}

template <class Law>
void verify_law_stability(Battery& battery, const Law& law) {
  Random random(5013);
  double least = 0;
  for (int sample = 0; sample < 500; ++sample) {
    const Matrix2<double> E = strain_of(random.uniform(0.97, 1.03), random.uniform(0.97, 1.03),
                                        random.uniform(-0.2, 0.2), law.reference());
    const auto r = membrane_response(law, E, Tangent::yes);
    // F as the Cholesky factor of C: the acoustic quotient S : n n |a|^2 + D : C : D.
    const double C11 = 1 + 2 * E(0, 0), C12 = 2 * E(0, 1), C22 = 1 + 2 * E(1, 1);
    Matrix2<double> F;
    F << std::sqrt(C11), C12 / std::sqrt(C11), 0, std::sqrt(C22 - C12 * C12 / C11);
    for (int k = 0; k < 30; ++k) {
      const double by = k * std::numbers::pi / 30;
      const Eigen::Vector2d n(std::cos(by), std::sin(by));
      Eigen::Matrix<double, 3, 2> strain;
      for (int i = 0; i < 2; ++i)
        strain.col(i) << F(i, 0) * n(0), F(i, 1) * n(1), F(i, 0) * n(1) + F(i, 1) * n(0);
      const double along = n.dot(r.S * n);
      const Matrix2<double> A =
          along * Matrix2<double>::Identity() + strain.transpose() * r.dS_dE * strain;
      least = (std::min)(
          {least, along, (A(0, 0) + A(1, 1)) / 2 - std::hypot((A(0, 0) - A(1, 1)) / 2, A(0, 1))});
    }
  }
  battery.measure(claims::law_stability, -least / static_cast<double>(law.stiffness_bound()), 1e-4,
                  "most negative acoustic eigenvalue over the stiffness");
}

}  // namespace detail

/// The claims B-LAW on one membrane law.
template <ElasticMembraneLaw Law>
void verify_law(Battery& battery, const Law& law) {
  const auto energy_at = [&](const FibreStrain<double>& b) {
    const auto s = law.evaluate(b);
    return law.yarn_energy(s) + law.shear_energy(s);
  };
  const auto gradient_at = [&](const FibreStrain<double>& b) {
    const auto m = law.stress(law.evaluate(b));
    return Eigen::Vector3d(m.m11, m.m22, 2 * m.m12);
  };
  const auto stiffness = static_cast<double>(law.stiffness_bound());
  Random random(5014);
  TaylorSlopes energy(2), stress(2);
  Worst deficit, lanes;
  for (int sample = 0; sample < 60; ++sample) {
    const FibreStrain<double> b = random_fibre_strain(random, law.reference());
    const Eigen::Vector3d h = random.vector(1), g = gradient_at(b);
    const double W = energy_at(b);
    const Eigen::Matrix3d H = detail::matrix(law.hessian(law.evaluate(b)));
    energy.see([&](double eps) { return energy_at(detail::moved(b, h, eps)) - W - eps * g.dot(h); },
               1e-3, 1e-17 * stiffness);
    stress.see(
        [&](double eps) {
          return (gradient_at(detail::moved(b, h, eps)) - g - eps * H * h).norm();
        },
        1e-3, 2e-16 * stiffness);
    deficit.see(-W / stiffness, sample);
    using P = Pack<double, 4>;
    const auto packed = law.stress(law.evaluate(FibreStrain<P>{P(b.b11), P(b.b22), P(b.b12)}));
    lanes.see((std::max)({std::abs(packed.m11[3] - g(0)), std::abs(packed.m22[3] - g(1)),
                          std::abs(2 * packed.m12[3] - g(2))}) /
                  stiffness,
              sample);
  }
  energy.measure(battery, claims::law_gradient, 0.1, "energy less its linear part: slope off 2");
  stress.measure(battery, claims::law_tangent, 0.1, "stress less its linear part: slope off 2");
  battery.measure(claims::law_rest, gradient_at({}).cwiseAbs().maxCoeff() / stiffness, 1e-13,
                  "stress at rest, relative");
  battery.measure(claims::law_rest, deficit, 1e-13, "largest deficit of energy, relative");
  battery.measure(claims::law_lanes, lanes, 1e-11, "stress of the lanes, relative");
  battery.show(Plot{claims::law_gradient.id,
                    "Taylor remainders of the membrane law",
                    "step [strain]",
                    "remainder [kN/mm]",
                    true,
                    true,
                    {energy.curve("energy, slope 2"), stress.curve("stress, slope 2")},
                    "Straight lines of slope 2 down to round-off.",
                    false});
  detail::verify_law_in_space(battery, law);
  detail::verify_law_stability(battery, law);
}

/// The whole way of a yarn law: B-YARN on itself, B-CELL on the cell and B-LAW on the membrane of
/// such yarns.
/// @param fabric the cell's other parameters
template <YarnLaw<double> Law>
void verify_yarn(Battery& battery, const Law& law, const CellParameters<double>& fabric = {}) {
  detail::verify_axial_law(battery, law);
  const CrossedBeamCell<double, Contact::unilateral, Law> cell(fabric, law, law);
  verify_cell(battery, cell);
  const auto right = FibreAngle<double>::right();
  verify_law(battery, WovenMembrane(cell, ConstantShear<double>(0.001), right));
}

/// The whole way of a shear law: B-SHEAR on itself and B-LAW on a membrane of Table 1 with it.
template <class Shear>
  requires ShearLaw<Shear, double>
void verify_shear(Battery& battery, const Shear& shear,
                  const FibreAngle<double>& reference = FibreAngle<double>::right()) {
  detail::verify_shear_layer(battery, shear, reference);
  verify_law(battery,
             WovenMembrane(CrossedBeamCell<double>(CellParameters<double>{}), shear, reference));
}

}  // namespace crossbeam::verification
