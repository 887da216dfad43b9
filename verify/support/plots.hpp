#pragma once
/// @file
/// Curves that several tests hand to the report.

#include "support/claim.hpp"
#include "support/taylor_test.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace verify {

/// A grey line of the given power, parallel to a curve and below it by `factor`.
inline Curve guide(std::string name, double power, const Curve& beside, double factor = 0.3) {
  const double from = beside.x.front(), to = beside.x.back(), y = factor * beside.y.front();
  return {std::move(name), {from, to}, {y, y * std::pow(to / from, power)}, Curve::Style::guide};
}

/// The remainders of a Taylor test over their steps.
inline Curve remainders(std::string name, const TaylorResult& result) {
  return {std::move(name), result.steps, result.remainders};
}

}  // namespace verify
