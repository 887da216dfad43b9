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

/// Cubic convolution (Catmull-Rom) of values on a regular grid, continued beyond its edges along
/// straight lines: exact for quadratic fields, of third order.
class GridField {
 public:
  /// @param first  material coordinate of the first value, in elements: 0 for nodes, 1/2 for
  ///   centres
  /// @param values nu x nv numbers, v running faster, every `stride`-th from `offset` on
  GridField(int nu, int nv, double first, const std::vector<double>& values, int stride = 1,
            int offset = 0)
      : nu_(nu), nv_(nv), first_(first), values_(values), stride_(stride), offset_(offset) {}

  [[nodiscard]] double at(double u, double v) const {
    const double a = u - first_, b = v - first_;
    const int i = static_cast<int>(std::floor(a)), j = static_cast<int>(std::floor(b));
    const std::array<double, 4> wa = weights(a - i), wb = weights(b - j);
    double sum = 0;
    for (int k = 0; k < 4; ++k)
      for (int l = 0; l < 4; ++l) sum += wa[k] * wb[l] * value(i - 1 + k, j - 1 + l);
    return sum;
  }

 private:
  static std::array<double, 4> weights(double t) {
    return {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (1.5 * t - 2.5),
            t * (0.5 + t * (2 - 1.5 * t)), t * t * (0.5 * t - 0.5)};
  }
  [[nodiscard]] double value(int i, int j) const {
    const int i0 = std::clamp(i, 0, std::max(nu_ - 2, 0)),
              j0 = std::clamp(j, 0, std::max(nv_ - 2, 0));
    if (nu_ > 1 && (i < 0 || i >= nu_))
      return value(i0, j) + (i - i0) * (value(i0 + 1, j) - value(i0, j));
    if (nv_ > 1 && (j < 0 || j >= nv_))
      return value(i, j0) + (j - j0) * (value(i, j0 + 1) - value(i, j0));
    const int k = std::clamp(i, 0, nu_ - 1) * nv_ + std::clamp(j, 0, nv_ - 1);
    return values_[static_cast<std::size_t>(k) * stride_ + offset_];
  }

  int nu_, nv_;
  double first_;
  const std::vector<double>& values_;
  int stride_, offset_;
};

/// Moves the material coordinates (u, v) of a first guess to where the smooth map meets p.
void refine(const GridField& x, const GridField& y, const Point& p, double& u, double& v) {
  constexpr double step = 1e-5;
  for (int k = 0; k < 8; ++k) {
    const Point r{x.at(u, v) - p[0], y.at(u, v) - p[1]};
    const Point a{(x.at(u + step, v) - x.at(u - step, v)) / (2 * step),
                  (y.at(u + step, v) - y.at(u - step, v)) / (2 * step)};
    const Point b{(x.at(u, v + step) - x.at(u, v - step)) / (2 * step),
                  (y.at(u, v + step) - y.at(u, v - step)) / (2 * step)};
    const double det = turn(a, b);
    if (det == 0) return;
    // A fold of the formed plan could throw the iteration off: never more than half an element.
    const double du = std::clamp(-turn(r, b) / det, -0.5, 0.5);
    const double dv = std::clamp(-turn(a, r) / det, -0.5, 0.5);
    u += du;
    v += dv;
    if (std::abs(du) + std::abs(dv) < 1e-10) return;
  }
}

}  // namespace

QuarterGrid quarter_grid(const BlankInput& blank) {
  const auto count = [&](double length) {
    return std::max(1, static_cast<int>(std::lround(length / blank.element_size)));
  };
  return {count(blank.half_width), count(blank.half_length), blank.half_width, blank.half_length};
}

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
                                     const std::vector<double>& element_shear) {
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
  const GridField shear(grid.nx, grid.ny, 0.5, element_shear);
  const GridField x(grid.nx + 1, grid.ny + 1, 0, points, 3, 0);
  const GridField y(grid.nx + 1, grid.ny + 1, 0, points, 3, 1);
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
        if (!locate(
                {plan(points, n[0]), plan(points, n[1]), plan(points, n[2]), plan(points, n[3])}, p,
                xi, eta))
          continue;
        double u = i + xi, v = j + eta;
        refine(x, y, p, u, v);
        point.shear_deg = shear.at(u, v) * 180 / std::numbers::pi;
        break;
      }
    out.push_back(point);
  }
  return out;
}

}  // namespace crossbeam::drape
