#pragma once
// Distance from a point to a parametrised surface by plain search: a grid over the parameters, then
// finer grids around the best point. It knows nothing of the tools' formulas.

#include "crossbeam/base/scalar.hpp"

#include <cmath>
#include <initializer_list>

namespace closest_point {

using Point = crossbeam::Vec3<double>;

struct Range {
  double low, high;
};

inline double distance(const Point& a, const Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

/// Refines until both grid steps are below `resolution`. Distance is stationary at the closest
/// point: a step e along the surface leaves an error of e^2 / (8 distance) only.
template <class SurfacePoint>
double search(const Point& p, Range a, Range b, const SurfacePoint& surface_point,
              int per_side = 60, double resolution = 1e-8) {
  double best = HUGE_VAL, best_a = 0, best_b = 0;
  const Range all_a = a, all_b = b;
  for (bool coarse = true; coarse;) {
    const double step_a = (a.high - a.low) / per_side, step_b = (b.high - b.low) / per_side;
    for (int i = 0; i <= per_side; ++i)
      for (int j = 0; j <= per_side; ++j) {
        const double s = a.low + i * step_a, t = b.low + j * step_b;
        const double d = distance(p, surface_point(s, t));
        if (d < best) best = d, best_a = s, best_b = t;
      }
    coarse = step_a > resolution || step_b > resolution;
    // Three old steps to either side: the valley may run askew to the grid.
    a = {std::fmax(all_a.low, best_a - 3 * step_a), std::fmin(all_a.high, best_a + 3 * step_a)};
    b = {std::fmax(all_b.low, best_b - 3 * step_b), std::fmin(all_b.high, best_b + 3 * step_b)};
  }
  return best;
}

}  // namespace closest_point
