#pragma once
/// @file
/// Tuples of node numbers (elements, stencils) packed into batches that fill the SIMD lanes. Where
/// consecutive tuples have consecutive nodes, as along a row of a structured mesh, a batch loads and
/// stores whole packs; elsewhere it gathers. One mesh type therefore serves both.
/// Theory: docs/theory/sweep.md.

#include "crossbeam/mesh/arrays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
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

  /// Batches of the same stage that follow each other: contiguous ones without a gap, or gathered
  /// ones.
  struct Run {
    int first_batch = 0, batches = 0;
    int tuples = 0;
    bool contiguous = false;
    /// Columns in the order of their nodes. Those less than `reach` nodes apart share a line, so
    /// that a node meets all their forces at once.
    std::array<std::uint8_t, Columns> column{}, shift{};
    std::array<std::uint8_t, Columns> line_end{};
    int lines = 0;
  };
  static constexpr int reach = 8;
  /// Tuples of a run, at most.
  static constexpr int run_capacity =
      std::max(lanes, 256 / Columns / lanes * lanes);

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
    arrange({});
  }

  /// Largest difference of two node numbers in one batch.
  [[nodiscard]] int bandwidth() const {
    int widest = 0;
    for (int b = 0; b < size(); ++b) {
      int low = node(b, 0, 0), high = low;
      for (int c = 0; c < Columns; ++c)
        for (int lane = 0; lane < batches_[b].active; ++lane) {
          low = std::min(low, node(b, c, lane));
          high = std::max(high, node(b, c, lane));
        }
      widest = std::max(widest, high - low);
    }
    return widest;
  }

  /// Sorts the batches by stage, the highest level of nodes that one touches, and gathers them into
  /// runs, tag [S-3].
  /// @param level_start first node of every level and the end; empty: one level
  void arrange(const std::vector<int>& level_start) {
    const auto level = [&](int node) {
      if (level_start.empty()) return 0;
      return static_cast<int>(
          std::upper_bound(level_start.begin() + 1, level_start.end(), node) -
          (level_start.begin() + 1));
    };
    const int levels = level_start.empty() ? 1 : static_cast<int>(level_start.size()) - 1;
    const auto stage = [&](int b) {
      int highest = 0;
      for (int c = 0; c < Columns; ++c)
        for (int lane = 0; lane < batches_[b].active; ++lane)
          highest = std::max(highest, level(node(b, c, lane)));
      return highest;
    };
    std::vector<std::vector<int>> members(static_cast<std::size_t>(levels));
    for (int b = 0; b < size(); ++b) members[stage(b)].push_back(b);
    runs_.clear();
    stage_runs_.assign(1, 0);
    for (const auto& batches : members) {
      for (std::size_t k = 0; k < batches.size(); ++k) {
        const int b = batches[k];
        if (k == 0 || b != batches[k - 1] + 1 || !continues(b)) runs_.push_back(new_run(b));
        ++runs_.back().batches;
        runs_.back().tuples += batches_[b].active;
      }
      stage_runs_.push_back(static_cast<int>(runs_.size()));
    }
  }

  [[nodiscard]] int stages() const { return static_cast<int>(stage_runs_.size()) - 1; }
  [[nodiscard]] int first_run(int stage) const { return stage_runs_[stage]; }
  [[nodiscard]] int run_count() const { return static_cast<int>(runs_.size()); }
  [[nodiscard]] const Run& run(int r) const { return runs_[r]; }

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

  /// @tparam U pack of the array's precision
  template <class U = T>
  [[nodiscard]] CROSSBEAM_INLINE Vec3<U> gather(const NodeVectors<real_t<U>>& a, const Batch& batch,
                                                int column) const {
    if (batch.gather_row < 0) return load<U>(a, batch.first[column]);
    const int* n = row(batch, column);
    real_t<U> x[lanes], y[lanes], z[lanes];
    for (int l = 0; l < lanes; ++l) {
      x[l] = a.x[n[l]];
      y[l] = a.y[n[l]];
      z[l] = a.z[n[l]];
    }
    return {U::load(x), U::load(y), U::load(z)};
  }

  /// All columns at once.
  CROSSBEAM_INLINE void gather_all(const NodeVectors<R>& a, const Batch& batch,
                                   Vec3<T> (&out)[Columns]) const {
    if (batch.gather_row < 0)
      unrolled<Columns>([&](auto c) CROSSBEAM_INLINE_LAMBDA {
        out[c] = crossbeam::load<T>(a, batch.first[c]);
      });
    else
      unrolled<Columns>([&](auto c) CROSSBEAM_INLINE_LAMBDA { out[c] = gather(a, batch, c); });
  }

  /// body(all columns), written out for either way to read them: packs wider than a register stay in
  /// registers only as long as no branch ends.
  template <class U, class Body>
  CROSSBEAM_INLINE void with_all(const NodeVectors<real_t<U>>& a, const Batch& batch,
                                 const Body& body) const {
    if (batch.gather_row < 0) {
      Vec3<U> x[Columns];
      unrolled<Columns>([&](auto c) CROSSBEAM_INLINE_LAMBDA {
        x[c] = crossbeam::load<U>(a, batch.first[c]);
      });
      body(x);
    } else {
      Vec3<U> x[Columns];
      unrolled<Columns>([&](auto c) CROSSBEAM_INLINE_LAMBDA { x[c] = gather<U>(a, batch, c); });
      body(x);
    }
  }

  /// a[node] -= f of a gathered batch, lane after lane in the order of the tuples.
  CROSSBEAM_INLINE void subtract(NodeVectors<R>& a, const Batch& batch, int column,
                                 const Vec3<T>& f) const {
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

  /// Whether batch b goes on where the last run ends.
  [[nodiscard]] bool continues(int b) const {
    const Run& run = runs_.back();
    const Batch &last = batches_[b - 1], &batch = batches_[b];
    if ((run.batches + 1) * lanes > run_capacity || run.contiguous != (batch.gather_row < 0))
      return false;
    if (!run.contiguous) return true;
    if (last.active < lanes) return false;
    for (int c = 0; c < Columns; ++c)
      if (batch.first[c] != last.first[c] + lanes) return false;
    return true;
  }

  [[nodiscard]] Run new_run(int b) const {
    Run run;
    run.first_batch = b;
    run.contiguous = batches_[b].gather_row < 0;
    const auto& first = batches_[b].first;
    std::iota(run.column.begin(), run.column.end(), std::uint8_t(0));
    std::stable_sort(run.column.begin(), run.column.end(),
                     [&](int p, int q) { return first[p] < first[q]; });
    int base = 0;
    for (int k = 0; k < Columns; ++k) {
      const int node = first[run.column[k]];
      if (k == 0 || node - base >= reach) {
        base = node;
        ++run.lines;
      }
      run.shift[k] = static_cast<std::uint8_t>(node - base);
      run.line_end[run.lines - 1] = static_cast<std::uint8_t>(k + 1);
    }
    return run;
  }

  std::vector<Batch> batches_;
  std::vector<int> table_;
  std::vector<Run> runs_;
  std::vector<int> stage_runs_;  // first run of every stage, and their count
};

namespace detail {

/// to[lane] -= value for the first `count` lanes. The nodes behind may be another thread's: they are
/// not even written with what they had.
template <class T>
CROSSBEAM_INLINE void subtract_lanes(real_t<T>* to, const T& value, int count) {
  if (count >= lanes_v<T>) {
    (T::load(to) - value).store(to);
    return;
  }
  for (int lane = 0; lane < count; ++lane) to[lane] -= value[lane];
}

/// Calls body(columns, where a's components begin, run, first column, nodes, columns) for every line of
/// a run, with the number of columns as an integral constant: up to three, or 0 for more.
template <class R, class Run, std::size_t Columns, class Body>
CROSSBEAM_INLINE void for_each_line(NodeVectors<R>& a, const Run& run,
                                    const std::array<int, Columns>& first, const Body& body) {
  int k = 0;
  for (int line = 0; line < run.lines; ++line) {
    const int begin = k;
    k = run.line_end[line];
    const int base = first[run.column[begin]], count = run.tuples + run.shift[k - 1];
    R* const out[3] = {a.x.data() + base, a.y.data() + base, a.z.data() + base};
    switch (k - begin) {
      case 1: body(std::integral_constant<int, 1>{}, out, run, begin, count, 1); break;
      case 2: body(std::integral_constant<int, 2>{}, out, run, begin, count, 2); break;
      case 3: body(std::integral_constant<int, 3>{}, out, run, begin, count, 3); break;
      default: body(std::integral_constant<int, 0>{}, out, run, begin, count, k - begin);
    }
  }
}

}  // namespace detail

/// Forces of one contiguous run, column by column, until the nodes get them: a node that is a corner
/// of several tuples is then read and written once, and no load overtakes a store that it overlaps.
template <int Columns, class T>
class RunForces {
 public:
  using R = real_t<T>;
  using Run = typename IndexBatches<Columns, T>::Run;
  static constexpr int lanes = lanes_v<T>;

  RunForces() {
    const T zero(R(0));
    for (auto& column : force_)
      for (auto& component : column)
        for (int i = 0; i < front; i += lanes) zero.store(component + i);
  }

  /// @param tuple place of lane 0 in the run; idle lanes must hold zeros
  CROSSBEAM_INLINE void put(int column, int tuple, const Vec3<T>& f) {
    f.x.store(force_[column][0] + front + tuple);
    f.y.store(force_[column][1] + front + tuple);
    f.z.store(force_[column][2] + front + tuple);
  }

  /// a[node] -= the forces put since the last time.
  void subtract_from(NodeVectors<R>& a, const Run& run, const std::array<int, Columns>& first) {
    const int end = (run.tuples + lanes - 1) / lanes * lanes;
    const T zero(R(0));
    for (auto& column : force_)
      for (auto& component : column)
        for (int i = 0; i < back; i += lanes) zero.store(component + front + end + i);
    detail::for_each_line(a, run, first, [&](auto columns, auto&&... line) CROSSBEAM_INLINE_LAMBDA {
      line_of<columns>(line...);
    });
  }

 private:
  static constexpr int reach = IndexBatches<Columns, T>::reach;
  // Loads reach up to `reach` numbers before the first and a pack beyond the last.
  static constexpr int front = std::max(reach, lanes), back = std::max(reach, lanes) + lanes;
  static constexpr int size = front + IndexBatches<Columns, T>::run_capacity + back;

  /// @tparam Count columns of the line, or 0: `columns` of them
  template <int Count>
  CROSSBEAM_INLINE void line_of(R* const (&out)[3], const Run& run, int begin, int count,
                                int columns) const {
    const int many = Count > 0 ? Count : columns;
    const R* from[Columns] = {};
    for (int k = 0; k < many; ++k)
      from[k] = force_[run.column[begin + k]][0] + front - run.shift[begin + k];
    for (int i = 0; i < count; i += lanes)
      unrolled<3>([&](auto component) CROSSBEAM_INLINE_LAMBDA {
        T sum = T::load(from[0] + component * size + i);
        for (int k = 1; k < many; ++k) sum = sum + T::load(from[k] + component * size + i);
        detail::subtract_lanes(out[component] + i, sum, count - i);
      });
  }

  alignas(64) R force_[Columns][3][size];
};

/// The same where every tuple has one vector, and column k of a tuple gets it times a constant of its
/// own: weight[k], with the sign of each component.
template <int Columns, class T>
class RunVectors {
 public:
  using R = real_t<T>;
  using Run = typename IndexBatches<Columns, T>::Run;
  static constexpr int lanes = lanes_v<T>;

  RunVectors() {
    const T zero(R(0));
    for (auto& component : vector_)
      for (int i = 0; i < front; i += lanes) zero.store(component + i);
  }

  /// @param tuple place of lane 0 in the run; idle lanes must hold zeros
  CROSSBEAM_INLINE void put(int tuple, const Vec3<T>& v) {
    v.x.store(vector_[0] + front + tuple);
    v.y.store(vector_[1] + front + tuple);
    v.z.store(vector_[2] + front + tuple);
  }

  /// a[node of column k] -= weight[component][k] times the vector.
  void subtract_from(NodeVectors<R>& a, const Run& run, const std::array<int, Columns>& first,
                     const std::array<R, Columns> (&weight)[3]) {
    const T zero(R(0));
    const int end = (run.tuples + lanes - 1) / lanes * lanes;
    for (auto& component : vector_)
      for (int i = 0; i < back; i += lanes) zero.store(component + front + end + i);
    detail::for_each_line(a, run, first, [&](auto columns, auto&&... line) CROSSBEAM_INLINE_LAMBDA {
      line_of<columns>(line..., weight);
    });
  }

 private:
  static constexpr int reach = IndexBatches<Columns, T>::reach;
  static constexpr int front = std::max(reach, lanes), back = std::max(reach, lanes) + lanes;
  static constexpr int size = front + IndexBatches<Columns, T>::run_capacity + back;

  template <int Count>
  CROSSBEAM_INLINE void line_of(R* const (&out)[3], const Run& run, int begin, int count,
                                int columns, const std::array<R, Columns> (&weight)[3]) const {
    const int many = Count > 0 ? Count : columns;
    const R* from[Columns] = {};
    for (int k = 0; k < many; ++k) from[k] = vector_[0] + front - run.shift[begin + k];
    for (int i = 0; i < count; i += lanes)
      unrolled<3>([&](auto component) CROSSBEAM_INLINE_LAMBDA {
        const auto& w = weight[component];
        T sum = T(w[run.column[begin]]) * T::load(from[0] + component * size + i);
        for (int k = 1; k < many; ++k)
          sum = sum + T(w[run.column[begin + k]]) * T::load(from[k] + component * size + i);
        detail::subtract_lanes(out[component] + i, sum, count - i);
      });
  }

  alignas(64) R vector_[3][size];
};

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
  /// @param active lanes of each batch that count
  template <class Scale, class Active>
  void collapse_if_uniform(const Scale& scale, const Active& active) {
    if (batches_ == 0) return;
    const R tolerance = std::max(R(1e-11), 2 * std::numeric_limits<R>::epsilon());
    for (int b = 0; b < batches_; ++b)
      for (int c = 0; c < components_; ++c)
        for (int l = 0; l < active(b); ++l)
          if (!(std::abs(at(b, c, l) - at(0, c, 0)) <= tolerance * scale(c))) return;
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
  R& at(int batch, int component, int lane) { return data_[offset(batch, component) + lane]; }

 private:
  [[nodiscard]] CROSSBEAM_INLINE std::size_t offset(int batch, int component) const {
    return static_cast<std::size_t>(batch) * stride_ + static_cast<std::size_t>(component) * lanes_v<T>;
  }
  int batches_ = 0, components_ = 0;
  std::size_t stride_ = 0;  // numbers of one batch; 0 where one batch serves all
  AlignedArray<R> data_;
};

}  // namespace crossbeam
