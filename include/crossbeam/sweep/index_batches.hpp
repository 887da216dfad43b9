#pragma once
/// @file
/// Tuples of node numbers (elements, stencils) packed into batches that fill the SIMD lanes. Where
/// consecutive tuples have consecutive nodes, as along a row of a structured mesh, a batch loads
/// and stores whole packs; elsewhere it gathers. One mesh type therefore serves both.
/// Theory: docs/theory/sweep.md.
///
/// The words of the sweep, from small to large:
///   tuple            node numbers of one element or stencil, one in each column
///   lane             one number of a pack; idle where it holds no tuple
///   mesh row         tuples whose nodes follow each other by one, as along a row of a rectangle
///   batch            as many tuples as a pack has lanes. Contiguous: part of a mesh row, whose
///                    nodes are loaded as they lie; gathered: any tuples, whose nodes are looked up
///   run              batches of one kind that follow each other, few enough for the first-level
///                    cache: what the short loops work on
///   slot             lane of a run, numbered from lane 0 of its first batch
///   line             columns of a run whose nodes lie less than `reach` apart: a node meets all
///                    their forces at once
///   level            range of node numbers, wider than any batch reaches (its bandwidth)
///   stage            the batches whose highest node lies in one level: stages two or more apart
///                    share no node
///   band             levels that one thread works on (dynamics/step_order.hpp)
///   steps in flight  time steps that go through the levels one behind the other, while those are
///                    in the cache (dynamics/step_order.hpp)

#include "crossbeam/base/simd.hpp"
#include "crossbeam/mesh/arrays.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace crossbeam {

/// @tparam T pack
template <int Columns, class T>
class IndexBatches {
 public:
  static constexpr int lanes = lanes_v<T>;
  using R = real_t<T>;
  static_assert(lanes <= 32);
  static constexpr std::uint32_t all_lanes = ~std::uint32_t(0) >> (32 - lanes);

  /// Tuples in the order of their lanes. A contiguous batch has lanes without one where the nodes of
  /// consecutive tuples leave some out, as from one row of a mesh to the next.
  struct Batch {
    std::array<int, Columns> first;  ///< node of lane 0 in each column, when contiguous
    int gather_row = -1;             ///< row of the lane table, or -1 when contiguous
    std::uint32_t held = 0;          ///< bit l: lane l holds a tuple
    int mask_row = 0;                ///< row of the table of masks
    int first_tuple = 0;

    [[nodiscard]] bool holds(int lane) const { return (held >> lane & 1u) != 0; }
    [[nodiscard]] bool is_full() const { return held == all_lanes; }
    /// Lanes up to the last that holds a tuple.
    [[nodiscard]] int length() const { return std::bit_width(held); }
  };

  /// Batches of the same stage that follow each other: contiguous ones without a gap, or gathered
  /// ones.
  struct Run {
    int first_batch = 0, batches = 0;
    int length = 0;  ///< slots up to the last tuple
    bool contiguous = false;
    /// Columns in the order of their nodes. Those less than `reach` nodes apart share a line, so
    /// that a node meets all their forces at once.
    std::array<std::uint8_t, Columns> column{}, shift{};
    std::array<std::uint8_t, Columns> line_end{};
    int lines = 0;
  };
  static constexpr int reach = 8;
  /// Slots of a run, at most.
  static constexpr int run_capacity = maximum(lanes, 256 / Columns / lanes * lanes);

  IndexBatches() = default;
  explicit IndexBatches(const std::vector<std::array<int, Columns>>& tuples) {
    const int count = static_cast<int>(tuples.size());
    masks_.assign(lanes, R(1));
    for (int begin = 0; begin < count;) {
      // Where the batch before ends or, if that leaves it too empty, at the next tuple.
      Batch batch;
      bool found = false;
      if (!batches_.empty() && batches_.back().gather_row < 0) {
        for (int c = 0; c < Columns; ++c) batch.first[c] = batches_.back().first[c] + lanes;
        found = fill(batch, tuples, begin);
      }
      if (!found) {
        batch.first = tuples[begin];
        found = fill(batch, tuples, begin);
      }
      if (!found) {
        const int some = minimum(lanes, count - begin);
        batch.held = all_lanes >> (lanes - some);
        batch.gather_row = static_cast<int>(table_.size()) / (Columns * lanes);
        for (int c = 0; c < Columns; ++c)
          for (int l = 0; l < lanes; ++l) table_.push_back(tuples[begin + minimum(l, some - 1)][c]);
      }
      batch.first_tuple = begin;
      if (!batch.is_full()) {
        batch.mask_row = static_cast<int>(masks_.size()) / lanes;
        for (int l = 0; l < lanes; ++l) masks_.push_back(batch.holds(l) ? R(1) : R(0));
      }
      begin += std::popcount(batch.held);
      batches_.push_back(batch);
    }
    arrange({});
  }

  /// Largest difference of two node numbers in one batch, idle lanes before its last tuple included:
  /// their nodes get zeros.
  [[nodiscard]] int bandwidth() const {
    int widest = 0;
    for (int b = 0; b < size(); ++b) {
      int low = (std::numeric_limits<int>::max)(), high = 0;
      for (int c = 0; c < Columns; ++c)
        for (int lane = 0; lane < batches_[b].length(); ++lane) {
          low = minimum(low, node(b, c, lane));
          high = maximum(high, node(b, c, lane));
        }
      widest = maximum(widest, high - low);
    }
    return widest;
  }

  /// Sorts the batches by stage, the highest level of nodes that one touches, and gathers them into
  /// runs, tag [S-3].
  /// @param level_start first node of every level and the end; empty: one level
  void arrange(const std::vector<int>& level_start) {
    const auto level = [&](int node) {
      if (level_start.empty()) return 0;
      return static_cast<int>(std::upper_bound(level_start.begin() + 1, level_start.end(), node) -
                              (level_start.begin() + 1));
    };
    const int levels = level_start.empty() ? 1 : static_cast<int>(level_start.size()) - 1;
    const auto stage = [&](int b) {
      int highest = 0;
      for (int c = 0; c < Columns; ++c)
        for (int lane = 0; lane < batches_[b].length(); ++lane)
          highest = maximum(highest, level(node(b, c, lane)));
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
        runs_.back().length = runs_.back().batches * lanes + batches_[b].length();
        ++runs_.back().batches;
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

  /// Tuple in a lane; idle lanes repeat one of their batch.
  [[nodiscard]] int tuple(int b, int lane) const {
    const std::uint32_t up_to_lane = ~std::uint32_t(0) >> (31 - lane);
    return batches_[b].first_tuple + maximum(std::popcount(batches_[b].held & up_to_lane) - 1, 0);
  }

  /// Node of a column in a lane up to the last that holds a tuple.
  [[nodiscard]] int node(int b, int column, int lane) const {
    const Batch& batch = batches_[b];
    return batch.gather_row < 0 ? batch.first[column] + lane : row(batch, column)[lane];
  }

  /// Lanes that hold a tuple.
  [[nodiscard]] CROSSBEAM_INLINE auto active(const Batch& batch) const {
    return T::load(masks_.data() + static_cast<std::ptrdiff_t>(batch.mask_row) * lanes) > T(R(0));
  }

  /// @tparam U pack of the array's precision
  template <class U = T>
  [[nodiscard]] Vec3<U> gather(const NodeVectors<real_t<U>>& a, const Batch& batch,
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

  /// Nodal vectors as the tuples of one run see them: in the nodes themselves, or gathered.
  /// @tparam U pack of their precision
  template <class U>
  struct View {
    const real_t<U>* component[3];
    std::array<std::ptrdiff_t, Columns> column;

    /// @param slot of lane 0
    CROSSBEAM_INLINE Vec3<U> load(int k, std::ptrdiff_t slot) const {
      const std::ptrdiff_t at = column[k] + slot;
      return {U::load(component[0] + at), U::load(component[1] + at), U::load(component[2] + at)};
    }
    CROSSBEAM_INLINE void load_all(std::ptrdiff_t slot, Vec3<U> (&out)[Columns]) const {
      unrolled<Columns>([&](auto k) CROSSBEAM_INLINE_LAMBDA { out[k] = load(k, slot); });
    }
  };
  template <class U>
  struct Gathered {
    alignas(64) real_t<U> number[3][Columns][run_capacity];
  };

  /// @param gathered holds the vectors where the run's nodes do not follow each other
  template <class U>
  [[nodiscard]] View<U> view(const NodeVectors<real_t<U>>& a, const Run& run,
                             Gathered<U>& gathered) const {
    View<U> out{{a.x.data(), a.y.data(), a.z.data()}, {}};
    if (run.contiguous) {
      for (int k = 0; k < Columns; ++k) out.column[k] = batches_[run.first_batch].first[k];
      return out;
    }
    for (int c = 0; c < 3; ++c) {
      const real_t<U>* from = out.component[c];
      out.component[c] = gathered.number[c][0];
      for (int i = 0; i < run.batches; ++i)
        for (int k = 0; k < Columns; ++k) {
          const int* n = row(batches_[run.first_batch + i], k);
          for (int l = 0; l < lanes; ++l) gathered.number[c][k][i * lanes + l] = from[n[l]];
        }
    }
    for (int k = 0; k < Columns; ++k) out.column[k] = k * run_capacity;
    return out;
  }

  /// First node of every column of a contiguous run.
  [[nodiscard]] const std::array<int, Columns>& first(const Run& run) const {
    return batches_[run.first_batch].first;
  }

  /// a[node] -= the vector of each tuple and column of a gathered run, one after the other in the order
  /// of the tuples.
  /// @param from(column, component) numbers of all tuples
  template <class From>
  void subtract_gathered(NodeVectors<R>& a, const Run& run, const From& from) const {
    R* const out[3] = {a.x.data(), a.y.data(), a.z.data()};
    for (int i = 0; i < run.batches; ++i) {
      const Batch& batch = batches_[run.first_batch + i];
      for (int k = 0; k < Columns; ++k) {
        const int* n = row(batch, k);
        for (int c = 0; c < 3; ++c) {
          const R* f = from(k, c) + i * lanes;
          for (int l = 0; l < batch.length(); ++l) out[c][n[l]] -= f[l];
        }
      }
    }
  }

 private:
  /// Puts tuples, from `begin` on, into lanes of a contiguous batch whose first nodes are given.
  /// @return whether it is worth it: from half the lanes on
  static bool fill(Batch& batch, const std::vector<std::array<int, Columns>>& tuples, int begin) {
    batch.held = 0;
    for (std::size_t k = static_cast<std::size_t>(begin); k < tuples.size(); ++k) {
      const int lane = tuples[k][0] - batch.first[0];
      if (lane < batch.length() || lane >= lanes) break;
      bool fits = true;
      for (int c = 1; c < Columns; ++c) fits = fits && tuples[k][c] - batch.first[c] == lane;
      if (!fits) break;
      batch.held |= std::uint32_t(1) << lane;
    }
    return 2 * std::popcount(batch.held) >= lanes;
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
    for (int c = 0; c < Columns; ++c)
      if (batch.first[c] != last.first[c] + lanes) return false;
    return true;
  }

  [[nodiscard]] Run new_run(int b) const {
    Run run;
    run.first_batch = b;
    run.contiguous = batches_[b].gather_row < 0;
    const auto& first = batches_[b].first;
    for (int c = 0; c < Columns; ++c) {  // sorted by insertion: there are few
      int k = c;
      for (; k > 0 && first[run.column[k - 1]] > first[c]; --k) run.column[k] = run.column[k - 1];
      run.column[k] = static_cast<std::uint8_t>(c);
    }
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
  AlignedArray<R> masks_;  // one row of ones; the rows of batches that are not full
  std::vector<Run> runs_;
  std::vector<int> stage_runs_;  // first run of every stage, and their count
};

}  // namespace crossbeam
