#pragma once
/// @file
/// How a rigid tool moves. Theory: docs/theory/contact.md.

#include "crossbeam/base/error.hpp"

#include <functional>
#include <utility>

namespace crossbeam {

/// How a tool moves along z: prescribed, or free under a given force.
struct ToolMotion {
  std::function<double(double)> position;  ///< z(t) [mm]; prescribed when set
  std::function<double(double)> velocity;  ///< dz/dt [mm/ms]; only methods without steps ask for it
  std::function<double(double)> force;     ///< applied F_z(t) [kN] of a free tool
  double mass = 0;                         ///< of a free tool [kg]
  double damping_rate = 0;                 ///< of a free tool [1/ms]
  double start = 0;                        ///< z(0) of a free tool [mm]

  static ToolMotion fixed() {
    return {[](double) { return 0.0; }, [](double) { return 0.0; }, {}, 0, 0, 0};
  }
  static ToolMotion prescribed(std::function<double(double)> z,
                               std::function<double(double)> velocity = {}) {
    return {std::move(z), std::move(velocity), {}, 0, 0, 0};
  }
  static ToolMotion free_under(std::function<double(double)> F, double mass, double damping_rate,
                               double start = 0) {
    ToolMotion motion{{}, {}, std::move(F), mass, damping_rate, start};
    validate(motion);
    return motion;
  }
  [[nodiscard]] bool is_free() const { return !position; }

  /// @throws InputError for a free tool without force or mass, and for a start that is no number
  friend void validate(const ToolMotion& motion) {
    if (!motion.is_free()) {
      require_finite("tool.position(0)", motion.position(0), "mm");
      return;
    }
    if (!motion.force)
      throw InputError("tool.motion", "empty", "", "a position z(t), or a force F(t) and a mass");
    require_positive("tool.mass", motion.mass, "kg");
    require_non_negative("tool.damping_rate", motion.damping_rate, "1/ms");
    require_finite("tool.start", motion.start, "mm");
  }
};

}  // namespace crossbeam
