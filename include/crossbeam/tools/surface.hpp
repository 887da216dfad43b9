#pragma once
/// @file
/// What the contact asks of a rigid tool: at a point, how far is the surface and which way does it
/// push. A tool is any class with `gap(Vec3<T>)`; there is no base class. All points are given in
/// the tool's own frame: whoever moves the tool subtracts its translation first.
/// Theory: docs/theory/tools.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <concepts>
#include <limits>
#include <string>

namespace crossbeam {

/// Answer of a rigid surface at one point [T-1].
template <class T>
struct SurfaceGap {
  T gap;           ///< signed distance, > 0 on the fabric's side [length]
  Vec3<T> normal;  ///< unit normal pointing to the fabric's side [-]
  T clearance;     ///< never above the Euclidean distance to the surface [length]; what a culling
                   ///< may rely on. Negative or zero: nothing is promised.
};

/// A rigid tool that can be asked with the scalar T.
template <class S, class T>
concept Surface = requires(const S& surface, const Vec3<T>& point) {
  { surface.gap(point) } -> std::same_as<SurfaceGap<T>>;
};

/// A tool of which a part is a plane z = const, where nodes can be asked for by their z alone:
/// `in_flat_part` says in which lanes, and `flat_gap` answers there what `gap` does, to rounding.
template <class S, class T>
concept HasFlatPart = requires(const S& surface, const Vec3<T>& point) {
  surface.in_flat_part(point);
  { surface.flat_gap(point) } -> std::same_as<SurfaceGap<T>>;
};

/// A tool that knows its width [length]: of all slabs between two parallel planes that contain it,
/// the thinnest; infinite where there is none.
template <class S>
concept HasWidth = requires(const S& surface) {
  { surface.width() } -> std::convertible_to<double>;
};

/// The width of a tool, and infinite where the tool does not say.
template <class S>
[[nodiscard]] double smallest_width(const S& surface) {
  if constexpr (HasWidth<S>)
    return static_cast<double>(surface.width());
  else
    return std::numeric_limits<double>::infinity();
}

/// A height z = h(x, y) with its gradient.
template <class T>
struct HeightSample {
  T h;         ///< [length]
  T h_x, h_y;  ///< dh/dx, dh/dy [-]
};

/// A height function that can be asked with the scalar T.
template <class H, class T>
concept Height = requires(const H& function, const T& x) {
  { function.height(x, x) } -> std::same_as<HeightSample<T>>;
  { function.max_slope() } -> std::convertible_to<real_t<T>>;
};

/// Where the fabric lies as seen from a height field.
enum class Side {
  above,  ///< z > h: punch, blank holder
  below   ///< z < h: die
};

namespace detail {

/// Squared lengths below it do not have all their digits.
template <class R>
constexpr R least_square() {
  return (std::numeric_limits<R>::min)() / std::numeric_limits<R>::epsilon();
}

/// A length whose square is still a number.
template <class R>
R require_square(const std::string& field, R value, const std::string& unit) {
  const R most = (std::numeric_limits<R>::max)() * std::numeric_limits<R>::epsilon();
  if (!(value * value <= most))
    throw InputError(field, to_text(value), unit, "a number whose square is one too");
  return value;
}

template <class R>
Vec3<R> require_finite_point(const std::string& field, const Vec3<R>& p, const std::string& unit) {
  require_finite(field + ".x", p.x, unit);
  require_finite(field + ".y", p.y, unit);
  require_finite(field + ".z", p.z, unit);
  return p;
}

/// A finite point whose coordinates can be squared.
template <class R>
Vec3<R> require_place(const std::string& field, const Vec3<R>& p, const std::string& unit) {
  require_finite_point(field, p, unit);
  require_square(field + ".x", p.x, unit);
  require_square(field + ".y", p.y, unit);
  require_square(field + ".z", p.z, unit);
  return p;
}

/// Returns v / |v|. The largest component is divided out first: no length over- or underflows.
template <class R>
Vec3<R> require_direction(const std::string& field, const Vec3<R>& v) {
  using std::sqrt;
  require_finite_point(field, v, "-");
  const R largest = maximum(magnitude(v.x), maximum(magnitude(v.y), magnitude(v.z)));
  if (!(largest > R(0))) throw InputError(field, "(0, 0, 0)", "-", "a vector of length > 0");
  const Vec3<R> scaled{v.x / largest, v.y / largest, v.z / largest};
  return (R(1) / sqrt(dot(scaled, scaled))) * scaled;
}

}  // namespace detail
}  // namespace crossbeam
