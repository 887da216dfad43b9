#pragma once
/// @file
/// Standard output and standard error as they are: closed, full, or read by nobody.

#include <cstdio>
#include <string_view>

namespace crossbeam::drape {

/// To be called first. A standard stream that the caller has closed stays unusable, but its number
/// is taken: otherwise the next file to be opened would get it, and messages would go into results.
void hold_standard_streams();

/// False when the stream does not take all of the text; errno has the reason.
[[nodiscard]] bool write_stream(std::FILE* stream, std::string_view text);

}  // namespace crossbeam::drape
