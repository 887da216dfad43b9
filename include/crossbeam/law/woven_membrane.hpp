#pragma once
/// @file
/// The woven membrane: unit cell + shear layer as one constitutive law of the membrane strain (paper,
/// section 3 and Eq. 26-27, with the corrections listed in docs/theory/law.md).
///
/// Strain measure: covariant Green-Lagrange strains in the fibre frame; work-conjugate stress: the
/// contravariant second Piola-Kirchhoff components m^{ab}, S = m^{ab} F_a (x) F_b, per unit width
/// [kN/mm, thickness 1].

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/cell/second_order.hpp"
#include "crossbeam/kinematics/convected.hpp"
#include "crossbeam/kinematics/fibre_frame.hpp"
#include "crossbeam/law/shear.hpp"

#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>

namespace crossbeam {

/// Eq. 15 divides a yarn's force by a width. Corrected: the width normal to the yarn,
/// L sin(delta_bar), which makes the law hyperelastic with the right energy. Literal: L, as printed.
enum class YarnWidth { corrected, literal };

/// Contravariant second Piola-Kirchhoff components in the fibre frame [kN/mm].
template <class T>
struct FibreStress {
  T m11{}, m22{}, m12{};
};

/// Whether explicit dynamics asks for an equilibrium of its own at every step, or follows the heights
/// of the cells from step to step, tag [C-14].
enum class CellPrice { equilibrium, followed };

/// @tparam Cell  CrossedBeamCell, SecondOrderCell or a UnitCell of one's own
/// @tparam Shear a shear layer; it is described without the fibre angle, which the law sets
template <class Cell, class Shear, CellPrice Price = CellPrice::equilibrium>
  requires UnitCell<Cell, typename Cell::Real> && ShearLaw<Shear, typename Cell::Real> &&
           (Price == CellPrice::equilibrium || FollowedCell<Cell, typename Cell::Real>)
class WovenMembrane {
 public:
  using Real = typename Cell::Real;
  using R = Real;
  static constexpr bool follows_heights = Price == CellPrice::followed;

  /// @param reference angle between the yarns in the reference state
  /// @param width selects the corrected or the literal Eq. 15
  /// @param control how the cell is iterated at every evaluation
  /// @throws InputError where the shear layer was given another angle before
  WovenMembrane(Cell cell, Shear shear, FibreAngle<R> reference = FibreAngle<R>::right(),
                YarnWidth width = YarnWidth::corrected,
                SolverControl control = SolverControl::converged())
      : cell_(std::move(cell)),
        shear_(between_yarns(std::move(shear), reference)),
        reference_(reference),
        width_(width),
        control_(control) {
    const auto& p = cell_.parameters();
    L1_ = p.warp.length;
    L2_ = p.weft.length;
    inv_A0_ = R(1) /
              (R(p.symmetry) * L1_ * L2_ * (width == YarnWidth::corrected ? reference.sine : R(1)));
    width1_ = L1_ * inv_A0_;
    width2_ = L2_ * inv_A0_;
  }

  /// The same law for explicit dynamics, which then follows the heights of the cells, tag [C-14]:
  /// the cheapest, and no other method can use it.
  template <class C = Cell>
    requires FollowedCell<C, R>
  [[nodiscard]] WovenMembrane<C, Shear, CellPrice::followed> followed() const {
    return {cell_, shear_, reference_, width_, control_};
  }

  [[nodiscard]] CROSSBEAM_HOST_DEVICE const Cell& cell() const { return cell_; }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE const Shear& shear() const { return shear_; }
  [[nodiscard]] CROSSBEAM_HOST_DEVICE const FibreAngle<R>& reference() const { return reference_; }

  template <class T>
  using CellSolution = typename Cell::template Solution<T>;

  /// One evaluation at a strain: kinematics of the yarns and the cell in equilibrium. Stress, energy
  /// and tangent are read off it as far as they are wanted.
  template <class T>
  struct State {
    FibreState<T> fibres;
    T u1, u2;  ///< elongations of the cell's yarns [mm]
    CellSolution<T> cell;
  };

  template <class T>
  CROSSBEAM_INLINE State<T> evaluate(const FibreStrain<T>& beta) const {
    State<T> s;
    s.fibres.beta = beta;
    stretch_yarns(s.fibres);
    s.u1 = T(L1_) * relative_elongation(beta.b11, s.fibres.lambda1);
    s.u2 = T(L2_) * relative_elongation(beta.b22, s.fibres.lambda2);
    s.cell = cell_.solve(s.u1, s.u2, control_);
    return s;
  }

  /// @name Stress by one residual evaluation of the cell, tag [C-14], for the small steps of
  /// explicit dynamics: a row of points in loops short enough for the processor to look ahead, tag
  /// [S-4], and what each of them does at one point.
  /// @{
  /// Stresses of a row of points, and the reciprocals of the yarns' stretches on the way.
  /// @param row the strains; a PointRows (sweep/point_rows.hpp), whose numbers stay in the cache
  /// @param end points, a multiple of the lanes
  /// @param heights of the cells of the first pack, warp and then weft; moved on to the equilibrium
  /// @param stride from one pack's heights to the next's
  template <class Row>
  CROSSBEAM_INLINE void stresses(Row& row, int end, R* heights, std::size_t stride) const {
    using T = typename Row::Number;
    constexpr int lanes = lanes_v<T>;
    for (int i = 0; i < end; i += lanes) {
      T u1, u2, inv1, inv2;
      elongate(row.b11.load(i), row.b22.load(i), u1, u2, inv1, inv2);
      row.u1.store(i, u1);
      row.u2.store(i, u2);
      row.inv1.store(i, inv1);
      row.inv2.store(i, inv2);
    }
    for (int y = 0; y < 2; ++y) {
      const auto& yarn = y == 0 ? cell_.warp() : cell_.weft();
      const auto& u = y == 0 ? row.u1 : row.u2;
      const R* height = heights + y * lanes;
      for (int i = 0; i < end; i += lanes, height += stride)
        row.yarn[y].store(i, cell_.evaluate_yarn(yarn, u.load(i), T::load(height)));
    }
    R* height = heights;
    for (int i = 0; i < end; i += lanes, height += stride) {
      CrimpHeights<T> w{T::load(height), T::load(height + lanes)};
      T m11, m22;
      follow(row.u1.load(i), row.u2.load(i), row.inv1.load(i), row.inv2.load(i),
             row.yarn[0].load(i), row.yarn[1].load(i), w, m11, m22);
      w.w1.store(height);
      w.w2.store(height + lanes);
      row.m11.store(i, m11);
      row.m22.store(i, m22);
    }
    for (int i = 0; i < end; i += lanes)
      row.store_stress(i, with_shear(row.strain(i), row.inv1.load(i), row.inv2.load(i),
                                     row.m11.load(i), row.m22.load(i)));
  }
  /// Elongations of the yarns and reciprocals of their stretches.
  template <class T>
  CROSSBEAM_INLINE void elongate(const T& b11, const T& b22, T& u1, T& u2, T& inv1, T& inv2) const {
    const T lambda1 = stretch(b11), lambda2 = stretch(b22);
    const T d1 = T(1) + lambda1, d2 = T(1) + lambda2;
    const T lambda12 = lambda1 * lambda2, d12 = d1 * d2;
    const T both = T(1) / (lambda12 * d12);  // one division for 1/lambda12 and 1/d12
    const T inv_lambda12 = both * d12, inv_d12 = both * lambda12;
    inv1 = inv_lambda12 * lambda2;
    inv2 = inv_lambda12 * lambda1;
    u1 = T(R(2) * L1_) * b11 * (inv_d12 * d2);
    u2 = T(R(2) * L2_) * b22 * (inv_d12 * d1);
  }
  /// The yarns' share of the stress, from the cell's two yarns at the heights of the last call.
  /// @param heights moved on to the equilibrium
  template <class T>
  CROSSBEAM_INLINE void follow(const T& u1, const T& u2, const T& inv1, const T& inv2,
                               const FollowedYarn<T>& y1, const FollowedYarn<T>& y2,
                               CrimpHeights<T>& heights, T& m11, T& m22) const {
    const YarnForces<T> F = cell_.follow(u1, u2, y1, y2, heights);
    m11 = F.F1 * T(width1_) * inv1;
    m22 = F.F2 * T(width2_) * inv2;
  }
  /// The shear layer's share added.
  template <class T>
  CROSSBEAM_INLINE FibreStress<T> with_shear(const FibreStrain<T>& beta, const T& inv1,
                                             const T& inv2, const T& m11, const T& m22) const {
    StrainGradient<T> g;
    if constexpr (requires { shear_.gradient(beta, inv1, inv2); })
      g = shear_.gradient(beta, inv1, inv2);
    else
      g = shear_.gradient(FibreState<T>{beta, stretch(beta.b11), stretch(beta.b22)});
    return {m11 + g.g1, m22 + g.g2, T(0.5) * g.g3};
  }
  /// @}

  /// Yarn tensions per unit width, m_i lambda_i, as first Piola-Kirchhoff components (Eq. 15).
  template <class T>
  CROSSBEAM_INLINE Vector2<T> yarn_tension(const State<T>& s) const {
    return {s.cell.forces.F1 * T(width1_), s.cell.forces.F2 * T(width2_)};
  }

  /// Eq. 15-20 and 26-27: cell + shear, tag [L-1].
  template <class T>
  CROSSBEAM_INLINE FibreStress<T> stress(const State<T>& s) const {
    const InverseStretches<T> inv(s.fibres.lambda1, s.fibres.lambda2);
    const StrainGradient<T> g = shear_.gradient(s.fibres);
    return {s.cell.forces.F1 * T(width1_) * inv.first + g.g1,
            s.cell.forces.F2 * T(width2_) * inv.second + g.g2, T(0.5) * g.g3};
  }

  /// Stored energy of the yarns per unit reference area [kN/mm]. Energy cells only.
  template <class T>
  CROSSBEAM_INLINE T yarn_energy(const State<T>& s) const
    requires requires(const Cell& c) { c.energy(s.u1, s.u2, s.cell); }
  {
    return cell_.energy(s.u1, s.u2, s.cell) * T(inv_A0_);
  }
  template <class T>
  CROSSBEAM_INLINE T shear_energy(const State<T>& s) const {
    return shear_.energy(s.fibres);
  }

  /// d(dW/dbeta)/dbeta, tag [L-3]. Energy cells only.
  template <class T>
  CROSSBEAM_INLINE StrainHessian<T> hessian(const State<T>& s) const
    requires requires(const Cell& c) { c.tangent(s.u1, s.u2, s.cell); }
  {
    const CellTangent<T> K = cell_.tangent(s.u1, s.u2, s.cell);
    StrainHessian<T> h = shear_.hessian(s.fibres);
    const T inv1 = T(1) / s.fibres.lambda1, inv2 = T(1) / s.fibres.lambda2;
    h.h11 = h.h11 + T(width1_) * inv1 * inv1 * (T(L1_) * K.K11 - s.cell.forces.F1 * inv1);
    h.h22 = h.h22 + T(width2_) * inv2 * inv2 * (T(L2_) * K.K22 - s.cell.forces.F2 * inv2);
    h.h12 = h.h12 + T(L1_ * L2_ * inv_A0_) * K.K12 * inv1 * inv2;
    return h;
  }

  /// Bound of the membrane stiffness for the critical time step [kN/mm], tag [C-10].
  [[nodiscard]] R stiffness_bound() const {
    return cell_.membrane_stiffness_bound(reference_.sine) + R(4) * shear_.modulus_bound();
  }

 private:
  template <class T>
  CROSSBEAM_INLINE static void stretch_yarns(FibreState<T>& fibres) {
    fibres.lambda1 = stretch(fibres.beta.b11);
    fibres.lambda2 = stretch(fibres.beta.b22);
  }

  Cell cell_;
  Shear shear_;
  FibreAngle<R> reference_;
  YarnWidth width_;
  SolverControl control_;
  R L1_{}, L2_{}, inv_A0_{};
  R width1_{}, width2_{};  ///< L_i / A0
};

/// @name Stress and tangent in the Cartesian axes Y, for host codes
/// @{

/// What a host code gets back at a strain E (Y components).
template <class T>
struct MembraneResponse {
  T energy{};        ///< per unit reference area [kN/mm]
  Matrix2<T> S;      ///< second Piola-Kirchhoff stress, Y components [kN/mm, t = 1]
  Matrix3<T> dS_dE;  ///< rows (S11, S22, S12), columns (E11, E22, 2 E12); on request
  /// Of the cell; outside_kinematics also for a strain that no deformation has (yarns on one line or
  /// beyond), not_converged also for an answer beyond the largest number.
  CellStatus status = CellStatus::converged;
};

enum class Tangent { no, yes };

namespace detail {

/// Whether every entry is a number and finite.
template <class Derived>
bool all_finite(const Eigen::MatrixBase<Derived>& a) {
  for (Eigen::Index i = 0; i < a.size(); ++i)
    if (!is_finite(passive(a.derived().coeff(i / a.cols(), i % a.cols())))) return false;
  return true;
}

}  // namespace detail

/// S = c^T m c (Eq. 20 with contravariant m) at the Cartesian strain E; tags [L-1], [L-2], [L-3].
/// A cell without a potential (SecondOrderCell) has no tangent, and its energy stays 0.
template <class Law, class T>
MembraneResponse<T> membrane_response(const Law& law, const Matrix2<T>& E,
                                      Tangent want = Tangent::no) {
  using R = typename Law::Real;
  const Matrix2<R> c_real = fibre_from_cartesian(law.reference());
  const Matrix2<T> c = c_real.template cast<T>();
  const auto state = law.evaluate(fibre_strain<T>(E, c));
  const FibreStress<T> m = law.stress(state);
  MembraneResponse<T> out;
  Matrix2<T> M;
  M << m.m11, m.m12, m.m12, m.m22;
  out.S = c.transpose() * M * c;
  out.status = state.cell.status;
  if constexpr (requires { law.yarn_energy(state); }) {
    out.energy = law.yarn_energy(state) + law.shear_energy(state);
    if (want == Tangent::yes) {
      const StrainHessian<T> h = law.hessian(state);
      Matrix3<T> H, V;
      H << h.h11, h.h12, h.h13, h.h12, h.h22, h.h23, h.h13, h.h23, h.h33;
      // The first row of c is (1, 0): Y1 is the warp.
      V << T(1), T(0), T(0),                                        //
          c(1, 0) * c(1, 0), c(1, 1) * c(1, 1), c(1, 0) * c(1, 1),  //
          c(1, 0), T(0), T(0.5) * c(1, 1);
      out.dS_dE = V.transpose() * H * V;
    }
  } else {
    CROSSBEAM_EXPECTS(want == Tangent::no);
  }
  if (out.status == CellStatus::converged) {
    const T cosine = fibre_cosine(state.fibres.beta, state.fibres.lambda1, state.fibres.lambda2,
                                  law.reference().cosine);
    const bool tangent = want == Tangent::yes;
    if (!(magnitude(cosine) < T(R(1) - R(8) * std::numeric_limits<R>::epsilon())))
      out.status = CellStatus::outside_kinematics;
    else if (!(detail::all_finite(out.S) && is_finite(passive(out.energy)) &&
               (!tangent || detail::all_finite(out.dS_dE))))
      out.status = CellStatus::not_converged;
  }
  return out;
}

/// The same for a strain in another matrix or expression of Eigen.
template <class Law, class Strain>
  requires std::is_base_of_v<Eigen::MatrixBase<Strain>, Strain>
auto membrane_response(const Law& law, const Strain& E, Tangent want = Tangent::no) {
  return membrane_response(law, Matrix2<typename Strain::Scalar>(E), want);
}

/// Cauchy stress (Eq. 21) from S and the surface gradient; J is the area ratio. For a host whose J
/// is that of the volume, give its thickness stretch: the membrane force does not change, tag [L-4].
/// @throws InputError for a collapsed surface, J = 0, which has no Cauchy stress
template <class T>
Matrix3<T> cauchy_stress(const Matrix2<T>& S, const Base<T>& gradient, const T& area_ratio,
                         const T& thickness_stretch = T(1)) {
  const T J = area_ratio * thickness_stretch;
  require_positive("area_ratio * thickness_stretch", passive(J), "-");
  return gradient * S * gradient.transpose() / J;
}
/// @}

}  // namespace crossbeam
