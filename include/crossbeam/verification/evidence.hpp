#pragma once
/// @file
/// What a verification leaves behind for its report: measurements against tolerances, and plots.
/// Each is one line of JSON in a log, from which verify/report/report.py makes the page:
///
///   {"kind": "measurement", "id", "measured", "tolerance", "bound", "pass", "note"}
///   {"kind": "plot", "id", "title", "caption", "style", "x", "y", "log_x", "log_y", "curves"}
///   {"kind": "map", "id", "title", "caption", "x", "y", "z", "at_x", "at_y", "values"}

#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace crossbeam::verification {

enum class Bound {
  upper,  ///< the measured number has to be <= the tolerance
  lower,  ///< >=: orders of convergence, and negative results that have to show
};

/// One number that a claim stands or falls with.
struct Measurement {
  std::string claim;  ///< its ID
  double measured = std::numeric_limits<double>::quiet_NaN(), tolerance = 0;
  std::string note;  ///< of what, with the unit
  Bound bound = Bound::upper;

  /// NaN fails.
  [[nodiscard]] bool pass() const {
    return bound == Bound::upper ? measured <= tolerance : measured >= tolerance;
  }
};

struct Curve {
  std::string name;  ///< for the legend
  std::vector<double> x, y;
  enum class Style { line, points, guide } style = Style::line;  ///< guide: a thin grey line
};

/// Curves over one pair of axes.
struct Plot {
  std::string claim;  ///< the ID of the claim it belongs to
  std::string title;
  std::string x_label, y_label;  ///< with units
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
  std::string caption;  ///< what to look for, one sentence
  bool bars = false;    ///< a histogram: one bar per point of the first curve
};

/// A field over a plane: values[i][j] at (at_x[j], at_y[i]).
struct Map {
  std::string claim, title, x_label, y_label, value_label;
  std::vector<double> at_x, at_y;
  std::vector<std::vector<double>> values;
  std::string caption;
};

namespace detail {

inline std::string json(double x) {
  if (!std::isfinite(x)) return "null";
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << x;
  return text.str();
}
inline std::string json(bool b) { return b ? "true" : "false"; }
inline std::string json(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04x", byte);
      out += escape;
    } else {
      out += c;
    }
  }
  return out + "\"";
}
inline std::string json(const char* s) { return json(std::string(s)); }
inline std::string json(const Curve& c);
template <class T>
std::string json(const std::vector<T>& list) {
  std::string out = "[";
  for (const auto& item : list) out += (out.size() > 1 ? ", " : "") + json(item);
  return out + "]";
}

/// {"key": value, ...}
class JsonObject {
 public:
  template <class T>
  JsonObject& operator()(const char* key, const T& value) {
    text_ += (text_.empty() ? "{" : ", ") + json(key) + ": " + json(value);
    return *this;
  }
  [[nodiscard]] std::string text() const { return text_ + "}"; }

 private:
  std::string text_;
};

inline std::string json(const Curve& c) {
  const char* style = c.style == Curve::Style::line     ? "line"
                      : c.style == Curve::Style::points ? "points"
                                                        : "guide";
  return JsonObject()("name", c.name)("style", style)("x", c.x)("y", c.y).text();
}

}  // namespace detail

inline std::string to_json(const Measurement& m) {
  return detail::JsonObject()("kind", "measurement")("id", m.claim)("measured", m.measured)(
             "tolerance", m.tolerance)("bound", m.bound == Bound::upper ? "upper" : "lower")(
             "pass", m.pass())("note", m.note)
      .text();
}
inline std::string to_json(const Plot& p) {
  return detail::JsonObject()("kind", "plot")("id", p.claim)("title", p.title)(
             "caption", p.caption)("style", p.bars ? "bars" : "curves")("x", p.x_label)(
             "y", p.y_label)("log_x", p.log_x)("log_y", p.log_y)("curves", p.curves)
      .text();
}
inline std::string to_json(const Map& m) {
  return detail::JsonObject()("kind", "map")("id", m.claim)("title", m.title)("caption", m.caption)(
             "x", m.x_label)("y", m.y_label)("z", m.value_label)("at_x", m.at_x)("at_y", m.at_y)(
             "values", m.values)
      .text();
}

/// Appends one line to a log; false when it cannot be written. Several programs may write the
/// same log: append mode and one write keep the lines whole.
inline bool append_line(const std::string& path, const std::string& line) {
  std::FILE* log = std::fopen(path.c_str(), "a");
  if (log == nullptr) return false;
  std::setvbuf(log, nullptr, _IOFBF, line.size() + 2);
  const std::string text = line + "\n";
  const bool written = std::fwrite(text.data(), 1, text.size(), log) == text.size();
  return std::fclose(log) == 0 && written;
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

  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] long seen() const { return seen_; }
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  double value_ = -1;
  long seen_ = 0;
  std::string where_;
};

}  // namespace crossbeam::verification
