#pragma once
/// @file
/// A fabric: the constitutive law of its membrane and what else belongs to a piece of cloth, each
/// number in one place. Whoever needs one of them asks the fabric.

#include "crossbeam/law/membrane_law.hpp"

#include <utility>

namespace crossbeam {

struct BendingStiffness {
  double warp = 0;  ///< D1 per unit width [kN mm]; >= 0
  double weft = 0;  ///< D2 per unit width [kN mm]; >= 0
};

struct FabricProperties {
  double areal_mass = 0;  ///< [kg/mm^2]; > 0: there is no default
  double thickness = 0;   ///< between its two faces [mm]; >= 0
  BendingStiffness bending{};
};

/// @tparam Law the membrane law: it holds cell, shear layer and the angle between the yarns
template <class Law>
  requires MembraneLaw<Law, typename Law::Real>
class Fabric {
 public:
  using Real = typename Law::Real;

  /// @throws InputError naming the property that is out of its range
  Fabric(Law law, const FabricProperties& properties)
      : law_(std::move(law)), properties_(properties) {
    require_positive("fabric.areal_mass", properties.areal_mass, "kg/mm^2");
    require_non_negative("fabric.thickness", properties.thickness, "mm");
    require_non_negative("fabric.bending.warp", properties.bending.warp, "kN mm");
    require_non_negative("fabric.bending.weft", properties.bending.weft, "kN mm");
  }

  [[nodiscard]] const Law& law() const { return law_; }
  [[nodiscard]] double areal_mass() const { return properties_.areal_mass; }
  [[nodiscard]] double thickness() const { return properties_.thickness; }
  [[nodiscard]] const BendingStiffness& bending() const { return properties_.bending; }
  /// Whether its yarns resist bending at all.
  [[nodiscard]] bool bends() const { return bending().warp > 0 || bending().weft > 0; }

 private:
  Law law_;
  FabricProperties properties_;
};

}  // namespace crossbeam
