#pragma once
/// @file
/// Where blocks and tools put the entries of a model's consistent tangent, for implicit methods.
/// Theory: docs/theory/reference.md, [R-2].

#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>

#include <vector>

namespace crossbeam {

/// Entries of -df/dx [kN/mm] and -df/dv [kN ms/mm]. Row and column 3 n + i are component i of node
/// n; those of the free tools follow. Entries at the same place add up.
struct TangentEntries {
  struct Entry {
    int row, column;
    double value;
  };
  std::vector<Entry> stiffness, damping;
  bool with_damping = false;  ///< whether anybody wants the second list

  /// Adds a 3 x 3 block to one of the lists.
  template <class Derived>
  static void add(std::vector<Entry>& list, int row, int column,
                  const Eigen::MatrixBase<Derived>& block) {
    for (int i = 0; i < block.rows(); ++i)
      for (int j = 0; j < block.cols(); ++j) list.push_back({row + i, column + j, block(i, j)});
  }
};

}  // namespace crossbeam
