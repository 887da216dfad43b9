#include "formed_state.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace crossbeam::drape {
namespace {

/// Every `step`-th node and the averages of step x step elements.
FormedState coarsened(const FormedState& fine, int step) {
  FormedState out{fine.nx / step, fine.ny / step, {}, {}, {}};
  for (int i = 0; i <= out.nx; ++i)
    for (int j = 0; j <= out.ny; ++j) {
      const auto n = static_cast<std::size_t>(i * step * (fine.ny + 1) + j * step);
      out.flat.push_back(fine.flat[n]);
      out.points.push_back(fine.points[n]);
    }
  for (int i = 0; i < out.nx; ++i)
    for (int j = 0; j < out.ny; ++j) {
      double sum = 0;
      for (int a = 0; a < step; ++a)
        for (int b = 0; b < step; ++b)
          sum += fine.shear[static_cast<std::size_t>((i * step + a) * fine.ny + j * step + b)];
      out.shear.push_back(sum / (step * step));
    }
  return out;
}

/// The border in plan, once around.
std::vector<Vec3<double>> border(const FormedState& s) {
  std::vector<Vec3<double>> out;
  const auto add = [&](int i, int j) {
    const Vec3<double>& p = s.points[static_cast<std::size_t>(i * (s.ny + 1) + j)];
    out.push_back({p.x, p.y, 0});
  };
  for (int i = 0; i < s.nx; ++i) add(i, 0);
  for (int j = 0; j < s.ny; ++j) add(s.nx, j);
  for (int i = s.nx; i > 0; --i) add(i, s.ny);
  for (int j = s.ny; j > 0; --j) add(0, j);
  return out;
}

double distance(const Vec3<double>& p, const std::vector<Vec3<double>>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Vec3<double>&a = line[k], &b = line[(k + 1) % line.size()];
    const Vec3<double> ab = b - a, ap = p - a;
    const double length = dot(ab, ab);
    const double s = length > 0 ? std::clamp(dot(ap, ab) / length, 0.0, 1.0) : 0.0;
    const Vec3<double> d = ap - s * ab;
    nearest = std::min(nearest, dot(d, d));
  }
  return std::sqrt(nearest);
}

}  // namespace

Errors compare(const FormedState& state, const FormedState& reference) {
  const int nx = std::min(state.nx, reference.nx);
  const auto step = [nx](const FormedState& s) {
    const int ratio = s.nx / nx;
    if (ratio * nx != s.nx || s.ny % ratio != 0)
      throw InputError("compare: elements", std::to_string(s.nx), "",
                       "a multiple of " + std::to_string(nx));
    return ratio;
  };
  const FormedState a = coarsened(state, step(state)), b = coarsened(reference, step(reference));
  if (a.ny != b.ny)
    throw InputError("compare: elements along y", std::to_string(a.ny), "", std::to_string(b.ny));
  Errors out;
  double difference = 0, displacement = 0;
  for (std::size_t n = 0; n < a.points.size(); ++n) {
    const Vec3<double> d = a.points[n] - b.points[n], u = b.points[n] - b.flat[n];
    difference += dot(d, d);
    displacement += dot(u, u);
    out.largest = std::max(out.largest, std::sqrt(dot(d, d)));
  }
  out.position = std::sqrt(difference / displacement);
  std::vector<double> angles;
  double squares = 0;
  for (std::size_t e = 0; e < a.shear.size(); ++e) {
    angles.push_back(std::abs(a.shear[e] - b.shear[e]));
    squares += angles.back() * angles.back();
  }
  out.shear_rms = std::sqrt(squares / static_cast<double>(angles.size()));
  std::sort(angles.begin(), angles.end());
  out.shear_quantile =
      angles[static_cast<std::size_t>(0.99 * static_cast<double>(angles.size() - 1))];
  const auto line = border(b);
  for (const Vec3<double>& p : border(a)) out.outline = std::max(out.outline, distance(p, line));
  return out;
}

}  // namespace crossbeam::drape
