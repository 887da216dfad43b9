#pragma once
/// @file
/// What cell and law promise for any input whatever, as functions of a string of bytes: libFuzzer
/// searches for a string that breaks them (cell_fuzz.cpp, law_fuzz.cpp), the tests feed them random
/// ones (stress/bytes_verify.cpp). A broken promise is a Broken exception. The promises:
/// docs/theory/robustness.md.

#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/cell/second_order.hpp"
#include "crossbeam/law/woven_membrane.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fuzz {

/// A promise that was not kept, and the input for which.
struct Broken : std::logic_error {
  using std::logic_error::logic_error;
};

template <class... Parts>
[[noreturn]] void broken(const Parts&... parts) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  ((text << parts << ' '), ...);
  throw Broken(text.str());
}

/// What came of one input.
enum class Outcome { answered, refused, no_answer };

/// Numbers no formula likes, in [0, inf] and NaN.
inline constexpr std::array special_numbers{0.0,
                                            std::numeric_limits<double>::denorm_min(),
                                            1e-310,
                                            std::numeric_limits<double>::min(),
                                            1e-300,
                                            1e-200,
                                            1e-150,
                                            1e-100,
                                            1e-75,
                                            1e-50,
                                            1e-30,
                                            1e-16,
                                            1e-8,
                                            0.1,
                                            1.0,
                                            2.0,
                                            1e3,
                                            1e8,
                                            1e16,
                                            1e30,
                                            1e50,
                                            1e75,
                                            1e100,
                                            1e150,
                                            1e200,
                                            1e300,
                                            std::numeric_limits<double>::max(),
                                            std::numeric_limits<double>::infinity(),
                                            std::numeric_limits<double>::quiet_NaN()};

/// Reads numbers off a string of bytes; zeros when it has ended.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> data) : data_(data) {}

  std::uint8_t byte() {
    if (next_ >= data_.size()) return 0;
    return data_[next_++];
  }
  int below(int count) { return byte() % count; }
  double fraction() {  // [0, 1)
    const int high = byte();
    return (high * 256 + byte()) / 65536.0;
  }
  double uniform(double low, double high) { return low + (high - low) * fraction(); }

  /// Any number of the format, special ones often.
  double any() {
    const int kind = byte();
    if (kind < 128) {
      const double value = special_numbers[byte() % special_numbers.size()];
      return kind % 2 == 0 ? value : -value;
    }
    if (kind < 192) return std::copysign(std::exp2(uniform(-40, 40)), kind % 2 == 0 ? 1.0 : -1.0);
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  /// Mostly of the size of `typical`, so that most inputs get past the checks of the input.
  double like(double typical) {
    const int kind = byte();
    if (kind < 236) return typical * std::exp2(uniform(-10, 10));
    if (kind < 250) return special_numbers[byte() % special_numbers.size()];
    return any();
  }

 private:
  std::span<const std::uint8_t> data_;
  std::size_t next_ = 0;
};

inline crossbeam::CellParameters<double> parameters(Bytes& bytes) {
  crossbeam::CellParameters<double> p;
  // One byte in four leaves the fabric of Table 1, one scales all of it: other units.
  const int kind = bytes.below(4);
  if (kind == 0) return p;
  for (auto* yarn : {&p.warp, &p.weft}) {
    yarn->youngs_modulus = bytes.like(35.4);
    yarn->cross_section = bytes.like(1);
    yarn->second_moment_of_area = bytes.below(4) == 0 ? 0 : bytes.like(1e-4);
    yarn->length = bytes.like(2.5);
  }
  p.contact_modulus = bytes.like(1);
  p.contact_area = bytes.like(17.6);
  p.contact_length = bytes.like(0.8);
  p.warp_height_fraction = bytes.below(8) == 0 ? bytes.any() : bytes.uniform(0.01, 0.99);
  p.bending_boundary_factor = bytes.below(8) == 0 ? bytes.any() : 3;
  p.residual_compression_stiffness = bytes.below(4) == 0 ? bytes.like(1e-3) : 0;
  p.symmetry = bytes.below(16) == 0 ? bytes.byte() : 1 + bytes.below(2);
  if (kind == 1) {
    const double force = std::exp2(std::floor(bytes.uniform(-600, 600)));
    const double length = std::exp2(std::floor(bytes.uniform(-200, 200)));
    for (auto* yarn : {&p.warp, &p.weft}) {
      yarn->youngs_modulus *= force;
      yarn->cross_section *= length * length;
      yarn->second_moment_of_area *= length * length * length * length;
      yarn->length *= length;
    }
    p.contact_modulus *= force;
    p.contact_area *= length * length;
    p.contact_length *= length;
    p.residual_compression_stiffness *= force * length;
  }
  return p;
}

/// A strain of some per cent, or anything; times the yarn's length.
inline double elongation(Bytes& bytes, double length) {
  return bytes.below(8) == 0 ? bytes.any() : length * bytes.uniform(-0.3, 0.15);
}

inline std::string text_of(const crossbeam::CellParameters<double>& p) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const auto* y : {&p.warp, &p.weft})
    text << "E " << y->youngs_modulus << " A " << y->cross_section << " I "
         << y->second_moment_of_area << " L " << y->length << "; ";
  text << "E3 " << p.contact_modulus << " A3 " << p.contact_area << " L3 " << p.contact_length
       << " chi " << p.warp_height_fraction << " kbc " << p.bending_boundary_factor << " kres "
       << p.residual_compression_stiffness;
  return text.str();
}

/// One yarn's energy and derivatives in long double, written from the parameters and not as the
/// kernel does: its range is 1e+-4932, in which none of the inputs over- or underflows.
struct LongYarn {
  long double L, H, l0, ka, kb, kres;
  LongYarn(const crossbeam::CellParameters<double>& p, const crossbeam::YarnParameters<double>& y,
           long double share)
      : L(y.length),
        H(share * p.contact_length),
        l0(std::sqrt(L * L + H * H)),
        ka(static_cast<long double>(y.youngs_modulus) * y.cross_section / l0),
        kb(static_cast<long double>(p.bending_boundary_factor) * y.youngs_modulus *
           y.second_moment_of_area / (l0 * l0 * l0)),
        kres(p.residual_compression_stiffness) {}
  struct Forces {
    long double horizontal, vertical, slope;  ///< the last: of the vertical force with the height
  };
  [[nodiscard]] Forces at(long double u, long double w) const {
    const long double Lc = L + u, h = H + w, l = std::sqrt(Lc * Lc + h * h);
    const long double N = ka * (l - l0), t = (L * w - H * u) / l0;
    const long double compressed = u < 0 ? kres * u : 0;
    const long double c = Lc / l, s = h / l, c0 = L / l0;
    return {N * c - kb * H / l0 * t + compressed, N * s + kb * c0 * t,
            ka * s * s + N / l * c * c + kb * c0 * c0};
  }
};

template <class T>
bool finite(const crossbeam::CellForces<T>& f) {
  using std::isfinite;
  return isfinite(f.F1) && isfinite(f.F2) && isfinite(f.w1) && isfinite(f.w2) && isfinite(f.q);
}

/// Largest violation of equilibrium, of the horizontal forces, of the contact law and of stability,
/// as a share of the largest force the parts of the cell could take at these displacements.
inline double imbalance(const crossbeam::CellParameters<double>& p, double u1, double u2,
                        const crossbeam::CellForces<double>& f, bool unilateral) {
  using Long = long double;
  const Long chi = p.warp_height_fraction, L3 = p.contact_length;
  const LongYarn warp(p, p.warp, chi), weft(p, p.weft, 1 - chi);
  const Long k3 = static_cast<Long>(p.contact_modulus) * p.contact_area / L3;
  const auto a = warp.at(u1, f.w1), b = weft.at(u2, f.w2);
  const Long length = L3 + std::abs(Long(u1)) + std::abs(Long(u2)) + std::abs(Long(f.w1)) +
                      std::abs(Long(f.w2)) + warp.L + weft.L;
  const Long force = (std::max(warp.ka, weft.ka) + std::max(warp.kb, weft.kb) + warp.kres) * length;
  const Long gap = Long(f.w1) + f.w2 + f.q / k3;
  // The branch on which the cell is stable: heights that are not negative, on the rising side.
  const Long stiffness = force / length;
  const Long unstable = unilateral
                            ? std::max({-a.slope / stiffness, -b.slope / stiffness,
                                        -(warp.H + f.w1) / length, -(weft.H + f.w2) / length})
                            : Long(0);
  const Long contact = unilateral && !(f.q > 0) ? std::max(-gap, Long(0)) : std::abs(gap);
  return static_cast<double>(
      std::max({std::abs(a.vertical - f.q) / force, std::abs(b.vertical - f.q) / force,
                std::abs(a.horizontal - f.F1) / force, std::abs(b.horizontal - f.F2) / force,
                contact / length, unstable}));
}

/// Roundings of a converged answer. Errors of a factor are what is looked for here; digits are the
/// business of the claims on the cell.
inline constexpr double allowed_imbalance = 1e-9;

/// A cell answers with finite numbers in equilibrium, or says that it does not.
template <class Cell>
Outcome check_cell(const Cell& cell, double u1, double u2) {
  const auto& p = cell.parameters();
  const auto s = cell.solve(u1, u2);
  if (s.status != crossbeam::CellStatus::converged) return Outcome::no_answer;
  const auto where = [&] {
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << "at u = " << u1 << ", " << u2 << " of " << text_of(p) << ": F " << s.forces.F1 << ", "
         << s.forces.F2 << " w " << s.forces.w1 << ", " << s.forces.w2 << " q " << s.forces.q;
    return text.str();
  };
  if (!(u1 > -p.warp.length && u2 > -p.weft.length)) broken("a yarn of no length", where());
  if (!finite(s.forces)) broken("silent", where());
  if constexpr (requires { cell.energy(u1, u2, s); }) {
    const double off =
        imbalance(p, u1, u2, s.forces, std::is_same_v<Cell, crossbeam::CrossedBeamCell<double>>);
    if (!(off <= allowed_imbalance)) broken("imbalance", off, where());
    const double W = cell.energy(u1, u2, s);
    if (!(W >= 0 && std::isfinite(W))) broken("energy", W, where());
    const auto K = cell.tangent(u1, u2, s);
    if (!(std::isfinite(K.K11) && std::isfinite(K.K12) && std::isfinite(K.K22)))
      broken("tangent", K.K11, K.K12, K.K22, where());
  }
  return Outcome::answered;
}

inline Outcome check_cell(std::span<const std::uint8_t> data) {
  using namespace crossbeam;
  Bytes bytes(data);
  const int kind = bytes.below(3);
  const CellParameters<double> p = parameters(bytes);
  const double u1 = elongation(bytes, p.warp.length), u2 = elongation(bytes, p.weft.length);
  try {
    if (kind == 0) return check_cell(CrossedBeamCell<double>(p), u1, u2);
    if (kind == 1) return check_cell(BilateralCell<double>(p), u1, u2);
    return check_cell(SecondOrderCell<double>(p), u1, u2);
  } catch (const InputError&) {
    return Outcome::refused;
  }
}

/// A law answers with finite stress, energy and tangent, or says that it does not.
/// @param shear_hardens at all angles; a polynomial modulus has to be positive up to 1.2 rad only
template <class Law>
Outcome check_law(const Law& law, const crossbeam::Matrix2<double>& E, bool shear_hardens) {
  using namespace crossbeam;
  constexpr bool has_tangent =
      requires(const Law& l) { l.yarn_energy(l.evaluate(FibreStrain<double>{})); };
  const auto r = membrane_response(law, E, has_tangent ? Tangent::yes : Tangent::no);
  if (r.status != CellStatus::converged) return Outcome::no_answer;
  const auto where = [&] {
    std::ostringstream text;
    text.precision(std::numeric_limits<double>::max_digits10);
    text << "at E = " << E(0, 0) << ", " << E(1, 1) << ", " << E(0, 1) << ", angle "
         << law.reference().delta << " of " << text_of(law.cell().parameters());
    return text.str();
  };
  if (!r.S.allFinite()) broken("silent: S", r.S, where());
  if constexpr (has_tangent) {
    if (!(std::isfinite(r.energy) && (r.energy >= 0 || !shear_hardens)))
      broken("energy", r.energy, where());
    if (!r.dS_dE.allFinite()) broken("tangent", r.dS_dE, where());
  }
  // A metric that no two vectors have, and not by rounding: the strain cannot be.
  const long double C11 = 1 + 2 * static_cast<long double>(E(0, 0)),
                    C22 = 1 + 2 * static_cast<long double>(E(1, 1)), C12 = 2.0L * E(0, 1);
  const long double rounding = 1e-12L * (1 + C11 * C11 + C22 * C22 + C12 * C12);
  if (!(C11 + C22 > 0 && C11 * C22 > C12 * C12 - rounding)) broken("no such strain", where());
  return Outcome::answered;
}

inline Outcome check_law(std::span<const std::uint8_t> data) {
  using namespace crossbeam;
  Bytes bytes(data);
  const int kind = bytes.below(5);
  const bool second_order = bytes.below(8) == 0;
  const double delta = bytes.below(8) == 0 ? bytes.any() : bytes.uniform(0.3, 2.8);
  const YarnWidth width = bytes.below(2) == 0 ? YarnWidth::corrected : YarnWidth::literal;
  const CellParameters<double> p =
      bytes.below(2) == 0 ? CellParameters<double>{} : parameters(bytes);
  Matrix2<double> E;
  const auto strain = [&] {
    return bytes.below(8) == 0 ? bytes.any() : bytes.uniform(-0.55, 0.55);
  };
  E(0, 0) = strain();
  E(1, 1) = strain();
  E(0, 1) = E(1, 0) = strain();
  try {
    const FibreAngle<double> angle(delta);
    const auto check = [&](const auto& shear, bool hardens = true) {
      using Shear = std::decay_t<decltype(shear)>;
      if (second_order)
        return check_law(WovenMembrane<SecondOrderCell<double>, Shear>(SecondOrderCell<double>(p),
                                                                       shear, angle, width),
                         E, hardens);
      return check_law(WovenMembrane<CrossedBeamCell<double>, Shear>(CrossedBeamCell<double>(p),
                                                                     shear, angle, width),
                       E, hardens);
    };
    if (kind == 0) return check(NoShear<double>{});
    if (kind <= 2)
      return check(ConstantShear<double>(
          bytes.like(1e-3), bytes.below(2) == 0 ? ShearMeasure::tensor : ShearMeasure::engineering,
          kind == 1 ? ShearFrame::cartesian : ShearFrame::fibre));
    std::vector<double> first, second;
    if (kind == 3) {
      const int terms = bytes.below(10);
      for (int k = 0; k < terms; ++k)
        first.push_back(bytes.below(4) == 0 ? bytes.any() : bytes.uniform(-1e-3, 9e-3));
      return check(PolynomialShear<double>(PolynomialCurve<double>(first)), false);
    }
    const int points = bytes.below(6);
    double angle_sum = 0, traction_sum = 0;
    for (int k = 0; k < points; ++k) {
      first.push_back(angle_sum);
      second.push_back(traction_sum);
      angle_sum += bytes.below(8) == 0 ? bytes.any() : bytes.uniform(0.01, 0.5);
      traction_sum += bytes.below(8) == 0 ? bytes.any() : bytes.uniform(0, 1e-4);
    }
    return check(TabulatedShear<double>(TabulatedCurve<double>(first, second)));
  } catch (const InputError&) {
    return Outcome::refused;
  }
}

}  // namespace fuzz
