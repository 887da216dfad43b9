#pragma once
/// @file
/// Fixed-size Eigen names of the public interface and the Voigt map of the membrane.
///
/// Voigt order is (11, 22, 12). A strain carries 2 E12 in the third place, a stress S12, so that
/// their product is the work.

#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>

namespace crossbeam {

/// Unaligned and by columns whatever the compiler's flags and Eigen's macros say: files that are
/// compiled for different processors then agree about every struct that holds one
/// (docs/embedding.md).
template <class T, int Rows, int Columns>
using FixedMatrix = Eigen::Matrix<T, Rows, Columns, Eigen::ColMajor | Eigen::DontAlign>;
template <class T>
using Vector2 = FixedMatrix<T, 2, 1>;
template <class T>
using Vector3 = FixedMatrix<T, 3, 1>;
template <class T>
using Matrix2 = FixedMatrix<T, 2, 2>;
template <class T>
using Matrix3 = FixedMatrix<T, 3, 3>;
/// Two spatial vectors side by side: columns are base vectors.
template <class T>
using Base = FixedMatrix<T, 3, 2>;

/// (E11, E22, 2 E12) of a symmetric strain tensor.
template <class T>
Vector3<T> strain_to_voigt(const Matrix2<T>& E) {
  return {E(0, 0), E(1, 1), E(0, 1) + E(1, 0)};
}

}  // namespace crossbeam
