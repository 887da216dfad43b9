#pragma once
/// @file What is measured on the formed quarter: shear angles along the benchmark's line, outline,
///   draw-in.

#include "case.hpp"
#include "result.hpp"

#include <array>
#include <vector>

namespace crossbeam::drape {

/// The structured quarter blank: node (i, j) has the number i * (ny + 1) + j.
struct QuarterGrid {
  int nx = 0, ny = 0;
  double half_width = 0, half_length = 0;  ///< [mm]
  [[nodiscard]] int node(int i, int j) const { return i * (ny + 1) + j; }
  [[nodiscard]] int node_count() const { return (nx + 1) * (ny + 1); }
  [[nodiscard]] int element_count() const { return nx * ny; }
};

/// The grid of a case's blank.
[[nodiscard]] QuarterGrid quarter_grid(const BlankInput& blank);

/// Average of the adjacent elements on every node.
std::vector<double> node_average(const QuarterGrid& grid, const std::vector<double>& on_elements);

/// Formed free edges in plan, from the symmetry plane x = 0 to the plane y = 0.
std::vector<std::array<double, 2>> outline(const QuarterGrid& grid,
                                           const std::vector<double>& points);

/// Points 1..10 of the paper: the straight line (0, half_length)-(half_width, 0) in the formed
/// plan, from border to border in nine equal parts, clipped to the quarter. Material point and
/// shear angle there come from nodes and element centres by cubic convolution: third order in the
/// mesh size, where averaging onto nodes first would shave 0.4 deg off the peak of a 5 mm mesh
/// (docs/theory/double_dome.md).
/// @param element_shear angle at the element centres [rad]
std::vector<ShearPoint> shear_points(const QuarterGrid& grid, const std::vector<double>& points,
                                     const std::vector<double>& element_shear);

}  // namespace crossbeam::drape
