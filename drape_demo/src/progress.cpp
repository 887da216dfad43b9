#include "progress.hpp"

#include "interrupt.hpp"
#include "standard_streams.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
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

std::string without_spaces_at_end(const std::string& text) {
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

}  // namespace

Progress::Style Progress::style_for(bool quiet, std::FILE* stream) {
  if (quiet) return Style::silent;
  return isatty(fileno(stream)) != 0 ? Style::bar : Style::lines;
}

std::string Progress::line(Style style, double fraction, double stroke_mm, double elapsed_s,
                           int columns) {
  const double done = std::clamp(fraction, 0.0, 1.0);
  const std::string time = done >= 1     ? "took " + minutes(elapsed_s)
                           : done > 0.01 ? "left " + minutes(elapsed_s * (1 - done) / done)
                                         : "left -:--";
  const std::string percent = fmt::format("{:3.0f} %", std::floor(100 * done));
  const std::string numbers =
      fmt::format("{}   stroke {:5.1f} mm   {:<12}", percent, stroke_mm, time);
  if (style != Style::bar) return without_spaces_at_end(numbers);

  // A line as wide as the terminal would wrap, and the next one would not be drawn over it.
  const auto room = static_cast<std::size_t>(std::max(columns - 1, 1));
  constexpr std::size_t widest = 40, least = 5, brackets = 3;
  if (numbers.size() + brackets + least <= room) {
    const std::size_t width = std::min(widest, room - numbers.size() - brackets);
    const auto filled = static_cast<std::size_t>(std::floor(done * static_cast<double>(width)));
    return fmt::format("[{:#<{}}{:.<{}}] {}", "", filled, "", width - filled, numbers);
  }
  for (const std::string& shorter : {without_spaces_at_end(numbers), percent + "  " + time})
    if (shorter.size() <= room) return shorter;
  return percent.substr(0, room);
}

int Progress::columns() const {
  winsize size{};
  return ioctl(fileno(stream_), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 98;
}

/// Over what the bar's line has shown, or as a line of its own.
void Progress::show(std::string text) const {
  if (style_ == Style::bar) {
    const std::size_t letters = text.size();
    const auto room = static_cast<std::size_t>(std::max(columns() - 1, 1));
    text.resize(std::max(letters, std::min(shown_, room)), ' ');
    shown_ = letters;
    text.insert(0, 1, '\r');
  } else {
    text += '\n';
  }
  lost_ = !write_stream(stream_, text);
}

void Progress::announce(const std::string& what) const {
  check_interrupt();
  if (style_ == Style::silent || lost_) return;
  show(style_ == Style::bar ? what.substr(0, static_cast<std::size_t>(std::max(columns() - 1, 1)))
                            : what);
}

void Progress::update(double fraction, double stroke_mm) const {
  check_interrupt();
  if (style_ == Style::silent || lost_) return;
  const auto now = Clock::now();
  if (start_ == Clock::time_point{}) start_ = now;
  const double elapsed = seconds_between(start_, now);
  const int tenth = static_cast<int>(std::floor(10 * std::clamp(fraction, 0.0, 1.0) + 1e-9));

  if (style_ == Style::bar) {
    const bool end = fraction >= 1 && last_tenth_ < 10;
    if (last_ != Clock::time_point{} && !end && seconds_between(last_, now) < 0.1) return;
    if (end) last_tenth_ = 10;
    last_ = now;
    show(line(style_, fraction, stroke_mm, elapsed, columns()));
  } else if (tenth > last_tenth_) {
    last_tenth_ = tenth;
    show(line(style_, fraction, stroke_mm, elapsed));
  }
}

Progress::~Progress() {
  if (shown_ > 0 && !lost_) static_cast<void>(write_stream(stream_, "\n"));
}

}  // namespace crossbeam::drape
