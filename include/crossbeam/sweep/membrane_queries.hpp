#pragma once
/// @file
/// What is asked of the elements of a membrane beside their forces: stored energies, and what each
/// looks like.

#include "crossbeam/model/force_block.hpp"
#include "crossbeam/sweep/membrane_memory.hpp"
#include "crossbeam/sweep/membrane_points.hpp"

#include <cstddef>
#include <vector>

namespace crossbeam {

/// Stored energies of a membrane [kN mm].
struct MembraneEnergy {
  double yarn = 0, shear = 0, hourglass = 0;
};

/// @return the yarns' share is 0 for a law without a potential
template <class T, class Element, class Law>
MembraneEnergy membrane_energy(const MembranePoints<T, Element, Law>& points,
                               const NodeVectors<double>& x) {
  using R = real_t<T>;
  MembraneEnergy out;
  points.for_each_point(x, [&](const auto& at) {
    const auto active = points.batches.active(at.batch);
    const auto sum = [&](const T& energy) {
      return static_cast<double>(lane_sum(select(active, energy, T(R(0)))));
    };
    const T weight = at.constants.point().weight;
    if constexpr (MembraneLawWithEnergy<Law, T>)
      out.yarn += sum(weight * points.law.yarn_energy(at.state));
    out.shear += sum(weight * points.law.shear_energy(at.state));
    if constexpr (Element::has_hourglass) {
      const auto& c = at.constants;
      const Vec3<T> q = at.D[2] - (c.hourglass(0) * at.D[0] + c.hourglass(1) * at.D[1]);
      const T stiffness = T(points.constants.hourglass_modulus()) * c.hourglass(2);
      out.hourglass += sum(T(R(0.5)) * stiffness * dot(q, q));
    }
  });
  return out;
}

namespace detail {

/// The cell's share of a sample.
template <class Parameters, class Solution>
void sample_cell(const Parameters& cell, const Solution& solution, int lane, double share,
                 ElementSample& s) {
  const double H1 = static_cast<double>(cell.warp_height_fraction * cell.contact_length);
  const double H2 = static_cast<double>(cell.contact_length) - H1;
  s.crimp_height[0] += share * (H1 + static_cast<double>(solution.forces.w1[lane]));
  s.crimp_height[1] += share * (H2 + static_cast<double>(solution.forces.w2[lane]));
  const double q = static_cast<double>(solution.forces.q[lane]);
  s.contact_force += share * q;
  s.slack = s.slack || !(q > 0);
  if constexpr (requires { solution.fallback; })
    s.fallback = s.fallback || solution.fallback[lane] > 0;
  if constexpr (requires { solution.last_correction; })
    s.cell_correction =
        maximum(s.cell_correction, static_cast<double>(solution.last_correction[lane]));
}

}  // namespace detail

/// Appends the samples of all elements, averaged over their points.
/// @param heights of followed cells: a sample then says how far off the next step will find them
template <class T, class Element, class Law>
void sample_membrane(const MembranePoints<T, Element, Law>& points, const NodeVectors<double>& x,
                     [[maybe_unused]] const CellHeights<T, Element::points>& heights,
                     std::vector<ElementSample>& out) {
  const std::size_t offset = out.size();
  out.resize(offset + static_cast<std::size_t>(points.element_count));
  constexpr double share = 1.0 / Element::points;
  const Law& law = points.law;
  points.for_each_point(x, [&](const auto& at) {
    const FibreState<T>& fibres = at.state.fibres;
    const T gamma = shear_angle(
        fibre_cosine(fibres.beta, fibres.lambda1, fibres.lambda2, law.reference().cosine),
        law.reference());
    const auto tension = law.yarn_tension(at.state);
    [[maybe_unused]] T off1(0), off2(0);
    if constexpr (FollowingLaw<Law, T>)
      if (heights.are_known()) {
        CrimpHeights<T> next = heights.load(at.b, at.p);
        law.cell().follow(at.state.u1, at.state.u2, next);
        off1 = magnitude(next.w1 - at.state.cell.forces.w1);
        off2 = magnitude(next.w2 - at.state.cell.forces.w2);
      }
    for (int l = 0; l < lanes_v<T>; ++l) {
      if (!at.batch.holds(l)) continue;
      const auto real = [l](const T& value) { return static_cast<double>(value[l]); };
      ElementSample& s = out[offset + static_cast<std::size_t>(points.batches.tuple(at.b, l))];
      const double lambda[2] = {real(fibres.lambda1), real(fibres.lambda2)};
      s.shear_angle += share * real(gamma);
      for (int i = 0; i < 2; ++i) {
        s.stretch[i] += share * (lambda[i] - 1);
        s.tension[i] += share * real(tension(i));
      }
      if constexpr (requires { law.cell().parameters(); })  // a law of one's own need not have one
        detail::sample_cell(law.cell().parameters(), at.state.cell, l, share, s);
      if constexpr (FollowingLaw<Law, T>)
        s.cell_correction = maximum(s.cell_correction, maximum(real(off1), real(off2)));
      const auto unit = [&](const Vec3<T>& f, double length) {
        return (share / length) * Vec3<double>{real(f.x), real(f.y), real(f.z)};
      };
      s.warp = s.warp + unit(at.kinematics.f1, lambda[0]);
      s.weft = s.weft + unit(at.kinematics.f2, lambda[1]);
    }
  });
}

}  // namespace crossbeam
