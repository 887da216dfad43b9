#pragma once
/// @file
/// Tuples of node numbers (elements, stencils) packed into batches that fill the SIMD lanes. Where
/// consecutive tuples have consecutive nodes, as along a row of a structured mesh, a batch loads and
/// stores whole packs; elsewhere it gathers. One mesh type therefore serves both.
/// Theory: docs/theory/sweep.md.

#include "crossbeam/mesh/arrays.hpp"

#include <array>
#include <vector>

namespace crossbeam {

/// @tparam T pack
template <int Columns, class T>
class IndexBatches {
 public:
  static constexpr int lanes = lanes_v<T>;
  using R = real_t<T>;

  struct Batch {
    std::array<int, Columns> first;  ///< node of lane 0 in each column, when contiguous
    int gather_row = -1;             ///< row of the lane table, or -1 when contiguous
    int active = lanes;              ///< lanes that hold a tuple
    int first_tuple = 0;
  };

  IndexBatches() = default;
  explicit IndexBatches(const std::vector<std::array<int, Columns>>& tuples) {
    const int count = static_cast<int>(tuples.size());
    for (int begin = 0; begin < count;) {
      int run = 1;
      while (run < lanes && begin + run < count && follows(tuples[begin + run - 1],
                                                           tuples[begin + run]))
        ++run;
      Batch batch;
      batch.first = tuples[begin];
      batch.first_tuple = begin;
      // A short run is worth its own contiguous batch from half the lanes on.
      if (2 * run >= lanes) {
        batch.active = run;
      } else {
        batch.active = std::min(lanes, count - begin);
        batch.gather_row = static_cast<int>(table_.size()) / (Columns * lanes);
        for (int c = 0; c < Columns; ++c)
          for (int l = 0; l < lanes; ++l)
            table_.push_back(tuples[begin + std::min(l, batch.active - 1)][c]);
      }
      begin += batch.active;
      batches_.push_back(batch);
    }
  }

  [[nodiscard]] int size() const { return static_cast<int>(batches_.size()); }
  [[nodiscard]] const Batch& operator[](int b) const { return batches_[b]; }

  /// Tuple in a lane; idle lanes repeat the last tuple.
  [[nodiscard]] int tuple(int b, int lane) const {
    return batches_[b].first_tuple + std::min(lane, batches_[b].active - 1);
  }

  /// Node of a column in an active lane.
  [[nodiscard]] int node(int b, int column, int lane) const {
    const Batch& batch = batches_[b];
    return batch.gather_row < 0 ? batch.first[column] + lane : row(batch, column)[lane];
  }

  /// Lanes that hold a tuple.
  [[nodiscard]] CROSSBEAM_INLINE auto active(const Batch& batch) const {
    R number[lanes];
    for (int l = 0; l < lanes; ++l) number[l] = R(l);
    return T::load(number) < T(R(batch.active));
  }

  [[nodiscard]] CROSSBEAM_INLINE Vec3<T> gather(const NodeVectors<R>& a, const Batch& batch,
                                                int column) const {
    if (batch.gather_row < 0) return load<T>(a, batch.first[column]);
    const int* n = row(batch, column);
    R x[lanes], y[lanes], z[lanes];
    for (int l = 0; l < lanes; ++l) {
      x[l] = a.x[n[l]];
      y[l] = a.y[n[l]];
      z[l] = a.z[n[l]];
    }
    return {T::load(x), T::load(y), T::load(z)};
  }

  /// a[node] -= f, lane after lane in the order of the tuples. Idle lanes must hold zeros when the
  /// batch is contiguous.
  CROSSBEAM_INLINE void subtract(NodeVectors<R>& a, const Batch& batch, int column,
                                 const Vec3<T>& f) const {
    if (batch.gather_row < 0) {
      const int n = batch.first[column];
      store(a, n, load<T>(a, n) - f);
      return;
    }
    const int* n = row(batch, column);
    for (int l = 0; l < batch.active; ++l) {
      a.x[n[l]] -= f.x[l];
      a.y[n[l]] -= f.y[l];
      a.z[n[l]] -= f.z[l];
    }
  }

 private:
  static bool follows(const std::array<int, Columns>& a, const std::array<int, Columns>& b) {
    for (int c = 0; c < Columns; ++c)
      if (b[c] != a[c] + 1) return false;
    return true;
  }
  [[nodiscard]] const int* row(const Batch& batch, int column) const {
    return table_.data() + (static_cast<std::size_t>(batch.gather_row) * Columns + column) * lanes;
  }

  std::vector<Batch> batches_;
  std::vector<int> table_;
};

/// Constants of the tuples in the order of the lanes: component c of batch b is one pack.
template <class T>
class LaneArray {
 public:
  using R = real_t<T>;
  LaneArray() = default;
  LaneArray(int batches, int components)
      : components_(components),
        data_(static_cast<std::size_t>(batches) * components * lanes_v<T>) {}

  CROSSBEAM_INLINE T load(int batch, int component) const {
    return T::load(data_.data() + offset(batch, component));
  }
  CROSSBEAM_INLINE void store(int batch, int component, const T& value) {
    value.store(data_.data() + offset(batch, component));
  }
  R& at(int batch, int component, int lane) { return data_[offset(batch, component) + lane]; }

 private:
  [[nodiscard]] CROSSBEAM_INLINE std::size_t offset(int batch, int component) const {
    return (static_cast<std::size_t>(batch) * components_ + component) * lanes_v<T>;
  }
  int components_ = 0;
  AlignedArray<R> data_;
};

}  // namespace crossbeam
