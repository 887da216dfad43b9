#pragma once
/// @file
/// The three kinds of error and what each looks like to a caller (docs/errors.md):
///  - input:    InputError, thrown where data enters, names field, value, unit and admissible range;
///  - contract: CROSSBEAM_EXPECTS, a programming mistake, checked unless NDEBUG is set;
///  - numerics: a status in the returned struct (kernels) or RunError (a time integration).

#include "crossbeam/base/scalar.hpp"

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

namespace crossbeam {

/// Bad input. what() reads "<field> = <value> [<unit>] is not admissible: <range>".
class InputError : public std::invalid_argument {
 public:
  InputError(std::string field, const std::string& value, const std::string& unit,
             const std::string& admissible)
      : std::invalid_argument(field + " = " + value + (unit.empty() ? "" : " [" + unit + "]") +
                              " is not admissible: " + admissible),
        field_(std::move(field)) {}

  /// The same error with a place added to its text, for readers of files.
  InputError(const InputError& error, const std::string& place)
      : std::invalid_argument(error.what() + place), field_(error.field_) {}

  /// The offending field as the caller spells it, for instance "cell.warp.youngs_modulus".
  [[nodiscard]] const std::string& field() const noexcept { return field_; }

 private:
  std::string field_;
};

/// A time integration that had to stop: an element, the cell or the energy ledger went wrong.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

namespace detail {

/// The digits that make a double; of wider numbers as many.
[[nodiscard]] inline std::string to_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}
template <class T>
[[nodiscard]] std::string to_text(const T& value) {
  return to_text(static_cast<double>(value));
}

}  // namespace detail

/// Admissible ranges of one real input; each throws InputError and returns the value otherwise.
/// @{
template <class T>
T require_finite(const std::string& field, const T& value, const std::string& unit) {
  if (!is_finite(value)) throw InputError(field, detail::to_text(value), unit, "a finite number");
  return value;
}

template <class T>
T require_positive(const std::string& field, const T& value, const std::string& unit) {
  if (!(is_finite(value) && value > T(0)))
    throw InputError(field, detail::to_text(value), unit, "a finite number > 0");
  return value;
}

template <class T>
T require_non_negative(const std::string& field, const T& value, const std::string& unit) {
  if (!(is_finite(value) && value >= T(0)))
    throw InputError(field, detail::to_text(value), unit, "a finite number >= 0");
  return value;
}

/// Open interval (low, high).
template <class T>
T require_between(const std::string& field, const T& value, const std::string& unit, double low,
                  double high) {
  if (!(is_finite(value) && value > T(low) && value < T(high)))
    throw InputError(field, detail::to_text(value), unit,
                     "strictly between " + detail::to_text(low) + " and " + detail::to_text(high));
  return value;
}
/// @}

namespace detail {

[[noreturn]] inline void contract_violation(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "crossbeam contract violated: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace detail
}  // namespace crossbeam

#ifndef CROSSBEAM_EXPECTS
#ifdef NDEBUG
#define CROSSBEAM_EXPECTS(condition) static_cast<void>(0)
#else
/// Precondition of a function; replaceable by defining the macro before the first include.
#define CROSSBEAM_EXPECTS(condition)  \
  ((condition) ? static_cast<void>(0) \
               : ::crossbeam::detail::contract_violation(#condition, __FILE__, __LINE__))
#endif
#endif
