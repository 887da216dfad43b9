#pragma once
/// @file
/// A height field as a biquadratic B-spline on a uniform grid: the form in which a drape asks for
/// its tools, once per node and step. Theory: docs/theory/tools.md.

#include "crossbeam/tools/surface.hpp"

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace crossbeam {

/// Where and how finely a height function is tabulated.
template <class R = double>
struct HeightTableGrid {
  R x0 = R(0), x1 = R(0);   ///< range along x [mm]; x0 < x1
  R y0 = R(0), y1 = R(0);   ///< range along y [mm]; y0 < y1
  R spacing = R(1) / R(2);  ///< cell size aimed at; rounded down to fill the range evenly [mm]; > 0
  bool mirror_x = false;  ///< x = x0 is a symmetry plane: x < x0 is answered from the mirror image
  bool mirror_y = false;  ///< likewise y = y0
};

/// Interpolates the samples at the cell centres by a C1 spline whose gradient is the exact
/// derivative of its value [T-12]. The normal slope is zero on all four sides, so that the constant
/// continuation outside (or the mirror image) is C1 too: the range has to end on symmetry planes
/// or on the flat flange. Copying copies the table.
template <class R = double>
class HeightTable {
 public:
  /// @param source any callable z(x, y), or any class with height(x, y).h
  template <class Source>
  HeightTable(const Source& source, const HeightTableGrid<R>& grid)
      : x_(axis("x", grid.x0, grid.x1, grid.spacing, grid.mirror_x)),
        y_(axis("y", grid.y0, grid.y1, grid.spacing, grid.mirror_y)),
        stride_(checked_stride(x_, y_, grid.spacing)),
        // One number more than are used: the last one is loaded as part of four.
        coefficients_(stride_ * (static_cast<std::size_t>(y_.cells) + 2) + 1) {
    for (int j = 0; j < y_.cells; ++j)
      for (int i = 0; i < x_.cells; ++i)
        at(i + 1, j + 1) =
            require_finite("table.source(x, y)", sampled(source, x_.centre(i), y_.centre(j)), "mm");
    std::vector<R> work(static_cast<std::size_t>(maximum(x_.cells, y_.cells)));
    for (int j = 1; j <= y_.cells; ++j) solve(&at(0, j), 1, x_.cells, work);
    for (int i = 0; i < x_.cells + 2; ++i) solve(&at(i, 0), stride_, y_.cells, work);
    max_slope_ = require_finite("table.source(x, y): slope", slope_bound(), "-");
    find_flat_part();
  }

  /// Height and gradient. T is R, a Pack of R or a number with derivatives over R.
  template <class T>
    requires std::same_as<real_t<T>, R>
  CROSSBEAM_INLINE HeightSample<T> height(const T& x, const T& y) const {
    const SplineWeights<T> a = locate(x_, x), b = locate(y_, y);
    T h = T(R(0)), h_x = T(R(0)), h_y = T(R(0));
    for (int j = 0; j < 3; ++j) {
      T c0, c1, c2;
      gather(a.cell, b.cell, j, c0, c1, c2);
      const T row = a.weight[0] * c0 + a.weight[1] * c1 + a.weight[2] * c2;
      h = h + b.weight[j] * row;
      h_x = h_x + b.weight[j] * (a.rate[0] * c0 + a.rate[1] * c1 + a.rate[2] * c2);
      h_y = h_y + b.rate[j] * row;
    }
    return {h, h_x, h_y};
  }

  /// Where the table has nothing but its last height: towards its upper ends along x or y.
  template <class T>
  CROSSBEAM_INLINE auto in_flat_part(const T& x, const T& y) const {
    return (beyond(x_, x) >= T(flat_x_)) || (beyond(y_, y) >= T(flat_y_));
  }
  [[nodiscard]] R flat_height() const { return coefficients_[coefficients_.size() - 2]; }

  /// Upper bound of the gradient's length over the whole table.
  [[nodiscard]] R max_slope() const { return max_slope_; }
  [[nodiscard]] R spacing_x() const { return x_.spacing; }
  [[nodiscard]] R spacing_y() const { return y_.spacing; }
  [[nodiscard]] std::size_t bytes() const { return coefficients_.size() * sizeof(R); }

 private:
  struct Axis {
    R origin, spacing, per_spacing;
    int cells;
    bool mirror;
    [[nodiscard]] R centre(int i) const { return origin + (R(i) + R(1) / R(2)) * spacing; }
  };

  /// Cell of a coordinate and the three spline weights there, with their derivatives [1/length].
  template <class T>
  struct SplineWeights {
    int cell[lanes_v<T>];
    T weight[3], rate[3];
  };

  static Axis axis(const std::string& name, R low, R high, R spacing, bool mirror) {
    require_finite("table." + name + "0", low, "mm");
    require_finite("table." + name + "1", high, "mm");
    require_positive("table.spacing", spacing, "mm");
    if (!(low < high))
      throw InputError("table." + name + "1", detail::to_text(high), "mm",
                       "above " + name + "0 = " + detail::to_text(low));
    // More than this is a typing error in the spacing: a thousand cells resolve 0.2 mm on the tool.
    constexpr int most = 20000;
    const R wanted = (high - low) / spacing;
    if (!(wanted <= R(most)))
      throw InputError("table.spacing", detail::to_text(spacing), "mm",
                       "at least 1/" + std::to_string(most) + " of the range along " + name);
    // The slack keeps 90 / 0.1 at 900 cells although the quotient may round up.
    using std::ceil;
    const int cells = static_cast<int>(ceil(wanted * (R(1) - R(8) * epsilon_of<R>())));
    const R exact = (high - low) / R(cells);
    return {low, exact, require_finite("1 / table.spacing along " + name, R(1) / exact, "1/mm"),
            cells, mirror};
  }

  static std::size_t checked_stride(const Axis& x, const Axis& y, R spacing) {
    // Beyond, the table would fill the memory: the tool of the drape has a few 100 000 cells.
    constexpr double most = 1e8;
    if (!(static_cast<double>(x.cells) * y.cells <= most))
      throw InputError("table.spacing", detail::to_text(spacing), "mm",
                       "so large that the table has at most 1e8 cells");
    return static_cast<std::size_t>(x.cells) + 2;
  }

  template <class Source>
  static R sampled(const Source& source, R x, R y) {
    if constexpr (requires { source.height(x, y).h; })
      return static_cast<R>(source.height(x, y).h);
    else
      return static_cast<R>(source(x, y));
  }

  R& at(int i, int j) {
    return coefficients_[static_cast<std::size_t>(j) * stride_ + static_cast<std::size_t>(i)];
  }

  /// One line of coefficients in place: (c[k-1] + 6 c[k] + c[k+1]) / 8 = sample k, k = 1..n, with
  /// c[0] = c[1] and c[n+1] = c[n] [T-13]. Diagonally dominant: elimination without pivoting.
  static void solve(R* line, std::size_t step, int n, std::vector<R>& upper) {
    const auto c = [&](int k) -> R& { return line[static_cast<std::size_t>(k) * step]; };
    const auto u = [&](int k) -> R& { return upper[static_cast<std::size_t>(k - 1)]; };
    for (int k = 1; k <= n; ++k) {
      const R diagonal = R(6) + R(k == 1 ? 1 : 0) + R(k == n ? 1 : 0);
      const R pivot = k == 1 ? diagonal : diagonal - u(k - 1);
      u(k) = R(1) / pivot;
      c(k) = (R(8) * c(k) - (k == 1 ? R(0) : c(k - 1))) / pivot;
    }
    for (int k = n - 1; k >= 1; --k) c(k) = c(k) - u(k) * c(k + 1);
    c(0) = c(1);
    c(n + 1) = c(n);
  }

  /// The gradient is an average of neighbouring coefficients' difference quotients: their largest
  /// over the cell bounds it [T-14].
  [[nodiscard]] R slope_bound() {
    using std::sqrt;
    R bound = R(0);
    for (int j = 0; j < y_.cells; ++j)
      for (int i = 0; i < x_.cells; ++i) {
        R along_x = R(0), along_y = R(0);
        for (int m = 0; m < 3; ++m)
          for (int k = 0; k < 2; ++k) {
            along_x = larger(along_x, at(i + k + 1, j + m) - at(i + k, j + m));
            along_y = larger(along_y, at(i + m, j + k + 1) - at(i + m, j + k));
          }
        const R here = square(along_x * x_.per_spacing) + square(along_y * y_.per_spacing);
        if (!(here <= bound)) bound = here;  // heights that overflowed end as infinite or no slope
        if (!(bound <= (std::numeric_limits<R>::max)())) return bound;
      }
    return sqrt(bound);
  }

  template <class T>
  CROSSBEAM_INLINE static T beyond(const Axis& axis, const T& x) {
    const T t = x - T(axis.origin);
    return axis.mirror ? magnitude(t) : t;
  }

  /// Equal but for rounding counts as flat: the spline's answer to an edge dies out by 0.17 a cell.
  void find_flat_part() {
    R largest(0);
    for (const R& c : coefficients_) largest = maximum(largest, magnitude(c));
    const R tolerance = R(8) * epsilon_of<R>() * largest, last = flat_height();
    const auto differs = [&](int i, int j) { return !(magnitude(at(i, j) - last) <= tolerance); };
    int columns = 0, rows = 0;  // first coefficient from which on all are the last
    for (int j = 0; j < y_.cells + 2; ++j)
      for (int i = 0; i < x_.cells + 2; ++i)
        if (differs(i, j)) {
          columns = maximum(columns, i + 1);
          rows = maximum(rows, j + 1);
        }
    flat_x_ = R(columns) * x_.spacing;
    flat_y_ = R(rows) * y_.spacing;
  }

  /// The larger magnitude; a NaN wins.
  static R larger(R so_far, R step) {
    const R size = magnitude(step);
    return so_far >= size ? so_far : size;
  }

  template <class T>
  CROSSBEAM_INLINE static SplineWeights<T> locate(const Axis& axis, const T& x) {
    const T zero = T(R(0)), one = T(R(1)), half = T(R(1) / R(2));
    T t = (x - T(axis.origin)) * T(axis.per_spacing);
    T sign = one;
    if (axis.mirror) {
      sign = select(t < zero, -one, one);
      t = t * sign;
    }
    // The first and last coefficient repeat their neighbour, so the clamped end has zero slope.
    t = select(t < zero, zero, t);
    t = select(t > T(R(axis.cells)), T(R(axis.cells)), t);
    SplineWeights<T> p;
    constexpr R half_cell = R(1) / R(2);  // keeps the upper end in the last cell
    // A NaN coordinate looks up cell 0 and comes back as NaN through the weights.
    const auto inside = passive(select(t >= zero, t, zero));
    passive_t<T> base;
    if constexpr (lanes_v<T> == 1) {
      p.cell[0] = static_cast<int>(minimum(inside, passive_t<T>(R(axis.cells) - half_cell)));
      base = passive_t<T>(R(p.cell[0]));
    } else {
      base = truncate(minimum(inside, passive_t<T>(R(axis.cells) - half_cell)), p.cell);
    }
    const T v = t - T(base), u = one - v;
    const T scale = sign * T(axis.per_spacing);
    p.weight[0] = half * u * u;
    p.weight[1] = half + v * u;
    p.weight[2] = half * v * v;
    p.rate[0] = -scale * u;
    p.rate[1] = scale * (u - v);
    p.rate[2] = scale * v;
    return p;
  }

  /// Three neighbours along x of every lane's cell, in row j of its three.
  template <class T>
  CROSSBEAM_INLINE void gather(const int* cell_x, const int* cell_y, int j, T& c0, T& c1,
                               T& c2) const {
    const auto first = [&](int lane) {
      return coefficients_.data() + static_cast<std::size_t>(cell_y[lane] + j) * stride_ +
             static_cast<std::size_t>(cell_x[lane]);
    };
    if constexpr (lanes_v<T> == 1) {
      const R* c = first(0);
      c0 = T(c[0]);
      c1 = T(c[1]);
      c2 = T(c[2]);
    } else {
      passive_t<T> c[3];
      gather_three(first, c);
      c0 = T(c[0]);
      c1 = T(c[1]);
      c2 = T(c[2]);
    }
  }

  Axis x_, y_;
  std::size_t stride_;
  std::vector<R> coefficients_;
  R max_slope_ = R(0);
  R flat_x_ = R(0), flat_y_ = R(0);  // distance from the origin beyond which the table is flat
};

}  // namespace crossbeam
