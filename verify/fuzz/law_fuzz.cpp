// libFuzzer target: properties.hpp. A broken promise ends the program, and libFuzzer keeps the
// input.

#include "fuzz/properties.hpp"

#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    static_cast<void>(fuzz::check_law(std::span<const std::uint8_t>(data, size)));
  } catch (const fuzz::Broken& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::abort();
  }
  return 0;
}
