#pragma once
/// @file
/// The model in space: nodes, force blocks and tools, before anything is said about time. The
/// explicit scheme, the first-order system for other integrators and the statics all take one.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/model/force_block.hpp"
#include "crossbeam/model/tool_contact.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
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

  /// Nodes with their padding.
  [[nodiscard]] int padded_count() const { return static_cast<int>(state.f.x.size()); }

  void clear_forces() { clear_forces(0, padded_count()); }
  void clear_forces(int first, int last) {
    for (auto* component : {&state.f.x, &state.f.y, &state.f.z})
      std::fill(component->begin() + first, component->begin() + last, R(0));
  }

  /// Cuts the nodes into levels wide enough that no piece of work touches more than two, and sorts
  /// the blocks' work by them, tag [S-3].
  /// @param least nodes of a level, at least
  /// @return first node of every level, multiples of the array padding, and the node count
  [[nodiscard]] std::vector<int> arrange(int least) {
    const int end = state.node_count;
    int width = maximum(least, array_padding);
    for (const auto& b : blocks) width = maximum(width, minimum(b->bandwidth(), end));
    width = (width + array_padding - 1) / array_padding * array_padding;
    std::vector<int> level_start;
    for (int n = 0; n < end; n += width) level_start.push_back(n);
    level_start.push_back(end);
    for (const auto& b : blocks) b->arrange(level_start);
    return level_start;
  }

  /// @throws InputError for a block whose forces depend on earlier steps
  void require_no_memory() const {
    for (std::size_t k = 0; k < blocks.size(); ++k)
      if (blocks[k]->has_memory())
        throw InputError("blocks[" + std::to_string(k) + "] cells", "followed from step to step",
                         "", "solved anew at every evaluation, which is what this method can use");
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
    return contact > 0 ? minimum(all, stable_step(contact, contact_damping)) : all;
  }

 private:
  /// Positive root of dt^2 omega^2 / 4 + dt rate = 1: damping forces take the predicted velocity.
  static double stable_step(double omega_squared, double rate) {
    return 2 / (rate + std::sqrt(rate * rate + omega_squared));
  }
};

}  // namespace crossbeam
