#pragma once
/// @file
/// The most fused multiply-adds that one core of this machine does, measured: the yardstick of
/// every `share_of_peak`.

#include "crossbeam/base/simd.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace bench {

/// Chains of dependent multiply-adds side by side: two units of four cycles want eight. All of them
/// and two constants fit sixteen registers.
inline constexpr int fma_chains = 12;

/// Floating-point operations of one round of run_fma_chains; a multiply-add is two.
template <class R>
constexpr double flops_per_fma_round() {
  return 2.0 * fma_chains * crossbeam::lanes_v<crossbeam::NativePack<R>>;
}

/// `rounds` multiply-adds in every chain; the numbers tend to 1. Written on the vectors themselves
/// and in one expression, which every compiler fuses where the processor can.
template <class R>
[[gnu::noinline]] void run_fma_chains(std::int64_t rounds) {
  using Pack = crossbeam::NativePack<R>;
  Pack factor(R(0.75)), term(R(0.25));
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  const auto a = factor.v, b = term.v;
  auto x0 = Pack(R(0.10)).v, x1 = Pack(R(0.15)).v, x2 = Pack(R(0.20)).v, x3 = Pack(R(0.25)).v;
  auto x4 = Pack(R(0.30)).v, x5 = Pack(R(0.35)).v, x6 = Pack(R(0.40)).v, x7 = Pack(R(0.45)).v;
  auto x8 = Pack(R(0.50)).v, x9 = Pack(R(0.55)).v, x10 = Pack(R(0.60)).v, x11 = Pack(R(0.65)).v;
  for (std::int64_t k = 0; k < rounds; ++k) {
    x0 = x0 * a + b, x1 = x1 * a + b, x2 = x2 * a + b, x3 = x3 * a + b;
    x4 = x4 * a + b, x5 = x5 * a + b, x6 = x6 * a + b, x7 = x7 * a + b;
    x8 = x8 * a + b, x9 = x9 * a + b, x10 = x10 * a + b, x11 = x11 * a + b;
  }
  Pack sum(((x0 + x1) + (x2 + x3)) + ((x4 + x5) + (x6 + x7)) + ((x8 + x9) + (x10 + x11)));
  benchmark::DoNotOptimize(sum);
}

/// Floating-point operations per second with packs of R: the best of a few short runs, measured at
/// the first call (some 0.05 s), for other programs on the core only take away from it.
template <class R>
double peak_flops() {
  static const double peak = [] {
    using Clock = std::chrono::steady_clock;
    constexpr std::int64_t rounds = 400000;
    double best = 0;
    for (int run = 0; run < 20; ++run) {
      const auto begin = Clock::now();
      run_fma_chains<R>(rounds);
      const std::chrono::duration<double> seconds = Clock::now() - begin;
      const double flops = static_cast<double>(rounds) * flops_per_fma_round<R>();
      best = std::max(best, flops / seconds.count());
    }
    return best;
  }();
  return peak;
}

}  // namespace bench
