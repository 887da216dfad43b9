#pragma once
/// @file
/// How far a run is: a bar with the time left on a terminal, plain lines elsewhere.

#include <chrono>
#include <cstdio>
#include <string>

namespace crossbeam::drape {

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

  /// @param fraction of the run that is done, 0..1, never falling
  /// @param stroke_mm of the punch
  /// Cheap enough for every hundredth step or so. Throws Interrupted after Ctrl-C.
  void update(double fraction, double stroke_mm) const;

  /// One line of the report, without its end.
  [[nodiscard]] static std::string line(Style style, double fraction, double stroke_mm,
                                        double elapsed_s);

 private:
  using Clock = std::chrono::steady_clock;

  Style style_ = Style::silent;
  std::FILE* stream_ = nullptr;
  // What has been shown belongs to the stream, not to the run that reports.
  mutable Clock::time_point start_{}, last_{};
  mutable int last_tenth_ = -1;
  mutable bool drawn_ = false;
};

}  // namespace crossbeam::drape
