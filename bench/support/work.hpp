#pragma once
/// @file
/// How much work an item is, and how near to the machine's peak it is done.

#include "support/peak.hpp"
#include "support/ring.hpp"

#include "crossbeam/base/counting.hpp"

#include <benchmark/benchmark.h>

namespace bench {

/// Of one item; see OperationCount for what is a flop.
struct Work {
  double flops = 0;
  double bytes = 0;  ///< that have to come in and go out, whatever cache they are in; 0: not said
};

/// Flops of `kernel(k)` per state of the ring, k = 0..ring_size-1, on counting numbers: a mean
/// where the number of sweeps depends on the state.
template <class Kernel>
double counted_flops(const Kernel& kernel) {
  crossbeam::reset_operation_count();
  for (int k = 0; k < ring_size; ++k) benchmark::DoNotOptimize(kernel(k));
  return static_cast<double>(crossbeam::operation_count().flops()) / ring_size;
}

/// Counters of a benchmark whose iteration worked on `items`, each worth `work`: work per item,
/// flops per second, and their share of the peak of packs of R.
template <class R>
void report_work(benchmark::State& state, double items, const Work& work) {
  using benchmark::Counter;
  state.counters["flops_per_item"] = work.flops;
  if (work.bytes > 0) state.counters["bytes_per_item"] = work.bytes;
  state.counters["flops"] = Counter(items * work.flops, Counter::kIsIterationInvariantRate);
  state.counters["share_of_peak"] =
      Counter(items * work.flops / peak_flops<R>(), Counter::kIsIterationInvariantRate);
}

}  // namespace bench
