#pragma once
/// @file
/// The small case of the reference solutions: a ball rises into a square sheet. Everything a drape
/// has is in it: yarns, shear layer, bending, bulk viscosity, mass damping, contact damping and
/// friction; and nothing in it has a step or a memory, so that any integrator can run it.

#include "crossbeam/crossbeam.hpp"
#include "crossbeam/sweep/membrane_tangent.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

namespace crossbeam::drape {

struct SphereSheet {
  static constexpr double side = 60, radius = 15;  ///< [mm]
  static constexpr double areal_mass = 0.743e-6;   ///< [kg/mm^2]
  int elements = 8;                                ///< along a side
  double stroke = 14, duration = 7;                ///< of the ball [mm], [ms]
  bool held = false;                               ///< the rim is held; else it slides in its plane
  int gauss_points = 1;                            ///< 1 or 4
  int cell_sweeps = 5;                             ///< beyond rounding for these strains
  double mass_damping = 1;                         ///< [1/ms]
  double bending = 1.4e-3;  ///< of both families [kN mm]; 0 switches bending off
  double perturbation = 0;  ///< of the start, z of the inner nodes [mm]
  std::uint64_t seed = 1;
  Friction friction_model = Friction::smooth;
  double smoothing = 0.1;  ///< of the penalty [mm]

  [[nodiscard]] Mesh<4> mesh() const { return rectangle(side, side, elements, elements); }

  /// Place and speed of the ball, smooth at both ends.
  [[nodiscard]] double travel(double t) const {
    const double s = std::min(t / duration, 1.0);
    return stroke * (s - std::sin(2 * std::numbers::pi * s) / (2 * std::numbers::pi));
  }
  [[nodiscard]] double speed(double t) const {
    const double s = std::min(t / duration, 1.0);
    return stroke / duration * (1 - std::cos(2 * std::numbers::pi * s));
  }

  template <class R>
  [[nodiscard]] auto law() const {
    const auto angle = FibreAngle<R>::right();
    return WovenMembrane(CrossedBeamCell<R>(CellParameters<R>{}),
                         PolynomialShear<R>(PolynomialCurve<R>(
                             {R(0.051e-3), R(-0.83e-3), R(6.1275e-3), R(-12.0972e-3), R(8.48e-3)})),
                         angle, YarnWidth::corrected, SolverControl::fixed(cell_sweeps));
  }

  template <class R>
  [[nodiscard]] Model<R> model() const {
    using T = NativePack<R>;
    using Law = decltype(law<R>());
    const Mesh<4> sheet = mesh();
    std::vector<NodeConstraint> rim;
    const int n = elements;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j)
        if (i == 0 || i == n || j == 0 || j == n)
          rim.push_back({i * (n + 1) + j, held, held, true});
    NodalState<R> state(sheet, areal_mass, rim);
    std::uint64_t random = seed;
    if (perturbation > 0)
      for (int k = 0; k < sheet.node_count; ++k) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const double uniform = static_cast<double>(random >> 11) * 0x1.0p-52 - 1;
        state.x.z[k] = static_cast<double>(state.free.z[k]) * (perturbation * uniform);
      }
    Model<R> out(std::move(state), mass_damping);
    const MembraneOptions options{1e-4, 0.06};
    if (gauss_points == 1)
      out.add(std::make_unique<MembraneSweepWithTangent<T, Quadrilateral<1>, Law>>(
          sheet, law<R>(), areal_mass, options));
    else
      out.add(std::make_unique<MembraneSweepWithTangent<T, Quadrilateral<4>, Law>>(
          sheet, law<R>(), areal_mass, options));
    if (bending > 0)
      out.add(
          std::make_unique<BendingSweep<T>>(sheet, BendingStiffness{bending, bending}, areal_mass));
    ContactParameters contact;
    contact.friction_model = friction_model;
    contact.slip_speed = 0.1 * stroke / duration;
    contact.smoothing = smoothing;
    const Sphere<R> ball({R(side / 2), R(side / 2), R(-radius)}, R(radius));
    out.add(std::make_unique<RigidToolContact<T, Sphere<R>>>(
        ball,
        ToolMotion::prescribed([s = *this](double t) { return s.travel(t); },
                               [s = *this](double t) { return s.speed(t); }),
        contact, sheet.node_count));
    return out;
  }

  [[nodiscard]] int middle() const { return elements / 2 * (elements + 1) + elements / 2; }
};

}  // namespace crossbeam::drape
