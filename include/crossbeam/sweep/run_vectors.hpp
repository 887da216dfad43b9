#pragma once
/// @file
/// The forces of one run of tuples on their way to the nodes. Theory: docs/theory/sweep.md.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/sweep/index_batches.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace crossbeam {

/// Vectors of the tuples of one run until its nodes get them, line by line: a node that several tuples
/// touch is then read and written once, and no load overtakes a store that it overlaps.
/// @tparam Vectors one for each column, or 1
template <int Vectors, int Columns, class T>
class RunVectors {
 public:
  using R = real_t<T>;
  using Batches = IndexBatches<Columns, T>;
  using Run = typename Batches::Run;
  static constexpr int lanes = lanes_v<T>;
  static_assert(Vectors == Columns || Vectors == 1);

  RunVectors() {
    for (auto& vector : number_)
      for (auto& component : vector) clear<front>(component);
  }

  /// @param slot of lane 0; idle lanes must hold zeros
  template <class U>
  CROSSBEAM_INLINE void put(int vector, std::ptrdiff_t slot, const Vec3<U>& v) {
    v.x.store(number_[vector][0] + front + slot);
    v.y.store(number_[vector][1] + front + slot);
    v.z.store(number_[vector][2] + front + slot);
  }
  /// Zeros in the other lanes.
  /// @param vectors the first ones; @param slot of lane 0
  template <class Mask>
  void keep(int vectors, std::ptrdiff_t slot, const Mask& active) {
    for (int k = 0; k < vectors; ++k)
      for (auto& component : number_[k]) {
        R* const at = component + front + slot;
        select(active, T::load(at), T(R(0))).store(at);
      }
  }

  /// a[node of column k] -= vector k.
  void subtract_from(NodeVectors<R>& a, const Batches& batches, const Run& run) {
    if (!run.contiguous)
      batches.subtract_gathered(a, run, [&](int k, int c) { return number_[k][c] + front; });
    else
      subtract_lines<false>(a, batches, run, {});
  }
  /// a[node of column k] -= weight[component][k] times the one vector.
  void subtract_from(NodeVectors<R>& a, const Batches& batches, const Run& run,
                     const std::array<R, Columns> (&weight)[3]) {
    subtract_lines<true>(a, batches, run, weight);
  }

 private:
  static constexpr int reach = Batches::reach;
  // Loads reach up to `reach` numbers before the first and a pack beyond the last.
  static constexpr int front = maximum(reach, lanes), back = maximum(reach, lanes) + lanes;
  static constexpr int size = front + Batches::run_capacity + back;

  template <int Count>
  CROSSBEAM_INLINE static void clear(R* from) {
    unrolled<Count / lanes>([&](auto i)
                                CROSSBEAM_INLINE_LAMBDA { T(R(0)).store(from + i * lanes); });
  }

  template <bool Weighted>
  void subtract_lines(NodeVectors<R>& a, const Batches& batches, const Run& run,
                      const std::array<R, Columns> (&weight)[3]) {
    const int end = front + run.batches * lanes;
    for (auto& vector : number_)
      for (auto& component : vector) clear<back>(component + end);
    const auto& first = batches.first(run);
    for (int line = 0, k = 0; line < run.lines; k = run.line_end[line++]) {
      R* const out[3] = {a.x.data(), a.y.data(), a.z.data()};
      const Line to{{out[0] + first[run.column[k]], out[1] + first[run.column[k]],
                     out[2] + first[run.column[k]]},
                    run.length + run.shift[run.line_end[line] - 1]};
      const int columns = run.line_end[line] - k;
      if (columns == 1)
        line_of<Weighted, 1>(to, run, k, 1, weight);
      else if (columns == 2)
        line_of<Weighted, 2>(to, run, k, 2, weight);
      else
        line_of<Weighted, Columns == 3 ? 3 : 0>(to, run, k, columns, weight);
    }
  }

  struct Line {
    R* component[3];
    int nodes;
  };

  /// @tparam Count columns of the line, or 0: `columns` of them
  template <bool Weighted, int Count>
  CROSSBEAM_INLINE void line_of(const Line& to, const Run& run, int begin, int columns,
                                const std::array<R, Columns> (&weight)[3]) const {
    constexpr int most = Count > 0 ? Count : Columns;
    const int many = Count > 0 ? Count : columns;
    const R* from[most] = {};
    T w[3][most];
    for (int k = 0; k < many; ++k) {
      const int column = run.column[begin + k];
      from[k] = number_[Vectors == 1 ? 0 : column][0] + front - run.shift[begin + k];
      if constexpr (Weighted)
        for (int c = 0; c < 3; ++c) w[c][k] = T(weight[c][column]);
    }
    R* const out[3] = {to.component[0], to.component[1], to.component[2]};
    const auto sum = [&](auto c, int i) CROSSBEAM_INLINE_LAMBDA {
      const auto term = [&](int k) CROSSBEAM_INLINE_LAMBDA {
        const T f = T::load(from[k] + c * size + i);
        if constexpr (Weighted)
          return w[c][k] * f;
        else
          return f;
      };
      T total = term(0);
      for (int k = 1; k < many; ++k) total = total + term(k);
      return total;
    };
    int i = 0;
    for (; i + lanes <= to.nodes; i += lanes)
      unrolled<3>([&](auto c) CROSSBEAM_INLINE_LAMBDA {
        (T::load(out[c] + i) - sum(c, i)).store(out[c] + i);
      });
    // The nodes behind may be another thread's: they are not even written with what they had.
    if (i < to.nodes)
      unrolled<3>([&](auto c) CROSSBEAM_INLINE_LAMBDA {
        const T last = sum(c, i);
        for (int lane = 0; lane < to.nodes - i; ++lane) out[c][i + lane] -= last[lane];
      });
  }

  alignas(64) R number_[Vectors][3][size];
};

}  // namespace crossbeam
