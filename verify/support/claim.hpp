#pragma once
/// @file
/// One measured claim: checked by doctest and, when the environment variable CROSSBEAM_CLAIMS_LOG
/// names a file, appended to it as one JSON line {id, measured, tolerance, bound, pass, note}. The
/// report is merged from these lines.

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

namespace verify {

enum class Bound {
  upper,  ///< the measured number has to be <= the tolerance
  lower,  ///< >=: orders of convergence, and negative results that have to show
};

namespace detail {

inline std::string json_number(double x) {
  if (!std::isfinite(x)) return "null";
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << x;
  return text.str();
}

inline std::string json_string(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out + "\"";
}

}  // namespace detail

/// Checks measured <= tolerance (or >=) and logs it. NaN fails.
inline void claim(const std::string& id, double measured, double tolerance, const std::string& note,
                  Bound bound = Bound::upper) {
  const bool pass = bound == Bound::upper ? measured <= tolerance : measured >= tolerance;
  CHECK_MESSAGE(pass, id, ": ", note, ": measured ", measured,
                bound == Bound::upper ? ", has to be <= " : ", has to be >= ", tolerance);
  const char* path = std::getenv("CROSSBEAM_CLAIMS_LOG");
  if (path == nullptr || *path == '\0') return;
  const std::string line = "{\"id\": " + detail::json_string(id) +
                           ", \"measured\": " + detail::json_number(measured) +
                           ", \"tolerance\": " + detail::json_number(tolerance) +
                           ", \"bound\": " + (bound == Bound::upper ? "\"upper\"" : "\"lower\"") +
                           ", \"pass\": " + (pass ? "true" : "false") +
                           ", \"note\": " + detail::json_string(note) + "}\n";
  // Test processes run side by side: append mode and one write keep the lines whole.
  if (std::FILE* log = std::fopen(path, "a")) {
    std::fwrite(line.data(), 1, line.size(), log);
    std::fclose(log);
  } else {
    FAIL_CHECK("CROSSBEAM_CLAIMS_LOG = " << path << " cannot be written");
  }
}

/// The worst of many errors and where it occurred. NaN counts as worst of all.
class Worst {
 public:
  template <class... Where>
  void see(double error, const Where&... where) {
    ++seen_;
    if (error <= value_ || std::isnan(value_)) return;
    value_ = error;
    std::ostringstream text;
    text.precision(9);
    ((text << where << ' '), ...);
    where_ = text.str();
  }

  /// The claim that the worst error is within the tolerance; nothing seen is a failure.
  void claim(const std::string& id, double tolerance, const std::string& note) const {
    REQUIRE_MESSAGE(seen_ > 0, id, ": nothing was measured");
    INFO("worst at: ", where_);
    verify::claim(id, value_, tolerance, note);
  }

  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] long seen() const { return seen_; }
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  double value_ = -1;
  long seen_ = 0;
  std::string where_;
};

}  // namespace verify
