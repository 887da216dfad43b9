#include "output_folder.hpp"

#include "manifest.hpp"

#include "crossbeam/base/error.hpp"

#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <system_error>

namespace crossbeam::drape {
namespace fs = std::filesystem;
namespace {

using Status = struct stat;

[[noreturn]] void refuse(const fs::path& target, const std::string& reason) {
  throw InputError("--out", target.string(), "", reason);
}

/// Beginning of the hidden names beside the target; six letters that mkdtemp chooses follow.
std::string hidden_beginning(const fs::path& target) {
  return fmt::format(".{}.crossbeam-", target.filename().string());
}

bool on_another_device(const fs::path& folder, const fs::path& parent) {
  Status a{}, b{};
  return stat(folder.c_str(), &a) == 0 && stat(parent.c_str(), &b) == 0 && a.st_dev != b.st_dev;
}

bool contains(const fs::path& folder, const fs::path& inner) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), inner.begin(), inner.end());
  return end == folder.end();
}

/// Names that a result has, whatever its number of frames.
bool is_result_name(const std::string& name) {
  static const std::set<std::string> names{"summary.json", "shear_points.csv", "outline.csv",
                                           "energy.csv",   "drape.pvd",        "frames",
                                           manifest_name};
  return names.contains(name) || name.rfind("frames/frame_", 0) == 0;
}

/// What is in a folder and not as the program wrote it: folders of the program's are left out. A
/// folder of others counts as one.
std::vector<std::string> foreign_files(const fs::path& folder, const Manifest& manifest) {
  std::vector<std::string> names;
  for (auto entry = fs::recursive_directory_iterator(folder);
       entry != fs::recursive_directory_iterator(); ++entry) {
    const std::string name = fs::relative(entry->path(), folder).generic_string();
    if (name == manifest_name) continue;
    if (entry->is_directory() && !entry->is_symlink()) {
      const bool holds_own =
          std::any_of(manifest.begin(), manifest.end(),
                      [&](const WrittenFile& file) { return file.name.rfind(name + "/", 0) == 0; });
      if (holds_own) continue;
      entry.disable_recursion_pending();
      names.push_back(name);
    } else if (state_of(folder, manifest, name) != FileState::as_written) {
      names.push_back(name);
    }
  }
  return names;
}

/// Removes what the program has written into a folder, the summary first, and the folders in it
/// that are empty then.
void remove_own(const fs::path& folder, const Manifest& manifest) {
  std::error_code ignored;
  std::set<fs::path> folders;
  const auto remove = [&](const std::string& name) {
    if (state_of(folder, manifest, name) == FileState::as_written)
      fs::remove(folder / name, ignored);
    for (fs::path parent = fs::path(name).parent_path(); !parent.empty();
         parent = parent.parent_path())
      folders.insert(parent);
  };
  remove("summary.json");
  for (const WrittenFile& file : manifest) remove(file.name);
  for (auto inner = folders.rbegin(); inner != folders.rend(); ++inner)
    fs::remove(folder / *inner, ignored);
}

/// Renames without replacing anything. Throws std::system_error.
void move_to_free_name(const fs::path& from, const fs::path& to) {
#ifdef RENAME_NOREPLACE
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS)
    throw std::system_error(errno, std::generic_category(), to.string());
#endif
  if (fs::exists(fs::symlink_status(to)))
    throw std::system_error(EEXIST, std::generic_category(), to.string());
  fs::rename(from, to);
}

/// The lock of a hidden folder, or -1 with the reason in errno. A lock file that was removed
/// meanwhile is no lock (ENOENT).
int lock_of(const fs::path& hidden, int flags) {
  const fs::path file = hidden / "lock";
  const int descriptor = open(file.c_str(), O_RDWR | O_CLOEXEC | flags, 0666);
  if (descriptor < 0) return -1;
  Status by_name{}, by_descriptor{};
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &by_descriptor) == 0 &&
      stat(file.c_str(), &by_name) == 0 && by_name.st_ino == by_descriptor.st_ino &&
      by_name.st_dev == by_descriptor.st_dev)
    return descriptor;
  const int reason = by_descriptor.st_ino != 0 ? ENOENT : errno;
  close(descriptor);
  errno = reason;
  return -1;
}

/// A file system without locks: a folder there is never taken for a leftover.
bool has_no_locks(int reason) {
  return reason == ENOLCK || reason == ENOSYS || reason == EOPNOTSUPP || reason == EINVAL;
}

/// Removes a hidden folder whose lock is held. An earlier result that was about to be replaced goes
/// back to its place when that is free.
void remove_hidden(const fs::path& hidden, const fs::path& target) noexcept {
  std::error_code ignored;
  const fs::path earlier = hidden / "earlier";
  if (fs::exists(earlier, ignored)) {
    try {
      move_to_free_name(earlier, target);
    } catch (const std::exception&) {
      const auto manifest = read_manifest(earlier);
      if (manifest) remove_own(earlier, *manifest);
      if (manifest && foreign_files(earlier, *manifest).empty())
        fs::remove(earlier / manifest_name, ignored);
      fs::remove(earlier, ignored);
    }
  }
  fs::remove_all(hidden / "result", ignored);
  fs::remove(hidden / "lock", ignored);
  fs::remove(hidden, ignored);
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target) {
  if (target.empty()) refuse(target, "the path of a folder");
  std::error_code error;
  target_ = fs::absolute(target, error);
  if (!error && !target_.has_filename()) target_ = target_.parent_path();
  if (!error && fs::is_symlink(fs::symlink_status(target_, error)) && !fs::exists(target_, error))
    refuse(target, "a folder, and this is a link to nowhere");
  target_ = fs::weakly_canonical(target_, error);
  if (error) refuse(target, "a folder that can be made: " + error.message());
  if (target_.filename().empty()) target_ = target_.parent_path();
  check_target();
  make_parents();
  remove_leftovers();
  make_hidden();
}

OutputFolder::~OutputFolder() {
  remove_hidden(hidden_, target_);
  if (lock_ >= 0) close(lock_);
  remove_empty_parents();
}

void OutputFolder::check_target() const {
  std::error_code error;
  const auto status = fs::status(target_, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) refuse(target_, "a folder, and this is a file");
  if (contains(target_, fs::current_path(error)))
    refuse(target_, "a folder other than the present one and those around it");
  if (on_another_device(target_, target_.parent_path()))
    refuse(target_, "no mount point; name a folder inside it");
  fs::directory_iterator first(target_, error);
  if (error) refuse(target_, "a folder that can be read: " + error.message());
  if (first == fs::directory_iterator()) return;
  const auto manifest = read_manifest(target_);
  if (!manifest)
    refuse(target_, fmt::format("a new or empty folder, or one with a result of this program and "
                                "its {}; in this one there is {}",
                                manifest_name, first->path().filename().string()));
  for (const std::string& name : foreign_files(target_, *manifest)) {
    const bool listed = std::any_of(manifest->begin(), manifest->end(),
                                    [&](const WrittenFile& file) { return file.name == name; });
    if (listed)
      refuse(target_, fmt::format("another folder, or this one without {}, which was changed since "
                                  "the program wrote it",
                                  name));
    if (is_result_name(name))
      refuse(target_,
             fmt::format("another folder, or this one without {}, which is not of this program but "
                         "has the name of a result",
                         name));
  }
}

void OutputFolder::make_parents() {
  fs::path missing = target_.parent_path();
  std::error_code error;
  while (!missing.empty() && !fs::exists(missing, error) && missing != missing.parent_path()) {
    made_parents_.insert(made_parents_.begin(), missing);
    missing = missing.parent_path();
  }
  fs::create_directories(target_.parent_path(), error);
  if (error) {
    remove_empty_parents();
    refuse(target_, fmt::format("a folder that can be made: {}: {}", target_.parent_path().string(),
                                error.message()));
  }
}

/// Between mkdtemp and the lock another run may take the folder for a leftover and remove it: then
/// there is a next one.
void OutputFolder::make_hidden() {
  const fs::path parent = target_.parent_path();
  constexpr int attempts = 100;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    std::string name = (parent / (hidden_beginning(target_) + "XXXXXX")).string();
    if (mkdtemp(name.data()) == nullptr) break;
    hidden_ = name;
    lock_ = lock_of(hidden_, O_CREAT);
    if ((lock_ >= 0 || has_no_locks(errno)) && mkdir(path().c_str(), 0777) == 0) return;
    const int reason = errno;
    if (lock_ >= 0) close(lock_);
    remove_hidden(hidden_, target_);
    errno = reason;
    if (reason != ENOENT && reason != EWOULDBLOCK) break;
  }
  const std::string reason = std::strerror(errno);
  remove_empty_parents();
  refuse(target_, fmt::format("a folder that can be made: {}: {}", parent.string(), reason));
}

void OutputFolder::remove_leftovers() const {
  std::error_code ignored;
  const std::string beginning = hidden_beginning(target_);
  for (const auto& entry : fs::directory_iterator(target_.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(beginning, 0) != 0 || name.size() != beginning.size() + 6) continue;
    const int lock = lock_of(entry.path(), 0);
    if (lock >= 0) {
      remove_hidden(entry.path(), target_);
      close(lock);
    } else if (!fs::exists(entry.path() / "lock", ignored)) {
      fs::remove(entry.path(), ignored);  // killed before it had a lock: an empty folder
    }
  }
}

void OutputFolder::remove_empty_parents() const noexcept {
  std::error_code ignored;
  for (auto folder = made_parents_.rbegin(); folder != made_parents_.rend(); ++folder)
    fs::remove(*folder, ignored);
}

/// As a whole: what was there goes into the hidden folder, and from there with it.
void OutputFolder::replace_folder() {
  if (fs::exists(target_)) fs::rename(target_, hidden_ / "earlier");
  move_to_free_name(path(), target_);
}

/// Among files of others: file by file. From the first change to the last the manifest lists the
/// old and the new, and there is no summary.json: should the program be killed meanwhile, the next
/// result replaces both.
void OutputFolder::replace_files() {
  const auto earlier = read_manifest(target_);
  Manifest both = manifest_of(path());
  const Manifest result = both;
  if (earlier) both.insert(both.end(), earlier->begin(), earlier->end());
  sort_by_name(both);
  write_manifest(target_, both);
  if (earlier) remove_own(target_, *earlier);
  std::vector<std::string> moved;
  const auto move = [&](const std::string& name) {
    fs::create_directories((target_ / name).parent_path());
    move_to_free_name(path() / name, target_ / name);
    moved.push_back(name);
  };
  try {
    for (const WrittenFile& file : result)
      if (file.name != "summary.json") move(file.name);
    move("summary.json");
    write_manifest(target_, result);
  } catch (const std::exception&) {
    std::error_code ignored;
    for (const std::string& name : moved) fs::rename(target_ / name, path() / name, ignored);
    throw;
  }
}

void OutputFolder::commit() {
  CROSSBEAM_EXPECTS(fs::exists(path() / "summary.json"));
  std::string reason;
  try {
    write_manifest(path(), manifest_of(path()));
    check_target();
    const auto manifest = read_manifest(target_);
    const bool shared = manifest && !foreign_files(target_, *manifest).empty();
    shared ? replace_files() : replace_folder();
    made_parents_.clear();
    return;
  } catch (const std::exception& error) {
    reason = error.what();
  }
  // The run is complete and may have taken hours: its results are kept under a name of their own.
  made_parents_.clear();
  for (int k = 1; k < 1000; ++k) {
    const fs::path kept = fmt::format("{}-{}", target_.string(), k);
    try {
      move_to_free_name(path(), kept);
    } catch (const std::system_error&) {
      continue;
    }
    throw std::runtime_error(fmt::format("{} cannot be written ({}); the results are in {}",
                                         target_.string(), reason, kept.string()));
  }
  const fs::path kept = hidden_ / "complete";  // which is not swept up
  fs::rename(path(), kept);
  throw std::runtime_error(
      fmt::format("{} cannot be written ({}), nor anything beside it; the results are in {}",
                  target_.string(), reason, kept.string()));
}

}  // namespace crossbeam::drape
