// libFuzzer target: scene_properties.hpp. A broken promise ends the program, and libFuzzer keeps
// the text.

#include "fuzz/scene_properties.hpp"

#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    static_cast<void>(
        fuzz::check_scene(std::string_view(reinterpret_cast<const char*>(data), size)));
  } catch (const fuzz::Broken& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::abort();
  }
  return 0;
}
