#pragma once
/// @file
/// Derivatives tested by their rate: the remainder of a Taylor polynomial falls with the power of
/// the first term left out until round-off takes over. One step size proves little, a slope proves.
///
///   f(x + eps h) - f(x)                              slope 1
///   f(x + eps h) - f(x) - eps f'(x) h                slope 2 if and only if f' is the derivative
///   ... - eps^2/2 h f''(x) h                         slope 3 if and only if f'' is too

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace crossbeam::verification {

struct TaylorResult {
  /// Largest |slope - expected| over the best sequence of halvings that spans a decade; infinite
  /// when there is no such sequence above round-off.
  double deviation = std::numeric_limits<double>::infinity();
  std::vector<double> steps, remainders;  ///< down to where round-off takes over, for a plot
  std::string table;                      ///< eps, remainder, slope; for the failure message
};

/// @param remainder callable double -> real number, signed or not
/// @param round_off remainders below it are noise and end the table
template <class Remainder>
TaylorResult taylor_test(int expected_slope, Remainder remainder, double first_step = 1e-2,
                         double round_off = 0, int halvings = 24) {
  constexpr int decade = 4;  // 2^4 > 10
  TaylorResult result;
  std::vector<double> slopes;
  double eps = first_step, before = 0;
  for (int k = 0; k <= halvings; ++k, eps /= 2) {
    const double size = std::abs(static_cast<double>(remainder(eps)));
    const double slope = k == 0 ? 0 : std::log2(before / size);
    char line[96];
    std::snprintf(line, sizeof line, "\n  %10.3e  %12.5e  %8.4f", eps, size, slope);
    result.table += line;
    if (!(size > round_off)) break;
    result.steps.push_back(eps);
    result.remainders.push_back(size);
    if (k > 0) slopes.push_back(std::abs(slope - expected_slope));
    before = size;
  }
  for (std::size_t first = 0; first + decade <= slopes.size(); ++first) {
    double worst = 0;
    for (std::size_t k = first; k < first + decade; ++k) worst = std::fmax(worst, slopes[k]);
    result.deviation = std::fmin(result.deviation, worst);
  }
  return result;
}

}  // namespace crossbeam::verification
