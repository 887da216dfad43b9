#pragma once
/// @file
/// Punch and die of the double-dome forming benchmark: a flat-topped ridge along y, ended by two
/// spherical domes at (0, +-y_c), all feet running into a flat flange through large fillets.
/// The analytic surface is a fit (0.11 mm rms) to the tool height map of a public textile-forming
/// study (repository eismont21/knowledge-surrogate-opt). Theory: docs/theory/tools.md.

#include "crossbeam/tools/surface.hpp"

#include <numbers>

namespace crossbeam {

/// Dimensions of the punch, flange plane at z = 0.
template <class R = double>
struct DoubleDomeParameters {
  R depth = R(60);                 ///< H, tops above the flange [mm]; in (0, R_d + r_f)
  R dome_axis = R(100);            ///< y_c, domes about (0, +-y_c) [mm]
  R dome_radius = R(175) / R(3);   ///< R_d of the spheres [mm]; > 0
  R dome_fillet = R(100) / R(3);   ///< r_f of the domes' concave foot [mm]; > 0
  R ridge_flat = R(50) / R(3);     ///< a_0, half width of the flat top [mm]; >= 0
  R ridge_edge = R(25) / R(3);     ///< r_1 of the convex top edge [mm]; > 0
  R ridge_fillet = R(100) / R(3);  ///< r_2 of the concave foot [mm]; > 0
  R wall_angle = R(57475) / R(180000) * std::numbers::pi_v<R>;  ///< alpha, ridge wall against the
                                                                ///< flange [rad]; in (0, pi/2)
  R blend_start = R(75);    ///< y_b, start of the linear ramp from ridge to dome [mm]
  R blend_end = R(97);      ///< y_e, end of the linear ramp [mm]; <= y_c - c
  R blend_rounding = R(3);  ///< c, half length of the parabolas at the ramp's corners [mm]; > 0
};

/// Half section of a tool over the distance `s` from its middle: flat top, convex arc, straight
/// wall, concave arc, flange [T-7]. The parallel curve keeps the arc centres and changes the radii.
template <class R>
class DomeProfile {
 public:
  /// A point of the section, found from its level: s and (ds/d delta) sqrt(delta eps), where delta
  /// and eps are the depths below the top and above the flange. The product is finite at both ends,
  /// where ds/d delta is not.
  struct LevelPoint {
    R s, s_rate;
  };
  struct Value {
    R z, slope;
  };

  /// @param flat half width of the flat top
  /// @param edge radius of the convex arc
  /// @param fillet radius of the concave arc
  /// @param angle of the wall against the flange [rad]
  /// @param depth top above flange
  /// @param offset distance of the parallel curve
  DomeProfile(R flat, R edge, R fillet, R angle, R depth, R offset)
      : flat_(flat), edge_(edge + offset), fillet_(fillet - offset), depth_(depth), base_(offset) {
    using std::cos;
    using std::sin;
    sin_ = sin(angle);
    cos_ = cos(angle);
    // Length of the straight wall from the depth that the two arcs leave over; zero for the dome,
    // whose angle is chosen so [T-8].
    const R wall = maximum((depth - (edge + fillet) * (R(1) - cos_)) / sin_, R(0));
    foot_ = flat + (edge + fillet) * sin_ + wall * cos_;
    wall_start_ = flat_ + edge_ * sin_;
    wall_end_ = foot_ - fillet_ * sin_;
    wall_drop_ = edge_ * (R(1) - cos_);
    wall_rise_ = fillet_ * (R(1) - cos_);
  }

  /// Height and slope at the distance s >= 0 from the middle [T-7].
  [[nodiscard]] Value at(R s) const {
    using std::sqrt;
    if (s <= flat_) return {base_ + depth_, R(0)};
    if (s >= foot_) return {base_, R(0)};
    if (s < wall_start_) {
      // Drop of a circle as t^2 / (r + sqrt(r^2 - t^2)): no cancellation near the flat.
      const R t = s - flat_;
      const R root = sqrt((edge_ - t) * (edge_ + t));
      return {base_ + depth_ - t * t / (edge_ + root), -t / root};
    }
    if (s < wall_end_)
      return {base_ + depth_ - wall_drop_ - (s - wall_start_) * sin_ / cos_, -sin_ / cos_};
    const R t = foot_ - s;
    const R root = sqrt((fillet_ - t) * (fillet_ + t));
    return {base_ + t * t / (fillet_ + root), -t / root};
  }

  /// The inverse, at the level given by u = sqrt(delta), w = sqrt(eps), u^2 + w^2 = depth [T-10].
  [[nodiscard]] LevelPoint at_level(R u, R w) const {
    using std::sqrt;
    const R delta = u * u, eps = w * w;
    if (delta <= wall_drop_) {
      const R root = sqrt(R(2) * edge_ - delta);
      return {flat_ + u * root, (edge_ - delta) * w / root};
    }
    if (eps <= wall_rise_) {
      const R root = sqrt(R(2) * fillet_ - eps);
      return {foot_ - w * root, (fillet_ - eps) * u / root};
    }
    return {wall_start_ + (delta - wall_drop_) * cos_ / sin_, u * w * cos_ / sin_};
  }

  [[nodiscard]] R flat() const { return flat_; }              ///< end of the flat top
  [[nodiscard]] R wall_start() const { return wall_start_; }  ///< end of the convex arc
  [[nodiscard]] R wall_end() const { return wall_end_; }      ///< start of the concave arc
  [[nodiscard]] R foot() const { return foot_; }              ///< start of the flange
  [[nodiscard]] R max_slope() const { return sin_ / cos_; }

 private:
  R flat_, edge_, fillet_, depth_, base_;
  R sin_{}, cos_{}, foot_{}, wall_start_{}, wall_end_{};
  R wall_drop_{};  ///< depth of the convex arc below the top
  R wall_rise_{};  ///< height of the concave arc above the flange
};

/// The double-dome surface and its outward parallel family. It is one height field for all four
/// quadrants, C1 everywhere; R is a plain scalar. Punch: offset 0. Die: offset 5/3 mm; mid-surface
/// of a 1 mm fabric on the punch and under the die: offsets 1/2 and 5/3 - 1/2. The parallel surface
/// is exact on ridge and domes; in the blend it is the blend of the parallel sections [T-11].
template <class R = double>
class DoubleDome {
 public:
  using Parameters = DoubleDomeParameters<R>;

  /// @param offset distance of the parallel surface outwards [mm]; above -min(R_d, r_1), below
  ///        min(r_f, r_2). The flange of the result lies at z = offset.
  explicit DoubleDome(const Parameters& parameters = {}, R offset = R(0))
      : parameters_(validated(parameters, offset)),
        offset_(offset),
        ridge_(parameters.ridge_flat, parameters.ridge_edge, parameters.ridge_fillet,
               parameters.wall_angle, parameters.depth, offset),
        dome_(R(0), parameters.dome_radius, parameters.dome_fillet, dome_angle(parameters),
              parameters.depth, offset),
        max_slope_(slope_bound()) {
    // What single fields cannot show: arcs too flat to have an angle, lengths too large to square.
    for (const auto* profile : {&ridge_, &dome_})
      detail::require_square("dome: distance of the foot", profile->foot(), "mm");
    require_finite("dome: largest slope", max_slope_, "-");
  }

  /// Height and gradient; NaN in, NaN out.
  [[nodiscard]] HeightSample<R> height(R x, R y) const {
    using std::isnan;
    if (isnan(x) || isnan(y)) return {x + y, x + y, x + y};
    const R sign_x = x < R(0) ? R(-1) : R(1), sign_y = y < R(0) ? R(-1) : R(1);
    const HeightSample<R> s = quarter(sign_x * x, sign_y * y);
    return {s.h, sign_x * s.h_x, sign_y * s.h_y};
  }

  /// Parallel surface further out by d.
  [[nodiscard]] DoubleDome offset(R d) const { return DoubleDome(parameters_, offset_ + d); }

  /// Upper bound of the gradient's length.
  [[nodiscard]] R max_slope() const { return max_slope_; }
  [[nodiscard]] const Parameters& parameters() const { return parameters_; }
  [[nodiscard]] R offset() const { return offset_; }
  [[nodiscard]] const DomeProfile<R>& ridge() const { return ridge_; }
  /// Meridian of the domes; its s is the distance from the dome's axis.
  [[nodiscard]] const DomeProfile<R>& dome() const { return dome_; }

  struct Ramp {
    R g, g_y;
  };
  /// Share of the dome section, 0 on the ridge and 1 from y_c on, with its derivative [T-9].
  [[nodiscard]] Ramp ramp(R y) const {
    const R c = parameters_.blend_rounding;
    const R y_b = parameters_.blend_start, y_e = parameters_.blend_end;
    const R k = R(1) / (y_e - y_b);
    if (y <= y_b - c) return {R(0), R(0)};
    if (y < y_b + c) {
      const R t = y - (y_b - c);
      return {k * t * t / (R(4) * c), k * t / (R(2) * c)};
    }
    if (y <= y_e - c) return {k * (y - y_b), k};
    if (y < y_e + c) {
      const R t = (y_e + c) - y;
      return {R(1) - k * t * t / (R(4) * c), k * t / (R(2) * c)};
    }
    return {R(1), R(0)};
  }

 private:
  static const Parameters& validated(const Parameters& p, R offset) {
    require_positive("dome.depth", p.depth, "mm");
    require_positive("dome.dome_radius", p.dome_radius, "mm");
    require_positive("dome.dome_fillet", p.dome_fillet, "mm");
    require_non_negative("dome.ridge_flat", p.ridge_flat, "mm");
    require_positive("dome.ridge_edge", p.ridge_edge, "mm");
    require_positive("dome.ridge_fillet", p.ridge_fillet, "mm");
    require_between("dome.wall_angle", p.wall_angle, "rad", 0, std::numbers::pi / 2);
    require_finite("dome.dome_axis", p.dome_axis, "mm");
    require_finite("dome.blend_start", p.blend_start, "mm");
    require_finite("dome.blend_end", p.blend_end, "mm");
    require_positive("dome.blend_rounding", p.blend_rounding, "mm");
    require_finite("dome.offset", offset, "mm");
    using std::cos;
    const auto admit = [](bool good, const std::string& field, R value, const std::string& range) {
      if (!good) throw InputError(field, detail::to_text(value), "mm", range);
    };
    admit(p.depth < p.dome_radius + p.dome_fillet, "dome.depth", p.depth,
          "below dome_radius + dome_fillet = " + detail::to_text(p.dome_radius + p.dome_fillet));
    const R arcs = (p.ridge_edge + p.ridge_fillet) * (R(1) - cos(p.wall_angle));
    admit(p.depth >= arcs, "dome.depth", p.depth,
          "at least the height of the ridge's two arcs = " + detail::to_text(arcs));
    admit(p.blend_start >= p.blend_rounding, "dome.blend_start", p.blend_start,
          "at least blend_rounding = " + detail::to_text(p.blend_rounding));
    admit(p.blend_end >= p.blend_start + R(2) * p.blend_rounding, "dome.blend_end", p.blend_end,
          "at least blend_start + 2 blend_rounding = " +
              detail::to_text(p.blend_start + R(2) * p.blend_rounding));
    admit(
        p.blend_end + p.blend_rounding <= p.dome_axis, "dome.dome_axis", p.dome_axis,
        "at least blend_end + blend_rounding = " + detail::to_text(p.blend_end + p.blend_rounding));
    const R low = -minimum(p.dome_radius, p.ridge_edge);
    const R high = minimum(p.dome_fillet, p.ridge_fillet);
    admit(offset > low && offset < high, "dome.offset", offset,
          "strictly between " + detail::to_text(low) + " and " + detail::to_text(high));
    return p;
  }

  /// Wall angle at which sphere and foot fillet touch without a straight piece [T-8].
  static R dome_angle(const Parameters& p) {
    using std::acos;
    return acos(R(1) - p.depth / (p.dome_radius + p.dome_fillet));
  }

  [[nodiscard]] HeightSample<R> quarter(R x, R y) const {
    if (y >= parameters_.dome_axis) {
      using std::sqrt;
      const R y_local = y - parameters_.dome_axis;
      const R rho = sqrt(x * x + y_local * y_local);
      const typename DomeProfile<R>::Value v = dome_.at(rho);
      const R per_rho = rho > R(0) ? v.slope / rho : R(0);
      return {v.z, per_rho * x, per_rho * y_local};
    }
    const Ramp ramp_here = ramp(y);
    if (ramp_here.g <= R(0)) {
      const typename DomeProfile<R>::Value v = ridge_.at(x);
      return {v.z, v.slope, R(0)};
    }
    return blend(x, ramp_here);
  }

  /// Both sections at the level phi in [0, pi/2], which splits the depth into H sin^2 below the top
  /// and H cos^2 above the flange: a variable in which the sections are smooth at both ends [T-10].
  struct BlendPoint {
    R u, w, x, x_rate, dome_less_ridge;
  };
  [[nodiscard]] BlendPoint blend_at(R phi, R g) const {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const R root = sqrt(parameters_.depth);
    const R u = root * sin(phi), w = root * cos(phi);
    const auto a = ridge_.at_level(u, w), b = dome_.at_level(u, w);
    return {u, w, (R(1) - g) * a.s + g * b.s, (R(1) - g) * a.s_rate + g * b.s_rate, b.s - a.s};
  }

  /// Half widths of ridge and dome interpolated at equal height: solve for the level at which the
  /// section is x wide, then the gradient by implicit differentiation [T-10].
  [[nodiscard]] HeightSample<R> blend(R x, const Ramp& r) const {
    const R top = offset_ + parameters_.depth;
    if (x <= (R(1) - r.g) * ridge_.flat()) return {top, R(0), R(0)};
    if (x >= (R(1) - r.g) * ridge_.foot() + r.g * dome_.foot()) return {offset_, R(0), R(0)};
    // Newton, kept inside a bracket that shrinks every time: x grows with phi throughout.
    R low = R(0), high = std::numbers::pi_v<R> / R(2);
    R phi = (low + high) / R(2);
    BlendPoint point = blend_at(phi, r.g);
    constexpr int enough = 4 * std::numeric_limits<R>::digits;  // pure bisection would be done
    for (int i = 0; i < enough; ++i) {
      const R excess = point.x - x;
      if (excess == R(0)) break;
      (excess > R(0) ? high : low) = phi;
      R next = phi - excess / (R(2) * point.x_rate);  // dx/dphi = 2 x_rate
      if (!(next > low && next < high)) next = (low + high) / R(2);
      if (magnitude(next - phi) <= epsilon_of<R>() * phi || next == low || next == high) break;
      phi = next;
      point = blend_at(phi, r.g);
    }
    const R steep = point.u * point.w / point.x_rate;  // -dh/dx
    return {offset_ + point.w * point.w, -steep, r.g_y * point.dome_less_ridge * steep};
  }

  /// Between two levels both half widths and both slopes are enclosed by their end values (the
  /// slope also by the wall's, where the wall lies in between), which encloses the gradient [T-10].
  [[nodiscard]] R slope_bound() const {
    using std::sqrt;
    constexpr int levels = 512;
    const R ramp_slope = R(1) / (parameters_.blend_end - parameters_.blend_start);
    const auto steepness = [](const typename DomeProfile<R>::LevelPoint& p, R u, R w) {
      return u * w / p.s_rate;
    };
    R bound = maximum(ridge_.max_slope(), dome_.max_slope());
    const BlendPoint start = blend_at(R(0), R(0));
    auto a0 = ridge_.at_level(start.u, start.w), b0 = dome_.at_level(start.u, start.w);
    R steep0 = R(0);
    for (int i = 1; i <= levels; ++i) {
      const R phi = std::numbers::pi_v<R> / R(2) * R(i) / R(levels);
      const BlendPoint p = blend_at(phi, R(0));
      const auto a = ridge_.at_level(p.u, p.w), b = dome_.at_level(p.u, p.w);
      R steep = maximum(steepness(a, p.u, p.w), steepness(b, p.u, p.w));
      R here = maximum(steep, steep0);
      if (a0.s <= ridge_.wall_end() && a.s >= ridge_.wall_start())
        here = maximum(here, ridge_.max_slope());
      if (b0.s <= dome_.wall_end() && b.s >= dome_.wall_start())
        here = maximum(here, dome_.max_slope());
      const R spread = maximum(magnitude(b.s - a0.s), magnitude(b0.s - a.s));
      bound = maximum(bound, here * sqrt(R(1) + square(ramp_slope * spread)));
      a0 = a, b0 = b, steep0 = steep;
    }
    return bound;
  }

  Parameters parameters_;
  R offset_;
  DomeProfile<R> ridge_;
  DomeProfile<R> dome_;
  R max_slope_;
};

}  // namespace crossbeam
