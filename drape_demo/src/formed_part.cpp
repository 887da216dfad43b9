#include "formed_part.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace crossbeam::drape {

namespace {

using Point = std::array<double, 2>;

Point plan(const std::vector<double>& points, int node) {
  return {points[3 * node], points[3 * node + 1]};
}

double turn(const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1]}; }

/// Inverse of the bilinear map of a quadrilateral at p; true when p lies inside (with a margin for
/// rounding on shared edges).
bool locate(const std::array<Point, 4>& q, const Point& p, double& xi, double& eta) {
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const Point& c : q)
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], c[i]);
      high[i] = std::max(high[i], c[i]);
    }
  for (int i = 0; i < 2; ++i)
    if (p[i] < low[i] - 1e-9 || p[i] > high[i] + 1e-9) return false;
  xi = eta = 0.5;
  for (int k = 0; k < 30; ++k) {
    const double N[4] = {(1 - xi) * (1 - eta), xi * (1 - eta), xi * eta, (1 - xi) * eta};
    const double dx[4] = {-(1 - eta), 1 - eta, eta, -eta}, de[4] = {-(1 - xi), -xi, xi, 1 - xi};
    Point r{-p[0], -p[1]}, a{}, b{};
    for (int c = 0; c < 4; ++c)
      for (int i = 0; i < 2; ++i) {
        r[i] += N[c] * q[c][i];
        a[i] += dx[c] * q[c][i];
        b[i] += de[c] * q[c][i];
      }
    const double det = turn(a, b);
    if (det == 0) return false;
    const double step_xi = -turn(r, b) / det, step_eta = -turn(a, r) / det;
    xi += step_xi;
    eta += step_eta;
    if (std::abs(step_xi) + std::abs(step_eta) < 1e-12) break;
  }
  constexpr double margin = 1e-6;
  return xi > -margin && xi < 1 + margin && eta > -margin && eta < 1 + margin;
}

}  // namespace

std::vector<double> node_average(const QuarterGrid& grid, const std::vector<double>& on_elements) {
  std::vector<double> sum(grid.node_count(), 0.0), count(grid.node_count(), 0.0);
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j)
      for (int di = 0; di < 2; ++di)
        for (int dj = 0; dj < 2; ++dj) {
          sum[grid.node(i + di, j + dj)] += on_elements[i * grid.ny + j];
          count[grid.node(i + di, j + dj)] += 1;
        }
  for (int n = 0; n < grid.node_count(); ++n) sum[n] /= count[n];
  return sum;
}

std::vector<Point> outline(const QuarterGrid& grid, const std::vector<double>& points) {
  std::vector<Point> out;
  for (int i = 0; i <= grid.nx; ++i) out.push_back(plan(points, grid.node(i, grid.ny)));
  for (int j = grid.ny - 1; j >= 0; --j) out.push_back(plan(points, grid.node(grid.nx, j)));
  return out;
}

std::vector<ShearPoint> shear_points(const QuarterGrid& grid, const std::vector<double>& points,
                                     const std::vector<double>& node_shear) {
  const Point start{0, grid.half_length}, end{grid.half_width, 0};
  const Point along = minus(end, start);
  // Where the line crosses the formed edge; without a crossing the line's own ends count.
  double first = 0, last = 1;
  const std::vector<Point> edge = outline(grid, points);
  std::vector<double> crossings;
  for (std::size_t k = 0; k + 1 < edge.size(); ++k) {
    const Point side = minus(edge[k + 1], edge[k]), offset = minus(edge[k], start);
    const double det = turn(along, side);
    if (det == 0) continue;
    const double s = turn(offset, side) / det, t = turn(offset, along) / det;
    if (t >= 0 && t <= 1 && s >= 0 && s <= 1) crossings.push_back(s);
  }
  const bool starts_outside = edge.front()[1] < start[1], ends_outside = edge.back()[0] < end[0];
  if (!crossings.empty()) {
    const auto [low, high] = std::minmax_element(crossings.begin(), crossings.end());
    if (starts_outside) first = *low;
    if (ends_outside) last = *high;
  }
  std::vector<ShearPoint> out;
  for (int k = 0; k < 10; ++k) {
    const double s = first + (last - first) * k / 9;
    // The border points sit on the edge itself: a hair inside they surely lie in an element.
    const double inside = std::clamp(s, first + 1e-6, last - 1e-6);
    const Point p{start[0] + inside * along[0], start[1] + inside * along[1]};
    ShearPoint point{start[0] + s * along[0], start[1] + s * along[1], std::nan("")};
    for (int i = 0; i < grid.nx && std::isnan(point.shear_deg); ++i)
      for (int j = 0; j < grid.ny; ++j) {
        const int n[4] = {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1),
                          grid.node(i, j + 1)};
        double xi = 0, eta = 0;
        if (!locate({plan(points, n[0]), plan(points, n[1]), plan(points, n[2]), plan(points, n[3])},
                    p, xi, eta))
          continue;
        const double shear =
            (1 - xi) * (1 - eta) * node_shear[n[0]] + xi * (1 - eta) * node_shear[n[1]] +
            xi * eta * node_shear[n[2]] + (1 - xi) * eta * node_shear[n[3]];
        point.shear_deg = shear * 180 / std::numbers::pi;
        break;
      }
    out.push_back(point);
  }
  return out;
}

}  // namespace crossbeam::drape
