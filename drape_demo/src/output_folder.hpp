#pragma once
/// @file
/// A folder of results that appears complete or not at all, and touches nobody else's files.

#include <filesystem>
#include <vector>

namespace crossbeam::drape {

/// Collects files in a hidden folder beside the target and puts them in place at the end. Whatever
/// ends the run before commit(), the hidden folder goes with the object; one that a killed program
/// left behind is removed by the next run into the same target, whichever machine or container it
/// was killed in: a program that is alive holds a lock on its folder.
///
/// manifest.json in a folder of results lists what this program has written there, each file with
/// its size and time. Those files are replaced by a new result, and nothing else is: other files
/// stay, and a file that was changed since is refused by name.
class OutputFolder {
 public:
  /// Throws InputError, before any work is done, when the target is no place for results: a file, a
  /// link to nowhere, a folder with files in it but without a manifest, a file of a result that was
  /// changed, or a place that cannot be written.
  explicit OutputFolder(const std::filesystem::path& target);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Where to write until commit().
  [[nodiscard]] std::filesystem::path path() const { return hidden_ / "result"; }
  /// Where the results will be.
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Puts the results in place; an earlier result there is replaced. They must hold a summary.json,
  /// the mark of a complete result. Throws std::runtime_error naming where the results are when the
  /// target cannot be replaced.
  void commit();

 private:
  void check_target() const;
  void make_parents();
  void make_hidden();
  void remove_leftovers() const;
  void remove_empty_parents() const noexcept;
  void replace_folder();
  void replace_files();

  std::filesystem::path target_, hidden_;
  int lock_ = -1;                                    ///< descriptor, held until the end
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
};

}  // namespace crossbeam::drape
