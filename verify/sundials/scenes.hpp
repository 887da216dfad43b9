#pragma once
/// @file
/// The reference solutions' small case, run by any integrator.

#include "dynamics/scenes.hpp"
#include "sphere_sheet.hpp"

#include "crossbeam/adapters/sundials.hpp"

#include <memory>

namespace reference_scenes {

using namespace scenes;
using drape::SphereSheet;
using T = NativePack<double>;

inline Points positions(const Model<double>& model) {
  Points x;
  for (int n = 0; n < model.nodes().node_count; ++n) x.push_back(eigen(model.nodes().x.get(n)));
  return x;
}

/// Positions at ten even times.
using Frames = std::vector<Points>;

template <class Integrator>
Frames frames(const SphereSheet& sheet, const reference::Tolerances& tolerances) {
  Model<double> model = sheet.model<double>();
  Integrator integrator(model, tolerances);
  Frames out;
  for (int k = 1; k <= 10; ++k) {
    integrator.advance(sheet.duration * k / 10);
    out.push_back(positions(model));
  }
  return out;
}

/// @param steps of the explicit scheme between two frames
inline Frames explicit_frames(const SphereSheet& sheet, int steps) {
  CentralDifference<T> run(sheet.model<double>(), TimeStep::fixed(sheet.duration / 10 / steps));
  Frames out;
  while (out.size() < 10) {
    for (int k = 0; k < steps; ++k) run.step();
    out.push_back(positions(run.model()));
  }
  return out;
}

/// Largest distance of any node at any of the times.
inline double distance(const Frames& a, const Frames& b) {
  double out = 0;
  for (std::size_t k = 0; k < a.size(); ++k) out = std::max(out, scenes::distance(a[k], b[k]));
  return out;
}

}  // namespace reference_scenes
