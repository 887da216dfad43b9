#pragma once
/// @file
/// A row of Gauss points in the first-level cache: what the short loops over them hand on to each
/// other, tag [S-4]. Theory: docs/theory/sweep.md.

#include "crossbeam/law/woven_membrane.hpp"

namespace crossbeam {

/// @tparam T pack; @tparam Size points of a row at most, a multiple of its lanes
template <class T, int Size>
struct PointRows {
  using Number = T;
  using R = real_t<T>;
  static constexpr int lanes = lanes_v<T>;

  /// One number of every point. Point i is that of lane 0.
  struct Row {
    alignas(64) R number[Size];
    CROSSBEAM_INLINE T load(int i) const { return T::load(number + i); }
    CROSSBEAM_INLINE void store(int i, const T& value) { value.store(number + i); }
    /// Zeros in the other lanes.
    template <class Mask>
    CROSSBEAM_INLINE void keep(int i, const Mask& active) {
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
    template <class Mask>
    CROSSBEAM_INLINE void keep(int i, const Mask& active) {
      for (Row* component : {&x, &y, &z}) component->keep(i, active);
    }
  };
  struct YarnRow {
    Row g, D, F, k_Lh;
    CROSSBEAM_INLINE FollowedYarn<T> load(int i) const {
      return {g.load(i), D.load(i), F.load(i), k_Lh.load(i)};
    }
    CROSSBEAM_INLINE void store(int i, const FollowedYarn<T>& y) {
      g.store(i, y.g);
      D.store(i, y.D);
      F.store(i, y.F);
      k_Lh.store(i, y.k_Lh);
    }
  };

  VectorRow f1, f2;   ///< fibre vectors
  Row b11, b22, b12;  ///< fibre strains
  Row inv1, inv2;     ///< reciprocals of the yarns' stretches
  Row u1, u2;         ///< elongations of the cells' yarns
  Row m11, m22, m12;  ///< stress
  YarnRow yarn[2];

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
};

}  // namespace crossbeam
