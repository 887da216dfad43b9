#pragma once
/// @file
/// A number that counts what is done with it, to learn how many operations a kernel takes: run the
/// kernel on Counting<double> and read operation_count(). Values are those of the plain number.
///
/// Counted is what is written, before a compiler fuses operations or drops those whose result
/// nobody uses. Work on plain constants of the kernel is not counted: it is done once, or by the
/// compiler.

#include "crossbeam/base/scalar.hpp"

#include <Eigen/Core>

#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace crossbeam {

/// Operations done by the Counting numbers of one thread.
struct OperationCount {
  std::int64_t additions = 0;        ///< and subtractions
  std::int64_t multiplications = 0;  ///< a fused multiply-add counts as one of each
  std::int64_t divisions = 0;
  std::int64_t square_roots = 0;
  std::int64_t comparisons = 0;  ///< of two numbers
  std::int64_t selections = 0;   ///< by a mask
  std::int64_t negations = 0;    ///< changes of the sign alone
  std::int64_t functions = 0;    ///< sin, cos, exp, log and calls through per_lane

  /// Floating-point operations by the convention of every rate here: addition, multiplication,
  /// division and square root count one each, so that a fused multiply-add is two; comparison,
  /// selection, negation and library functions count none. A division takes as long as many
  /// additions, so that a kernel with divisions cannot reach the rate of one without.
  [[nodiscard]] std::int64_t flops() const {
    return additions + multiplications + divisions + square_roots;
  }

  friend OperationCount operator-(const OperationCount& a, const OperationCount& b) {
    return {a.additions - b.additions,     a.multiplications - b.multiplications,
            a.divisions - b.divisions,     a.square_roots - b.square_roots,
            a.comparisons - b.comparisons, a.selections - b.selections,
            a.negations - b.negations,     a.functions - b.functions};
  }
  friend bool operator==(const OperationCount&, const OperationCount&) = default;
};

namespace detail {
inline thread_local OperationCount counted_operations{};
}

/// What the calling thread's numbers have done since its reset_operation_count(), or since it
/// began.
inline OperationCount operation_count() { return detail::counted_operations; }
inline void reset_operation_count() { detail::counted_operations = {}; }

/// Result of a comparison. A bool, and a mask of one lane for loops written for packs.
struct CountingMask {
  bool v;

  operator bool() const { return v; }
  bool operator[](int) const { return v; }
  friend CountingMask operator&(CountingMask a, CountingMask b) { return {a.v && b.v}; }
  friend CountingMask operator|(CountingMask a, CountingMask b) { return {a.v || b.v}; }
  friend CountingMask operator&&(CountingMask a, CountingMask b) { return {a.v && b.v}; }
  friend CountingMask operator||(CountingMask a, CountingMask b) { return {a.v || b.v}; }
  friend CountingMask operator!(CountingMask a) { return {!a.v}; }
  friend bool any(CountingMask a) { return a.v; }
  friend bool all(CountingMask a) { return a.v; }
};

/// @tparam T float or double. Also stands in for a pack of one lane (load, store, [lane]).
template <std::floating_point T>
struct Counting {
  using Value = T;
  using Mask = CountingMask;
  T v{};

  Counting() = default;
  template <class A>
    requires std::is_arithmetic_v<A>
  Counting(A value) : v(static_cast<T>(value)) {}
  template <class A>
    requires(std::is_arithmetic_v<A> && !std::is_same_v<A, bool>)
  explicit operator A() const {
    return static_cast<A>(v);
  }

  static Counting load(const T* from) { return *from; }
  void store(T* to) const { *to = v; }
  T operator[](int) const { return v; }
  void set(int, T value) { v = value; }

  friend Counting operator+(Counting a, Counting b) {
    return ++counts().additions, Counting(a.v + b.v);
  }
  friend Counting operator-(Counting a, Counting b) {
    return ++counts().additions, Counting(a.v - b.v);
  }
  friend Counting operator*(Counting a, Counting b) {
    return ++counts().multiplications, Counting(a.v * b.v);
  }
  friend Counting operator/(Counting a, Counting b) {
    return ++counts().divisions, Counting(a.v / b.v);
  }
  friend Counting operator-(Counting a) { return ++counts().negations, Counting(-a.v); }
  friend Counting operator+(Counting a) { return a; }
  Counting& operator+=(Counting b) { return *this = *this + b; }
  Counting& operator-=(Counting b) { return *this = *this - b; }
  Counting& operator*=(Counting b) { return *this = *this * b; }
  Counting& operator/=(Counting b) { return *this = *this / b; }

  friend Mask operator<(Counting a, Counting b) { return compared(a.v < b.v); }
  friend Mask operator<=(Counting a, Counting b) { return compared(a.v <= b.v); }
  friend Mask operator>(Counting a, Counting b) { return compared(a.v > b.v); }
  friend Mask operator>=(Counting a, Counting b) { return compared(a.v >= b.v); }
  friend Mask operator==(Counting a, Counting b) { return compared(a.v == b.v); }

  friend Counting select(bool mask, const Counting& a, const Counting& b) {
    return ++counts().selections, mask ? a : b;
  }

  friend Counting sqrt(Counting a) { return ++counts().square_roots, Counting(std::sqrt(a.v)); }
  friend Counting sin(Counting a) { return function(std::sin(a.v)); }
  friend Counting cos(Counting a) { return function(std::cos(a.v)); }
  friend Counting exp(Counting a) { return function(std::exp(a.v)); }
  friend Counting log(Counting a) { return function(std::log(a.v)); }
  template <class Op>
  friend Counting per_lane(const Counting& a, Op op) {
    return function(op(a.v));
  }
  friend bool isfinite(Counting a) { return std::isfinite(a.v); }
  friend T lane_maximum(Counting a) { return a.v; }
  friend T lane_sum(Counting a) { return a.v; }

 private:
  static OperationCount& counts() { return detail::counted_operations; }
  static Mask compared(bool answer) { return ++counts().comparisons, Mask{answer}; }
  static Counting function(T value) { return ++counts().functions, Counting(value); }
};

template <class T>
struct ScalarTraits<Counting<T>> {
  using Real = T;
  using Passive = Counting<T>;
  static constexpr int lanes = 1;
  static constexpr int derivative_order = 0;
};
template <>
struct DoubleLanes<Counting<float>> {
  using type = Counting<double>;
};

}  // namespace crossbeam

/// Lets Eigen's fixed-size matrices hold them.
template <class T>
struct Eigen::NumTraits<crossbeam::Counting<T>> : Eigen::NumTraits<T> {
  using Real = crossbeam::Counting<T>;
  using NonInteger = crossbeam::Counting<T>;
  using Nested = crossbeam::Counting<T>;
  enum { RequireInitialization = 1 };
};
