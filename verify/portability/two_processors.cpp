// A program of two files that are compiled for different processors: this one for the lowest, the
// other for a later one (docs/embedding.md). They agree about every public struct, and a response
// computed there is that computed here up to rounding. Returns 0; 1: they differ; 77: this processor
// cannot run the other file.

#include "two_processors.hpp"

#include <cmath>
#include <cstdio>

int main() {
#if defined(__x86_64__)
  if (LEVEL == 4 ? !(__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                     __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
                 : !(__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))) {
    std::printf("two processors: skipped, no x86-64-v%d here\n", LEVEL);
    return 77;
  }
#endif
  using namespace two_processors;
  int faults = 0;
  const auto here = layout(), there = layout_there();
  for (std::size_t k = 0; k < here.size(); ++k)
    if (here[k] != there[k]) {
      ++faults;
      std::printf("two processors: entry %zu of the layout is %zu here, %zu there\n", k, here[k],
                  there[k]);
    }

  double largest = 0;
  int responses = 0;
  // In turn at both places that the smallest alignment allows.
  alignas(64) char place[2 * sizeof(Guarded)];
  for (const double e : {-0.02, 0.002, 0.01, 0.03})
    for (const double g : {-0.1, 0.0, 0.2}) {
      Matrix2<double> strain;
      strain << e, g, g, 0.5 * e;
      const auto mine = membrane_response(law(), strain, Tangent::yes);
      Guarded& yours = *new (place + responses++ % 2 * alignof(Guarded)) Guarded;
      respond_there(strain, yours);
      faults += yours.after != 1 || yours.response.status != mine.status;
      largest = std::fmax(largest, (yours.response.S - mine.S).cwiseAbs().maxCoeff());
      largest = std::fmax(largest, (yours.response.dS_dE - mine.dS_dE).cwiseAbs().maxCoeff() / 100);
    }
  std::printf("two processors: %d faults, %d responses differ by %.1e kN/mm\n", faults, responses,
              largest);
  return faults == 0 && largest < 1e-11 ? 0 : 1;  // of stresses about 1 kN/mm
}
