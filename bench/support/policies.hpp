#pragma once
/// @file
/// What the library decides by flags at run time, fixed at compile time: the measure of what the
/// flags cost. For the fabric of the benchmarks: bending in the cell, no residual stiffness.

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/element/quadrilateral.hpp"

namespace bench {

/// The energy cell whose `follow` asks neither for bending nor for residual stiffness.
template <class R>
class FixedCell : public crossbeam::CrossedBeamCell<R> {
 public:
  using Base = crossbeam::CrossedBeamCell<R>;
  using Base::Base;

  /// CrossedBeamCell::follow without its flags.
  template <class T>
  CROSSBEAM_INLINE crossbeam::YarnForces<T> follow(const T&, const T&,
                                                   const crossbeam::FollowedYarn<T>& y1,
                                                   const crossbeam::FollowedYarn<T>& y2,
                                                   crossbeam::CrimpHeights<T>& heights) const {
    const T k3(this->contact_stiffness()), most(this->parameters().contact_length / R(8));
    const T D12 = y1.D * y2.D, closed = D12 + k3 * (y1.D + y2.D);
    const T both = T(1) / (closed * D12);
    const T q = maximum(
        k3 * ((y1.g - heights.w1 * y1.D) * y2.D + (y2.g - heights.w2 * y2.D) * y1.D) * (both * D12),
        T(0));
    const T r = both * closed;
    const T dw1 = maximum(minimum((q - y1.g) * (y2.D * r), most), -most);
    const T dw2 = maximum(minimum((q - y2.g) * (y1.D * r), most), -most);
    heights.w1 = heights.w1 + dw1;
    heights.w2 = heights.w2 + dw2;
    return {y1.F + y1.k_Lh * dw1, y2.F + y2.k_Lh * dw2};
  }
  template <class T>
  CROSSBEAM_INLINE crossbeam::YarnForces<T> follow(const T& u1, const T& u2,
                                                   crossbeam::CrimpHeights<T>& heights) const {
    return follow(u1, u2, this->evaluate_yarn(this->warp(), u1, heights.w1),
                  this->evaluate_yarn(this->weft(), u2, heights.w2), heights);
  }
};

/// The one-point quadrilateral for which hourglass control does not exist.
struct QuadWithoutHourglass : crossbeam::Quadrilateral<1> {
  static constexpr bool has_hourglass = false;
};

}  // namespace bench
