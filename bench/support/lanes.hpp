#pragma once
/// @file
/// One way between a number and an array, whatever number it is: a scalar, a pack, or a dual number.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/mesh/arrays.hpp"

namespace bench {

/// As many values as T has lanes.
template <class T>
CROSSBEAM_INLINE T load_at(const crossbeam::real_t<T>* from) {
  if constexpr (crossbeam::lanes_v<T> == 1)
    return T(*from);
  else
    return T::load(from);
}
template <class T>
CROSSBEAM_INLINE void store_at(crossbeam::real_t<T>* to, const T& value) {
  if constexpr (crossbeam::lanes_v<T> == 1)
    *to = static_cast<crossbeam::real_t<T>>(value);
  else
    value.store(to);
}

/// Values from `first` on.
template <class T>
CROSSBEAM_INLINE T load(const crossbeam::AlignedArray<crossbeam::real_t<T>>& from, int first) {
  return load_at<T>(from.data() + first);
}

/// The same as variable number `index` of a dual number.
template <class Dual>
CROSSBEAM_INLINE Dual load_variable(const crossbeam::AlignedArray<crossbeam::real_t<Dual>>& from,
                                    int first, int index) {
  return Dual::variable(load<crossbeam::passive_t<Dual>>(from, first), index);
}

}  // namespace bench
