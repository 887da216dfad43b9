#pragma once
/// @file
/// A pack of N floating-point numbers that computes like one number. It stands on the vector
/// extensions of g++ and clang; on another compiler NativePack is a pack of one.
/// Choice and measurement of the back end: docs/theory/sweep.md.

#include "crossbeam/base/scalar.hpp"

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#if defined(__AVX__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>  // a third of the time of the whole, which Eigen too asks for from AVX on
#elif defined(__ARM_NEON) && defined(__aarch64__)
#include <arm_neon.h>
#endif

namespace crossbeam {

namespace detail {

template <int Bytes>
struct MaskInteger;
template <>
struct MaskInteger<4> {
  using type = std::int32_t;
};
template <>
struct MaskInteger<8> {
  using type = std::int64_t;
};

// The vector type must be spelled in a trait of its own: inside the class template g++ drops the
// attribute.
template <class S, int N>
struct VectorOf {
  typedef S type __attribute__((vector_size(N * sizeof(S))));
  // In memory: at any address of an S. (A copy by memcpy is cut into 128-bit pieces by g++ 12, which
  // a load of the whole then has to wait for.)
  typedef S unaligned __attribute__((vector_size(N * sizeof(S)), aligned(alignof(S)), may_alias));
};
/// One lane is a plain number, and its mask a bool: g++ 12 miscompiles masks of one-element vectors
/// from -O2 on (a stopped plate was pushed on by its friction, V-CONT-22), and other compilers have
/// no vectors.
template <class S>
struct VectorOf<S, 1> {
  using type = S;
  using unaligned = S;
};
template <class S, int N>
using MaskOf =
    std::conditional_t<N == 1, bool,
                       typename VectorOf<typename MaskInteger<sizeof(S)>::type, N>::type>;

}  // namespace detail

/// Result of comparing packs, one truth value per lane.
template <class S, int N>
struct PackMask {
  using Integer = typename detail::MaskInteger<sizeof(S)>::type;
  using Vector = detail::MaskOf<S, N>;
  Vector v;

  CROSSBEAM_HOST_INLINE friend PackMask operator&(PackMask a, PackMask b) {
    return {Vector(a.v & b.v)};
  }
  CROSSBEAM_HOST_INLINE friend PackMask operator|(PackMask a, PackMask b) {
    return {Vector(a.v | b.v)};
  }
  CROSSBEAM_HOST_INLINE friend PackMask operator&&(PackMask a, PackMask b) { return a & b; }
  CROSSBEAM_HOST_INLINE friend PackMask operator||(PackMask a, PackMask b) { return a | b; }
  CROSSBEAM_HOST_INLINE friend PackMask operator!(PackMask a) {
    if constexpr (N == 1)
      return {!a.v};
    else
      return {~a.v};
  }
  CROSSBEAM_HOST_INLINE bool operator[]([[maybe_unused]] int lane) const {
    if constexpr (N == 1)
      return v;
    else
      return v[lane] != 0;
  }

  CROSSBEAM_HOST_INLINE friend bool any(PackMask a) {
    if constexpr (N == 1) {
      return a.v;
    } else if constexpr (has_bits) {
      return a.bits() != 0;
    } else {
      Integer r = 0;
      for (int i = 0; i < N; ++i) r |= a.v[i];
      return r != 0;
    }
  }
  CROSSBEAM_HOST_INLINE friend bool all(PackMask a) {
    if constexpr (N == 1) {
      return a.v;
    } else if constexpr (has_bits) {
      return (!a).bits() == 0;
    } else {
      Integer r = -1;
      for (int i = 0; i < N; ++i) r &= a.v[i];
      return r != 0;
    }
  }

 private:
  /// Whether `bits` has an instruction for masks of this size: g++ 12 makes a chain of shuffles of
  /// the loops.
#if defined(__AVX512DQ__)
  static constexpr bool has_bits = sizeof(Vector) >= 16 && sizeof(Vector) <= 64;
#elif defined(__AVX__)
  static constexpr bool has_bits = sizeof(Vector) == 16 || sizeof(Vector) == 32;
#elif defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__))
  static constexpr bool has_bits = sizeof(Vector) == 16;
#else
  static constexpr bool has_bits = false;
#endif

  /// Not zero where a lane is true.
  CROSSBEAM_HOST_INLINE auto bits() const {
#if defined(__AVX512DQ__)
    if constexpr (sizeof(Vector) == 64 && sizeof(S) == 8)
      return _mm512_movepi64_mask(__m512i(v));
    else if constexpr (sizeof(Vector) == 64)
      return _mm512_movepi32_mask(__m512i(v));
    else
#endif
#if defined(__AVX__)
        if constexpr (sizeof(Vector) == 32 && sizeof(S) == 8)
      return _mm256_movemask_pd(__m256d(v));
    else if constexpr (sizeof(Vector) == 32)
      return _mm256_movemask_ps(__m256(v));
    else
#endif
#if defined(__SSE2__)
        if constexpr (sizeof(S) == 8)
      return _mm_movemask_pd(__m128d(v));
    else
      return _mm_movemask_ps(__m128(v));
#elif defined(__ARM_NEON) && defined(__aarch64__)
    return vmaxvq_u32(uint32x4_t(v));
#else
    return 0;
#endif
  }
};

template <class S, int N>
struct Pack {
  using Value = S;
  using Vector = typename detail::VectorOf<S, N>::type;
  using Mask = PackMask<S, N>;
  Vector v;

  Pack() = default;
  CROSSBEAM_HOST_INLINE Pack(Vector x) : v(x) {}
  /// Broadcast. (s - 0 is s, and costs nothing; s + 0 would lose the sign of -0.)
  template <class A>
    requires std::is_arithmetic_v<A>
  CROSSBEAM_HOST_INLINE Pack(A s) : v(static_cast<S>(s) - Vector{}) {}

  CROSSBEAM_HOST_INLINE static Pack load(const S* from) {
    return Vector(*reinterpret_cast<const typename detail::VectorOf<S, N>::unaligned*>(from));
  }
  CROSSBEAM_HOST_INLINE void store(S* to) const {
    *reinterpret_cast<typename detail::VectorOf<S, N>::unaligned*>(to) = v;
  }
  CROSSBEAM_HOST_INLINE S operator[]([[maybe_unused]] int lane) const {
    if constexpr (N == 1)
      return v;
    else
      return v[lane];
  }
  CROSSBEAM_HOST_INLINE void set([[maybe_unused]] int lane, S value) {
    if constexpr (N == 1)
      v = value;
    else
      v[lane] = value;
  }

  CROSSBEAM_HOST_INLINE friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
  CROSSBEAM_HOST_INLINE friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
  CROSSBEAM_HOST_INLINE friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
  CROSSBEAM_HOST_INLINE friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
  CROSSBEAM_HOST_INLINE friend Pack operator-(Pack a) { return -a.v; }
  CROSSBEAM_HOST_INLINE friend Pack operator+(Pack a) { return a; }
  CROSSBEAM_HOST_INLINE Pack& operator+=(Pack b) { return v += b.v, *this; }
  CROSSBEAM_HOST_INLINE Pack& operator-=(Pack b) { return v -= b.v, *this; }
  CROSSBEAM_HOST_INLINE Pack& operator*=(Pack b) { return v *= b.v, *this; }

  CROSSBEAM_HOST_INLINE friend Mask operator<(Pack a, Pack b) { return {a.v < b.v}; }
  CROSSBEAM_HOST_INLINE friend Mask operator<=(Pack a, Pack b) { return {a.v <= b.v}; }
  CROSSBEAM_HOST_INLINE friend Mask operator>(Pack a, Pack b) { return {a.v > b.v}; }
  CROSSBEAM_HOST_INLINE friend Mask operator>=(Pack a, Pack b) { return {a.v >= b.v}; }
  CROSSBEAM_HOST_INLINE friend Mask operator==(Pack a, Pack b) { return {a.v == b.v}; }

  CROSSBEAM_HOST_INLINE friend Pack select(Mask m, Pack a, Pack b) { return m.v ? a.v : b.v; }

  CROSSBEAM_HOST_INLINE friend Pack magnitude(Pack a) {
    if constexpr (N == 1)
      return std::abs(a.v);
    else
      return Vector(Bits(a.v) & ~sign_bits());
  }
  CROSSBEAM_HOST_INLINE friend Pack times_sign(Pack a, Pack b) {
    if constexpr (N == 1)
      return std::signbit(b.v) ? -a.v : a.v;
    else
      return Vector(Bits(a.v) ^ (Bits(b.v) & sign_bits()));
  }

  /// Square root by the vector unit itself, so that no compiler flag is needed. (The masked forms:
  /// the plain 512-bit ones read an undefined register in g++ 12's headers and warn.)
  CROSSBEAM_HOST_INLINE friend Pack sqrt(Pack a) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Vector) == 64 && sizeof(S) == 8)
      return Vector(_mm512_mask_sqrt_pd(__m512d(a.v), 0xff, __m512d(a.v)));
    else if constexpr (sizeof(Vector) == 64)
      return Vector(_mm512_mask_sqrt_ps(__m512(a.v), 0xffff, __m512(a.v)));
    else
#endif
#if defined(__AVX__)
        if constexpr (sizeof(Vector) == 32 && sizeof(S) == 8)
      return Vector(_mm256_sqrt_pd(__m256d(a.v)));
    else if constexpr (sizeof(Vector) == 32)
      return Vector(_mm256_sqrt_ps(__m256(a.v)));
    else
#endif
#if defined(__SSE2__)
        if constexpr (sizeof(Vector) == 16 && sizeof(S) == 8)
      return Vector(_mm_sqrt_pd(__m128d(a.v)));
    else if constexpr (sizeof(Vector) == 16)
      return Vector(_mm_sqrt_ps(__m128(a.v)));
    else
#elif defined(__ARM_NEON) && defined(__aarch64__)
    if constexpr (sizeof(Vector) == 16 && sizeof(S) == 8)
      return Vector(vsqrtq_f64(float64x2_t(a.v)));
    else if constexpr (sizeof(Vector) == 16)
      return Vector(vsqrtq_f32(float32x4_t(a.v)));
    else
#endif
      return per_lane(a, [](S s) { return std::sqrt(s); });
  }

  template <class Op>
  CROSSBEAM_HOST_INLINE friend Pack per_lane(Pack a, Op op) {
    Pack r;
    for (int i = 0; i < N; ++i) r.set(i, static_cast<S>(op(a[i])));
    return r;
  }

  // Lane after lane, in their order. Written out, for g++ -O2 runs a loop through memory.
  CROSSBEAM_HOST_INLINE friend S lane_maximum(Pack a) {
    return [a]<int... k>(std::integer_sequence<int, k...>) {
      S r = a[0];
      ((r = a[k] > r ? a[k] : r), ...);
      return r;
    }(std::make_integer_sequence<int, N>());
  }
  CROSSBEAM_HOST_INLINE friend S lane_sum(Pack a) {
    return [a]<int... k>(std::integer_sequence<int, k...>) {
      S r = a[0];
      ((r += a[k + 1]), ...);
      return r;
    }(std::make_integer_sequence<int, N - 1>());
  }

 private:
  using Bits = typename Mask::Vector;
  CROSSBEAM_HOST_INLINE static Bits sign_bits() {
    return Bits{} | (std::numeric_limits<typename Mask::Integer>::min)();
  }
};

template <class S, int N>
struct ScalarTraits<Pack<S, N>> {
  using Real = S;
  using Passive = Pack<S, N>;
  static constexpr int lanes = N;
  static constexpr int derivative_order = 0;
};

template <int N>
struct DoubleLanes<Pack<float, N>> {
  using type = Pack<double, N>;
};

/// T itself or half of it, so that as many doubles fill one register: what differences of positions are
/// formed in.
template <class T>
struct DifferenceLanes {
  using type = T;
};
template <int N>
  requires(N > 1)
struct DifferenceLanes<Pack<float, N>> {
  using type = Pack<float, N / 2>;
};
template <class T>
using difference_lanes_t = typename DifferenceLanes<T>::type;

/// The same numbers in the precision of T, rounded to nearest.
template <class T, class U>
CROSSBEAM_HOST_INLINE T convert(const U& x) {
  if constexpr (std::is_same_v<T, U>) {
    return x;
  } else if constexpr (lanes_v<T> == 1) {
    return T(static_cast<real_t<T>>(x[0]));
  } else {
    return T(__builtin_convertvector(x.v, typename T::Vector));
  }
}
template <class T, class U>
CROSSBEAM_HOST_INLINE Vec3<T> convert(const Vec3<U>& v) {
  return {convert<T>(v.x), convert<T>(v.y), convert<T>(v.z)};
}

/// Integer part, towards zero, of numbers that fit an int: as numbers and as integers.
template <class S, int N>
CROSSBEAM_HOST_INLINE Pack<S, N> truncate(const Pack<S, N>& x, int (&integers)[N]) {
  if constexpr (N == 1) {
    integers[0] = static_cast<int>(x[0]);
    return Pack<S, N>(integers[0]);
  } else {
    // All lanes at once: numbers written one by one and read as a whole would have to wait.
    using Integers = typename detail::VectorOf<int, N>::type;
    const Integers i = __builtin_convertvector(x.v, Integers);
    *reinterpret_cast<typename detail::VectorOf<int, N>::unaligned*>(integers) = i;
    return __builtin_convertvector(i, typename Pack<S, N>::Vector);
  }
}

/// c[k] of every lane = from(lane)[k], k = 0..2. Reads from(lane)[3] too.
template <class From, class S, int N>
CROSSBEAM_HOST_INLINE void gather_three(const From& from, Pack<S, N> (&c)[3]) {
#if defined(__AVX512F__)
  if constexpr (std::is_same_v<S, double> && N == 8) {
    const auto pair = [&](int k) {  // lanes k and k + 2
      return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(from(k))),
                                _mm256_loadu_pd(from(k + 2)), 1);
    };
    const __m512d r0 = pair(0), r1 = pair(1), r2 = pair(4), r3 = pair(5);
    const __m512d a = _mm512_unpacklo_pd(r0, r1), b = _mm512_unpackhi_pd(r0, r1);
    const __m512d d = _mm512_unpacklo_pd(r2, r3), e = _mm512_unpackhi_pd(r2, r3);
    c[0].v = _mm512_shuffle_f64x2(a, d, 0x88);
    c[1].v = _mm512_shuffle_f64x2(b, e, 0x88);
    c[2].v = _mm512_shuffle_f64x2(a, d, 0xdd);
    return;
  } else if constexpr (std::is_same_v<S, float> && N == 16) {
    const auto four = [&](int k) {  // lanes k, k + 4, k + 8, k + 12
      __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(from(k)));
      r = _mm512_insertf32x4(r, _mm_loadu_ps(from(k + 4)), 1);
      r = _mm512_insertf32x4(r, _mm_loadu_ps(from(k + 8)), 2);
      return _mm512_insertf32x4(r, _mm_loadu_ps(from(k + 12)), 3);
    };
    const __m512 r0 = four(0), r1 = four(1), r2 = four(2), r3 = four(3);
    const __m512 a = _mm512_unpacklo_ps(r0, r1), b = _mm512_unpackhi_ps(r0, r1);
    const __m512 d = _mm512_unpacklo_ps(r2, r3), e = _mm512_unpackhi_ps(r2, r3);
    c[0].v = _mm512_shuffle_ps(a, d, 0x44);
    c[1].v = _mm512_shuffle_ps(a, d, 0xee);
    c[2].v = _mm512_shuffle_ps(b, e, 0x44);
    return;
  } else
#endif
#if defined(__AVX__)
      if constexpr (std::is_same_v<S, double> && N == 4) {
    const __m256d r0 = _mm256_loadu_pd(from(0)), r1 = _mm256_loadu_pd(from(1));
    const __m256d r2 = _mm256_loadu_pd(from(2)), r3 = _mm256_loadu_pd(from(3));
    const __m256d a = _mm256_unpacklo_pd(r0, r1), b = _mm256_unpackhi_pd(r0, r1);
    const __m256d d = _mm256_unpacklo_pd(r2, r3), e = _mm256_unpackhi_pd(r2, r3);
    c[0].v = _mm256_permute2f128_pd(a, d, 0x20);
    c[1].v = _mm256_permute2f128_pd(b, e, 0x20);
    c[2].v = _mm256_permute2f128_pd(a, d, 0x31);
    return;
  } else if constexpr (std::is_same_v<S, float> && N == 8) {
    // Lane k and lane k + 4 share a register.
    const auto pair = [&](int k) {
      return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(from(k))),
                                  _mm_loadu_ps(from(k + 4)), 1);
    };
    const __m256 r0 = pair(0), r1 = pair(1), r2 = pair(2), r3 = pair(3);
    const __m256 a = _mm256_unpacklo_ps(r0, r1), b = _mm256_unpackhi_ps(r0, r1);
    const __m256 d = _mm256_unpacklo_ps(r2, r3), e = _mm256_unpackhi_ps(r2, r3);
    c[0].v = _mm256_shuffle_ps(a, d, 0x44);
    c[1].v = _mm256_shuffle_ps(a, d, 0xee);
    c[2].v = _mm256_shuffle_ps(b, e, 0x44);
    return;
  } else
#endif
  {
    // Through memory: compilers fill a register lane by lane more slowly, floats most of all.
    S r[3][N];
    for (int lane = 0; lane < N; ++lane)
      for (int k = 0; k < 3; ++k) r[k][lane] = from(lane)[k];
    for (int k = 0; k < 3; ++k) c[k] = Pack<S, N>::load(r[k]);
  }
}

namespace detail {
#if defined(__AVX512F__)
inline constexpr int vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif
}  // namespace detail

/// The pack that fills one vector register of the machine compiled for. The only place that
/// decides the width; a host code may put its own type here by defining the macro.
#ifdef CROSSBEAM_NATIVE_PACK
template <class S>
using NativePack = CROSSBEAM_NATIVE_PACK<S>;
#else
template <class S>
using NativePack = Pack<S, detail::vector_bytes / static_cast<int>(sizeof(S))>;
#endif

}  // namespace crossbeam
