#pragma once
/// @file
/// The model in space: nodes, force blocks and tools, before anything is said about time. The
/// explicit scheme, the first-order system for other integrators and the statics all take one.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/model/force_block.hpp"
#include "crossbeam/model/tool_contact.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace crossbeam {

/// Blocks and tools are added to a model; a simulation that was made from it takes no more.
template <class R>
class Model {
 public:
  /// @param nodes with their masses, constraints, positions and velocities at the start
  /// @param mass_damping alpha of the force -alpha m v [1/ms]; >= 0
  /// @throws InputError for a damping out of range
  explicit Model(NodalState<R> nodes, double mass_damping = 0)
      : nodes_(std::move(nodes)),
        mass_damping_(require_non_negative("mass_damping", mass_damping, "1/ms")) {}

  /// @throws InputError where the block was made for other nodes or another areal mass, or where a
  /// simulation was made from the model
  void add(std::unique_ptr<ForceBlock<R>> block) {
    const std::string name = "blocks[" + std::to_string(blocks_.size()) + "]";
    require_open(name);
    if (!block) throw InputError(name, "empty", "", "a force block");
    require_nodes(name, block->node_count());
    const std::optional<double> mass = block->areal_mass();
    if (mass && *mass != nodes_.areal_mass)
      throw InputError(name + ".areal_mass", detail::to_text(*mass), "kg/mm^2",
                       "that of the nodes, " + detail::to_text(nodes_.areal_mass));
    blocks_.push_back(std::move(block));
  }
  /// @throws InputError where the tool was made for another number of nodes, or where a simulation
  /// was made from the model
  void add(std::unique_ptr<ToolContact<R>> tool) {
    const std::string name = "tools[" + std::to_string(tools_.size()) + "]";
    require_open(name);
    if (!tool) throw InputError(name, "empty", "", "a tool");
    require_nodes(name, tool->node_count());
    tools_.push_back(std::move(tool));
  }

  /// A block of one's own, for instance a load.
  template <class Block>
    requires std::derived_from<Block, ForceBlock<R>>
  void add(Block block) {
    add(std::unique_ptr<ForceBlock<R>>(std::make_unique<Block>(std::move(block))));
  }

  /// From here on nothing can be added: a simulation has made its arrangements.
  void close() { is_closed_ = true; }

  [[nodiscard]] NodalState<R>& nodes() { return nodes_; }
  [[nodiscard]] const NodalState<R>& nodes() const { return nodes_; }
  [[nodiscard]] double areal_mass() const { return nodes_.areal_mass; }  ///< [kg/mm^2]
  [[nodiscard]] double mass_damping() const { return mass_damping_; }    ///< [1/ms]
  [[nodiscard]] const std::vector<std::unique_ptr<ForceBlock<R>>>& blocks() const {
    return blocks_;
  }
  [[nodiscard]] const std::vector<std::unique_ptr<ToolContact<R>>>& tools() const { return tools_; }

  /// Sum of all forces at the nodes' x and v into their f.
  /// @param dt step, for forces that depend on it; @param travel as ToolContact::add_forces
  void compute_forces(double dt, double travel) {
    clear_forces();
    for (const auto& b : blocks_) b->add_forces(nodes_, dt);
    for (const auto& t : tools_) t->add_forces(nodes_, dt, travel);
  }

  /// Nodes with their padding.
  [[nodiscard]] int padded_count() const { return static_cast<int>(nodes_.f.x.size()); }

  void clear_forces() { clear_forces(0, padded_count()); }
  void clear_forces(int first, int last) {
    for (auto* component : {&nodes_.f.x, &nodes_.f.y, &nodes_.f.z})
      std::fill(component->begin() + first, component->begin() + last, R(0));
  }

  /// Cuts the nodes into levels wide enough that no piece of work touches more than two, and sorts
  /// the blocks' work by them, tag [S-3].
  /// @param least nodes of a level, at least
  /// @return first node of every level, multiples of the array padding, and the node count
  [[nodiscard]] std::vector<int> arrange(int least) {
    const int end = nodes_.node_count;
    int width = maximum(least, array_padding);
    for (const auto& b : blocks_) width = maximum(width, minimum(b->bandwidth(), end));
    width = (width + array_padding - 1) / array_padding * array_padding;
    std::vector<int> level_start;
    for (int n = 0; n < end; n += width) level_start.push_back(n);
    level_start.push_back(end);
    for (const auto& b : blocks_) b->arrange(level_start);
    return level_start;
  }

  /// @throws InputError for a block whose forces depend on earlier steps
  void require_no_memory() const {
    for (std::size_t k = 0; k < blocks_.size(); ++k)
      if (blocks_[k]->has_memory())
        throw InputError("blocks[" + std::to_string(k) + "] cells", "followed from step to step",
                         "", "solved anew at every evaluation, which is what this method can use");
  }

  /// Bound of the critical step [ms], tag [D-3]: all stiffnesses together with the fabric's
  /// viscosity, and the contacts with their own damping by themselves. Constant over a run.
  /// @throws RunError for a model without stiffness
  [[nodiscard]] double critical_step() const {
    double fabric = 0, viscosity = 0, contact = 0, contact_damping = 0, area = 0;
    for (int n = 0; n < nodes_.node_count; ++n) area += static_cast<double>(nodes_.area[n]);
    for (const auto& b : blocks_) {
      fabric += b->omega_squared();
      viscosity += b->damping_rate();
    }
    for (const auto& t : tools_) {
      contact += t->omega_squared(areal_mass(), area);
      contact_damping += t->damping_rate(areal_mass(), area);
    }
    if (!(fabric + contact > 0)) throw RunError("no stiffness in the model: no critical step");
    const double all = stable_step(fabric + contact, viscosity);
    return contact > 0 ? minimum(all, stable_step(contact, contact_damping)) : all;
  }

 private:
  void require_open(const std::string& name) const {
    if (is_closed_)
      throw InputError(name, "added to the model of a running simulation", "",
                       "added to the model before a simulation is made from it");
  }
  void require_nodes(const std::string& name, const std::optional<int>& count) const {
    if (count && *count != nodes_.node_count)
      throw InputError(name + ".node_count", std::to_string(*count), "",
                       "the model's number of nodes, " + std::to_string(nodes_.node_count));
  }

  /// Positive root of dt^2 omega^2 / 4 + dt rate = 1: damping forces take the predicted velocity.
  static double stable_step(double omega_squared, double rate) {
    return 2 / (rate + std::sqrt(rate * rate + omega_squared));
  }

  NodalState<R> nodes_;
  double mass_damping_;
  bool is_closed_ = false;
  std::vector<std::unique_ptr<ForceBlock<R>>> blocks_;
  std::vector<std::unique_ptr<ToolContact<R>>> tools_;
};

}  // namespace crossbeam
