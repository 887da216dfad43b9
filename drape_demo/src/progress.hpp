#pragma once
/// @file
/// How far a run is: a bar with the time left on a terminal, plain lines elsewhere.

#include <chrono>
#include <cstdio>
#include <string>

namespace crossbeam::drape {

/// A stream that cannot be written to costs the reports, not the run.
class Progress {
 public:
  enum class Style {
    silent,
    lines,  ///< a line at every 10 %
    bar     ///< one line that is redrawn, ten times a second at most
  };

  Progress() = default;  ///< silent
  explicit Progress(Style style, std::FILE* stream = stderr) : style_(style), stream_(stream) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// bar when the stream is a terminal, lines otherwise, silent when asked.
  [[nodiscard]] static Style style_for(bool quiet, std::FILE* stream = stderr);

  /// What is being done before the first step. Throws Interrupted after Ctrl-C.
  void announce(const std::string& what) const;

  /// @param fraction of the run that is done, 0..1, never falling
  /// @param stroke_mm of the punch
  /// Cheap enough for every hundredth step or so. Throws Interrupted after Ctrl-C.
  void update(double fraction, double stroke_mm) const;

  /// One line of the report, without its end; a bar leaves the last of the columns free.
  [[nodiscard]] static std::string line(Style style, double fraction, double stroke_mm,
                                        double elapsed_s, int columns = 98);

 private:
  using Clock = std::chrono::steady_clock;

  void show(std::string text) const;
  /// Of the terminal; 98 where the stream does not tell.
  [[nodiscard]] int columns() const;

  Style style_ = Style::silent;
  std::FILE* stream_ = nullptr;
  // What has been shown belongs to the stream, not to the run that reports.
  mutable Clock::time_point start_{}, last_{};
  mutable int last_tenth_ = -1;
  mutable std::size_t shown_ = 0;  ///< letters of the bar's line on the terminal
  mutable bool lost_ = false;      ///< the stream takes nothing more
};

}  // namespace crossbeam::drape
