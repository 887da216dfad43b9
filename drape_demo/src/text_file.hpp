#pragma once
/// @file
/// Writing a whole file, with the errors that streams keep to themselves.

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace crossbeam::drape {

/// Throws std::runtime_error naming file and reason, also for a disk that fills up on the way.
inline void write_file(const std::filesystem::path& file, std::string_view content) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream)
    throw std::runtime_error("cannot write " + file.string() + ": " +
                             (errno != 0 ? std::strerror(errno) : "the stream failed"));
}

}  // namespace crossbeam::drape
