#include "output_folder.hpp"

#include "summary.hpp"

#include "crossbeam/base/error.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>

namespace crossbeam::drape {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse(const fs::path& target, const std::string& reason) {
  throw InputError("--out", target.string(), "", reason);
}

/// The name of this machine, in letters that suit a file name.
std::string host_name() {
  std::array<char, 65> buffer{};
  if (gethostname(buffer.data(), buffer.size() - 1) != 0) return "host";
  std::string name = buffer.data();
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

/// Beginning of the hidden names beside the target; the process number follows.
std::string hidden_name(const fs::path& target, const char* kind) {
  return fmt::format(".{}.{}-{}-", target.filename().string(), kind, host_name());
}

fs::path hidden_sibling(const fs::path& target, const char* kind) {
  return target.parent_path() / (hidden_name(target, kind) + std::to_string(getpid()));
}

bool is_running(const std::string& process) {
  const bool number =
      !process.empty() && process.size() < 10 &&
      std::all_of(process.begin(), process.end(), [](char c) { return c >= '0' && c <= '9'; });
  return !number || kill(static_cast<pid_t>(std::stol(process)), 0) == 0 || errno == EPERM;
}

bool on_another_device(const fs::path& folder, const fs::path& parent) {
  using Status = struct stat;
  Status a{}, b{};
  return stat(folder.c_str(), &a) == 0 && stat(parent.c_str(), &b) == 0 && a.st_dev != b.st_dev;
}

bool contains(const fs::path& folder, const fs::path& inner) {
  const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), inner.begin(), inner.end());
  return end == folder.end();
}

}  // namespace

bool holds_result(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto json = nlohmann::json::parse(file, nullptr, false);
  return json.is_object() && json.contains("program") && json["program"] == summary_program;
}

OutputFolder::OutputFolder(const fs::path& target) {
  if (target.empty()) refuse(target, "the path of a folder");
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(target), error);
  if (error) refuse(target, "a folder that can be made: " + error.message());
  if (target_.filename().empty()) target_ = target_.parent_path();
  check_target();
  make_parents();
  remove_leftovers();
  partial_ = hidden_sibling(target_, "partial");
  fs::remove_all(partial_, error);
  fs::create_directory(partial_, error);
  if (error) {
    remove_empty_parents();
    refuse(target_, fmt::format("a folder that can be made: {}: {}", target_.parent_path().string(),
                                error.message()));
  }
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
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
  const bool empty = fs::is_empty(target_, error);
  if (error) refuse(target_, "a folder that can be read: " + error.message());
  if (!empty && !holds_result(target_))
    refuse(target_,
           "a new or empty folder, or one with an earlier result (a summary.json of this program)");
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

void OutputFolder::remove_leftovers() const {
  std::error_code ignored;
  const auto process_of = [](const std::string& name, const std::string& beginning) {
    return name.rfind(beginning, 0) == 0 ? name.substr(beginning.size()) : std::string();
  };
  for (const auto& entry : fs::directory_iterator(target_.parent_path(), ignored)) {
    const std::string name = entry.path().filename().string();
    const std::string partial = process_of(name, hidden_name(target_, "partial"));
    const std::string old = process_of(name, hidden_name(target_, "old"));
    if (!partial.empty() && !is_running(partial)) fs::remove_all(entry.path(), ignored);
    if (!old.empty() && !is_running(old)) {
      if (fs::exists(target_, ignored))
        fs::remove_all(entry.path(), ignored);
      else
        fs::rename(entry.path(), target_, ignored);
    }
  }
}

void OutputFolder::remove_empty_parents() const noexcept {
  std::error_code ignored;
  for (auto folder = made_parents_.rbegin(); folder != made_parents_.rend(); ++folder)
    fs::remove(*folder, ignored);
}

void OutputFolder::commit() {
  CROSSBEAM_EXPECTS(!committed_ && fs::exists(partial_ / "summary.json"));
  committed_ = true;
  std::string reason;
  try {
    check_target();
  } catch (const InputError& refused) {
    reason = refused.what();
  }
  std::error_code error;
  if (reason.empty()) {
    const fs::path old = hidden_sibling(target_, "old");
    const bool replaces = fs::exists(target_, error);
    if (replaces) fs::rename(target_, old, error);
    if (!error) {
      fs::rename(partial_, target_, error);
      std::error_code ignored;
      if (error && replaces) fs::rename(old, target_, ignored);
      if (!error) fs::remove_all(old, ignored);
    }
    if (!error) return;
    reason = error.message();
  }
  // The run is complete and may have taken hours: its results are kept under a name of their own.
  const fs::path kept = target_.string() + "-" + std::to_string(getpid());
  fs::rename(partial_, kept, error);
  throw std::runtime_error(fmt::format("{} cannot be written ({}); the results are in {}",
                                       target_.string(), reason,
                                       (error ? partial_ : kept).string()));
}

}  // namespace crossbeam::drape
