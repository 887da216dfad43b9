#pragma once
/// @file
/// Models for the reference solutions: everything in rate form, smooth where the explicit scene of
/// dynamics/scenes.hpp has kinks.

#include "dynamics/scenes.hpp"

#include "crossbeam/adapters/sundials.hpp"

namespace reference_scenes {

using namespace scenes;

/// A ball rises into a sheet whose rim slides in its plane: yarns, shear layer, bending, bulk
/// viscosity, mass damping, contact damping and friction, all at once.
struct SphereSheet {
  static constexpr double side = 60, radius = 15, stroke = 14, duration = 7;  // [mm], [ms]
  int n = 12;                    ///< elements along a side
  double friction = 0.2;
  double mass_damping = 1;       ///< [1/ms]
  SolverControl control = SolverControl::fixed(8);
  Friction friction_model = Friction::smooth;
  bool clamped = false; double height=1;

  Mesh<4> mesh = rectangle(side, side, n, n);

  /// Smooth at both ends.
  static double travel(double t) {
    const double s = std::min(t / duration, 1.0);
    return stroke * (s - std::sin(2 * pi * s) / (2 * pi));
  }
  static double speed(double t) {
    const double s = std::min(t / duration, 1.0);
    return stroke / duration * (1 - std::cos(2 * pi * s));
  }

  [[nodiscard]] ContactParameters contact() const {
    ContactParameters p;
    p.friction = friction;
    p.friction_model = friction_model;
    p.slip_speed = 0.2;
    p.smoothing = 0.1;
    return p;
  }

  [[nodiscard]] auto law() const {
    return WovenMembrane<CrossedBeamCell<double>, PolynomialShear<double>>(
        CrossedBeamCell<double>(CellParameters<double>{}),
        PolynomialShear<double>(
            PolynomialCurve<double>({0.051e-3, -0.83e-3, 6.1275e-3, -12.0972e-3, 8.48e-3}),
            FibreAngle<double>::right()),
        FibreAngle<double>::right(), YarnWidth::corrected, control);
  }

  [[nodiscard]] NodalState<double> start() const {
    std::vector<NodeConstraint> rim;
    for (const auto& c : fixed_rim(n, n)) rim.push_back({c.node, clamped, clamped, true});
    return NodalState<double>(mesh, areal_mass, rim);
  }

  [[nodiscard]] Model<double> model() const {
    using T = NativePack<double>;
    Model<double> out(start(), areal_mass, mass_damping);
    using Law = decltype(law());
    out.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, Law>>(mesh, law(), areal_mass,
                                                                     MembraneOptions{1e-4, 0.06}));
    out.add(std::make_unique<BendingSweep<T>>(mesh, BendingStiffness{1.4e-3, 1.4e-3}, areal_mass));
    out.add(tool<T>(Sphere<double>({side / 2, side / 2, -radius}, radius),
                    ToolMotion::prescribed(travel, speed), contact(), mesh.node_count));
    return out;
  }

  [[nodiscard]] int middle() const { return n / 2 * (n + 1) + n / 2; }
};

inline Points positions(const Model<double>& model) {
  Points x;
  for (int n = 0; n < model.state.node_count; ++n) x.push_back(eigen(model.state.x.get(n)));
  return x;
}

}  // namespace reference_scenes
