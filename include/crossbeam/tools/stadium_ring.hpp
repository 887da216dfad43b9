#pragma once
/// @file
/// The blank holder: a flat ring with a stadium-shaped opening and a rounded inner edge.
/// Theory: docs/theory/tools.md.

#include "crossbeam/tools/surface.hpp"

namespace crossbeam {

/// Dimensions of the ring. The defaults are the holder of the double-dome benchmark; the edge
/// radius is ours (a sharp edge lets nodes that sag into the opening slip back with a kick).
template <class R = double>
struct StadiumRingParameters {
  R opening_radius = R(275) / R(3);  ///< r, of the half circles; also half the opening along x
                                     ///< [mm]; > 0
  R centre_distance = R(100);        ///< y_c, half circles about (0, +-y_c) [mm]; >= 0
  R edge_radius = R(5);              ///< r_e of the rounded inner edge [mm]; > 0
};

/// The tool fills z <= 0 outside the opening, without end outwards and downwards; the fabric lies
/// on z > 0. Signed distance exact everywhere [T-6]; the normal is continuous wherever the gap is
/// above -edge_radius, apart from the middle line of the opening.
template <class R = double>
class StadiumRing {
 public:
  /// @param offset distance of the parallel surface, towards the fabric; > -edge_radius and
  ///        < opening_radius [length]
  explicit StadiumRing(const StadiumRingParameters<R>& p = {}, R offset = R(0))
      : parameters_(p),
        reach_(require_positive("ring.opening_radius", p.opening_radius, "mm") +
               require_positive("ring.edge_radius", p.edge_radius, "mm")),
        rounding_(require_positive("ring.edge_radius + offset",
                                   p.edge_radius + require_finite("ring.offset", offset, "mm"),
                                   "mm")),
        offset_(offset),
        flat_squared_(square(reach_ * (R(1) + R(8) * epsilon_of<R>()))) {
    require_non_negative("ring.centre_distance", p.centre_distance, "mm");
    require_positive("ring.opening_radius - offset", p.opening_radius - offset, "mm");
    detail::require_square("ring.opening_radius + edge_radius", reach_, "mm");
    detail::require_square("ring.centre_distance", p.centre_distance, "mm");
  }

  template <class T>
  CROSSBEAM_INLINE SurfaceGap<T> gap(const Vec3<T>& p) const {
    using std::sqrt;
    const T zero = T(R(0)), one = T(R(1)), least = T(detail::least_square<R>());
    // In plan: vector and distance from the opening's middle line.
    const T beyond = maximum(magnitude(p.y) - T(parameters_.centre_distance), zero);
    const T along_y = select(p.y < zero, -beyond, beyond);
    const T plan_squared = p.x * p.x + along_y * along_y;
    const auto off_line = !(plan_squared <= least);  // a NaN stays one
    const T from_line = sqrt(select(off_line, plan_squared, one));
    const T rho = select(off_line, from_line, zero);
    const Vec3<T> outward{select(off_line, p.x / from_line, one),
                          select(off_line, along_y / from_line, zero), zero};
    // In the meridian plane: inward and upward distance from the centre line of the rounding.
    const T inward = T(reach_) - rho;
    const T upward = p.z + T(parameters_.edge_radius);
    const T inward_part = maximum(inward, zero), upward_part = maximum(upward, zero);
    const T corner_squared = inward_part * inward_part + upward_part * upward_part;
    const auto outside_core = !(corner_squared <= least);
    const T corner = sqrt(select(outside_core, corner_squared, one));
    const auto wall_nearer = inward > upward;
    const T gap = select(outside_core, corner, select(wall_nearer, inward, upward)) - T(rounding_);
    const T n_in = select(outside_core, inward_part / corner, select(wall_nearer, one, zero));
    const T n_up = select(outside_core, upward_part / corner, select(wall_nearer, zero, one));
    return {gap, {-n_in * outward.x, -n_in * outward.y, n_up}, gap};
  }

  /// Outside the rounded edge, below or above the face: the flat of the ring.
  template <class T>
  CROSSBEAM_INLINE auto in_flat_part(const Vec3<T>& p) const {
    const T beyond = maximum(magnitude(p.y) - T(parameters_.centre_distance), T(R(0)));
    return (p.x * p.x + beyond * beyond >= T(flat_squared_)) && (p.z > T(-parameters_.edge_radius));
  }
  template <class T>
  CROSSBEAM_INLINE SurfaceGap<T> flat_gap(const Vec3<T>& p) const {
    const T zero = T(R(0)), gap = (p.z + T(parameters_.edge_radius)) - T(rounding_);
    return {gap, {zero, zero, T(R(1))}, gap};
  }

  /// Parallel surface: same centre line of the rounding, edge radius + d, flat at z = d [T-6].
  [[nodiscard]] StadiumRing offset(R d) const { return StadiumRing(parameters_, offset_ + d); }

 private:
  StadiumRingParameters<R> parameters_;
  R reach_;     ///< distance of the rounding's centre line from the opening's middle line
  R rounding_;  ///< edge radius of the parallel surface
  R offset_;
  R flat_squared_;  ///< beyond this squared distance from the middle line the ring is flat
};

}  // namespace crossbeam
