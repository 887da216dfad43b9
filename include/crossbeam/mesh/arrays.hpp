#pragma once
/// @file
/// Nodal vectors as structures of arrays. They are aligned and padded, so that a pack may be loaded
/// at any node.

#include "crossbeam/base/scalar.hpp"

#include <cstddef>
#include <new>
#include <vector>

namespace crossbeam {

/// Cache-line aligned allocation.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, alignment); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
};

template <class T>
using AlignedArray = std::vector<T, AlignedAllocator<T>>;

/// Nodes are padded to a multiple of this and by as many again, whatever the pack width.
inline constexpr int array_padding = 32;

inline constexpr int padded(int count) {
  return (count + array_padding - 1) / array_padding * array_padding + array_padding;
}

/// Three components of a quantity on every node.
template <class R>
struct NodeVectors {
  AlignedArray<R> x, y, z;

  NodeVectors() = default;
  explicit NodeVectors(int count) : x(padded(count)), y(padded(count)), z(padded(count)) {}

  [[nodiscard]] Vec3<R> get(int node) const { return {x[node], y[node], z[node]}; }
  void set(int node, const Vec3<R>& v) {
    x[node] = v.x;
    y[node] = v.y;
    z[node] = v.z;
  }
};

/// Addresses at which the components begin. In a loop that stores packs, a compiler would read them
/// again and again from the arrays themselves.
template <class R>
struct NodePointers {
  R *x, *y, *z;

  explicit NodePointers(NodeVectors<R>& a) : x(a.x.data()), y(a.y.data()), z(a.z.data()) {}
  template <class T>
  [[nodiscard]] CROSSBEAM_INLINE Vec3<T> load(std::ptrdiff_t first) const {
    return {T::load(x + first), T::load(y + first), T::load(z + first)};
  }
  template <class T>
  CROSSBEAM_INLINE void store(std::ptrdiff_t first, const Vec3<T>& v) const {
    v.x.store(x + first);
    v.y.store(y + first);
    v.z.store(z + first);
  }
};

/// Loads one lane per consecutive node.
template <class T, class R>
CROSSBEAM_INLINE Vec3<T> load(const NodeVectors<R>& a, int first) {
  return {T::load(a.x.data() + first), T::load(a.y.data() + first), T::load(a.z.data() + first)};
}
template <class T, class R>
CROSSBEAM_INLINE void store(NodeVectors<R>& a, int first, const Vec3<T>& v) {
  v.x.store(a.x.data() + first);
  v.y.store(a.y.data() + first);
  v.z.store(a.z.data() + first);
}

}  // namespace crossbeam
