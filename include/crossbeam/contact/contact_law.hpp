#pragma once
/// @file
/// The contact law of one node and a rigid tool, as functions of its depth, its velocity and its
/// elastic slip: penalty with damping, Coulomb friction. S is a number, a pack or a dual number.
/// Theory: docs/theory/contact.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <limits>
#include <string>
#include <utility>

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
  bool check_start = true;     ///< refuse nodes deep in the tool and tools that fit between nodes
};

inline void validate(const ContactParameters& p, const std::string& prefix = "contact") {
  require_positive(prefix + ".penalty", p.penalty, "kN/mm^3");
  require_non_negative(prefix + ".damping_ratio", p.damping_ratio, "-");
  require_non_negative(prefix + ".friction", p.friction, "-");
  require_positive(prefix + ".stick_ratio", p.stick_ratio, "-");
  require_positive(prefix + ".slip_speed", p.slip_speed, "mm/ms");
  require_non_negative(prefix + ".smoothing", p.smoothing, "mm");
}

/// What the penalty makes of a depth. Forces act on the node along the normal.
template <class S>
struct NormalForce {
  S viscous;   ///< the damper's share of the pressure [kN]; negative while the node leaves
  S pressure;  ///< >= 0 [kN]
  S energy;    ///< stored in the penalty [kN mm]
};

/// Penalty with damping, tag [F-1]. Damping never pulls: the total stays a pressure.
/// @param depth into the tool [mm], 0 where the node does not touch
/// @param closing speed into the tool [mm/ms]
/// @param k stiffness k_p A [kN/mm]; @param c damping coefficient [kN ms/mm]
template <class S, class Mask>
CROSSBEAM_INLINE NormalForce<S> normal_force(const S& depth, const S& closing, const S& k,
                                             const S& c, const Mask& touching) {
  using R = real_t<S>;
  const S zero(R(0));
  const S elastic = k * depth;
  const S viscous = select(touching, maximum(c * closing, -elastic), zero);
  return {viscous, elastic + viscous, S(R(0.5)) * elastic * depth};
}

/// The same without a kink: stiffness and damping set in over the depth e [mm], tag [F-5].
template <class S, class Mask>
CROSSBEAM_INLINE NormalForce<S> normal_force(const S& depth, const S& closing, const S& k,
                                             const S& c, const S& e, const Mask& touching) {
  using R = real_t<S>;
  const S zero(R(0)), one(R(1));
  const S u = minimum(depth / e, one), over = depth - e * u;
  const S slope = u * u * (S(R(3)) - S(R(2)) * u);
  const S elastic = k * (e * u * u * u * (one - S(R(0.5)) * u) + over);
  const S energy = k * (e * e * u * u * u * u * (S(R(0.25)) - S(R(0.1)) * u) +
                        over * (S(R(0.5)) * e + S(R(0.5)) * over));
  const S viscous = select(touching, maximum(c * slope * closing, -elastic), zero);
  return {viscous, elastic + viscous, energy};
}

/// Component along the normal; in a flat part the normal is +-z.
template <bool Flat, class S>
CROSSBEAM_INLINE S along_normal(const Vec3<S>& v, const Vec3<S>& normal) {
  if constexpr (Flat)
    return v.z * normal.z;
  else
    return dot(v, normal);
}
/// The part of v in the tangent plane.
template <bool Flat, class S>
CROSSBEAM_INLINE Vec3<S> tangential(const Vec3<S>& v, const Vec3<S>& normal) {
  if constexpr (Flat)
    return {v.x, v.y, S(real_t<S>(0))};
  else
    return v - dot(v, normal) * normal;
}

template <class S>
struct StickFriction {
  Vec3<S> force;    ///< on the node [kN]
  Vec3<S> trial;    ///< elastic slip before the cone is asked [mm]
  Vec3<S> slipped;  ///< elastic slip that belongs to a force on the cone [mm]
  decltype(std::declval<S>() > std::declval<S>()) slips;  ///< the trial force left the cone
};

/// Elastic stick with return mapping onto Coulomb's cone, tag [F-2].
/// @param xi elastic slip so far [mm]; @param slip_rate velocity in the tangent plane [mm/ms]
/// @param k_t tangential stiffness [kN/mm]; @param c_t its damping coefficient [kN ms/mm]
/// @param limit mu p [kN]
template <bool Flat, class S>
CROSSBEAM_INLINE StickFriction<S> stick_friction(const Vec3<S>& xi, const Vec3<S>& slip_rate,
                                                 const Vec3<S>& normal, const S& k_t, const S& c_t,
                                                 const S& limit) {
  using std::sqrt;
  using R = real_t<S>;
  const S tiny(std::numeric_limits<R>::min());
  StickFriction<S> out;
  out.trial = tangential<Flat>(xi, normal);
  const Vec3<S> t = S(R(-1)) * (k_t * out.trial + c_t * slip_rate);
  const S size = sqrt(maximum(dot(t, t), tiny));  // has a derivative at zero
  out.slips = size > limit;
  out.force = select(out.slips, limit / size, S(R(1))) * t;
  out.slipped = (S(R(-1)) / maximum(k_t, tiny)) * out.force;
  return out;
}

/// Friction regularised by a slip speed v_s, its impulse capped at what stops half the node's slip
/// in a step, tag [F-3].
/// @param cap m/(2 dt) [kN ms/mm]
template <class S>
CROSSBEAM_INLINE Vec3<S> viscous_friction(const Vec3<S>& slip_rate, const S& limit, const S& v_s,
                                          const S& cap) {
  using std::sqrt;
  const S speed = sqrt(dot(slip_rate, slip_rate));
  return (S(real_t<S>(0)) - minimum(limit / maximum(speed, v_s), cap)) * slip_rate;
}

/// Friction regularised without a kink or a cap, tag [F-6].
template <class S>
CROSSBEAM_INLINE Vec3<S> smooth_friction(const Vec3<S>& slip_rate, const S& limit, const S& v_s) {
  using std::sqrt;
  return (-limit / sqrt(dot(slip_rate, slip_rate) + v_s * v_s)) * slip_rate;
}

}  // namespace crossbeam
