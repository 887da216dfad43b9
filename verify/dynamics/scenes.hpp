#pragma once
/// @file
/// Small dynamic models for the verification of contact and time integration.

#include "element/patches.hpp"

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace scenes {

using namespace patches;

/// The same force per mass on every node [mm/ms^2].
template <class R = double>
class Gravity final : public ForceBlock<R> {
 public:
  explicit Gravity(const Eigen::Vector3d& g) : g_(g) {}
  void add_forces(NodalState<R>& state, double) override {
    for (int n = 0; n < state.node_count; ++n) {
      const R m = state.mass[n];
      state.f.set(n, state.f.get(n) + m * Vec3<R>{R(g_.x()), R(g_.y()), R(g_.z())});
    }
  }
  void add_energy(const NodalState<R>& state, EnergyLedger& e) const override {
    double potential = 0;
    for (int n = 0; n < state.node_count; ++n) {
      const auto x = state.x.get(n);
      potential -= double(state.mass[n]) *
                   (g_.x() * double(x.x) + g_.y() * double(x.y) + g_.z() * double(x.z));
    }
    e.add("gravity", EnergyKind::stored, potential);
  }
  [[nodiscard]] double omega_squared() const override { return 0; }

 private:
  Eigen::Vector3d g_;
};

/// Given forces on given nodes at a time that the model counts itself, in steps of dt.
class Pull final : public ForceBlock<double> {
 public:
  Pull(std::vector<int> nodes, std::function<Eigen::Vector3d(double)> force)
      : nodes_(std::move(nodes)), force_(std::move(force)) {}
  void add_forces(NodalState<double>& state, double dt) override {
    const Eigen::Vector3d f = force_(time_);
    for (int n : nodes_) state.f.set(n, state.f.get(n) + vec3(f));
    time_ += dt;
  }
  void add_energy(const NodalState<double>&, EnergyLedger&) const override {}
  [[nodiscard]] double omega_squared() const override { return 0; }

 private:
  std::vector<int> nodes_;
  std::function<Eigen::Vector3d(double)> force_;
  double time_ = 0;
};

template <class T, class Shape>
std::unique_ptr<ToolContact<real_t<T>>> tool(Shape shape, ToolMotion motion,
                                             const ContactParameters& p, int nodes) {
  return std::make_unique<RigidToolContact<T, Shape>>(std::move(shape), std::move(motion), p,
                                                      nodes);
}

/// Rim nodes of a grid with n + 1 nodes per row.
inline std::vector<NodeConstraint> fixed_rim(int nx, int ny) {
  std::vector<NodeConstraint> out;
  for (int i = 0; i <= nx; ++i)
    for (int j = 0; j <= ny; ++j)
      if (i == 0 || i == nx || j == 0 || j == ny)
        out.push_back({i * (ny + 1) + j, true, true, true});
  return out;
}

/// A sheet stretched by `strain` both ways and held at its rim: taut, so that its law is smooth
/// around it. Its nodes start with a smooth velocity in all directions [mm/ms].
struct TautSheet {
  static constexpr double h = 5, strain = 0.015;
  /// @param elements along each side
  explicit TautSheet(double warp_angle = 0.3, int elements = 8)
      : n(elements), mesh(rectangle(n * h, n * h, n, n, warp_angle)) {}
  int n;
  Mesh<4> mesh;
  Woven<ConstantShear<double>> law = fabric(pi / 2, 0.01);
  double speed = 1;

  [[nodiscard]] NodalState<double> state() const {
    NodalState<double> s(mesh, areal_mass, fixed_rim(n, n));
    for (int k = 0; k < mesh.node_count; ++k) {
      const Vec3<double> X = mesh.nodes.get(k);
      s.x.set(k, (1 + strain) * X);
      const double a = std::sin(pi * X.x / (n * h)), b = std::sin(pi * X.y / (n * h));
      s.v.set(k, speed * Vec3<double>{a * b, -0.7 * a * b * b, 2 * a * a * b});
    }
    return s;
  }

  template <class T = Lane>
  [[nodiscard]] Model<double> model(double mass_damping = 0, double bulk_viscosity = 0,
                                    double bending = 1.4e-3) const {
    Model<double> out(state(), mass_damping);
    out.add(std::make_unique<MembraneSweep<T, Quadrilateral<1>, decltype(law)>>(
        mesh, law, areal_mass, MembraneOptions{1e-4, bulk_viscosity}));
    if (bending > 0)
      out.add(
          std::make_unique<BendingSweep<T>>(mesh, BendingStiffness{bending, bending}, areal_mass));
    return out;
  }
};

template <class Run>
Points positions(const Run& run) {
  Points x;
  for (int n = 0; n < run.state().node_count; ++n) x.push_back(eigen(run.state().x.get(n)));
  return x;
}

inline double distance(const Points& a, const Points& b) {
  double out = 0;
  for (std::size_t n = 0; n < a.size(); ++n) out = std::max(out, (a[n] - b[n]).norm());
  return out;
}

}  // namespace scenes
