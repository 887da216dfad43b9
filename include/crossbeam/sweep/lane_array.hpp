#pragma once
/// @file
/// Constants of the tuples of a sweep, one pack for each batch and component. Theory:
/// docs/theory/sweep.md, [S-2].

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/mesh/arrays.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace crossbeam {

/// Constants of the tuples in the order of the lanes: component c of batch b is one pack.
template <class T>
class LaneArray {
 public:
  using R = real_t<T>;
  LaneArray() = default;
  LaneArray(int batches, int components)
      : batches_(batches),
        components_(components),
        stride_(static_cast<std::size_t>(components) * lanes_v<T>),
        data_(static_cast<std::size_t>(batches) * stride_) {}

  /// Keeps one tuple's constants where all agree but for the rounding of the mesh's coordinates:
  /// a regular mesh then streams no constants, tag [S-2].
  /// @param scale size that a component's differences are compared with
  /// @param counts whether a lane of a batch does
  template <class Scale, class Counts>
  void collapse_if_uniform(const Scale& scale, const Counts& counts) {
    if (batches_ == 0) return;
    const R tolerance = maximum(R(1e-11), 2 * std::numeric_limits<R>::epsilon());
    for (int b = 0; b < batches_; ++b)
      for (int c = 0; c < components_; ++c)
        for (int l = 0; l < lanes_v<T>; ++l)
          if (counts(b, l) && !(std::abs(at(b, c, l) - at(0, c, 0)) <= tolerance * scale(c)))
            return;
    for (int c = 0; c < components_; ++c)
      for (int l = 0; l < lanes_v<T>; ++l) at(0, c, l) = at(0, c, 0);
    data_.resize(stride_);
    data_.shrink_to_fit();
    stride_ = 0;
  }
  [[nodiscard]] bool is_uniform() const { return stride_ == 0; }

  CROSSBEAM_INLINE T load(int batch, int component) const {
    return T::load(data_.data() + offset(batch, component));
  }
  CROSSBEAM_INLINE void store(int batch, int component, const T& value) {
    value.store(data_.data() + offset(batch, component));
  }
  /// Numbers of one batch; those of the next begin `stride` further on.
  [[nodiscard]] CROSSBEAM_INLINE const R* data(int batch) const {
    return data_.data() + static_cast<std::size_t>(batch) * stride_;
  }
  [[nodiscard]] CROSSBEAM_INLINE R* data(int batch) {
    return data_.data() + static_cast<std::size_t>(batch) * stride_;
  }
  [[nodiscard]] CROSSBEAM_INLINE std::size_t stride() const { return stride_; }
  R& at(int batch, int component, int lane) { return data_[offset(batch, component) + lane]; }

 private:
  [[nodiscard]] CROSSBEAM_INLINE std::size_t offset(int batch, int component) const {
    return static_cast<std::size_t>(batch) * stride_ +
           static_cast<std::size_t>(component) * lanes_v<T>;
  }
  int batches_ = 0, components_ = 0;
  std::size_t stride_ = 0;  // numbers of one batch; 0 where one batch serves all
  AlignedArray<R> data_;
};

}  // namespace crossbeam
