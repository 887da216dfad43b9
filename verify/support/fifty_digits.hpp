#pragma once
/// @file
/// Numbers of fifty decimal digits (Boost.Multiprecision), in which the library's own templates are
/// run as a judge of what double loses.

#include "support/reference_states.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace verify {

/// 168 bits: 50 digits and some guard.
using Fifty = boost::multiprecision::cpp_bin_float_50;

template <>
inline Fifty number<Fifty>(const Json& text) {
  return Fifty(text.get<std::string>());
}

inline Fifty absolute(const Fifty& x) { return x < 0 ? Fifty(-x) : x; }

/// |a - b| / scale of a double against fifty digits, in roundings of double.
inline double roundings(double a, const Fifty& b, const Fifty& scale) {
  return static_cast<double>(absolute(Fifty(a) - b) / scale) /
         std::numeric_limits<double>::epsilon();
}

/// Counts how many decimal digits of many results are right, in bins of half a digit.
class Digits {
 public:
  void see(double relative_error) {
    const double digits = relative_error > 0 ? -std::log10(relative_error) : most;
    ++count_[static_cast<std::size_t>(2 * std::clamp(digits, 0.0, most))];
  }
  [[nodiscard]] std::vector<double> at() const {
    std::vector<double> x;
    for (std::size_t k = 0; k < count_.size(); ++k) x.push_back(0.5 * static_cast<double>(k));
    return x;
  }
  [[nodiscard]] std::vector<double> count() const { return {count_.begin(), count_.end()}; }

 private:
  static constexpr double most = 17;
  std::vector<long> count_ = std::vector<long>(2 * 17 + 1, 0);
};

}  // namespace verify
