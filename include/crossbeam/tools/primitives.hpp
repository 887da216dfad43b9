#pragma once
/// @file
/// Plane, sphere and infinite cylinder as rigid tools: exact signed distances, so the clearance is
/// the gap itself and the parallel surface at distance d is the same shape with its gap less d.
/// The fabric lies outside the sphere and the cylinder. Theory: docs/theory/tools.md.

#include "crossbeam/tools/surface.hpp"

namespace crossbeam {

namespace detail {

template <class T, class R>
CROSSBEAM_INLINE Vec3<T> spread(const Vec3<R>& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

/// Distance of a round tool: |radial| - radius, along the radial direction [T-5]. On the centre (or
/// so near that the squared distance loses its digits), where every direction is as good, the
/// normal is the given one.
template <class T, class R>
CROSSBEAM_INLINE SurfaceGap<T> round_gap(const Vec3<T>& radial, const R& radius,
                                         const Vec3<R>& at_centre) {
  using std::sqrt;
  const T squared = dot(radial, radial);
  const auto off_centre = !(squared <= T(least_square<R>()));  // a NaN stays one
  const T length = sqrt(select(off_centre, squared, T(R(1))));
  const T inverse = T(R(1)) / length;
  const Vec3<T> normal{select(off_centre, radial.x * inverse, T(at_centre.x)),
                       select(off_centre, radial.y * inverse, T(at_centre.y)),
                       select(off_centre, radial.z * inverse, T(at_centre.z))};
  const T gap = select(off_centre, length, T(R(0))) - T(radius);
  return {gap, normal, gap};
}

}  // namespace detail

/// Half space below a plane [T-4].
template <class R = double>
class Plane {
 public:
  /// @param point on the plane [length]
  /// @param normal towards the fabric, of any length > 0 [-]
  /// @param offset distance of the parallel plane, towards the fabric [length]
  Plane(const Vec3<R>& point, const Vec3<R>& normal, R offset = R(0))
      : normal_(detail::require_direction("plane.normal", normal)),
        point_(detail::require_place("plane.point", point, "length") +
               detail::require_square("plane.offset", offset, "length") * normal_) {}

  template <class T>
  CROSSBEAM_INLINE SurfaceGap<T> gap(const Vec3<T>& p) const {
    const Vec3<T> n = detail::spread<T>(normal_);
    const T gap = dot(p - detail::spread<T>(point_), n);
    return {gap, n, gap};
  }

  [[nodiscard]] Plane offset(R d) const { return {point_, normal_, d}; }

 private:
  Vec3<R> normal_;
  Vec3<R> point_;
};

/// Ball; the fabric is outside [T-5].
template <class R = double>
class Sphere {
 public:
  /// @param centre [length]
  /// @param radius > 0 [length]
  /// @param offset distance of the parallel sphere, outwards, > -radius [length]
  Sphere(const Vec3<R>& centre, R radius, R offset = R(0))
      : centre_(detail::require_place("sphere.centre", centre, "length")),
        radius_(require_positive(
            "sphere.radius + offset",
            detail::require_square("sphere.radius",
                                   require_positive("sphere.radius", radius, "length"), "length") +
                detail::require_square("sphere.offset", offset, "length"),
            "length")) {}

  template <class T>
  CROSSBEAM_INLINE SurfaceGap<T> gap(const Vec3<T>& p) const {
    return detail::round_gap(p - detail::spread<T>(centre_), radius_, {R(0), R(0), R(1)});
  }

  [[nodiscard]] R width() const { return R(2) * radius_; }
  [[nodiscard]] Sphere offset(R d) const { return {centre_, radius_, d}; }

 private:
  Vec3<R> centre_;
  R radius_;
};

/// Infinite round bar; the fabric is outside [T-5].
template <class R = double>
class Cylinder {
 public:
  /// @param point on the axis [length]
  /// @param axis direction of the axis, of any length > 0 [-]
  /// @param radius > 0 [length]
  /// @param offset distance of the parallel cylinder, outwards, > -radius [length]
  Cylinder(const Vec3<R>& point, const Vec3<R>& axis, R radius, R offset = R(0))
      : point_(detail::require_place("cylinder.point", point, "length")),
        axis_(detail::require_direction("cylinder.axis", axis)),
        radius_(require_positive(
            "cylinder.radius + offset",
            detail::require_square("cylinder.radius",
                                   require_positive("cylinder.radius", radius, "length"),
                                   "length") +
                detail::require_square("cylinder.offset", offset, "length"),
            "length")),
        across_(across(axis_)) {}

  template <class T>
  CROSSBEAM_INLINE SurfaceGap<T> gap(const Vec3<T>& p) const {
    const Vec3<T> e = detail::spread<T>(axis_);
    const Vec3<T> arm = p - detail::spread<T>(point_);
    return detail::round_gap(arm - dot(arm, e) * e, radius_, across_);
  }

  [[nodiscard]] R width() const { return R(2) * radius_; }
  [[nodiscard]] Cylinder offset(R d) const { return {point_, axis_, radius_, d}; }

 private:
  /// A direction square to the axis: the coordinate axis furthest from it, projected.
  static Vec3<R> across(const Vec3<R>& e) {
    const R x = magnitude(e.x), y = magnitude(e.y), z = magnitude(e.z);
    const Vec3<R> axis = z <= x && z <= y ? Vec3<R>{R(0), R(0), R(1)}
                         : y <= x         ? Vec3<R>{R(0), R(1), R(0)}
                                          : Vec3<R>{R(1), R(0), R(0)};
    return detail::require_direction("cylinder.axis", axis - dot(axis, e) * e);
  }

  Vec3<R> point_;
  Vec3<R> axis_;
  R radius_;
  Vec3<R> across_;
};

}  // namespace crossbeam
