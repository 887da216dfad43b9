#pragma once
/// @file
/// The highest frequency of one membrane element on its share of the mass, in plain numbers.
/// Theory: docs/theory/dynamics.md, [D-3].

#include "crossbeam/element/coefficients.hpp"

#include <array>
#include <cmath>

namespace crossbeam {

namespace detail {

/// Largest eigenvalue of a symmetric matrix by Jacobi's rotations; NaN or infinite where an entry
/// is.
/// @param a the first `size` rows and columns; destroyed
inline double largest_eigenvalue(double (&a)[3][3], int size) {
  double norm = 0;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) norm += std::abs(a[i][j]);
  if (!std::isfinite(norm)) return norm;
  constexpr int most_sweeps = 20;  // four are enough: the convergence is quadratic
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double off_diagonal = 0;
    for (int p = 0; p < size; ++p)
      for (int q = p + 1; q < size; ++q) off_diagonal += std::abs(a[p][q]);
    if (off_diagonal <= 1e-17 * norm) break;
    for (int p = 0; p < size; ++p)
      for (int q = p + 1; q < size; ++q) {
        if (a[p][q] == 0) continue;
        // The smaller root t = tan of t^2 + 2 theta t = 1 takes a_pq to zero.
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1 / (std::abs(theta) + std::hypot(theta, 1)), theta);
        const double c = 1 / std::sqrt(1 + t * t), s = t * c;
        a[p][p] -= t * a[p][q];
        a[q][q] += t * a[p][q];
        a[p][q] = a[q][p] = 0;
        for (int k = 0; k < size; ++k) {
          if (k == p || k == q) continue;
          const double at_p = a[p][k], at_q = a[q][k];
          a[p][k] = a[k][p] = c * at_p - s * at_q;
          a[q][k] = a[k][q] = s * at_p + c * at_q;
        }
      }
  }
  double largest = a[0][0];
  for (int i = 1; i < size; ++i) largest = largest < a[i][i] ? a[i][i] : largest;
  return largest;
}

/// Largest eigenvalue of C Q C^T, that of L^T Q L with L L^T = C^T C.
/// @param Q symmetric; @param C row a is that of corner a
/// @param size rows of Q and columns of C, at most 3
inline double largest_eigenvalue_at_corners(const double (&Q)[3][3], const double (*C)[3],
                                            int corners, int size) {
  double L[3][3] = {}, S[3][3] = {};
  for (int i = 0; i < size; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int a = 0; a < corners; ++a) sum += C[a][i] * C[a][j];
      for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(sum) : sum / L[j][j];
    }
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j)
      for (int k = i; k < size; ++k)
        for (int n = j; n < size; ++n) S[i][j] += L[k][i] * Q[k][n] * L[n][j];
  return largest_eigenvalue(S, size);
}

}  // namespace detail

/// Largest squared frequency of one element [1/ms^2].
/// @param stiffness bound of the law's [kN/mm]; @param hourglass_modulus [kN/mm]
/// @param corner_mass lumped mass of each corner [kg]
template <class Element>
double element_omega_squared(const std::array<Vec3<double>, Element::corners>& X,
                             const FibreDirections<double>& fibres, double stiffness,
                             double hourglass_modulus, double corner_mass) {
  constexpr int K = Element::vectors;
  static_assert(K <= 3);
  // The element's stiffness in one direction of space is C Q C^T, with C the integers of
  // D_k = sum_a C_ak x_a.
  double C[Element::corners][3] = {}, Q[3][3] = {};
  for (int a = 0; a < Element::corners; ++a) {
    Vec3<double> x[Element::corners]{}, D[K];
    x[a].x = 1;
    Element::relative_vectors(x, D);
    for (int k = 0; k < K; ++k) C[a][k] = D[k].x;
  }
  for (const auto& p : Element::coefficients(X, fibres))
    for (int i = 0; i < K; ++i)
      for (int j = 0; j < K; ++j)
        Q[i][j] += p.weight * stiffness * (p.t1[i] * p.t1[j] + p.t2[i] * p.t2[j]);
  if constexpr (Element::has_hourglass) {
    const auto h = Element::hourglass(X);
    const double g[3] = {-h.p1, -h.p2, 1};
    for (int i = 0; i < K; ++i)
      for (int j = 0; j < K; ++j) Q[i][j] += hourglass_modulus * h.stiffness * g[i] * g[j];
  }
  return detail::largest_eigenvalue_at_corners(Q, C, Element::corners, K) / corner_mass;
}

}  // namespace crossbeam
