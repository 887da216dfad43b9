#pragma once
/// @file
/// A row of Gauss points in the first-level cache, and the law of followed cells over all of them in
/// short loops, tag [S-4]. Theory: docs/theory/sweep.md.

#include "crossbeam/law/woven_membrane.hpp"

#include <cstddef>

namespace crossbeam {

/// What the loops over a row of points hand on to each other.
/// @tparam T pack; @tparam Size points of a row at most, a multiple of its lanes
template <class T, int Size>
struct PointRows {
  using R = real_t<T>;
  static constexpr int lanes = lanes_v<T>;

  struct Row {
    alignas(64) R number[Size];
    /// @param i place of lane 0
    CROSSBEAM_INLINE T load(int i) const { return T::load(number + i); }
    CROSSBEAM_INLINE void store(int i, const T& value) { value.store(number + i); }
    template <class Mask>
    CROSSBEAM_INLINE void rest(int i, const Mask& active) {
      store(i, select(active, load(i), T(R(0))));
    }
  };
  struct VectorRow {
    Row x, y, z;
    CROSSBEAM_INLINE Vec3<T> load(int i) const { return {x.load(i), y.load(i), z.load(i)}; }
    CROSSBEAM_INLINE void store(int i, const Vec3<T>& v) {
      x.store(i, v.x);
      y.store(i, v.y);
      z.store(i, v.z);
    }
  };

  VectorRow f1, f2;   ///< fibre vectors
  Row b11, b22, b12;  ///< fibre strains
  Row inv1, inv2;     ///< reciprocals of the yarns' stretches
  Row u1, u2;         ///< elongations of the cells' yarns
  Row m11, m22, m12;  ///< stress
  struct {
    Row g, D, F, k_Lh;
  } yarn[2];  ///< FollowedYarn

  CROSSBEAM_INLINE FibreStrain<T> strain(int i) const {
    return {b11.load(i), b22.load(i), b12.load(i)};
  }
  CROSSBEAM_INLINE void store_strain(int i, const FibreStrain<T>& beta) {
    b11.store(i, beta.b11);
    b22.store(i, beta.b22);
    b12.store(i, beta.b12);
  }
  CROSSBEAM_INLINE FibreStress<T> stress(int i) const {
    return {m11.load(i), m22.load(i), m12.load(i)};
  }
  CROSSBEAM_INLINE void store_stress(int i, const FibreStress<T>& m) {
    m11.store(i, m.m11);
    m22.store(i, m.m22);
    m12.store(i, m.m12);
  }

  /// Stresses at the strains, tag [C-14]; leaves inv1 and inv2 behind.
  /// @param law WovenMembrane with CellPrice::followed
  /// @param end points, a multiple of the lanes
  /// @param heights of the first pack, warp and then weft; moved on to the equilibrium
  /// @param stride from one pack's heights to the next's
  template <class Law>
  CROSSBEAM_INLINE void follow(const Law& law, int end, R* heights, std::size_t stride) {
    for (int i = 0; i < end; i += lanes) {
      T e1, e2, i1, i2;
      law.elongate(b11.load(i), b22.load(i), e1, e2, i1, i2);
      u1.store(i, e1);
      u2.store(i, e2);
      inv1.store(i, i1);
      inv2.store(i, i2);
    }
    const auto& cell = law.cell();
    for (int y = 0; y < 2; ++y) {
      const auto& constants = y == 0 ? cell.warp() : cell.weft();
      const Row& u = y == 0 ? u1 : u2;
      auto& out = yarn[y];
      const R* height = heights + y * lanes;
      for (int i = 0; i < end; i += lanes, height += stride) {
        const auto at = cell.evaluate_yarn(constants, u.load(i), T::load(height));
        out.g.store(i, at.g);
        out.D.store(i, at.D);
        out.F.store(i, at.F);
        out.k_Lh.store(i, at.k_Lh);
      }
    }
    const auto followed = [&](int y, int i) CROSSBEAM_INLINE_LAMBDA {
      const auto& from = yarn[y];
      return FollowedYarn<T>{from.g.load(i), from.D.load(i), from.F.load(i), from.k_Lh.load(i)};
    };
    R* height = heights;
    for (int i = 0; i < end; i += lanes, height += stride) {
      CrimpHeights<T> w{T::load(height), T::load(height + lanes)};
      T s11, s22;
      law.follow(u1.load(i), u2.load(i), inv1.load(i), inv2.load(i), followed(0, i), followed(1, i),
                 w, s11, s22);
      w.w1.store(height);
      w.w2.store(height + lanes);
      m11.store(i, s11);
      m22.store(i, s22);
    }
    for (int i = 0; i < end; i += lanes)
      store_stress(i,
                   law.with_shear(strain(i), inv1.load(i), inv2.load(i), m11.load(i), m22.load(i)));
  }
};

}  // namespace crossbeam
