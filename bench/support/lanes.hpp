#pragma once
/// @file
/// One way to fill a number from an array, whatever it is: a scalar, a pack, or a dual number.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/mesh/arrays.hpp"

namespace bench {

/// Values from `first` on, as many as T has lanes.
template <class T>
CROSSBEAM_INLINE T load(const crossbeam::AlignedArray<crossbeam::real_t<T>>& from, int first) {
  if constexpr (crossbeam::lanes_v<T> == 1)
    return T(from[static_cast<std::size_t>(first)]);
  else
    return T::load(from.data() + first);
}

/// The same as variable number `index` of a dual number.
template <class Dual>
CROSSBEAM_INLINE Dual load_variable(const crossbeam::AlignedArray<crossbeam::real_t<Dual>>& from,
                                    int first, int index) {
  return Dual::variable(load<crossbeam::passive_t<Dual>>(from, first), index);
}

}  // namespace bench
