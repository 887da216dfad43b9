// Every lane of a pack computes bit for bit what its scalar computes, in the kernels and for the
// instruction set that this file is compiled for. Without a test framework, so that any compiler,
// a cross compiler too, makes a program of this one file. It prints what it compared and returns 0;
// 1: lanes differ; 77: this processor does not have the instructions.

#include "crossbeam/base/simd.hpp"
#include "crossbeam/cell/crossed_beam.hpp"
#include "crossbeam/element/membrane.hpp"
#include "crossbeam/element/quadrilateral.hpp"
#include "crossbeam/law/woven_membrane.hpp"
#include "crossbeam/tools/height_surface.hpp"
#include "crossbeam/tools/height_table.hpp"
#include "crossbeam/tools/stadium_ring.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>

namespace {

using namespace crossbeam;

/// Uniform numbers that are the same everywhere (splitmix64).
class Random {
 public:
  double operator()(double low, double high) {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return low + (high - low) * static_cast<double>(z >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 20260401;
};

long long compared = 0, unequal = 0;

template <class P, class S>
void expect_lane(const P& pack, int lane, S scalar) {
  const S value = pack[lane];
  ++compared;
  unequal += std::memcmp(&value, &scalar, sizeof value) != 0;
}

/// Lanes filled with random numbers.
template <class P>
P random_pack(Random& random, double low, double high) {
  P pack(0);
  for (int i = 0; i < lanes_v<P>; ++i)
    pack.set(i, static_cast<typename P::Value>(random(low, high)));
  return pack;
}

/// Differences of double positions in the precision of the run, and velocities back to double.
template <class P>
void compare_differences(Random& random) {
  using S = typename P::Value;
  using Wide = double_lanes_t<P>;
  const Vec3<Wide> a{random_pack<Wide>(random, 100, 200), random_pack<Wide>(random, 100, 200),
                     random_pack<Wide>(random, 100, 200)};
  const Wide x = random_pack<Wide>(random, 100, 200);
  const P v = random_pack<P>(random, -1, 1);
  const Vec3<P> d = convert<P>(Vec3<Wide>{a.x - x, a.y - x, a.z - x});
  const Wide moved = x + Wide(1e-3) * convert<Wide>(v);
  for (int i = 0; i < lanes_v<P>; ++i) {
    expect_lane(d.x, i, S(a.x[i] - x[i]));
    expect_lane(d.y, i, S(a.y[i] - x[i]));
    expect_lane(d.z, i, S(a.z[i] - x[i]));
    expect_lane(moved, i, x[i] + 1e-3 * double(v[i]));
  }
}

/// Masks and sums against loops over the lanes.
template <class P>
void compare_reductions(Random& random) {
  using S = typename P::Value;
  constexpr int n = lanes_v<P>;
  for (int sample = 0; sample < 2000; ++sample) {
    // Mostly one sign, so that "any" and "all" have both answers for every width.
    const double bias = sample % 2 == 0 ? 0.9 : -0.9;
    P p = random_pack<P>(random, bias - 1, bias + 1);
    if (sample % 8 == 7) p.set(sample / 8 % n, std::numeric_limits<S>::quiet_NaN());
    bool some = false, every = true;
    S sum = p[0], largest = p[0];
    for (int i = 0; i < n; ++i) {
      const bool positive = p[i] > S(0);
      some = some || positive;
      every = every && positive;
      if (i > 0) {
        sum += p[i];
        largest = p[i] > largest ? p[i] : largest;
      }
      ++compared;
      unequal += (p > P(0))[i] != positive;
    }
    compared += 4;
    unequal += any(p > P(0)) != some;
    unequal += all(p > P(0)) != every;
    const S pack_sum = lane_sum(p), pack_largest = lane_maximum(p);
    unequal += sum == sum ? std::memcmp(&pack_sum, &sum, sizeof sum) != 0 : pack_sum == pack_sum;
    unequal += largest == largest ? std::memcmp(&pack_largest, &largest, sizeof sum) != 0
                                  : pack_largest == pack_largest;
  }
}

int slack = 0, taut = 0, sheared_left = 0, sheared_right = 0;

/// Cell, stress, energies, tangent and corner forces of random sheared quadrilaterals.
template <class P, class Law>
void compare_elements(const Law& law, Random& random, int samples) {
  using S = typename P::Value;
  using Element = Quadrilateral<1>;
  constexpr int n = lanes_v<P>, K = Element::vectors, M = Element::membrane_vectors;
  for (int sample = 0; sample < samples; ++sample) {
    Vec3<P> x[4];
    PointLanes<P, M> point;
    for (int i = 0; i < n; ++i) {
      // A square of 5 mm, its yarns stretched or shortened by up to 3 %, sheared and out of plane.
      const double gamma = random(-0.9, 0.9), l1 = random(0.97, 1.03), l2 = random(0.97, 1.03);
      sheared_left += gamma < -0.8;
      sheared_right += gamma > 0.8;
      const double u[2] = {5 * l1, 0}, v[2] = {5 * l2 * std::sin(gamma), 5 * l2 * std::cos(gamma)};
      for (int a = 0; a < 4; ++a) {
        const double first = a == 1 || a == 2, second = a >= 2;
        x[a].x.set(i, S(first * u[0] + second * v[0] + 100));
        x[a].y.set(i, S(first * u[1] + second * v[1] - 20));
        x[a].z.set(i, S(random(-0.05, 0.05)));
      }
      // Warp and weft along the diagonals' halves: D1 = 5 (F1 + F2), D2 = 5 (F2 - F1).
      point.t1[0].set(i, S(random(0.099, 0.101)));
      point.t1[1].set(i, S(random(-0.101, -0.099)));
      point.t2[0].set(i, S(random(0.099, 0.101)));
      point.t2[1].set(i, S(random(0.099, 0.101)));
      point.weight.set(i, S(random(20, 30)));
    }
    Vec3<P> D[K], R[K]{}, f[4];
    Element::relative_vectors(x, D);
    const PointKinematics<P, M, K> kinematics(D, point);
    const auto state = law.evaluate(kinematics.strain(law.reference().cosine));
    const auto stress = law.stress(state);
    const auto hessian = law.hessian(state);
    const P yarn_energy = law.yarn_energy(state), shear_energy = law.shear_energy(state);
    add_point_forces(kinematics, stress, point, R);
    Element::corner_forces(R, f);

    for (int i = 0; i < n; ++i) {
      const auto lane = [i](const Vec3<P>& a) { return Vec3<S>{a.x[i], a.y[i], a.z[i]}; };
      Vec3<S> xs[4], Ds[K], Rs[K]{}, fs[4];
      PointLanes<S, M> ps;
      for (int a = 0; a < 4; ++a) xs[a] = lane(x[a]);
      for (int k = 0; k < M; ++k) {
        ps.t1[k] = point.t1[k][i];
        ps.t2[k] = point.t2[k][i];
      }
      ps.weight = point.weight[i];
      Element::relative_vectors(xs, Ds);
      const PointKinematics<S, M, K> ks(Ds, ps);
      const auto at = law.evaluate(ks.strain(law.reference().cosine));
      const auto m = law.stress(at);
      const auto h = law.hessian(at);
      add_point_forces(ks, m, ps, Rs);
      Element::corner_forces(Rs, fs);
      (at.cell.contact_stiffness > S(0) ? taut : slack) += 1;

      expect_lane(state.cell.forces.F1, i, at.cell.forces.F1);
      expect_lane(state.cell.forces.F2, i, at.cell.forces.F2);
      expect_lane(state.cell.forces.w1, i, at.cell.forces.w1);
      expect_lane(state.cell.forces.w2, i, at.cell.forces.w2);
      expect_lane(state.cell.forces.q, i, at.cell.forces.q);
      expect_lane(state.cell.last_correction, i, at.cell.last_correction);
      expect_lane(state.cell.contact_stiffness, i, at.cell.contact_stiffness);
      expect_lane(stress.m11, i, m.m11);
      expect_lane(stress.m22, i, m.m22);
      expect_lane(stress.m12, i, m.m12);
      expect_lane(yarn_energy, i, law.yarn_energy(at));
      expect_lane(shear_energy, i, law.shear_energy(at));
      expect_lane(hessian.h11, i, h.h11);
      expect_lane(hessian.h22, i, h.h22);
      expect_lane(hessian.h33, i, h.h33);
      expect_lane(hessian.h12, i, h.h12);
      expect_lane(hessian.h13, i, h.h13);
      expect_lane(hessian.h23, i, h.h23);
      for (int a = 0; a < 4; ++a) {
        expect_lane(f[a].x, i, fs[a].x);
        expect_lane(f[a].y, i, fs[a].y);
        expect_lane(f[a].z, i, fs[a].z);
      }
    }
  }
}

/// Gap and normal at random points.
template <class P, class Tool>
void compare_tool(const Tool& tool, Random& random, int samples) {
  using S = typename P::Value;
  for (int sample = 0; sample < samples; ++sample) {
    const Vec3<P> p{random_pack<P>(random, -130, 130), random_pack<P>(random, -230, 230),
                    random_pack<P>(random, -10, 40)};
    const SurfaceGap<P> g = tool.gap(p);
    for (int i = 0; i < lanes_v<P>; ++i) {
      const SurfaceGap<S> s = tool.gap(Vec3<S>{p.x[i], p.y[i], p.z[i]});
      expect_lane(g.gap, i, s.gap);
      expect_lane(g.normal.x, i, s.normal.x);
      expect_lane(g.normal.y, i, s.normal.y);
      expect_lane(g.normal.z, i, s.normal.z);
      expect_lane(g.clearance, i, s.clearance);
    }
  }
}

template <class P>
void compare_all() {
  using S = typename P::Value;
  Random random;
  compare_differences<P>(random);
  compare_reductions<P>(random);
  CellParameters<S> unbalanced;
  unbalanced.weft.youngs_modulus = S(20);
  unbalanced.weft.length = S(3);
  unbalanced.warp_height_fraction = S(0.6);
  const auto angle = FibreAngle<S>::right();
  const CrossedBeamCell<S> cell(unbalanced);
  const int samples = 4000 / lanes_v<P>;
  const auto law = [&](const auto& shear) {
    return WovenMembrane(cell, shear, angle, YarnWidth::corrected, SolverControl::fixed(3));
  };
  compare_elements<P>(law(PolynomialShear<S>(PolynomialCurve<S>({S(1e-4), S(0), S(2e-3)}))), random,
                      samples);
  compare_elements<P>(law(ConstantShear<S>(S(1e-3))), random, samples);

  const HeightTableGrid<S> grid{S(0), S(120), S(0), S(220), S(2), true, true};
  const auto hill = [](S x, S y) { return S(30) / (S(1) + (x * x + y * y) / S(4000)); };
  compare_tool<P>(HeightSurface(HeightTable<S>(hill, grid), Side::above), random, samples);
  compare_tool<P>(StadiumRing<S>(), random, samples);
}

const char* instruction_set() {
#if defined(__AVX512DQ__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#elif defined(__SSE2__)
  return "SSE2";
#elif defined(__ARM_NEON)
  return "NEON";
#else
  return "no vectors";
#endif
}

bool processor_has_it() {
#if defined(__AVX512DQ__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd");
#elif defined(__AVX2__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi2");
#else
  return true;
#endif
}

}  // namespace

int main() {
  if (!processor_has_it()) {
    std::printf("lanes: skipped, this processor has no %s\n", instruction_set());
    return 77;
  }
  using Double = NativePack<double>;
  using Float = NativePack<float>;
  compare_all<Double>();
  compare_all<Float>();
  std::printf(
      "lanes: %s, packs of %d double and %d float: %lld numbers compared, %lld not equal in "
      "every bit (%d states slack, %d taut, %d and %d sheared beyond -0.8 and 0.8 rad)\n",
      instruction_set(), lanes_v<Double>, lanes_v<Float>, compared, unequal, slack, taut,
      sheared_left, sheared_right);
  const bool covered = slack > 100 && taut > 100 && sheared_left > 100 && sheared_right > 100;
  return unequal == 0 && covered ? 0 : 1;
}
