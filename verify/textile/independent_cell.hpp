#pragma once
/// @file
/// The unit cell solved from its energy by nested bisection on monotone functions, in long double:
/// no Newton, no start, no tangent, and nothing of the library. Each yarn is either given its
/// elongation or its force. Numbers of Table 1.

#include <cmath>

namespace textile {

/// A yarn: chord of length l from (L + u) and h, energy ka/2 (l - l0)^2 + kb/2 t^2 with the
/// deflection t = c0 (h - H) - s0 u across the unstressed chord.
struct IndependentYarn {
  using R = long double;
  R youngs_modulus = 35.4L, I = 1e-4L, L = 2.5L, H = 0.4L;

  static R length(R a, R b) { return std::sqrt(a * a + b * b); }
  [[nodiscard]] R l0() const { return length(L, H); }
  [[nodiscard]] R ka() const { return youngs_modulus / l0(); }
  [[nodiscard]] R kb() const { return 3 * youngs_modulus * I / (l0() * l0() * l0()); }
  [[nodiscard]] R deflection(R u, R h) const { return (L * (h - H) - H * u) / l0(); }
  /// Derivatives of the energy with respect to u and h.
  [[nodiscard]] R along(R u, R h) const {
    const R l = length(L + u, h);
    return ka() * (l - l0()) * (L + u) / l - kb() * deflection(u, h) * H / l0();
  }
  [[nodiscard]] R upwards(R u, R h) const {
    const R l = length(L + u, h);
    return ka() * (l - l0()) * h / l + kb() * deflection(u, h) * L / l0();
  }
};

/// What is prescribed at a yarn's end.
struct Prescribed {
  enum class What { elongation, force } what;
  long double value;  ///< [mm] or [kN]
};

struct IndependentCell {
  using R = long double;
  IndependentYarn warp, weft;
  R contact_stiffness = 22;  ///< E3 A3 / L3 [kN/mm]

  struct Answer {
    R u1, u2, F1, F2, q;
  };

  /// Largest root of an increasing function; f(low) <= 0.
  template <class Function>
  static R root(R low, R high, Function f) {
    for (int k = 0; k < 66; ++k) {
      const R middle = (low + high) / 2;
      (f(middle) > 0 ? high : low) = middle;
    }
    return low;
  }

  struct End {
    R u, h;
  };
  /// A yarn under the contact force q: upwards() crosses q once as the height grows, and at
  /// constant q the force grows with the elongation.
  static End end(const IndependentYarn& y, const Prescribed& p, R q) {
    const auto height = [&](R u) {
      return root(0, 4 * y.H, [&](R h) { return y.upwards(u, h) - q; });
    };
    const R u =
        p.what == Prescribed::What::elongation
            ? p.value
            : root(-0.3L * y.L, 0.3L * y.L, [&](R e) { return y.along(e, height(e)) - p.value; });
    return {u, height(u)};
  }

  /// Where the yarns' heights and the contact's shortening fill the distance of the centre lines.
  [[nodiscard]] Answer solve(const Prescribed& p1, const Prescribed& p2) const {
    const R L3 = warp.H + weft.H;
    const R q = root(0, 20, [&](R force) {
      return end(warp, p1, force).h + end(weft, p2, force).h + force / contact_stiffness - L3;
    });
    const End a = end(warp, p1, q), b = end(weft, p2, q);
    return {a.u, b.u, warp.along(a.u, a.h), weft.along(b.u, b.h), q};
  }
};

}  // namespace textile
