#pragma once
/// @file
/// How a benchmark states its result, and under which names it is registered.

#include "crossbeam/base/simd.hpp"

#include <benchmark/benchmark.h>

#include <string>
#include <type_traits>

namespace bench {

/// Counters of a benchmark whose iteration worked on `items` points, cells or elements:
/// items_per_second, and its inverse as a time (seconds in the JSON file; the console adds the
/// prefix).
inline void report(benchmark::State& state, double items, const char* time_per_item) {
  using benchmark::Counter;
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
  state.counters[time_per_item] =
      Counter(items, Counter::Flags(Counter::kIsIterationInvariantRate | Counter::kInvert));
}

/// What a benchmark's name says of its number type.
template <class T>
std::string number_name() {
  const std::string real = std::is_same_v<crossbeam::real_t<T>, float> ? "float" : "double";
  return crossbeam::lanes_v<T> == 1 ? real : "pack_" + real;
}

/// Calls `use` with each of the number types that kernels are timed with.
template <class Use>
void for_each_number(Use use) {
  use.template operator()<double>();
  use.template operator()<crossbeam::NativePack<double>>();
  use.template operator()<crossbeam::NativePack<float>>();
}

/// Puts compiler and pack width into the record. Google Benchmark writes processor and load itself.
inline bool record_build() {
#if defined(__clang__)
  benchmark::AddCustomContext("compiler", "clang " __clang_version__);
#elif defined(__GNUC__)
  benchmark::AddCustomContext("compiler", "g++ " __VERSION__);
#endif
  benchmark::AddCustomContext("flags", CROSSBEAM_BENCH_FLAGS);
  benchmark::AddCustomContext("pack_lanes_double",
                              std::to_string(crossbeam::lanes_v<crossbeam::NativePack<double>>));
  benchmark::AddCustomContext("pack_lanes_float",
                              std::to_string(crossbeam::lanes_v<crossbeam::NativePack<float>>));
  return true;
}

}  // namespace bench
