#pragma once
/// @file
/// A formed sheet as plain numbers, and how far two of them are apart: the error measures of the
/// work-precision diagrams.

#include "crossbeam/model/model.hpp"

#include <vector>

namespace crossbeam::drape {

/// A structured sheet: node (i, j) is i * (ny + 1) + j, element (i, j) is i * ny + j.
struct FormedState {
  int nx = 0, ny = 0;
  std::vector<Vec3<double>> flat, points;  ///< material and formed positions [mm]
  std::vector<double> shear;               ///< of the elements [deg]
};

template <class R>
FormedState formed_state(const Model<R>& model, const Mesh<4>& mesh, int nx, int ny) {
  FormedState out{nx, ny, {}, {}, {}};
  for (int n = 0; n < mesh.node_count; ++n) {
    out.flat.push_back(mesh.nodes.get(n));
    out.points.push_back(model.nodes().x.get(n));
  }
  std::vector<ElementSample> samples;
  for (const auto& block : model.blocks()) block->sample(model.nodes(), samples);
  for (const ElementSample& s : samples)
    out.shear.push_back(s.shear_angle * 180 / std::numbers::pi);
  return out;
}

struct Errors {
  double position = 0;        ///< L2 norm of the difference over that of the displacement [-]
  double largest = 0;         ///< of any node [mm]
  double shear_rms = 0;       ///< area-weighted [deg]
  double shear_quantile = 0;  ///< 99 % of the area is below [deg]
  double outline = 0;         ///< largest distance of the outlines in plan [mm]
};

/// At the nodes and over the elements of the coarser of the two; one has to be a refinement of the
/// other.
/// @throws InputError where it is not
Errors compare(const FormedState& state, const FormedState& reference);

}  // namespace crossbeam::drape
