#pragma once
/// @file
/// The list of what the program has written into a folder: manifest.json.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace crossbeam::drape {

inline constexpr const char* manifest_name = "manifest.json";

/// A file as it was when it was written.
struct WrittenFile {
  std::string name;  ///< relative to the folder
  std::int64_t bytes = 0;
  std::int64_t modified_ns = 0;  ///< since 1970
  friend bool operator==(const WrittenFile&, const WrittenFile&) = default;
};

/// In the order of the names. A file may be listed twice, before and after it was replaced.
using Manifest = std::vector<WrittenFile>;
void sort_by_name(Manifest& manifest);

/// The manifest in a folder; none where there is no file of that name that this program can have
/// written. Names that lead out of the folder make it none.
[[nodiscard]] std::optional<Manifest> read_manifest(const std::filesystem::path& folder);

/// Of all files below a folder, without the manifest itself.
[[nodiscard]] Manifest manifest_of(const std::filesystem::path& folder);

/// Replaces the manifest of a folder as a whole. Throws std::runtime_error.
void write_manifest(const std::filesystem::path& folder, const Manifest& manifest);

/// Whether a file is there, and as it was when the program wrote it.
enum class FileState { absent, as_written, foreign };
[[nodiscard]] FileState state_of(const std::filesystem::path& folder, const Manifest& manifest,
                                 const std::string& name);

}  // namespace crossbeam::drape
