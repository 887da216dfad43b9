#pragma once
/// @file
/// The contact of one node with a rigid tool: penalty with damping, Coulomb friction. Theory:
/// docs/theory/contact.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <string>

namespace crossbeam {

enum class Friction {
  elastic_stick,  ///< elastic stick and return mapping onto Coulomb's cone, tag [F-2]
  viscous,        ///< slip-rate regularised, impulse capped, tag [F-3]
  smooth,         ///< slip-rate regularised without a kink or a cap, tag [F-6]
};

struct ContactParameters {
  double penalty = 0.05;       ///< pressure per penetration [kN/mm^3]; > 0
  double damping_ratio = 0.2;  ///< of a node's mass on its penalty spring [-]; >= 0
  double friction = 0.2;       ///< Coulomb coefficient [-]; >= 0
  Friction friction_model = Friction::elastic_stick;
  double stick_ratio = 0.5;    ///< tangential over normal penalty [-]; > 0 (elastic stick)
  double slip_speed = 0.04;    ///< speed of full friction [mm/ms]; > 0 (viscous, smooth)
  double smoothing = 0;        ///< depth over which the penalty sets in [mm]; 0: at once, tag [F-5]
  bool culling = true;         ///< skip packs of nodes that cannot have reached the tool
  bool region_classes = true;  ///< ask the flat part of a tool for its height alone
};

inline void validate(const ContactParameters& p, const std::string& prefix = "contact") {
  require_positive(prefix + ".penalty", p.penalty, "kN/mm^3");
  require_non_negative(prefix + ".damping_ratio", p.damping_ratio, "-");
  require_non_negative(prefix + ".friction", p.friction, "-");
  require_positive(prefix + ".stick_ratio", p.stick_ratio, "-");
  require_positive(prefix + ".slip_speed", p.slip_speed, "mm/ms");
  require_non_negative(prefix + ".smoothing", p.smoothing, "mm");
}

}  // namespace crossbeam
