#pragma once
/// @file
/// What a membrane sweep remembers from step to step: heights of followed cells, tag [C-14], and
/// the work of yarns without a potential.

#include "crossbeam/sweep/lane_array.hpp"
#include "crossbeam/sweep/membrane_points.hpp"

#include <cstddef>

namespace crossbeam {

/// What one stage has summed up: since the start, and in the last step.
struct StageSums {
  double viscous_work = 0, viscous_step = 0, path_work = 0;  ///< [kN mm]
  long long fallbacks = 0;
};

/// Heights of the cells of all points, warp and then weft.
template <class T, int Points>
class CellHeights {
 public:
  using R = real_t<T>;
  CellHeights() = default;
  explicit CellHeights(int batches) : numbers_(batches, 2 * Points) {}

  [[nodiscard]] bool are_known() const { return known_; }
  /// Those of the equilibrium at the positions x.
  template <class Element, class Law>
  void begin(const MembranePoints<T, Element, Law>& points, const NodeVectors<double>& x) {
    points.for_each_point(x, [this](const auto& at) {
      numbers_.store(at.b, 2 * at.p, at.state.cell.forces.w1);
      numbers_.store(at.b, 2 * at.p + 1, at.state.cell.forces.w2);
    });
    known_ = true;
  }
  [[nodiscard]] CrimpHeights<T> load(int b, int p) const {
    return {numbers_.load(b, 2 * p), numbers_.load(b, 2 * p + 1)};
  }
  /// Those of the batches from `first` on at point p; from one batch to the next it is `stride`.
  [[nodiscard]] CROSSBEAM_INLINE R* at_point(int first, int p) {
    return numbers_.data(first) + 2 * p * lanes_v<T>;
  }
  [[nodiscard]] CROSSBEAM_INLINE std::size_t stride() const { return numbers_.stride(); }

 private:
  LaneArray<T> numbers_;
  bool known_ = false;
};

/// Work of the yarns along the path of every point, by the trapezoidal rule.
template <class T, int Points>
class YarnWork {
 public:
  using R = real_t<T>;
  YarnWork() = default;
  explicit YarnWork(int batches) : previous_(batches, 4 * Points) {}

  /// Work since the last call [kN mm].
  /// @param tension of the yarns, m_i lambda_i; @param active lanes that hold an element
  template <class Tension, class Mask>
  double book(int b, int p, const T& weight, const FibreState<T>& fibres, const Tension& tension,
              const Mask& active) {
    const T zero(R(0));
    const T m1 = select(active, tension(0) / fibres.lambda1, zero);
    const T m2 = select(active, tension(1) / fibres.lambda2, zero);
    const FibreStrain<T>& beta = fibres.beta;
    const int i = 4 * p;
    const T work = T(R(0.5)) * weight *
                   ((m1 + previous_.load(b, i)) * (beta.b11 - previous_.load(b, i + 1)) +
                    (m2 + previous_.load(b, i + 2)) * (beta.b22 - previous_.load(b, i + 3)));
    previous_.store(b, i, m1);
    previous_.store(b, i + 1, beta.b11);
    previous_.store(b, i + 2, m2);
    previous_.store(b, i + 3, beta.b22);
    return static_cast<double>(lane_sum(select(active, work, zero)));
  }

 private:
  LaneArray<T> previous_;  // m11, beta11, m22, beta22
};

}  // namespace crossbeam
