#pragma once
/// @file
/// The energy-consistent crossed-beam cell: two crimped yarns with exact kinematics are joined by a
/// contact beam that presses but does not pull (unilateral, the default) or does both (bilateral,
/// the paper's literal beam 3, with a status because it has no unique solution in compression).
/// Theory, theorems and their proofs: docs/theory/cell.md. The source is section 4.1 of the paper;
/// the energy is our completion of it.
///
/// Units (any consistent set): force kN, length mm, energy kN mm, stiffness kN/mm.
/// Sign: w1, w2 are the increments of the yarns' crimp heights; the paper's u3 = w1, u4 = -w2.

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/cell/parameters.hpp"
#include "crossbeam/cell/yarn.hpp"

#include <cmath>
#include <concepts>
#include <utility>

namespace crossbeam {

/// Numbers of the cell's solver that no theory fixes.
namespace cell_constants {

/// Least slope of a vertical force by its height, over ka [-], where a cell is followed, [C-14],
/// and where the start shares out the gap, [C-5]. A slack yarn without bending has the slope zero:
/// its height has lost its spring and would move without bound. A larger number slows the heights
/// of slack yarns down, a smaller one leaves the correction to `largest_height_step`.
inline constexpr double least_slope = 1e-6;

/// Least slope of a vertical force by its height, over ka [-], in a Newton sweep, [C-4]. It keeps
/// the quotient defined where a straight yarn without bending has the slope zero; it lies at the
/// rounding of ka, so that it changes no other state. The fixed point does not depend on it.
inline constexpr double least_sweep_slope = 1e-14;

/// Largest step of a followed height, over L3 [-], [C-14]. At the time steps of a drape heights
/// move by 1e-4 of that; a cell that is struck harder is off for some steps instead of leaving its
/// branch.
inline constexpr double largest_height_step = 0.125;

/// Newton sweeps before a cell says not_converged [-]. Random fabrics need ten at most (V-CELL-11);
/// a larger limit only delays the answer of cells that have none.
inline constexpr int most_sweeps = 50;

}  // namespace cell_constants

enum class CellStatus {
  converged,
  not_converged,       ///< the iteration did not reach its tolerance
  unstable,            ///< the branch that was traced has no stable equilibrium (bilateral, second
                       ///< order)
  outside_kinematics,  ///< a yarn is shortened to nothing or drawn out beyond all numbers, or the
                       ///< input is NaN
};

/// What a cell answers to the elongations (u1, u2) of its yarns.
template <class T>
struct CellForces {
  T F1{}, F2{};  ///< forces on the master nodes N1 (warp), N2 (weft); F_i = dU/du_i
  T w1{}, w2{};  ///< crimp height increments
  T q{};         ///< contact force, compression positive
};

/// Condensed tangent dF_i/du_j; symmetric for the energy cells.
template <class T>
struct CellTangent {
  T K11{}, K12{}, K22{};
};

/// The forces alone.
template <class T>
struct YarnForces {
  T F1, F2;
};

/// What following a cell needs of one yarn at its last height, tag [C-14].
template <class T>
struct FollowedYarn {
  T g, D;     ///< vertical force and its derivative by the height
  T F, k_Lh;  ///< horizontal force and its derivative by the height
};

/// Increments of the two crimp heights that a cell remembers from one time step to the next [mm].
template <class T>
struct CrimpHeights {
  T w1{}, w2{};
};

/// How far the equilibrium is iterated.
struct SolverControl {
  static constexpr int until_converged = 0;

  int sweeps = until_converged;  ///< exactly that many Newton sweeps without a test, or
                                 ///< until_converged
  static constexpr SolverControl converged() { return {until_converged}; }
  static constexpr SolverControl fixed(int n) { return {n}; }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE constexpr bool is_fixed() const {
    return sweeps != until_converged;
  }
};

/// One yarn's constants, derived once. R is a plain real type, Law its axial law.
template <class R, class Law = LinearYarn>
struct YarnConstants {
  [[no_unique_address]] Law law{};
  R ka, kb;    ///< axial EA/l0 and bending kbc EI/l0^3 stiffness [kN/mm], tag [C-2]
  R L, H, l0;  ///< projected length, crimp height, chord length in the unstressed cell [mm]
  R c0, s0;    ///< cosine and sine of the crimp angle
  R least_start_squared;  ///< least height of a start, squared [mm^2], tag [C-5]
  R kb_c0, kb_s0;         ///< products that the forces need
  R kb_cc, kb_ss, kb_sc;  ///< and the tangents
  R follow_floor;         ///< least slope of a followed height [kN/mm]

  YarnConstants() = default;
  YarnConstants(const YarnParameters<R>& yarn, R height, R boundary_factor, Law axial_law)
      : law(std::move(axial_law)) {
    using std::cbrt;
    using std::sqrt;
    L = yarn.length;
    H = height;
    l0 = sqrt(L * L + H * H);
    c0 = L / l0;
    s0 = H / l0;
    ka = yarn.youngs_modulus * yarn.cross_section / l0;
    kb = boundary_factor * yarn.youngs_modulus * yarn.second_moment_of_area / (l0 * l0 * l0);
    const R least = cbrt(R(2) * l0 * l0 * (kb / ka) * c0 * c0 * H) / R(2);
    least_start_squared = least * least;
    kb_c0 = kb * c0;
    kb_s0 = kb * s0;
    kb_cc = kb * c0 * c0;
    kb_ss = kb * s0 * s0;
    kb_sc = kb * s0 * c0;
    follow_floor = R(cell_constants::least_slope) * ka;
  }
};

/// One yarn at elongation u and height increment w, tag [C-3]. All derivatives of its energy.
template <class T>
struct YarnState {
  T e, t;      ///< chord elongation, transverse displacement
  T c, s;      ///< current cosine and sine
  T N;         ///< axial force
  T k;         ///< axial stiffness dN/de
  T N_over_l;  ///< string stiffness

  template <class Yarn>
  CROSSBEAM_INLINE YarnState(const Yarn& y, const T& u, const T& w) {
    using std::sqrt;
    const T Lc = T(y.L) + u, h = T(y.H) + w;
    const T l = sqrt(Lc * Lc + h * h), sum = l + T(y.l0);
    const T both = T(1) / (l * sum);  // one division for 1/l and 1/(l + l0)
    const T inv_l = both * sum;
    e = (u * (T(y.L) + Lc) + w * (T(y.H) + h)) * (both * l);
    t = T(y.c0) * w - T(y.s0) * u;
    c = Lc * inv_l;
    s = h * inv_l;
    N = T(y.ka) * y.law.tension(e, T(y.l0));
    k = T(y.ka) * y.law.modulus(e, T(y.l0));
    N_over_l = N * inv_l;
  }

  template <class Yarn>
  CROSSBEAM_INLINE T energy(const Yarn& y) const {
    return T(y.ka) * y.law.energy(e, T(y.l0)) + T(0.5) * T(y.kb) * t * t;
  }
  template <class Yarn>
  CROSSBEAM_INLINE T horizontal_force(const Yarn& y) const {
    return N * c - T(y.kb_s0) * t;
  }
  template <class Yarn>
  CROSSBEAM_INLINE T vertical_force(const Yarn& y) const {
    return N * s + T(y.kb_c0) * t;
  }
  template <class Yarn>
  CROSSBEAM_INLINE T k_hh(const Yarn& y) const {
    return k * s * s + N_over_l * c * c + T(y.kb_cc);
  }
  template <class Yarn>
  CROSSBEAM_INLINE T k_LL(const Yarn& y) const {
    return k * c * c + N_over_l * s * s + T(y.kb_ss);
  }
  template <class Yarn>
  CROSSBEAM_INLINE T k_Lh(const Yarn& y) const {
    return (k - N_over_l) * c * s - T(y.kb_sc);
  }
};

/// A cell: answers the elongations (u1, u2) of its yarns with their forces. With members `energy`
/// and `tangent` as CrossedBeamCell's it has a potential, which a law then shows; without them it
/// says in `fallback` of its solution whether another cell had to answer.
template <class C, class T>
concept UnitCell = requires(const C& cell, const T& u, SolverControl control) {
  typename C::Real;
  typename C::template Solution<T>;
  { cell.parameters() } -> std::convertible_to<CellParameters<typename C::Real>>;
  { cell.solve(u, u, control) } -> std::same_as<typename C::template Solution<T>>;
  { cell.solve(u, u, control).forces } -> std::convertible_to<CellForces<T>>;
  { cell.solve(u, u, control).status } -> std::convertible_to<CellStatus>;
  { cell.membrane_stiffness_bound(typename C::Real()) } -> std::convertible_to<typename C::Real>;
};

/// A cell whose heights explicit dynamics can follow from step to step, tag [C-14].
template <class C, class T>
concept FollowedCell =
    UnitCell<C, T> &&
    requires(const C& cell, const T& u, const FollowedYarn<T>& y, CrimpHeights<T>& heights) {
      { cell.evaluate_yarn(cell.warp(), u, u) } -> std::same_as<FollowedYarn<T>>;
      { cell.evaluate_yarn(cell.weft(), u, u) } -> std::same_as<FollowedYarn<T>>;
      { cell.follow(u, u, y, y, heights) } -> std::same_as<YarnForces<T>>;
    };

enum class Contact { unilateral, bilateral };

/// The energy cell. Stateless: an answer depends on (u1, u2) alone.
/// @tparam Law axial law of both yarns, see YarnLaw
template <class R, Contact ContactKind = Contact::unilateral, class Law = LinearYarn>
  requires YarnLaw<Law, R>
class CrossedBeamCell {
 public:
  using Real = R;
  using Yarn = YarnConstants<R, Law>;

  /// @param warp, weft axial laws
  /// @throws InputError (validate).
  explicit CrossedBeamCell(const CellParameters<R>& parameters, Law warp = {}, Law weft = {})
      : parameters_(parameters) {
    validate(parameters);
    const R H1 = parameters.warp_height_fraction * parameters.contact_length;
    yarn1_ = Yarn(parameters.warp, H1, parameters.bending_boundary_factor, std::move(warp));
    yarn2_ = Yarn(parameters.weft, parameters.contact_length - H1,
                  parameters.bending_boundary_factor, std::move(weft));
    k3_ = parameters.contact_modulus * parameters.contact_area / parameters.contact_length;
    follow_limit_ = R(cell_constants::largest_height_step) * parameters.contact_length;
    largest_elongation_ = CellRange<R>(parameters).largest_elongation();
    has_bending_ = yarn1_.kb > R(0) || yarn2_.kb > R(0);
  }

  [[nodiscard]] CROSSBEAM_HOST_DEVICE const CellParameters<R>& parameters() const {
    return parameters_;
  }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE const Yarn& warp() const { return yarn1_; }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE const Yarn& weft() const { return yarn2_; }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE R contact_stiffness() const { return k3_; }
  /// Elongations from -L up to this one have an answer, tag [C-12].
  [[nodiscard]] CROSSBEAM_HOST_DEVICE R largest_elongation() const { return largest_elongation_; }

  /// A cell in equilibrium; its energy and tangent are computed only when asked for.
  template <class T>
  struct Solution {
    CellForces<T> forces{};
    CellStatus status = CellStatus::converged;
    int sweeps = 0;         ///< Newton sweeps spent
    T last_correction{};    ///< max |dw| of the last sweep: the error is of its square [mm]
    T contact_stiffness{};  ///< B of [C-6]: k3 where the contact is closed, else 0
  };

  /// Finds the equilibrium for elongations u_i > -L_i.
  /// Iterated until converged, it answers with the status not_converged or outside_kinematics where
  /// there is no right answer; with a fixed number of sweeps that check is the caller's
  /// (docs/theory/cell.md, error table).
  /// With dual numbers the iteration runs on plain values and the derivatives come from final
  /// sweeps in the dual numbers, tag [C-7].
  template <class T>
  CROSSBEAM_INLINE Solution<T> solve(const T& u1, const T& u2,
                                     SolverControl control = SolverControl::converged()) const {
    if constexpr (ScalarTraits<T>::derivative_order > 0) {
      const auto plain = solve(passive(u1), passive(u2), control);
      T w1(plain.forces.w1), w2(plain.forces.w2);
      Solution<T> solution;
      for (int k = 0; k < ScalarTraits<T>::derivative_order; ++k)
        sweep(u1, u2, w1, w2, solution.forces.q, solution.contact_stiffness);
      finish(u1, u2, w1, w2, solution);
      solution.status = plain.status;
      solution.sweeps = plain.sweeps;
      return solution;
    } else {
      Solution<T> solution;
      T w1, w2;
      if constexpr (ContactKind == Contact::unilateral) {
        if (start(u1, u2, w1, w2)) {  // every lane slack and no bending: nothing to iterate
          finish(u1, u2, w1, w2, solution);
          if (!control.is_fixed()) judge(u1, u2, solution);
          return solution;
        }
      } else {
        w1 = T(0);
        w2 = T(0);
      }
      if (control.is_fixed()) {
        for (int k = 0; k < control.sweeps; ++k)
          solution.last_correction =
              sweep(u1, u2, w1, w2, solution.forces.q, solution.contact_stiffness);
        solution.sweeps = control.sweeps;
      } else {
        iterate(u1, u2, w1, w2, solution);
      }
      finish(u1, u2, w1, w2, solution);
      if (!control.is_fixed()) judge(u1, u2, solution);
      return solution;
    }
  }

  /// @name Following the heights from one time step to the next, tag [C-14] The residual is
  /// evaluated once, at the given heights; the forces are linearised to the heights of the
  /// equilibrium, which replace the given ones. The error is of second order in the correction. The
  /// given heights are those of a nearby strain, at first those of solve(). There are two parts, so
  /// that each makes a short loop.
  /// @{
  template <class T>
  CROSSBEAM_INLINE static FollowedYarn<T> evaluate_yarn(const Yarn& yarn, const T& u, const T& w) {
    const YarnState<T> y(yarn, u, w);
    return {y.vertical_force(yarn), maximum(y.k_hh(yarn), T(yarn.follow_floor)),
            y.horizontal_force(yarn), y.k_Lh(yarn)};
  }
  template <class T>
  CROSSBEAM_INLINE YarnForces<T> follow(const T& u1, const T& u2, const FollowedYarn<T>& y1,
                                        const FollowedYarn<T>& y2, CrimpHeights<T>& heights) const
    requires(ContactKind == Contact::unilateral && ScalarTraits<T>::derivative_order == 0)
  {
    const T D12 = y1.D * y2.D, k3 = T(k3_), closed = D12 + k3 * (y1.D + y2.D);
    const T both = T(1) / (closed * D12);  // one division for 1/closed and 1/D12
    const T q = maximum(
        k3 * ((y1.g - heights.w1 * y1.D) * y2.D + (y2.g - heights.w2 * y2.D) * y1.D) * (both * D12),
        T(0));
    const T r = both * closed, most = T(follow_limit_);
    const T dw1 = maximum(minimum((q - y1.g) * (y2.D * r), most), -most);
    const T dw2 = maximum(minimum((q - y2.g) * (y1.D * r), most), -most);
    heights.w1 = heights.w1 + dw1;
    heights.w2 = heights.w2 + dw2;
    YarnForces<T> out{y1.F + y1.k_Lh * dw1, y2.F + y2.k_Lh * dw2};
    if (!has_bending_) slack_without_bending(u1, u2, heights, out);
    add_residual(u1, u2, out.F1, out.F2);
    return out;
  }
  /// Does both parts at once.
  template <class T>
  CROSSBEAM_INLINE YarnForces<T> follow(const T& u1, const T& u2, CrimpHeights<T>& heights) const
    requires(ContactKind == Contact::unilateral && ScalarTraits<T>::derivative_order == 0)
  {
    return follow(u1, u2, evaluate_yarn(yarn1_, u1, heights.w1),
                  evaluate_yarn(yarn2_, u2, heights.w2), heights);
  }
  /// @}

  /// Stored energy of the cell at a solution, tag [C-3].
  template <class T>
  CROSSBEAM_INLINE T energy(const T& u1, const T& u2, const Solution<T>& at) const {
    const YarnState<T> y1(yarn1_, u1, at.forces.w1), y2(yarn2_, u2, at.forces.w2);
    const T q = at.forces.q;
    return y1.energy(yarn1_) + y2.energy(yarn2_) + q * q / T(R(2) * k3_) + residual_energy(u1) +
           residual_energy(u2);
  }

  /// Condensed tangent at a solution, tag [C-6]. A contact that just touches counts as closed.
  template <class T>
  CROSSBEAM_INLINE CellTangent<T> tangent(const T& u1, const T& u2, const Solution<T>& at) const {
    const YarnState<T> y1(yarn1_, u1, at.forces.w1), y2(yarn2_, u2, at.forces.w2);
    const T h1 = y1.k_hh(yarn1_), h2 = y2.k_hh(yarn2_);
    const T m1 = y1.k_Lh(yarn1_), m2 = y2.k_Lh(yarn2_);
    const T B = at.contact_stiffness;
    T det = h1 * h2 + B * (h1 + h2);
    // A straight yarn without bending has k_hh = 0 and k_Lh = 0 while the contact is open. (The
    // bilateral contact is never open, and det < 0 is the honest answer where it is unstable.)
    if constexpr (ContactKind == Contact::unilateral)
      det = maximum(det, T((std::numeric_limits<R>::min)()));
    const T inv = T(1) / det;
    const T zero(0);
    return {y1.k_LL(yarn1_) - m1 * m1 * (h2 + B) * inv + select(u1 < zero, T(kres()), zero),
            m1 * m2 * B * inv,
            y2.k_LL(yarn2_) - m2 * m2 * (h1 + B) * inv + select(u2 < zero, T(kres()), zero)};
  }

  /// Upper bound of the eigenvalues of dP/dlambda, the membrane tangent per unit width [kN/mm],
  /// at taut yarns of moderate tension, tag [C-10]. Constant: no step has to look at the state.
  /// @param sine sine of the reference angle between the yarns
  [[nodiscard]] R membrane_stiffness_bound(R sine = R(1)) const {
    const R A0 = R(parameters_.symmetry) * yarn1_.L * yarn2_.L * sine;
    const auto bound = [&](const Yarn& y) {
      return (y.ka * R(y.law.modulus_bound()) + kres()) * y.L * y.L / A0;
    };
    return maximum(bound(yarn1_), bound(yarn2_));
  }

 private:
  [[nodiscard]] CROSSBEAM_INLINE R kres() const {
    return parameters_.residual_compression_stiffness;
  }

  template <class T>
  CROSSBEAM_INLINE T residual_energy(const T& u) const {
    const T shortening = minimum(u, T(0));
    return T(R(0.5) * kres()) * shortening * shortening;
  }

  /// l0^2 - (L + u)^2, the square of the height at which the yarn is as long as unstressed [mm^2].
  /// It is negative when even the straight yarn is stretched.
  template <class T>
  CROSSBEAM_INLINE static T spare_height_squared(const Yarn& y, const T& u) {
    return T(y.H * y.H) - u * (T(R(2) * y.L) + u);
  }

  /// Closed-form start on the convex branch, tag [C-5].
  /// @return true when nothing has to be iterated
  template <class T>
  CROSSBEAM_INLINE bool start(const T& u1, const T& u2, T& w1, T& w2) const {
    using std::sqrt;
    const T a1 = spare_height_squared(yarn1_, u1), a2 = spare_height_squared(yarn2_, u2);
    const T hs1 = sqrt(maximum(a1, T(yarn1_.least_start_squared)));
    const T hs2 = sqrt(maximum(a2, T(yarn2_.least_start_squared)));
    const T spare = hs1 + hs2 - T(yarn1_.H + yarn2_.H);
    const T gap = maximum(-spare, T(0));
    const T x1 = hs1 + T(0.5) * gap, x2 = hs2 + T(0.5) * gap;
    const T k1 = maximum(T(yarn1_.ka / (yarn1_.l0 * yarn1_.l0)) * (T(1.5) * x1 * x1 - T(0.5) * a1),
                         T(R(cell_constants::least_slope) * yarn1_.ka));
    const T k2 = maximum(T(yarn2_.ka / (yarn2_.l0 * yarn2_.l0)) * (T(1.5) * x2 * x2 - T(0.5) * a2),
                         T(R(cell_constants::least_slope) * yarn2_.ka));
    const T f = k2 / (k1 + k2);
    w1 = hs1 + f * gap - T(yarn1_.H);
    w2 = hs2 + (T(1) - f) * gap - T(yarn2_.H);
    // Strictly slack: yarns that just touch are closed, so that the virgin tangent is the taut one.
    // A yarn that even straight is stretched starts, and is, at height zero.
    return !has_bending_ && all(spare > T(0));
  }

  /// One Newton sweep on {g1 = q, g2 = q, w1 + w2 + q/k3 = 0} with q >= 0 for the unilateral
  /// contact, tag [C-4]. Returns max |dw|.
  template <class T>
  CROSSBEAM_INLINE T sweep(const T& u1, const T& u2, T& w1, T& w2, T& q, T& B) const {
    const YarnState<T> y1(yarn1_, u1, w1), y2(yarn2_, u2, w2);
    const T g1 = y1.vertical_force(yarn1_), g2 = y2.vertical_force(yarn2_);
    T D1 = y1.k_hh(yarn1_), D2 = y2.k_hh(yarn2_);
    if constexpr (ContactKind == Contact::unilateral) {
      D1 = maximum(D1, T(R(cell_constants::least_sweep_slope) * yarn1_.ka));
      D2 = maximum(D2, T(R(cell_constants::least_sweep_slope) * yarn2_.ka));
    }
    const T D12 = D1 * D2, k3 = T(k3_);
    q = k3 * ((g1 - w1 * D1) * D2 + (g2 - w2 * D2) * D1) / (D12 + k3 * (D1 + D2));
    B = k3;
    if constexpr (ContactKind == Contact::unilateral) {
      B = select(q < T(0), T(0), k3);
      q = maximum(q, T(0));
    }
    const T r = T(1) / D12;
    const T dw1 = (q - g1) * (D2 * r);
    const T dw2 = (q - g2) * (D1 * r);
    w1 = w1 + dw1;
    w2 = w2 + dw2;
    return maximum(magnitude(dw1), magnitude(dw2));
  }

  template <class T>
  CROSSBEAM_HOST_DEVICE void iterate(const T& u1, const T& u2, T& w1, T& w2,
                                     Solution<T>& solution) const {
    using std::sqrt;
    const R eps = std::numeric_limits<R>::epsilon();
    // The last correction is squared by the quadratic convergence: eps^(3/4) leaves eps^(3/2).
    const R tolerance = parameters_.contact_length * sqrt(eps) * sqrt(sqrt(eps));
    for (int k = 1; k <= cell_constants::most_sweeps; ++k) {
      solution.last_correction =
          sweep(u1, u2, w1, w2, solution.forces.q, solution.contact_stiffness);
      solution.sweeps = k;
      if (all(solution.last_correction <= T(tolerance))) return;
    }
    solution.status = CellStatus::not_converged;
  }

  template <class T>
  CROSSBEAM_INLINE void finish(const T& u1, const T& u2, const T& w1, const T& w2,
                               Solution<T>& solution) const {
    const YarnState<T> y1(yarn1_, u1, w1), y2(yarn2_, u2, w2);
    CellForces<T>& out = solution.forces;
    out.F1 = y1.horizontal_force(yarn1_);
    out.F2 = y2.horizontal_force(yarn2_);
    if (ContactKind == Contact::unilateral && !has_bending_) {
      // A crimped yarn without bending and without contact carries exactly nothing: the closed
      // form, not the rounding of its length.
      const auto open = solution.contact_stiffness <= T(0);
      out.F1 = select(open && spare_height_squared(yarn1_, u1) > T(0), T(0), out.F1);
      out.F2 = select(open && spare_height_squared(yarn2_, u2) > T(0), T(0), out.F2);
    }
    add_residual(u1, u2, out.F1, out.F2);
    out.w1 = w1;
    out.w2 = w2;
  }

  template <class T>
  CROSSBEAM_INLINE void add_residual(const T& u1, const T& u2, T& F1, T& F2) const {
    if (kres() > R(0)) {
      F1 = F1 + T(kres()) * minimum(u1, T(0));
      F2 = F2 + T(kres()) * minimum(u2, T(0));
    }
  }

  /// Without bending the slack region has a closed form and a singular tangent: there the heights
  /// are those of the start [C-5] and a crimped yarn carries nothing.
  template <class T>
  CROSSBEAM_INLINE void slack_without_bending(const T& u1, const T& u2, CrimpHeights<T>& heights,
                                              YarnForces<T>& out) const {
    using std::sqrt;
    const T a1 = spare_height_squared(yarn1_, u1), a2 = spare_height_squared(yarn2_, u2);
    const T h1 = sqrt(maximum(a1, T(yarn1_.least_start_squared)));
    const T h2 = sqrt(maximum(a2, T(yarn2_.least_start_squared)));
    const auto slack = h1 + h2 > T(yarn1_.H + yarn2_.H);
    const auto idle1 = slack && a1 > T(0), idle2 = slack && a2 > T(0);
    heights.w1 = select(slack, h1 - T(yarn1_.H), heights.w1);
    heights.w2 = select(slack, h2 - T(yarn2_.H), heights.w2);
    out.F1 = select(idle1, T(0), out.F1);
    out.F2 = select(idle2, T(0), out.F2);
  }

  /// Status of a solution that was iterated to convergence.
  template <class T>
  CROSSBEAM_HOST_DEVICE void judge(const T& u1, const T& u2, Solution<T>& solution) const {
    const auto within = [this](const T& u, R L) {
      return all(u > T(-L)) && all(u < T(largest_elongation_));
    };
    if (!(within(u1, yarn1_.L) && within(u2, yarn2_.L))) {
      solution.status = CellStatus::outside_kinematics;
    } else if (ContactKind == Contact::bilateral && solution.status == CellStatus::converged) {
      const T D1 = YarnState<T>(yarn1_, u1, solution.forces.w1).k_hh(yarn1_);
      const T D2 = YarnState<T>(yarn2_, u2, solution.forces.w2).k_hh(yarn2_);
      const T k3 = T(k3_);
      if (!(all(D1 + k3 > T(0)) && all(D1 * D2 + k3 * (D1 + D2) > T(0))))
        solution.status = CellStatus::unstable;
    }
  }

  CellParameters<R> parameters_{};
  Yarn yarn1_{}, yarn2_{};
  R k3_{};
  R follow_limit_{};  ///< largest correction of a height in one `follow` [mm]
  R largest_elongation_{};
  bool has_bending_ = false;
};

/// The bilateral energy cell (E-B): the paper's literal beam 3, which also pulls. Several solutions
/// exist in compression; look at the status and fall back on the unilateral cell.
template <class R>
using BilateralCell = CrossedBeamCell<R, Contact::bilateral>;

}  // namespace crossbeam
