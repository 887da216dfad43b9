#include "manifest.hpp"

#include "summary.hpp"
#include "text_file.hpp"

#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace crossbeam::drape {
namespace fs = std::filesystem;
namespace {

using Status = struct stat;

/// Neither absolute nor by way of "..".
bool stays_inside(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
}

/// Size and time of a file; none where there is no ordinary file. A link is none.
std::optional<WrittenFile> written_file(const fs::path& folder, const std::string& name) {
  Status status{};
  if (lstat((folder / name).c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return WrittenFile{name, static_cast<std::int64_t>(status.st_size),
                     1'000'000'000 * static_cast<std::int64_t>(status.st_mtim.tv_sec) +
                         static_cast<std::int64_t>(status.st_mtim.tv_nsec)};
}

}  // namespace

void sort_by_name(Manifest& manifest) { std::ranges::sort(manifest, {}, &WrittenFile::name); }

std::optional<Manifest> read_manifest(const fs::path& folder) {
  std::ifstream file(folder / manifest_name);
  const auto json = nlohmann::json::parse(file, nullptr, false);
  try {
    if (!json.is_object() || json.at("program") != summary_program) return {};
    Manifest manifest;
    for (const auto& entry : json.at("files")) {
      manifest.push_back({entry.at("name").get<std::string>(),
                          entry.at("bytes").get<std::int64_t>(),
                          entry.at("modified_ns").get<std::int64_t>()});
      if (!stays_inside(manifest.back().name)) return {};
    }
    sort_by_name(manifest);
    return manifest;
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

Manifest manifest_of(const fs::path& folder) {
  Manifest manifest;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).generic_string();
    const auto file = written_file(folder, name);
    if (file && name != manifest_name) manifest.push_back(*file);
  }
  sort_by_name(manifest);
  return manifest;
}

void write_manifest(const fs::path& folder, const Manifest& manifest) {
  nlohmann::ordered_json json{
      {"program", summary_program},
      {"about",
       "What the program has written here; a new result replaces these files and no other"},
      {"files", nlohmann::ordered_json::array()}};
  for (const WrittenFile& file : manifest)
    json["files"].push_back(
        {{"name", file.name}, {"bytes", file.bytes}, {"modified_ns", file.modified_ns}});
  const fs::path partial = folder / (std::string(manifest_name) + ".partial");
  write_file(partial, json.dump(1) + "\n");
  fs::rename(partial, folder / manifest_name);
}

FileState state_of(const fs::path& folder, const Manifest& manifest, const std::string& name) {
  Status status{};
  if (lstat((folder / name).c_str(), &status) != 0) return FileState::absent;
  const auto file = written_file(folder, name);
  const auto listed = std::ranges::equal_range(manifest, name, {}, &WrittenFile::name);
  return file && std::ranges::find(listed, *file) != listed.end() ? FileState::as_written
                                                                  : FileState::foreign;
}

}  // namespace crossbeam::drape
