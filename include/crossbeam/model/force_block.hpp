#pragma once
/// @file
/// What the time integration asks of a group of elements or stencils. A scene is a list of blocks:
/// what it does not have costs nothing.

#include "crossbeam/model/ledger.hpp"
#include "crossbeam/model/nodal_state.hpp"
#include "crossbeam/model/tangent_entries.hpp"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace crossbeam {

/// What one element looks like, averaged over its Gauss points: for output and checks.
struct ElementSample {
  double shear_angle = 0;           ///< signed [rad]
  double stretch[2] = {1, 1};       ///< warp, weft [-]
  double tension[2] = {0, 0};       ///< per unit width [kN/mm]
  double crimp_height[2] = {0, 0};  ///< H + w of the yarns [mm]
  double contact_force = 0;         ///< of the cell, pressure positive [kN]
  bool slack = false;               ///< the yarns do not touch
  bool fallback = false;            ///< second-order cell answered by the energy cell
  double cell_correction = 0;       ///< last Newton correction of the cell, or how far
                                    ///< its followed heights are off [mm]
  Vec3<double> warp{}, weft{};      ///< current unit directions
};

template <class R>
class ForceBlock {
 public:
  virtual ~ForceBlock() = default;
  /// Subtracts the internal forces at x_n from state.f.
  virtual void add_forces(NodalState<R>& state, double dt) = 0;

  /// @name The same in stages, one for each level of nodes, tag [S-3]
  /// @{
  /// Largest difference of two node numbers that are worked on at the same time; `whole` for a block
  /// that knows no stages and is asked for all at once.
  [[nodiscard]] virtual int bandwidth() const { return whole; }
  static constexpr int whole = (std::numeric_limits<int>::max)();
  /// Sorts the work: what touches level s and none above is stage s.
  /// @param level_start first node of every level and the end; levels are wider than the bandwidth
  virtual void arrange(const std::vector<int>& /*level_start*/) {}
  /// Before the stages of a step, or of several that are in flight together, tag [S-6].
  virtual void begin_step(const NodalState<R>&) {}
  /// Stages that are two or more apart may run at the same time, tag [S-5].
  virtual void add_stage(NodalState<R>& state, double dt, int stage) {
    if (stage == 0) add_forces(state, dt);
  }
  /// @}

  /// Whether the forces depend on the positions of earlier steps, which other integrators and the
  /// statics cannot offer.
  [[nodiscard]] virtual bool has_memory() const { return false; }
  /// Books the block's terms at x_n: the energy that it stores, what it has dissipated or supplied
  /// since the start.
  virtual void add_energy(const NodalState<R>& state, EnergyLedger& ledger) const = 0;
  /// @name What a model compares with its own; nothing where the block does not know it
  /// @{
  [[nodiscard]] virtual std::optional<int> node_count() const { return {}; }
  [[nodiscard]] virtual std::optional<double> areal_mass() const { return {}; }  ///< [kg/mm^2]
  /// @}
  /// Bound of the squared highest frequency of these forces on the lumped mass [1/ms^2]. Constant.
  [[nodiscard]] virtual double omega_squared() const = 0;
  /// Bound of the largest damping rate c/m of these forces' viscous part [1/ms]. Constant.
  [[nodiscard]] virtual double damping_rate() const { return 0; }
  /// Adds -df/dx and -df/dv at state.x, state.v, for implicit methods, tag.
  /// @throws InputError where the forces have no consistent tangent
  virtual void add_tangent(const NodalState<R>&, TangentEntries&) const {
    throw InputError("force block", "without a consistent tangent", "",
                     "one with add_tangent, for instance MembraneSweepWithTangent");
  }
  /// State of every element of the block; empty for blocks without elements.
  virtual void sample(const NodalState<R>&, std::vector<ElementSample>&) const {}
  /// Gauss points evaluated in a step.
  [[nodiscard]] virtual long long points() const { return 0; }
  /// Gauss points answered by a fallback up to now.
  [[nodiscard]] virtual long long fallbacks() const { return 0; }
};

}  // namespace crossbeam
