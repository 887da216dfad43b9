#pragma once
/// @file
/// From the relative vectors of an element to its generalised forces, by way of any membrane law
/// and without forming a matrix (docs/theory/element.md, [E-3]). One template for scalars and
/// packs.

#include "crossbeam/element/coefficients.hpp"
#include "crossbeam/law/membrane_law.hpp"

namespace crossbeam {

/// The fibre vectors of a Gauss point.
template <int M, class T, int K>
CROSSBEAM_INLINE Vec3<T> fibre_vector(const Vec3<T> (&D)[K], const T (&t)[M]) {
  Vec3<T> f = t[0] * D[0];
  unrolled<M - 1>([&](auto k) CROSSBEAM_INLINE_LAMBDA { f = f + t[k + 1] * D[k + 1]; });
  return f;
}

/// Coefficients of one Gauss point, loaded into the lanes.
template <class T, int M>
struct PointLanes {
  T t1[M], t2[M];
  T weight;
};

/// Strain and state of a Gauss point.
template <class T, int M, int K>
struct PointKinematics {
  Vec3<T> f1, f2;
  template <class R>
  CROSSBEAM_INLINE FibreStrain<T> strain(R reference_cosine) const {
    return fibre_strain(f1, f2, reference_cosine);
  }
  CROSSBEAM_INLINE PointKinematics(const Vec3<T> (&D)[K], const PointLanes<T, M>& point)
      : f1(fibre_vector<M>(D, point.t1)), f2(fibre_vector<M>(D, point.t2)) {}
  CROSSBEAM_INLINE PointKinematics(const Vec3<T>& warp, const Vec3<T>& weft) : f1(warp), f2(weft) {}
};

/// Generalised forces weight * (m^{ij} f_j) t_ik of a point: the derivatives of its energy with respect
/// to D_k, k < M; those of the others, which the point doesn't see, are left alone.
template <int M, class T, int K>
CROSSBEAM_INLINE void point_forces(const PointKinematics<T, M, K>& kinematics,
                                   const FibreStress<T>& m, const PointLanes<T, M>& point,
                                   Vec3<T> (&R)[K]) {
  const T a11 = point.weight * m.m11, a22 = point.weight * m.m22, a12 = point.weight * m.m12;
  const Vec3<T> P1 = a11 * kinematics.f1 + a12 * kinematics.f2;
  const Vec3<T> P2 = a12 * kinematics.f1 + a22 * kinematics.f2;
  unrolled<M>([&](auto k) CROSSBEAM_INLINE_LAMBDA { R[k] = point.t1[k] * P1 + point.t2[k] * P2; });
}

/// Adds them to R.
template <int M, class T, int K>
CROSSBEAM_INLINE void add_point_forces(const PointKinematics<T, M, K>& kinematics,
                                       const FibreStress<T>& m, const PointLanes<T, M>& point,
                                       Vec3<T> (&R)[K]) {
  Vec3<T> force[K];
  point_forces(kinematics, m, point, force);
  unrolled<M>([&](auto k) CROSSBEAM_INLINE_LAMBDA { R[k] = R[k] + force[k]; });
}

}  // namespace crossbeam
