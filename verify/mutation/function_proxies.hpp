#pragma once
/// @file
/// The proxies of functions: `maximum(a, b)` becomes `Maximum{7}(a, b)`. Apart from the others, for
/// base/scalar.hpp declares some of these functions.

#include "mutation/proxies.hpp"
//
#include "crossbeam/base/scalar.hpp"

namespace crossbeam::mutation {

/// Functions: `maximum(a, b)` becomes `Maximum{7}(a, b)`.
#define CROSSBEAM_MUTATION(Name, as_written, changed)                                    \
  struct Name {                                                                          \
    int site;                                                                            \
    template <class A, class... B>                                                       \
    CROSSBEAM_PROXY constexpr auto operator()(const A& a, const B&... b) const {         \
      using namespace std_and_crossbeam;                                                 \
      auto v = plain(as_written(a, b...));                                               \
      if (variant(site)) {                                                               \
        if constexpr (requires { changed(a, b...); })                                    \
          return changed_to<decltype(v), decltype(v)>(v, decltype(v)(changed(a, b...))); \
        not_applicable();                                                                \
      }                                                                                  \
      return v;                                                                          \
    }                                                                                    \
  };
namespace std_and_crossbeam {
using crossbeam::all;
using crossbeam::any;
using crossbeam::cross;
using crossbeam::magnitude;
using crossbeam::maximum;
using crossbeam::minimum;
using crossbeam::select;
using std::abs;
using std::cbrt;
using std::ceil;
using std::cos;
using std::floor;
using std::hypot;
using std::sin;
using std::sqrt;

template <class M, class A, class B>
CROSSBEAM_PROXY constexpr auto other_choice(const M& m, const A& a, const B& b) {
  return select(m, b, a);
}
template <class A, class... B>
CROSSBEAM_PROXY constexpr A argument(const A& a, const B&...) {
  return a;
}
template <class A>
CROSSBEAM_PROXY constexpr auto crossed_back(const A& a, const A& b) {
  return cross(b, a);
}
}  // namespace std_and_crossbeam
CROSSBEAM_MUTATION(Maximum, maximum, minimum)
CROSSBEAM_MUTATION(Minimum, minimum, maximum)
CROSSBEAM_MUTATION(StdMax, std::max, std::min)
CROSSBEAM_MUTATION(StdMin, std::min, std::max)
CROSSBEAM_MUTATION(MinElement, std::min_element, std::max_element)
CROSSBEAM_MUTATION(MaxElement, std::max_element, std::min_element)
CROSSBEAM_MUTATION(UpperBound, std::upper_bound, std::lower_bound)
CROSSBEAM_MUTATION(LowerBound, std::lower_bound, std::upper_bound)
CROSSBEAM_MUTATION(Ceil, ceil, floor)
CROSSBEAM_MUTATION(Floor, floor, ceil)
CROSSBEAM_MUTATION(Select, select, other_choice)
CROSSBEAM_MUTATION(Cos, cos, sin)
CROSSBEAM_MUTATION(Sin, sin, cos)
CROSSBEAM_MUTATION(Sqrt, sqrt, argument)
CROSSBEAM_MUTATION(Cbrt, cbrt, argument)
CROSSBEAM_MUTATION(Abs, abs, argument)
CROSSBEAM_MUTATION(Hypot, hypot, argument)
CROSSBEAM_MUTATION(Magnitude, magnitude, argument)
CROSSBEAM_MUTATION(Cross, cross, crossed_back)
CROSSBEAM_MUTATION(All, all, any)
CROSSBEAM_MUTATION(Any, any, all)
#undef CROSSBEAM_MUTATION

}  // namespace crossbeam::mutation
