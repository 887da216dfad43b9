#pragma once
/// @file
/// What every membrane element must satisfy, measured on one: a class like Triangle or
/// Quadrilateral, with three or four corners.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/verification/battery.hpp"
#include "crossbeam/verification/patch.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <numbers>

namespace crossbeam::verification {

namespace claims {

inline constexpr Claim element_patch{
    "B-ELEM-01", "Element", "Patch test: an affine map stresses distorted elements as the law says",
    "tractions P N along the border, without shape functions",
    "2e-12 of taut yarns' forces: coordinates of 100 mm on 3 mm edges"};
inline constexpr Claim element_rigid{"B-ELEM-02", "Element",
                                     "Rigid motions cost no energy, and forces turn along",
                                     "random rotations", "2e-12: the same rounding"};
inline constexpr Claim element_gradient{
    "B-ELEM-03", "Element", "Nodal forces are minus the gradient of the energy",
    "Taylor remainders, slope 2", "0.05 of the slope: next term"};
inline constexpr Claim element_balance{"B-ELEM-04", "Element",
                                       "The forces of a patch sum to zero and have no moment",
                                       "statics", "1e-13: 200 roundings"};
inline constexpr Claim element_modes{
    "B-ELEM-05", "Element", "One flat, unstressed element has no mode without energy but its own",
    "zero pivots of the differenced stiffness",
    "a count: the six rigid motions, and the hourglass out of the plane of 2x2 points"};
inline constexpr Claim element_lanes{"B-ELEM-06", "Element",
                                     "Any width of pack gives the same forces", "one lane",
                                     "1e-13: order of summation"};

}  // namespace claims

/// The claims B-ELEM on one element.
/// @param spurious_modes zero modes of one element that its author knows of, beyond rigid motions
template <class Element>
void verify_element(Battery& battery, int spurious_modes = 0) {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  using std::numbers::pi;
  using Lane = Pack<double, 1>;
  constexpr int corners = Element::corners, nx = 5, ny = 4;
  constexpr double edge = 3, distortion = 0.25, warp = 0.4, between = 1.2;
  const MembraneOptions options{0.3, 0};
  const FibreAngle<double> angle(between);
  const WovenMembrane law(CrossedBeamCell<double>(CellParameters<double>{}),
                          ConstantShear<double>(0.02), angle);
  using Law = decltype(law);
  using PlainLaw = std::remove_const_t<Law>;
  Random random(5021);

  Worst patch, rigid, turned, sums, moments, lanes;
  TaylorSlopes slopes(2);
  for (int sample = 0; sample < 8; ++sample) {
    const Matrix3d Q = random.rotation();
    const auto m = mesh<corners>(grid(nx, ny, edge, distortion, random), cells<corners>(nx, ny),
                                 warp, between, Q);
    MembraneSweep<Lane, Element, PlainLaw> sweep(m, law, areal_mass, options);
    Points X;
    for (int n = 0; n < m.node_count; ++n) X.push_back(eigen(m.nodes.get(n)));

    // An affine map, against border tractions.
    const Matrix3d A = random.rotation() * (Matrix3d::Identity() + random_matrix(random, 0.04));
    Base<double> Y;
    Y.col(0) = Q * direction(warp);
    Y.col(1) = Q * direction(warp + pi / 2);
    const Base<double> F = A * Y;
    const Matrix2<double> E = (F.transpose() * F - Matrix2<double>::Identity()) / 2;
    const Points expected = border_forces(m, F * membrane_response(law, E).S, Y);
    auto affine = state_at(m, map(X, A, random.vector(100)));
    const Points forces = gradient(sweep, affine);
    for (int n = 0; n < m.node_count; ++n)
      patch.see((forces[n] - expected[n]).norm() / (14 * edge * E.norm()), sample, n);

    // A rigid motion of the patch at rest, and of a deformed one.
    const Matrix3d R = random.rotation();
    const Vector3d b = random.vector(50);
    auto resting = state_at(m, map(X, R, b));
    rigid.see(largest(gradient(sweep, resting)) / (14 * edge), sample);
    Points x = X;
    for (auto& p : x) p += random.vector(0.1);
    auto before = state_at(m, x), after = state_at(m, map(x, R, b));
    const Points f = gradient(sweep, before), g = gradient(sweep, after);
    Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
    for (int n = 0; n < m.node_count; ++n) {
      turned.see((g[n] - R * f[n]).norm() / largest(f), sample, n);
      sum += f[n];
      moment += x[n].cross(f[n]);
    }
    sums.see(sum.norm() / largest(f), sample);
    moments.see(moment.norm() / (largest(f) * nx * edge), sample);

    using Wide = Pack<double, 4>;
    MembraneSweep<Wide, Element, PlainLaw> wide(m, law, areal_mass, options);
    const Points in_lanes = gradient(wide, before);
    for (int n = 0; n < m.node_count; ++n)
      lanes.see((in_lanes[n] - f[n]).norm() / largest(f), sample, n);

    const double W = energy(sweep, before);
    Points h = X;
    double slope = 0;
    for (int n = 0; n < m.node_count; ++n) {
      h[n] = random.vector(1);
      slope += f[n].dot(h[n]);
    }
    slopes.see(
        [&](double eps) {
          Points moved = x;
          for (int n = 0; n < m.node_count; ++n) moved[n] += eps * h[n];
          return energy(sweep, state_at(m, moved)) - W - eps * slope;
        },
        1e-4, 1e-13 * W);
  }
  battery.measure(claims::element_patch, patch, 2e-12, "nodal forces against border tractions");
  battery.measure(claims::element_rigid, rigid, 2e-13,
                  "forces at rest, turned and moved, relative");
  battery.measure(claims::element_rigid, turned, 2e-12, "forces turned along, relative");
  slopes.measure(battery, claims::element_gradient, 0.05,
                 "energy less its linear part: slope off 2");
  battery.measure(claims::element_balance, sums, 1e-13, "sum of the forces over the largest");
  battery.measure(claims::element_balance, moments, 1e-13, "moment, relative");
  battery.measure(claims::element_lanes, lanes, 1e-13,
                  "forces in four lanes against one, relative");
  battery.show(Plot{claims::element_gradient.id,
                    "Taylor remainders of a patch",
                    "step [mm]",
                    "remainder [kN mm]",
                    true,
                    true,
                    {slopes.curve("energy, slope 2")},
                    "A straight line of slope 2 down to round-off.",
                    false});

  // Modes without energy of one element, by differences of its forces.
  Points X = grid(1, 1, edge, distortion, random), used;
  std::vector<std::array<int, corners>> one{cells<corners>(1, 1)[0]};
  for (int n = 0; n < corners; ++n) {
    used.push_back(X[one[0][n]]);
    one[0][n] = n;
  }
  const auto m = mesh<corners>(used, one, warp, pi / 2);
  MembraneSweep<Lane, Element, LinearLaw<double>> sweep(m, LinearLaw<double>{}, areal_mass,
                                                        MembraneOptions{1, 0});
  constexpr int size = 3 * corners;
  Eigen::Matrix<double, size, size> K;
  constexpr double eps = 1e-4;  // forces are cubic: wrong by eps^2 = 1e-8, rounded to 1e-12
  for (int c = 0; c < size; ++c) {
    Points plus = used, minus = used;
    plus[c / 3][c % 3] += eps;
    minus[c / 3][c % 3] -= eps;
    auto p = state_at(m, plus), q = state_at(m, minus);
    const Points fp = gradient(sweep, p), fm = gradient(sweep, q);
    for (int r = 0; r < size; ++r) K(r, c) = (fp[r / 3][r % 3] - fm[r / 3][r % 3]) / (2 * eps);
  }
  Eigen::FullPivLU<Eigen::Matrix<double, size, size>> lu(K);
  lu.setThreshold(1e-5);
  battery.measure(claims::element_modes,
                  std::abs(static_cast<double>(size - lu.rank() - 6 - spurious_modes)), 0,
                  "modes without energy beyond the known ones");
}

}  // namespace crossbeam::verification
