#pragma once
/// @file
/// A folder of results that appears complete or not at all.

#include <filesystem>
#include <string>
#include <vector>

namespace crossbeam::drape {

/// Collects files in a hidden folder beside the target and renames it onto the target at the end.
/// Whatever ends the run before commit(), the hidden folder goes with the object; one that a killed
/// program left behind is removed by the next run into the same target.
class OutputFolder {
 public:
  /// Throws InputError, before any work is done, when the target is no place for results: a file,
  /// a folder that holds something else than an earlier result, or a place that cannot be written.
  explicit OutputFolder(const std::filesystem::path& target);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Where to write until commit().
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  /// Where the results will be.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Puts the results in place; an earlier result there is replaced. The folder must hold a
  /// summary.json, the mark of a complete result. Throws std::runtime_error naming where the
  /// results are when the target cannot be replaced.
  void commit();

 private:
  void check_target() const;
  void make_parents();
  void remove_leftovers() const;
  void remove_empty_parents() const noexcept;

  std::filesystem::path target_, partial_;
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
  bool committed_ = false;
};

/// True when the folder holds a summary.json that this program wrote.
[[nodiscard]] bool holds_result(const std::filesystem::path& folder);

}  // namespace crossbeam::drape
