#pragma once
/// @file
/// The inputs: a ring of random states with a fixed seed, gone through again and again. Long enough
/// to be hard on a branch predictor; the strains stay in the first-level cache, the corners in the
/// second.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"
#include "crossbeam/mesh/arrays.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace bench {

inline constexpr int ring_size = 512;  ///< a multiple of every pack width

/// Uniform numbers, the same with every standard library.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }

 private:
  std::mt19937_64 engine_;
};

/// One state of the ring.
struct RingState {
  double warp, weft;  ///< stretch of the yarns - 1 [-]
  double shear;       ///< shear angle [rad]
  double tilt = 0;    ///< of the element about y [rad]
};
using RingStates = std::vector<RingState>;

/// Yarn elongations from -2 to 3 % and shear angles up to 0.7 rad.
inline RingStates random_states() {
  Uniform random(20261122);
  RingStates states;
  for (int k = 0; k < ring_size; ++k) {
    const double warp = random(-0.02, 0.03), weft = random(-0.02, 0.03);
    const double shear = random(-0.7, 0.7), tilt = random(-1, 1);
    states.push_back({warp, weft, shear, tilt});
  }
  return states;
}

/// The states one explicit time step later: strains of the drape move by some 1e-5 per step.
inline RingStates one_step_later(RingStates states) {
  constexpr double increment = 1e-5;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const double sign = k % 2 == 0 ? 1 : -1;
    states[k].warp += sign * increment;
    states[k].weft -= sign * increment;
    states[k].shear += increment;
  }
  return states;
}

/// Fibres perpendicular at first.
template <class R>
struct Ring {
  crossbeam::AlignedArray<R> b11, b22, b12;  ///< fibre strains
  crossbeam::AlignedArray<R> u1, u2;         ///< the same elongations of Table 1's cell [mm]
  /// Corners of a deformed square element of edge 1 mm, turned in space [mm].
  std::array<crossbeam::NodeVectors<R>, 4> corner;

  /// @param states ring_size of them
  explicit Ring(const RingStates& states = random_states()) {
    for (auto* a : {&b11, &b22, &b12, &u1, &u2}) a->resize(ring_size);
    corner.fill(crossbeam::NodeVectors<R>(ring_size));
    for (std::size_t k = 0; k < ring_size; ++k) {
      const auto& [e1, e2, g, tilt] = states.at(k);
      const double l1 = 1 + e1, l2 = 1 + e2, length = 2.5;
      b11[k] = R(0.5 * (l1 * l1 - 1));
      b22[k] = R(0.5 * (l2 * l2 - 1));
      b12[k] = R(0.5 * l1 * l2 * std::sin(g));
      u1[k] = R(length * e1);
      u2[k] = R(length * e2);
      // Warp in the plane turned by `tilt` about y, weft at the sheared angle in that plane.
      const double c = std::cos(tilt), s = std::sin(tilt);
      const crossbeam::Vec3<double> warp{l1 * c, 0, l1 * s};
      const crossbeam::Vec3<double> weft{l2 * std::sin(g) * c, l2 * std::cos(g),
                                         l2 * std::sin(g) * s};
      const crossbeam::Vec3<double> x[4] = {{}, warp, warp + weft, weft};
      for (std::size_t a = 0; a < 4; ++a)
        corner[a].set(static_cast<int>(k), {R(x[a].x), R(x[a].y), R(x[a].z)});
    }
  }
};

}  // namespace bench
