#pragma once
/// @file
/// toml++ with its assertions as exceptions. Release 3.3 asserts what depends on the text it reads
/// (no brace after a comma in a list, for one): the program would stop, or with NDEBUG go on as if
/// it were not so.

#include <stdexcept>

namespace crossbeam::drape {

/// A text that toml++ did not expect; it is no TOML.
struct UnexpectedText : std::logic_error {
  using std::logic_error::logic_error;
};

}  // namespace crossbeam::drape

// Some of the assertions stand in noexcept functions; they do not depend on the text.
#if defined(__clang__)
#pragma clang diagnostic push
#pragma clang diagnostic ignored "-Wexceptions"
#elif defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wterminate"
#endif
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition)        \
  ((condition) ? static_cast<void>(0) \
               : throw ::crossbeam::drape::UnexpectedText("not expected here: !(" #condition ")"))
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
#if defined(__clang__)
#pragma clang diagnostic pop
#elif defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
