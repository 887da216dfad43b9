#pragma once
/// @file
/// The model in space: nodes, force blocks and tools, before anything is said about time. The
/// explicit scheme, the first-order system for other integrators and the statics all take one.

#include "crossbeam/contact/tool_contact.hpp"
#include "crossbeam/dynamics/force_block.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace crossbeam {

template <class R>
struct Model {
  NodalState<R> state;
  double areal_mass = 0;    ///< [kg/mm^2]; > 0
  double mass_damping = 0;  ///< alpha of the force -alpha m v [1/ms]; >= 0
  std::vector<std::unique_ptr<ForceBlock<R>>> blocks;
  std::vector<std::unique_ptr<ToolContact<R>>> tools;

  /// @throws InputError for an areal mass or a damping out of range
  Model(NodalState<R> nodal_state, double mass_per_area, double damping = 0)
      : state(std::move(nodal_state)),
        areal_mass(require_positive("areal_mass", mass_per_area, "kg/mm^2")),
        mass_damping(require_non_negative("mass_damping", damping, "1/ms")) {}

  void add(std::unique_ptr<ForceBlock<R>> block) { blocks.push_back(std::move(block)); }
  void add(std::unique_ptr<ToolContact<R>> tool) { tools.push_back(std::move(tool)); }

  /// Sum of all forces at state.x, state.v into state.f.
  /// @param dt step, for forces that depend on it; @param travel as ToolContact::add_forces
  void compute_forces(double dt, double travel) {
    clear_forces();
    for (const auto& b : blocks) b->add_forces(state, dt);
    for (const auto& t : tools) t->add_forces(state, dt, travel);
  }

  void clear_forces() {
    std::fill(state.f.x.begin(), state.f.x.end(), R(0));
    std::fill(state.f.y.begin(), state.f.y.end(), R(0));
    std::fill(state.f.z.begin(), state.f.z.end(), R(0));
  }

  /// Bound of the critical step [ms], tag [D-3]: all stiffnesses together with the fabric's
  /// viscosity, and the contacts with their own damping by themselves. Constant over a run.
  /// @throws RunError for a model without stiffness
  [[nodiscard]] double critical_step() const {
    double fabric = 0, viscosity = 0, contact = 0, contact_damping = 0, area = 0;
    for (int n = 0; n < state.node_count; ++n) area += static_cast<double>(state.area[n]);
    for (const auto& b : blocks) {
      fabric += b->omega_squared();
      viscosity += b->damping_rate();
    }
    for (const auto& t : tools) {
      contact += t->omega_squared(areal_mass, area);
      contact_damping += t->damping_rate(areal_mass, area);
    }
    if (!(fabric + contact > 0)) throw RunError("no stiffness in the model: no critical step");
    const double all = stable_step(fabric + contact, viscosity);
    return contact > 0 ? std::min(all, stable_step(contact, contact_damping)) : all;
  }

 private:
  /// Positive root of dt^2 omega^2 / 4 + dt rate = 1: damping forces take the predicted velocity.
  static double stable_step(double omega_squared, double rate) {
    return 2 / (rate + std::sqrt(rate * rate + omega_squared));
  }
};

}  // namespace crossbeam
