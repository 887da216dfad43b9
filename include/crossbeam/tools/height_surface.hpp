#pragma once
/// @file
/// A height field as a rigid tool. Theory: docs/theory/tools.md.

#include "crossbeam/tools/surface.hpp"

#include <utility>

namespace crossbeam {

/// Turns a height function (DoubleDome, HeightTable, a user's own) into a Surface.
/// The normal is the exact normal of the height field under the point; the gap is the distance to
/// the tangent plane there, so it is exact on the surface and second order in the gap beside it
/// [T-2]. A fabric thickness therefore belongs into the height function (its parallel surface),
/// not into the gap.
template <class HeightFunction>
class HeightSurface {
 public:
  HeightSurface(HeightFunction height, Side side)
      : height_(std::move(height)), sign_(side == Side::above ? 1 : -1) {
    // An infinite bound is one: then no node is skipped.
    if (const auto slope = height_.max_slope(); !(slope >= 0))
      throw InputError("height.max_slope", detail::to_text(slope), "-", "a number >= 0");
  }

  template <class T>
    requires Height<HeightFunction, T>
  CROSSBEAM_INLINE SurfaceGap<T> gap(const Vec3<T>& p) const {
    using std::sqrt;
    using R = real_t<T>;
    const HeightSample<T> s = height_.height(p.x, p.y);
    const T sign = T(R(sign_));
    const T n_z = T(R(1)) / sqrt(T(R(1)) + s.h_x * s.h_x + s.h_y * s.h_y);
    const T lift = sign * (p.z - s.h);
    const Vec3<T> upward{-s.h_x * n_z, -s.h_y * n_z, n_z};
    // A graph no steeper than m stays outside the cone of slope m about the vertical [T-3].
    const R m = R(height_.max_slope());
    return {lift * n_z, sign * upward, lift * T(R(1) / sqrt(R(1) + m * m))};
  }

  template <class T>
    requires requires(const HeightFunction& h, const T& x) { h.in_flat_part(x, x); }
  CROSSBEAM_INLINE auto in_flat_part(const Vec3<T>& p) const {
    return height_.in_flat_part(p.x, p.y);
  }
  template <class T>
    requires requires(const HeightFunction& h, const T& x) { h.in_flat_part(x, x); }
  CROSSBEAM_INLINE SurfaceGap<T> flat_gap(const Vec3<T>& p) const {
    using std::sqrt;
    using R = real_t<T>;
    const T sign = T(R(sign_)), zero = T(R(0));
    const T lift = sign * (p.z - T(height_.flat_height()));
    const R m = R(height_.max_slope());
    return {lift, {zero, zero, sign}, lift * T(R(1) / sqrt(R(1) + m * m))};
  }

  [[nodiscard]] const HeightFunction& height_function() const { return height_; }
  [[nodiscard]] Side side() const { return sign_ > 0 ? Side::above : Side::below; }

 private:
  HeightFunction height_;
  int sign_;
};

}  // namespace crossbeam
