#pragma once
/// @file
/// Parameters of the plain-weave unit cell (paper, section 4.1 and Table 1) and their admissible
/// ranges. Any consistent set of units; the comments use kN, mm. Theory: docs/theory/cell.md.

#include "crossbeam/base/error.hpp"
#include "crossbeam/base/scalar.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace crossbeam {

/// One yarn of the cell: a beam from the inflection of its crimp wave to the crossing.
template <class R>
struct YarnParameters {
  R youngs_modulus = R(35.4);                 ///< E [kN/mm^2]; > 0 (Table 1)
  R cross_section = R(1);                     ///< A [mm^2]; > 0 (Table 1)
  R second_moment_of_area = R(1) / R(10000);  ///< I [mm^4]; >= 0 (Table 1)
  R length = R(2.5);  ///< L, in-plane distance from inflection to crossing [mm]; > 0 (Table 1)

  template <class S>
  [[nodiscard]] YarnParameters<S> cast() const {
    return {S(youngs_modulus), S(cross_section), S(second_moment_of_area), S(length)};
  }
};

/// The cell: warp beam 1, weft beam 2, contact beam 3. Defaults are Table 1 of the paper, with the
/// 17.6 mm^2 of its row "A_warp" read as the contact area (docs/theory/cell.md, [C-1]).
template <class R = double>
struct CellParameters {
  YarnParameters<R> warp{};
  YarnParameters<R> weft{};
  R contact_modulus = R(1);              ///< E3 [kN/mm^2]; > 0
  R contact_area = R(176) / R(10);       ///< A3 [mm^2]; > 0
  R contact_length = R(8) / R(10);       ///< L3, distance of the yarns' centre lines [mm]; > 0
  R warp_height_fraction = R(1) / R(2);  ///< chi = H1 / L3 [-]; in (0, 1)
  R bending_boundary_factor = R(3);      ///< kbc: 3 hinged at the inflection, 12 clamped [-]; > 0
  R residual_compression_stiffness = R(0);  ///< kres, extra axial stiffness of a shortened yarn
                                            ///< [kN/mm]; >= 0, tag [C-8]
  int symmetry = 1;  ///< nsym: 1 as printed in Eq. 15; 2 for the full period, with A3/2; tag [C-9]

  /// The same parameters in another precision.
  template <class S>
  [[nodiscard]] CellParameters<S> cast() const {
    return {warp.template cast<S>(),
            weft.template cast<S>(),
            S(contact_modulus),
            S(contact_area),
            S(contact_length),
            S(warp_height_fraction),
            S(bending_boundary_factor),
            S(residual_compression_stiffness),
            symmetry};
  }
};

/// The extreme stiffnesses and lengths of a cell, as its solver forms them.
template <class R>
struct CellRange {
  R least_stiffness;              ///< of the yarns along their chords and of the contact
  R total_stiffness;              ///< these and bending added: NaN if one of them is NaN
  R softest_yarn, stiffest_yarn;  ///< along their chords; the stiffest also in bending
  R least_length, largest_length;

  explicit CellRange(const CellParameters<R>& p) {
    using std::sqrt;
    const R H1 = p.warp_height_fraction * p.contact_length;
    const auto chord = [](R L, R H) { return sqrt(L * L + H * H); };
    const R l1 = chord(p.warp.length, H1), l2 = chord(p.weft.length, p.contact_length - H1);
    const auto axial = [](const YarnParameters<R>& y, R l) {
      return y.youngs_modulus * y.cross_section / l;
    };
    const auto bending = [&p](const YarnParameters<R>& y, R l) {
      return p.bending_boundary_factor * y.youngs_modulus * y.second_moment_of_area / (l * l * l);
    };
    const R k1 = axial(p.warp, l1), k2 = axial(p.weft, l2);
    const R k3 = p.contact_modulus * p.contact_area / p.contact_length;
    const R b1 = bending(p.warp, l1), b2 = bending(p.weft, l2);
    softest_yarn = minimum(k1, k2);
    stiffest_yarn = maximum(maximum(k1, k2), maximum(b1, b2));
    least_stiffness = minimum(k3, softest_yarn);
    total_stiffness = k1 + k2 + k3 + b1 + b2 + p.residual_compression_stiffness;
    least_length = minimum(p.warp.length, p.weft.length);
    largest_length = maximum(l1, l2);
  }

  /// Whether products of three stiffnesses, with and without a length, and of a stiffness and three
  /// lengths keep their digits, and a stiffness over a squared length: solver, energy and tangent
  /// form them, tag [C-12].
  [[nodiscard]] bool workable() const {
    const R eps = std::numeric_limits<R>::epsilon();
    const R low = (std::numeric_limits<R>::min)() / (eps * eps * eps);
    const R high = (std::numeric_limits<R>::max)() * eps;
    const R k = least_stiffness, K = total_stiffness, l = least_length, L = largest_length;
    return minimum(R(1), l) * k * k * k >= low && k * l * l * l >= low && k >= low * L * L &&
           maximum(R(1), L) * K * K * K <= high && K * L * L * L <= high;
  }

  /// Whether the softer yarn's force is more than the rounding of the stiffer one's, tag [C-12].
  [[nodiscard]] bool comparable() const {
    using std::sqrt;
    return stiffest_yarn * sqrt(std::numeric_limits<R>::epsilon()) <= softest_yarn;
  }

  /// Elongations below this one keep forces and energies finite, tag [C-12] [mm].
  [[nodiscard]] R largest_elongation() const {
    using std::sqrt;
    const R high = (std::numeric_limits<R>::max)() * std::numeric_limits<R>::epsilon();
    const R K = total_stiffness;
    return minimum(minimum(sqrt(high), sqrt(high / K)), high / (K * K * K));
  }
};

/// Throws InputError that names the field, its value, unit and admissible range.
/// @param prefix the caller's name of the parameter set, for instance "cell".
template <class R>
void validate(const CellParameters<R>& p, const std::string& prefix = "cell") {
  const auto yarn = [](const YarnParameters<R>& y, const std::string& name) {
    require_positive(name + ".youngs_modulus", y.youngs_modulus, "kN/mm^2");
    require_positive(name + ".cross_section", y.cross_section, "mm^2");
    require_non_negative(name + ".second_moment_of_area", y.second_moment_of_area, "mm^4");
    require_positive(name + ".length", y.length, "mm");
  };
  yarn(p.warp, prefix + ".warp");
  yarn(p.weft, prefix + ".weft");
  require_positive(prefix + ".contact_modulus", p.contact_modulus, "kN/mm^2");
  require_positive(prefix + ".contact_area", p.contact_area, "mm^2");
  require_positive(prefix + ".contact_length", p.contact_length, "mm");
  require_between(prefix + ".warp_height_fraction", p.warp_height_fraction, "-", 0, 1);
  require_positive(prefix + ".bending_boundary_factor", p.bending_boundary_factor, "-");
  require_non_negative(prefix + ".residual_compression_stiffness", p.residual_compression_stiffness,
                       "kN/mm");
  if (p.symmetry != 1 && p.symmetry != 2)
    throw InputError(prefix + ".symmetry", std::to_string(p.symmetry), "", "1 or 2");
  const CellRange<R> range(p);
  if (!range.workable())
    throw InputError(
        prefix,
        detail::to_text(range.least_stiffness) + " to " + detail::to_text(range.total_stiffness) +
            " kN/mm (E A / l0 of the yarns, E3 A3 / L3) on lengths of " +
            detail::to_text(range.least_length) + " to " + detail::to_text(range.largest_length),
        "mm",
        "stiffness^3, times a length or not, and stiffness length^3 must be numbers "
        "with all their digits: choose other units");
  using std::sqrt;
  if (!range.comparable())
    throw InputError(prefix + ": stiffest yarn, along or in bending, over the softest",
                     detail::to_text(range.stiffest_yarn / range.softest_yarn), "-",
                     "at most " + detail::to_text(1 / sqrt(std::numeric_limits<R>::epsilon())));
}

}  // namespace crossbeam
