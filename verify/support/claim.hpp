#pragma once
/// @file
/// One measured claim, checked by doctest and, when the environment variable CROSSBEAM_CLAIMS_LOG
/// names a file, appended to it for the report (crossbeam/verification/evidence.hpp).

#include "crossbeam/verification/evidence.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

namespace verify {

using crossbeam::verification::Bound;
using crossbeam::verification::Curve;
using crossbeam::verification::Map;
using crossbeam::verification::Measurement;
using crossbeam::verification::Plot;

namespace detail {

inline void log(const std::string& line) {
  const char* path = std::getenv("CROSSBEAM_CLAIMS_LOG");
  if (path == nullptr || *path == '\0') return;
  if (!crossbeam::verification::append_line(path, line))
    FAIL_CHECK("CROSSBEAM_CLAIMS_LOG = " << path << " cannot be written");
}

}  // namespace detail

/// Checks measured <= tolerance (or >=) and logs it. NaN fails.
inline void claim(const Measurement& m) {
  CHECK_MESSAGE(m.pass(), m.claim, ": ", m.note, ": measured ", m.measured,
                m.bound == Bound::upper ? ", has to be <= " : ", has to be >= ", m.tolerance);
  detail::log(to_json(m));
}
inline void claim(const std::string& id, double measured, double tolerance, const std::string& note,
                  Bound bound = Bound::upper) {
  claim({id, measured, tolerance, note, bound});
}

/// Hands a plot or a map to the report.
template <class Picture>
void show(const Picture& picture) {
  detail::log(to_json(picture));
}

/// The worst of many errors and where it occurred. NaN counts as worst of all.
class Worst : public crossbeam::verification::Worst {
 public:
  /// The claim that the worst error is within the tolerance; nothing seen is a failure.
  void claim(const std::string& id, double tolerance, const std::string& note) const {
    REQUIRE_MESSAGE(seen() > 0, id, ": nothing was measured");
    INFO("worst at: ", where());
    verify::claim(id, value(), tolerance, note);
  }
};

}  // namespace verify
