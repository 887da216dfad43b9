#pragma once
/// @file
/// A battery is a list of claims that anything of a kind must satisfy: a cell, a yarn law, a shear
/// law, a membrane law, an element. It is measured on one subject, a user's own, and collected for
/// a table and a report. The batteries are in cell_battery.hpp, law_battery.hpp and
/// element_battery.hpp; docs/theory/own_laws.md shows how to use them.

#include "crossbeam/verification/evidence.hpp"
#include "crossbeam/verification/random.hpp"
#include "crossbeam/verification/taylor_test.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace crossbeam::verification {

/// A claim in words; the columns of the claims table.
struct Claim {
  const char* id;
  const char* area;
  const char* statement;
  const char* source;            ///< what it is compared with, independent of the subject's code
  const char* tolerance_reason;  ///< why the tolerance is what it is
};

class Battery {
 public:
  /// @param subject what is verified, for the title of the report
  /// @param log     file for the report, begun anew; none if empty
  /// @throws std::runtime_error if the log cannot be written
  explicit Battery(std::string subject, std::string log = {})
      : subject_(std::move(subject)), log_(std::move(log)) {
    if (!log_.empty()) std::remove(log_.c_str());
    write(detail::JsonObject()("kind", "subject")("name", subject_).text());
  }

  /// One comparison of a claim.
  void measure(const Claim& claim, double measured, double tolerance, const std::string& note,
               Bound bound = Bound::upper) {
    const bool stated = std::any_of(measurements_.begin(), measurements_.end(),
                                    [&](const Measurement& m) { return m.claim == claim.id; });
    if (!stated)
      write(detail::JsonObject()("kind", "claim")("id", claim.id)("area", claim.area)(
                "statement", claim.statement)("source", claim.source)("tolerance_reason",
                                                                      claim.tolerance_reason)
                .text());
    measurements_.push_back({claim.id, measured, tolerance, note, bound});
    write(to_json(measurements_.back()));
  }
  /// The worst of many errors; nothing seen is a failure.
  void measure(const Claim& claim, const Worst& worst, double tolerance, const std::string& note) {
    measure(claim, worst.seen() > 0 ? worst.value() : std::numeric_limits<double>::quiet_NaN(),
            tolerance, note);
  }
  template <class Picture>
  void show(const Picture& picture) {
    write(to_json(picture));
  }

  [[nodiscard]] const std::string& subject() const { return subject_; }
  [[nodiscard]] const std::vector<Measurement>& measurements() const { return measurements_; }

  /// IDs of the claims that do not hold, each once, in the order of their measurement.
  [[nodiscard]] std::vector<std::string> failed() const {
    std::vector<std::string> out;
    for (const Measurement& m : measurements_)
      if (!m.pass() && std::find(out.begin(), out.end(), m.claim) == out.end())
        out.push_back(m.claim);
    return out;
  }

  /// Prints every comparison that failed and the verdict.
  /// @return 0 if all claims hold, else 1: what `main` returns
  int finish() const {
    std::vector<std::string> ids;
    for (const Measurement& m : measurements_) {
      if (std::find(ids.begin(), ids.end(), m.claim) == ids.end()) ids.push_back(m.claim);
      if (!m.pass())
        std::printf("  %-10s DOES NOT HOLD: %s: measured %.3g, has to be %s %.3g\n",
                    m.claim.c_str(), m.note.c_str(), m.measured,
                    m.bound == Bound::upper ? "<=" : ">=", m.tolerance);
    }
    const std::size_t bad = failed().size();
    std::printf("%s: %zu of %zu claims hold\n", subject_.c_str(), ids.size() - bad, ids.size());
    return bad == 0 && !ids.empty() ? 0 : 1;
  }

 private:
  void write(const std::string& line) const {
    if (!log_.empty() && !append_line(log_, line))
      throw std::runtime_error("battery: " + log_ + " cannot be written");
  }

  std::string subject_, log_;
  std::vector<Measurement> measurements_;
};

/// Taylor slopes at many states. A remainder that vanishes to round-off from the start, because the
/// function is the polynomial itself, passes; one that leaves no decade above round-off says
/// nothing.
class TaylorSlopes {
 public:
  explicit TaylorSlopes(int slope) : slope_(slope) {}

  template <class Remainder>
  void see(Remainder remainder, double first_step, double round_off) {
    const TaylorResult r = taylor_test(slope_, remainder, first_step, round_off);
    ++states_;
    if (r.remainders.size() < 2) {
      ++exact_;
    } else if (r.remainders.size() > 5) {
      ++conclusive_;
      worst_.see(r.deviation, r.table);
    }
    if (r.remainders.size() > longest_.y.size()) {
      longest_.x = r.steps;
      longest_.y = r.remainders;
    }
  }

  /// The claim that all slopes are right, and that they were seen at half of the states.
  void measure(Battery& battery, const Claim& claim, double tolerance,
               const std::string& note) const {
    const bool seen = 2 * (conclusive_ + exact_) >= states_ && states_ > 0;
    const double value = !seen              ? std::numeric_limits<double>::quiet_NaN()
                         : conclusive_ == 0 ? 0.0
                                            : worst_.value();
    battery.measure(claim, value, tolerance, note);
  }
  [[nodiscard]] Curve curve(std::string name) const {
    return {std::move(name), longest_.x, longest_.y, Curve::Style::line};
  }

 private:
  int slope_, states_ = 0, exact_ = 0, conclusive_ = 0;
  Worst worst_;
  Curve longest_;
};

}  // namespace crossbeam::verification
