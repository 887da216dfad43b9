/// @file
/// What this machine can do at most, one core: the lines that the kernels are measured against.
///
///   roofline/fma/<number>                    multiply-adds, `flops`
///   roofline/division|square_root/<number>   packs as fast as they come, `flops` (one per lane)
///   roofline/read/<where>/<number>           sum of an array, `bytes`
///   roofline/triad/dram/<number>             a = b + s c, `bytes` (two read, one written)

#include "support/peak.hpp"
#include "support/report.hpp"

#include "crossbeam/mesh/arrays.hpp"

#include <cstddef>
#include <string>

namespace bench {
namespace {

using crossbeam::AlignedArray;
using crossbeam::lanes_v;
using crossbeam::NativePack;
using crossbeam::real_t;

benchmark::Counter per_second(double per_iteration) {
  return {per_iteration, benchmark::Counter::kIsIterationInvariantRate};
}

template <class T>
void fma(benchmark::State& state) {
  constexpr std::int64_t rounds = 10000;
  for (auto _ : state) run_fma_chains<real_t<T>>(rounds);
  state.counters["flops"] =
      per_second(static_cast<double>(rounds) * flops_per_fma_round<real_t<T>>());
}

/// Eight packs, which stay in registers as long as nobody asks for their address.
template <class T>
struct Eight {
  T x0, x1, x2, x3, x4, x5, x6, x7;

  [[nodiscard]] T sum() const { return ((x0 + x1) + (x2 + x3)) + ((x4 + x5) + (x6 + x7)); }
};

/// Eight chains of `op(x)`, each keeping its numbers near 1.
template <class T, class Op>
void chains(benchmark::State& state, const Op& op) {
  using R = real_t<T>;
  constexpr int rounds = 1000;
  const auto near_one = [](int k) { return T(R(1) + R(k) / R(100)); };
  Eight<T> start{near_one(1), near_one(2), near_one(3), near_one(4),
                 near_one(5), near_one(6), near_one(7), near_one(8)};
  for (auto _ : state) {
    benchmark::DoNotOptimize(start);
    Eight<T> c = start;
    for (int k = 0; k < rounds; ++k)
      c = {op(c.x0), op(c.x1), op(c.x2), op(c.x3), op(c.x4), op(c.x5), op(c.x6), op(c.x7)};
    T sum = c.sum();
    benchmark::DoNotOptimize(sum);
  }
  state.counters["flops"] = per_second(8.0 * rounds * lanes_v<T>);
}

/// Eight sums side by side, so that the additions are not what takes the time.
template <class T>
void read(benchmark::State& state, std::size_t bytes) {
  using R = real_t<T>;
  constexpr std::size_t lanes = static_cast<std::size_t>(lanes_v<T>), block = 8 * lanes;
  const std::size_t count = bytes / sizeof(R) / block * block;
  AlignedArray<R> data;
  data.resize(count);
  for (auto& value : data) value = R(1);
  const T zero(R(0));
  for (auto _ : state) {
    Eight<T> s{zero, zero, zero, zero, zero, zero, zero, zero};
    for (std::size_t k = 0; k < count; k += block) {
      const auto at = [&](std::size_t i) { return T::load(data.data() + k + i * lanes); };
      s = {s.x0 + at(0), s.x1 + at(1), s.x2 + at(2), s.x3 + at(3),
           s.x4 + at(4), s.x5 + at(5), s.x6 + at(6), s.x7 + at(7)};
    }
    T sum = s.sum();
    benchmark::DoNotOptimize(sum);
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] = per_second(static_cast<double>(count * sizeof(R)));
  state.counters["size"] = static_cast<double>(count * sizeof(R));
}

template <class T>
void triad(benchmark::State& state, std::size_t bytes) {
  using R = real_t<T>;
  constexpr std::size_t lanes = static_cast<std::size_t>(lanes_v<T>);
  const std::size_t count = bytes / 3 / sizeof(R) / lanes * lanes;
  AlignedArray<R> a, b, c;
  for (auto* array : {&a, &b, &c}) {
    array->resize(count);
    for (auto& value : *array) value = R(1);
  }
  const T factor(R(3));
  for (auto _ : state) {
    for (std::size_t k = 0; k < count; k += lanes)
      (T::load(b.data() + k) + factor * T::load(c.data() + k)).store(a.data() + k);
    benchmark::ClobberMemory();
  }
  state.counters["bytes"] = per_second(3.0 * static_cast<double>(count * sizeof(R)));
  state.counters["size"] = 3.0 * static_cast<double>(count * sizeof(R));
}

template <class T>
void register_number() {
  const std::string number = "/" + number_name<T>();
  const auto add = [&](const std::string& what, auto run) {
    return benchmark::RegisterBenchmark(("roofline/" + what + number).c_str(), run);
  };
  add("fma", fma<T>);
  add("division", [](benchmark::State& state) {
    T one(real_t<T>(1));
    benchmark::DoNotOptimize(one);
    chains<T>(state, [one](const T& x) { return one / x; });
  });
  add("square_root", [](benchmark::State& state) {
    chains<T>(state, [](const T& x) {
      using std::sqrt;
      return sqrt(x);
    });
  });
  // Half of a usual first-level cache of 32 KiB, second of 512 KiB, third of 16 MiB; and beyond
  // what any third level holds for one core.
  constexpr std::size_t KiB = 1024, MiB = 1024 * KiB;
  const auto add_read = [&](const char* where, std::size_t bytes) {
    add("read/" + std::string(where), [bytes](benchmark::State& state) { read<T>(state, bytes); });
  };
  add_read("l1", 16 * KiB);
  add_read("l2", 256 * KiB);
  add_read("l3", 8 * MiB);
  add_read("dram", 192 * MiB);
  add("triad/dram", [](benchmark::State& state) { triad<T>(state, 192 * MiB); });
}

[[maybe_unused]] const bool registered = [] {
  record_build();
  register_number<NativePack<double>>();
  register_number<NativePack<float>>();
  return true;
}();

}  // namespace
}  // namespace bench
