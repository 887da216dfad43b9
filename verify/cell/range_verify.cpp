// Which numbers a cell works with: the bounds of [C-12] recomputed in long double, whose exponents
// reach far beyond, decide the same about fabrics in any units.

#include "cell/states.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace {

using verify::Parameters;
using Wide = long double;

/// What [C-12] asks of a fabric in the number type R, as margins: a number from 1 on is within the
/// bound.
template <class R>
struct Margins {
  using Limits = std::numeric_limits<R>;
  enum Bound { k3, k3l, kl3, k_over_L2, K3, K3L, KL3, count };
  std::array<Wide, count> of;
  Wide stiff_over_soft, K, least_chord, largest_elongation;
  std::size_t narrowest_elongation;

  explicit Margins(const Parameters& p) {
    struct Yarn {
      Wide l, ka, kb;
    };
    const auto yarn = [&p](const auto& y, Wide fraction) {
      const Wide H = fraction * p.contact_length, L = y.length, l = std::sqrt(L * L + H * H);
      return Yarn{l, Wide(y.youngs_modulus) * y.cross_section / l,
                  Wide(p.bending_boundary_factor) * y.youngs_modulus * y.second_moment_of_area /
                      (l * l * l)};
    };
    const Yarn warp = yarn(p.warp, p.warp_height_fraction),
               weft = yarn(p.weft, 1 - Wide(p.warp_height_fraction));
    const Wide contact = Wide(p.contact_modulus) * p.contact_area / p.contact_length;
    const Wide k = std::min({warp.ka, weft.ka, contact});
    K = warp.ka + weft.ka + contact + warp.kb + weft.kb + p.residual_compression_stiffness;
    const Wide l = std::min(p.warp.length, p.weft.length), L = std::max(warp.l, weft.l);
    least_chord = std::min(warp.l, weft.l);
    const Wide eps = Limits::epsilon(), low = Wide(Limits::min()) / (eps * eps * eps),
               high = Wide(Limits::max()) * eps;
    of = {k * k * k / low,    k * k * k * l / low,    k * l * l * l / low,   k / (L * L) / low,
          high / (K * K * K), high / (K * K * K * L), high / (K * L * L * L)};
    stiff_over_soft = std::max({warp.ka, weft.ka, warp.kb, weft.kb}) / std::min(warp.ka, weft.ka);
    const std::array<Wide, 3> most{std::sqrt(high), std::sqrt(high / K), high / (K * K * K)};
    narrowest_elongation =
        static_cast<std::size_t>(std::min_element(most.begin(), most.end()) - most.begin());
    largest_elongation = most[narrowest_elongation];
  }
  /// The only bound that is broken, or `count`.
  [[nodiscard]] std::size_t alone() const {
    std::size_t which = count;
    for (std::size_t b = 0; b < count; ++b)
      if (of[b] < 1) {
        if (which < count) return count;
        which = b;
      }
    return which;
  }
  [[nodiscard]] bool workable() const { return *std::min_element(of.begin(), of.end()) >= 1; }
  /// Whether a decision is nearer to its bound than rounding allows for.
  [[nodiscard]] bool close() const {
    const Wide slack = 100 * Wide(Limits::epsilon());
    return std::any_of(of.begin(), of.end(), [&](Wide m) { return std::abs(m - 1) < slack; });
  }
};

double relative(Wide got, Wide expected) {
  return static_cast<double>(std::abs(got - expected) / expected);
}

/// A fabric in any units: most have yarns of about the same stiffness, some anything.
/// @param force, length reach of the units, as exponents of two
Parameters any_fabric(verify::Random& random, int n, double force, double length) {
  Parameters p = verify::random_fabric(random);
  if (n % 3 != 0) p.weft.youngs_modulus = p.warp.youngs_modulus * random.uniform(0.5, 2);
  if (n % 5 == 0) p.bending_boundary_factor = random.log_uniform(1e-3, 1e9);
  if (n % 7 == 0) p.residual_compression_stiffness = random.log_uniform(1, 1e4);
  if (n % 11 == 0) p.contact_length = random.log_uniform(0.05, 50);
  if (n % 13 == 0) p.warp.length = random.log_uniform(0.05, 50);
  return verify::in_other_units(p, static_cast<int>(random.uniform(-force, force)),
                                static_cast<int>(random.uniform(-length, length)));
}

struct Counts {
  std::array<long, Margins<double>::count> alone{};
  std::array<long, 3> narrowest{};
  long wrong = 0, workable = 0, incomparable = 0, residual = 0, within_10 = 0;
  verify::Worst off;
};

/// Compares one fabric's bounds; units in which a number does not exist are V-CELL-22's.
template <class R>
void compare(const crossbeam::CellParameters<R>& p, Counts& counts) {
  using Limits = std::numeric_limits<R>;
  const Parameters wide = p.template cast<double>();
  const Margins<R> expected(wide);
  for (const auto* yarn : {&p.warp, &p.weft})
    for (R value : {yarn->youngs_modulus, yarn->cross_section, yarn->length})
      if (!(value >= Limits::min() && value <= Limits::max())) return;
  for (R value : {p.contact_modulus, p.contact_area, p.contact_length})
    if (!(value >= Limits::min() && value <= Limits::max())) return;
  for (R value : {p.warp.second_moment_of_area, p.weft.second_moment_of_area})
    if (!(value == 0 || (value >= Limits::min() && value <= Limits::max()))) return;
  if (!(p.residual_compression_stiffness <= Limits::max())) return;
  // A bending stiffness has the cubed chord below it; where that is no normal number, refusals are
  // V-STRESS-01's.
  if (expected.least_chord * expected.least_chord * expected.least_chord < Limits::min()) return;
  if (expected.close()) return;
  const crossbeam::CellRange<R> range(p);
  counts.wrong += range.workable() != expected.workable();
  if (expected.alone() < expected.of.size()) ++counts.alone[expected.alone()];
  for (Wide m : expected.of) counts.within_10 += m > 0.1L && m < 10;
  if (!expected.workable()) return;
  ++counts.workable;
  const Wide most_ratio = 1 / std::sqrt(Wide(Limits::epsilon()));
  if (std::abs(expected.stiff_over_soft / most_ratio - 1) < 100 * Wide(Limits::epsilon())) return;
  const bool comparable = expected.stiff_over_soft <= most_ratio;
  counts.wrong += range.comparable() != comparable;
  counts.incomparable += !comparable;
  counts.residual += p.residual_compression_stiffness > R(0.1) * static_cast<R>(expected.K);
  const double eps = static_cast<double>(Limits::epsilon());
  counts.off.see(
      relative(Wide(range.stiffest_yarn) / range.softest_yarn, expected.stiff_over_soft) / eps,
      "stiffest over softest yarn");
  counts.off.see(relative(range.total_stiffness, expected.K) / eps, "sum of the stiffnesses");
  counts.off.see(relative(range.largest_elongation(), expected.largest_elongation) / eps,
                 "largest elongation");
  ++counts.narrowest[expected.narrowest_elongation];
  bool accepted = true;
  try {
    crossbeam::validate(p);
  } catch (const crossbeam::InputError&) {
    accepted = false;
  }
  counts.wrong += accepted != comparable;
}

}  // namespace

TEST_SUITE_BEGIN("cell");

TEST_CASE("V-CELL-34 a cell works with the numbers of [C-12] and refuses all others") {
  VERIFY_RANDOM(random, 3401);
  Counts counts;
  for (int n = 0; n < 150000; ++n) {
    compare(any_fabric(random, n, 1100, 560), counts);
    compare(any_fabric(random, n, 110, 60).cast<float>(), counts);
  }
  // Every bound decides by itself somewhere.
  for (std::size_t b = 0; b < counts.alone.size(); ++b) {
    CAPTURE(b);
    CHECK(counts.alone[b] > 20);
  }
  for (std::size_t b = 0; b < counts.narrowest.size(); ++b) {
    CAPTURE(b);
    CHECK(counts.narrowest[b] > 100);
  }
  CAPTURE(counts.workable);
  REQUIRE(counts.workable > 10000);
  REQUIRE(counts.incomparable > 50);
  REQUIRE(counts.residual > 50);
  REQUIRE(counts.within_10 > 1000);
  verify::claim("V-CELL-34", static_cast<double>(counts.wrong), 0,
                "fabrics in any units accepted or refused otherwise than in long double");
  // Ten roundings of products, a root and a sum; the cube of the last triples them.
  counts.off.claim("V-CELL-34", 40, "roundings in ratios, sums and the largest elongation");
}

TEST_SUITE_END();
