#pragma once
/// @file
/// One measured claim, checked by doctest and, when the environment variable CROSSBEAM_CLAIMS_LOG
/// names a file, appended to it for the report (crossbeam/verification/evidence.hpp).

#include "crossbeam/verification/evidence.hpp"

#include <string>

namespace verify {

using crossbeam::verification::Bound;
using crossbeam::verification::Curve;
using crossbeam::verification::Map;
using crossbeam::verification::Measurement;
using crossbeam::verification::Plot;

/// Checks measured <= tolerance (or >=) and logs it. NaN fails.
void claim(const Measurement& m);
void claim(const std::string& id, double measured, double tolerance, const std::string& note,
           Bound bound = Bound::upper);

/// Hands a plot or a map to the report.
void show(const Plot& plot);
void show(const Map& map);

/// The worst of many errors and where it occurred. NaN counts as worst of all.
class Worst : public crossbeam::verification::Worst {
 public:
  /// The claim that the worst error is within the tolerance; nothing seen is a failure.
  void claim(const std::string& id, double tolerance, const std::string& note) const;
};

}  // namespace verify
