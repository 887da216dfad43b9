// What a run does over a long time: its energy, which must not drift.

#include "dynamics/scenes.hpp"
#include "support/claim.hpp"

#include <doctest/doctest.h>

#include <string>

namespace {

using namespace scenes;
using verify::claim;

/// Error of the total energy of a conservative run, over the kinetic energy it began with.
struct EnergyError {
  std::vector<double> time, error;  // [ms], [-]

  EnergyError(const TautSheet& sheet, double share_of_critical, long steps, int every) {
    using T = NativePack<double>;
    CentralDifference<T> run(sheet.model<T>(), TimeStep::fraction(share_of_critical));
    EnergyLedger row;
    double kinetic = 0;
    for (long k = 0; k < steps; ++k) {
      const bool sample = k % every == 0;
      run.step(sample ? &row : nullptr);
      if (!sample) continue;
      if (k == 0) kinetic = row.value("kinetic");
      time.push_back(row.time);
      error.push_back(-row.residual() / kinetic);
    }
    REQUIRE(kinetic > 0);
    // Energy went to and fro between yarns and motion, and nothing else took part.
    REQUIRE(row.value("yarn") > 0);
    REQUIRE(row.total(EnergyKind::dissipated) + row.value("tools") == 0);
  }

  [[nodiscard]] double amplitude() const {
    double out = 0;
    for (const double e : error) out = std::max(out, std::abs(e));
    return out;
  }
};

/// The error by blocks of time, each much longer than the slowest oscillation, and a straight line
/// through their means, whose scatter about it gives the uncertainty of its slope.
struct Drift {
  static constexpr int blocks = 100;
  std::vector<double> time, mean, least, most;
  double over_the_run = 0, uncertainty = 0;

  explicit Drift(const EnergyError& e) {
    const std::size_t size = e.error.size() / blocks;
    REQUIRE(size > 10);
    for (std::size_t k = 0; k < blocks; ++k) {
      const Eigen::Map<const Eigen::ArrayXd> block(e.error.data() + k * size,
                                                   static_cast<Eigen::Index>(size));
      time.push_back(e.time[k * size]);
      mean.push_back(block.mean());
      least.push_back(block.minCoeff());
      most.push_back(block.maxCoeff());
    }
    const Eigen::Map<const Eigen::ArrayXd> y(mean.data(), blocks);
    const Eigen::ArrayXd x = Eigen::ArrayXd::LinSpaced(blocks, -0.5, 0.5);
    const double xx = x.square().sum();
    over_the_run = (x * y).sum() / xx;
    const Eigen::ArrayXd rest = y - y.mean() - over_the_run * x;
    uncertainty = std::sqrt(rest.square().sum() / (blocks - 2) / xx);
  }
};

/// @param name of the number of steps, for notes and captions
void claim_no_drift(const TautSheet& sheet, long steps, const std::string& name) {
  const EnergyError whole(sheet, 0.5, steps, 23);
  const Drift drift(whole);
  // The scheme is symplectic, and the force smooth as long as the sheet is taut: its energy error
  // is bounded. A line through noise is off by three of its uncertainties once in 370 times.
  claim("V-DYN-08", std::abs(drift.over_the_run) / drift.uncertainty, 3,
        "drift over " + name + " steps, in its own uncertainties");
  claim("V-DYN-08", std::abs(drift.over_the_run) / whole.amplitude(), 0.01,
        "drift over " + name + " steps, over the amplitude of the oscillation");
  verify::show(verify::Plot{
      "V-DYN-08",
      "Energy error of a conservative run of " + name + " steps",
      "time [ms]",
      "total energy less that at the start, over the first kinetic energy [-]",
      false,
      false,
      {{"largest of a hundredth of the run", drift.time, drift.most},
       {"mean", drift.time, drift.mean},
       {"smallest", drift.time, drift.least}},
      "The error oscillates between two level lines; nothing leaks, nothing is created."});
}

}  // namespace

TEST_SUITE_BEGIN("dynamics");

TEST_CASE("V-DYN-08 the energy of a conservative run over a million steps does not drift") {
  TautSheet sheet(0.3, 4);
  sheet.speed = 3;
  claim_no_drift(sheet, 1000000, "1e6");

  // What oscillates is of the size of dt^2, over the same time.
  std::vector<double> amplitude;
  for (const int halving : {0, 1, 2})
    amplitude.push_back(EnergyError(sheet, 0.25 / (1 << halving), 8000L << halving, 3).amplitude());
  REQUIRE(amplitude[2] > 1e-10);  // not rounding
  claim("V-DYN-08", amplitude[0], 1e-4, "amplitude at a quarter of the critical step, relative");
  // The next term of the series is of relative size (omega dt)^2 / 4 = 0.06 at the coarsest step.
  for (const int k : {0, 1})
    claim("V-DYN-08", std::abs(std::log2(amplitude[k] / amplitude[k + 1]) - 2), 0.1,
          "order of the amplitude in the step, off 2");
}

TEST_CASE("V-DYN-08 nor over ten million (long)") {
  TautSheet sheet(0.3, 4);
  sheet.speed = 3;
  claim_no_drift(sheet, 10000000, "1e7");
}

TEST_SUITE_END();
