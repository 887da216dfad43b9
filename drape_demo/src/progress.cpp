#include "progress.hpp"

#include "interrupt.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace crossbeam::drape {
namespace {

std::string minutes(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::min(seconds, 1e7)));
  return whole < 3600 ? fmt::format("{}:{:02}", whole / 60, whole % 60)
                      : fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

double seconds_between(std::chrono::steady_clock::time_point a,
                       std::chrono::steady_clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace

Progress::Style Progress::style_for(bool quiet, std::FILE* stream) {
  if (quiet) return Style::silent;
  return isatty(fileno(stream)) != 0 ? Style::bar : Style::lines;
}

std::string Progress::line(Style style, double fraction, double stroke_mm, double elapsed_s) {
  const double done = std::clamp(fraction, 0.0, 1.0);
  const std::string time = done >= 1     ? "took " + minutes(elapsed_s)
                           : done > 0.01 ? "left " + minutes(elapsed_s * (1 - done) / done)
                                         : "left -:--";
  const std::string numbers = fmt::format("{:3.0f} %   stroke {:5.1f} mm   {:<12}",
                                          std::floor(100 * done), stroke_mm, time);
  if (style != Style::bar) return numbers.substr(0, numbers.find_last_not_of(' ') + 1);
  constexpr int width = 40;
  const int filled = static_cast<int>(std::floor(done * width));
  return fmt::format("[{:#<{}}{:.<{}}] {}", "", filled, "", width - filled, numbers);
}

void Progress::update(double fraction, double stroke_mm) const {
  check_interrupt();
  if (style_ == Style::silent) return;
  const auto now = Clock::now();
  if (start_ == Clock::time_point{}) start_ = now;
  const double elapsed = seconds_between(start_, now);

  if (style_ == Style::bar) {
    const bool end = fraction >= 1 && last_tenth_ < 10;
    if (drawn_ && !end && seconds_between(last_, now) < 0.1) return;
    if (end) last_tenth_ = 10;
    last_ = now;
    drawn_ = true;
    fmt::print(stream_, "\r{}", line(style_, fraction, stroke_mm, elapsed));
  } else {
    const int tenth = static_cast<int>(std::floor(10 * std::clamp(fraction, 0.0, 1.0) + 1e-9));
    if (tenth <= last_tenth_) return;
    last_tenth_ = tenth;
    fmt::print(stream_, "{}\n", line(style_, fraction, stroke_mm, elapsed));
  }
  std::fflush(stream_);
}

Progress::~Progress() {
  if (!drawn_) return;
  std::fputc('\n', stream_);
  std::fflush(stream_);
}

}  // namespace crossbeam::drape
