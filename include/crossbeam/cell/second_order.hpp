#pragma once
/// @file
/// The cell as the paper prints it (Eq. 24-25): second-order theory on the unstressed geometry,
/// where K = K_E + K_G(F_warp, F_weft) is iterated. It has no potential, and its iteration diverges
/// for yarns shortened by some per cent; such answers carry a status and the energy cell's forces
/// instead. Theory, region of divergence and defects: docs/theory/cell.md, [C-11].

#include "crossbeam/cell/crossed_beam.hpp"

namespace crossbeam {

template <class R>
class SecondOrderCell {
 public:
  using Real = R;

  /// @param string_factor kappa of K_G: 1 string, 6/5 consistent beam matrix
  /// @throws InputError (validate).
  explicit SecondOrderCell(const CellParameters<R>& parameters, R string_factor = R(1))
      : fallback_(parameters), kappa_(require_positive("cell.string_factor", string_factor, "-")) {}

  [[nodiscard]] const CellParameters<R>& parameters() const { return fallback_.parameters(); }

  template <class T>
  struct Solution {
    CellForces<T> forces{};
    CellStatus status = CellStatus::converged;  ///< the worst over the lanes
    int iterations = 0;
    T fallback{};  ///< 1 where the energy cell had to answer, else 0
  };

  /// Fixed point of Eq. 25 with K_hh checked for positive definiteness and the heights for staying
  /// within the cell; where it fails, the answer of the energy cell, marked by `fallback` and
  /// `status`.
  /// @param control of the energy cell, where it has to answer
  template <class T>
  CROSSBEAM_HOST_DEVICE Solution<T> solve(
      const T& u1, const T& u2, SolverControl control = SolverControl::converged()) const {
    static_assert(ScalarTraits<T>::derivative_order == 0,
                  "the second-order cell has no potential and no differentiable solver");
    Solution<T> solution;
    CellForces<T>& out = solution.forces;
    const YarnConstants<R>&y1 = fallback_.warp(), &y2 = fallback_.weft();
    const T k3(fallback_.contact_stiffness());
    const R L3 = fallback_.parameters().contact_length;
    const T tolerance = T(R(8) * std::numeric_limits<R>::epsilon()) *
                        (T(y1.ka) * magnitude(u1) + T(y2.ka) * magnitude(u2));
    decltype(u1 == u1) stable{}, converged{};
    for (int k = 1; k <= cell_constants::most_sweeps; ++k) {
      const Stiffness<T> a(y1, T(kappa_) * out.F1), b(y2, T(kappa_) * out.F2);
      const T det = a.hh * b.hh + k3 * (a.hh + b.hh);
      const T r1 = a.Lh * u1, r2 = b.Lh * u2;
      out.w1 = (k3 * r2 - (b.hh + k3) * r1) / det;
      out.w2 = (k3 * r1 - (a.hh + k3) * r2) / det;
      // Short of det = 0 the heights grow without bound: they must stay within the cell's own.
      stable = (det > T(0)) && (a.hh + k3 > T(0)) && (magnitude(out.w1) < T(L3)) &&
               (magnitude(out.w2) < T(L3));
      out.q = -(k3 * (out.w1 + out.w2));
      const T F1 = a.LL * u1 + a.Lh * out.w1, F2 = b.LL * u2 + b.Lh * out.w2;
      converged = (magnitude(F1 - out.F1) <= tolerance) && (magnitude(F2 - out.F2) <= tolerance);
      out.F1 = F1;
      out.F2 = F2;
      solution.iterations = k;
      if (all(converged)) break;
    }
    const T most(fallback_.largest_elongation());
    const auto within = (u1 > T(-y1.L)) && (u2 > T(-y2.L)) && (u1 < most) && (u2 < most);
    const auto good = converged && stable && within;
    if (!all(good)) {
      const auto energy = fallback_.solve(u1, u2, control);
      const auto choose = [&](const T& a, const T& b) { return select(good, a, b); };
      out = {choose(out.F1, energy.forces.F1), choose(out.F2, energy.forces.F2),
             choose(out.w1, energy.forces.w1), choose(out.w2, energy.forces.w2),
             choose(out.q, energy.forces.q)};
      solution.fallback = select(good, T(0), T(1));
      solution.status = !all(within)  ? CellStatus::outside_kinematics
                        : all(stable) ? CellStatus::not_converged
                                      : CellStatus::unstable;
    }
    return solution;
  }

  /// See CrossedBeamCell; the second-order cell adds F/l0 to the taut stiffness in the same way.
  [[nodiscard]] R membrane_stiffness_bound(R sine = R(1)) const {
    return fallback_.membrane_stiffness_bound(sine);
  }

 private:
  /// K_E + K_G of one yarn in (u, w); S = kappa F.
  template <class T>
  struct Stiffness {
    T LL, Lh, hh;
    CROSSBEAM_INLINE Stiffness(const YarnConstants<R>& y, const T& S) {
      const T bending = T(y.kb) + S * T(R(1) / y.l0);
      LL = T(y.ka * y.c0 * y.c0) + bending * T(y.s0 * y.s0);
      Lh = (T(y.ka) - bending) * T(y.s0 * y.c0);
      hh = T(y.ka * y.s0 * y.s0) + bending * T(y.c0 * y.c0);
    }
  };

  CrossedBeamCell<R> fallback_;
  R kappa_;
};

}  // namespace crossbeam
