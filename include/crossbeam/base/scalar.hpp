#pragma once
/// @file
/// What a kernel may ask of its scalar. Every kernel is one template that runs on float, double,
/// long double, multiprecision numbers, dual numbers (base/dual.hpp) and SIMD packs
/// (base/simd.hpp). It therefore never branches on a value: it compares, gets a mask (bool or a
/// lane mask) and selects.

#include "crossbeam/base/version.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

/// Kernels are device code too where nvcc compiles them (docs/device_code.md); to other compilers
/// the macro says nothing.
#if defined(__CUDACC__)
#define CROSSBEAM_HOST_DEVICE __host__ __device__
#else
#define CROSSBEAM_HOST_DEVICE
#endif

/// Kernels must be inlined as a whole: compilers otherwise pass packs through memory.
#if defined(__CUDACC__)
#define CROSSBEAM_INLINE __host__ __device__ __forceinline__
#elif defined(__GNUC__)
#define CROSSBEAM_INLINE [[gnu::always_inline]] inline
#else
#define CROSSBEAM_INLINE inline
#endif

/// The same for lambdas, behind their parameters.
#if defined(__CUDACC__)
#define CROSSBEAM_INLINE_LAMBDA
#elif defined(__GNUC__)
#define CROSSBEAM_INLINE_LAMBDA __attribute__((always_inline))
#else
#define CROSSBEAM_INLINE_LAMBDA
#endif

/// The same for what stays on the processor: a device does not know the vector types of packs.
#if defined(__CUDACC__)
#define CROSSBEAM_HOST_INLINE __forceinline__
#else
#define CROSSBEAM_HOST_INLINE CROSSBEAM_INLINE
#endif

namespace crossbeam {

/// Whether x is a number and finite; of float and double by the exponent's bits, for under
/// -ffast-math compilers take std::isfinite for true. (By reference: there clang gives an argument
/// that is a NaN no defined value.)
template <class T>
CROSSBEAM_INLINE bool is_finite(const T& x) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(x) << 1 < std::uint64_t{0x7ff} << 53;
  } else if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<std::uint32_t>(x) << 1 < std::uint32_t{0xff} << 24;
  } else {
    using std::isfinite;
    return isfinite(x);
  }
}

/// What the kernels know about a scalar type. Packs and dual numbers specialise it.
template <class T>
struct ScalarTraits {
  using Real = T;                             ///< type of the constants a kernel mixes with T
  using Passive = T;                          ///< T without derivatives
  static constexpr int lanes = 1;             ///< values held side by side
  static constexpr int derivative_order = 0;  ///< highest derivative that T carries
};

template <class T>
using real_t = typename ScalarTraits<T>::Real;
template <class T>
using passive_t = typename ScalarTraits<T>::Passive;
template <class T>
inline constexpr int lanes_v = ScalarTraits<T>::lanes;

/// The type of positions: as many lanes of double as T has. Packs specialise it.
template <class T>
struct DoubleLanes {
  using type = T;
};
template <class T>
using double_lanes_t = typename DoubleLanes<T>::type;

/// The value without its derivatives. Dual numbers overload it.
template <class T>
  requires(ScalarTraits<T>::derivative_order == 0)
CROSSBEAM_INLINE constexpr const T& passive(const T& x) {
  return x;
}

template <class T>
CROSSBEAM_INLINE constexpr T select(bool condition, const T& a, const T& b) {
  return condition ? a : b;
}
CROSSBEAM_INLINE constexpr bool any(bool condition) { return condition; }
CROSSBEAM_INLINE constexpr bool all(bool condition) { return condition; }

template <class T>
CROSSBEAM_INLINE constexpr T maximum(const T& a, const T& b) {
  return select(a < b, b, a);
}
template <class T>
CROSSBEAM_INLINE constexpr T minimum(const T& a, const T& b) {
  return select(b < a, b, a);
}
template <class T>
CROSSBEAM_INLINE T magnitude(const T& a) {
  if constexpr (std::is_floating_point_v<T>)
    return std::abs(a);
  else
    return select(a < T(0), -a, a);
}
/// a times the sign of b.
template <class T>
CROSSBEAM_INLINE T times_sign(const T& a, const T& b) {
  if constexpr (std::is_floating_point_v<T>)
    return std::signbit(b) ? -a : a;
  else
    return select(b < T(0), -a, a);
}
template <class T>
CROSSBEAM_INLINE T square(const T& a) {
  return a * a;
}

/// Calls body(0), ..., body(N - 1), unrolled; the indices are integral constants. Arrays of packs
/// that a loop would index at run time have to live in memory, these do not.
template <int N, class Body>
CROSSBEAM_INLINE void unrolled(const Body& body) {
  [&]<int... k>(std::integer_sequence<int, k...>) CROSSBEAM_INLINE_LAMBDA {
    (body(std::integral_constant<int, k>{}), ...);
  }(std::make_integer_sequence<int, N>{});
}

/// Rounding unit of the numbers inside T.
template <class T>
constexpr real_t<T> epsilon_of() {
  return std::numeric_limits<real_t<T>>::epsilon();
}

/// The largest value over the lanes; for plain scalars, the value itself.
template <class T>
  requires(ScalarTraits<T>::lanes == 1)
CROSSBEAM_INLINE T lane_maximum(const T& x) {
  return x;
}
template <class T>
  requires(ScalarTraits<T>::lanes == 1)
CROSSBEAM_INLINE T lane_sum(const T& x) {
  return x;
}

/// Calls `op` on the numbers inside T one by one: for functions that no vector unit has.
template <class T, class Op>
  requires(ScalarTraits<T>::lanes == 1)
CROSSBEAM_INLINE T per_lane(const T& x, Op op) {
  return op(x);
}

/// Three components of any scalar: the points, directions and forces of the kernels. (The public
/// matrices are Eigen's; inside a SIMD sweep compilers optimise a plain struct better.)
template <class T>
struct Vec3 {
  T x, y, z;

  CROSSBEAM_INLINE friend Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  CROSSBEAM_INLINE friend Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  template <class S>
  CROSSBEAM_INLINE friend Vec3 operator*(const S& s, const Vec3& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
};

template <class T>
CROSSBEAM_INLINE T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
CROSSBEAM_INLINE Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace crossbeam
