// A pack computes in every lane exactly what its scalar computes: the operations compared here are
// correctly rounded by IEEE 754, so equality is bit for bit and no tolerance is needed.

#include "crossbeam/base/simd.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace {

using crossbeam::Pack;

template <class P>
using Lanes = std::array<typename P::Value, crossbeam::lanes_v<P>>;

template <class P>
Lanes<P> random_lanes(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> uniform(low, high);
  Lanes<P> values;
  for (auto& value : values) {
    // Volatile: g++ 12 takes two floats that came of doubles for those doubles when they are
    // widened.
    const volatile auto rounded = static_cast<typename P::Value>(uniform(random));
    value = rounded;
  }
  return values;
}

}  // namespace

TEST_SUITE_BEGIN("base");

TEST_CASE_TEMPLATE("arithmetic, square root and selection of packs equal the scalar's in each lane",
                   P, Pack<double, 1>, Pack<double, 2>, Pack<double, 4>, Pack<double, 8>,
                   Pack<float, 1>, Pack<float, 4>, Pack<float, 8>, Pack<float, 16>) {
  using S = typename P::Value;
  std::mt19937 random(20260101);
  for (int sample = 0; sample < 50; ++sample) {
    const auto a = random_lanes<P>(random, -10, 10);
    const auto b = random_lanes<P>(random, 0.1, 10);
    const P pa = P::load(a.data()), pb = P::load(b.data());
    const P sum = pa + pb, difference = pa - pb, product = pa * pb, quotient = pa / pb;
    const P root = sqrt(pb), negative = -pa, chosen = select(pa < pb, pa, pb);
    const P larger = maximum(pa, pb), smaller = minimum(pa, pb), size = magnitude(pa);
    P added = pa, subtracted = pa, multiplied = pa;
    added += pb;
    subtracted -= pb;
    multiplied *= pb;
    for (int i = 0; i < crossbeam::lanes_v<P>; ++i) {
      CAPTURE(sample);
      CAPTURE(i);
      CHECK(sum[i] == a[i] + b[i]);
      CHECK(difference[i] == a[i] - b[i]);
      CHECK(product[i] == a[i] * b[i]);
      CHECK(quotient[i] == a[i] / b[i]);
      CHECK(root[i] == std::sqrt(b[i]));
      CHECK(negative[i] == -a[i]);
      CHECK(chosen[i] == (a[i] < b[i] ? a[i] : b[i]));
      CHECK(larger[i] == std::max(a[i], b[i]));
      CHECK(smaller[i] == std::min(a[i], b[i]));
      CHECK(size[i] == std::abs(a[i]));
      CHECK(added[i] == a[i] + b[i]);
      CHECK(subtracted[i] == a[i] - b[i]);
      CHECK(multiplied[i] == a[i] * b[i]);
      CHECK((S(2) * pa)[i] == S(2) * a[i]);
    }
  }
}

TEST_CASE_TEMPLATE("comparisons, any and all of packs agree with the lanes", P, Pack<double, 2>,
                   Pack<double, 4>, Pack<double, 8>, Pack<float, 4>, Pack<float, 16>) {
  using S = typename P::Value;
  const P zero(S(0));
  Lanes<P> values;
  // Every pattern of -1, 0 and 1 that two neighbouring lanes can show.
  for (int first = -1; first <= 1; ++first)
    for (int second = -1; second <= 1; ++second) {
      CAPTURE(first);
      CAPTURE(second);
      for (int i = 0; i < crossbeam::lanes_v<P>; ++i) values[i] = S(i % 2 == 0 ? first : second);
      const P p = P::load(values.data());
      for (int i = 0; i < crossbeam::lanes_v<P>; ++i) {
        CHECK((p < zero)[i] == (values[i] < 0));
        CHECK((p <= zero)[i] == (values[i] <= 0));
        CHECK((p > zero)[i] == (values[i] > 0));
        CHECK((p >= zero)[i] == (values[i] >= 0));
        CHECK((p == zero)[i] == (values[i] == 0));
        CHECK((!(p < zero))[i] == !(values[i] < 0));
        CHECK(((p < zero) || (p > zero))[i] == (values[i] != 0));
        CHECK(((p <= zero) && (p >= zero))[i] == (values[i] == 0));
      }
      CHECK(any(p < zero) == (first < 0 || second < 0));
      CHECK(all(p < zero) == (first < 0 && second < 0));
    }
}

TEST_CASE_TEMPLATE("one true lane out of all makes any true and all false", P, Pack<double, 2>,
                   Pack<double, 4>, Pack<double, 8>, Pack<float, 4>, Pack<float, 8>,
                   Pack<float, 16>) {
  for (int lane = 0; lane < crossbeam::lanes_v<P>; ++lane) {
    CAPTURE(lane);
    P p(0);
    CHECK_FALSE(any(p > P(0)));
    p.set(lane, 1);
    CHECK(any(p > P(0)));
    CHECK_FALSE(all(p > P(0)));
    CHECK_FALSE(all(p < P(1)));
    CHECK(any(p < P(1)));
    CHECK(all(p >= P(0)));
  }
}

TEST_CASE_TEMPLATE("load, store, broadcast, lane_sum and lane_maximum of packs keep every lane", P,
                   Pack<double, 1>, Pack<double, 4>, Pack<double, 8>, Pack<float, 8>,
                   Pack<float, 16>) {
  using S = typename P::Value;
  // Small integers add up without rounding in any order.
  Lanes<P> values, stored;
  S sum = 0;
  for (int i = 0; i < crossbeam::lanes_v<P>; ++i) {
    values[i] = S((7 * i + 3) % 11 - 5);
    sum += values[i];
  }
  const P p = P::load(values.data());
  p.store(stored.data());
  CHECK(stored == values);
  CHECK(lane_sum(p) == sum);
  CHECK(lane_maximum(p) == *std::max_element(values.begin(), values.end()));
  CHECK(lane_maximum(-p) == -*std::min_element(values.begin(), values.end()));
  for (int lane = 0; lane < crossbeam::lanes_v<P>; ++lane) {
    CAPTURE(lane);
    P raised = p;
    raised.set(lane, S(100));
    CHECK(lane_maximum(raised) == S(100));
    CHECK(lane_sum(raised) == sum - values[lane] + S(100));
    CHECK(P(S(2.5))[lane] == S(2.5));
    CHECK(std::signbit(P(S(-0.0))[lane]));
  }
}

TEST_CASE_TEMPLATE("the lanes of a pack in the other precision are those of the scalar", P,
                   Pack<float, 1>, Pack<float, 2>, Pack<float, 4>, Pack<float, 8>,
                   Pack<float, 16>) {
  using Wide = crossbeam::double_lanes_t<P>;
  static_assert(crossbeam::lanes_v<Wide> == crossbeam::lanes_v<P>);
  static_assert(std::is_same_v<typename Wide::Value, double>);
  static_assert(std::is_same_v<crossbeam::double_lanes_t<Wide>, Wide>);
  std::mt19937 random(20260108);
  for (int sample = 0; sample < 50; ++sample) {
    const auto doubles = random_lanes<Wide>(random, -10, 10);
    const auto floats = random_lanes<P>(random, -10, 10);
    const P narrow = crossbeam::convert<P>(Wide::load(doubles.data()));
    const Wide wide = crossbeam::convert<Wide>(P::load(floats.data()));
    const Wide same = crossbeam::convert<Wide>(Wide::load(doubles.data()));
    for (int i = 0; i < crossbeam::lanes_v<P>; ++i) {
      CHECK(narrow[i] == static_cast<float>(doubles[i]));
      CHECK(wide[i] == static_cast<double>(floats[i]));
      CHECK(same[i] == doubles[i]);
    }
  }
}

TEST_SUITE_END();
