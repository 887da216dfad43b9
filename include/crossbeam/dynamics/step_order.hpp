#pragma once
/// @file
/// The order in which a step goes through the levels of its nodes: stages, bands that threads share,
/// and how close steps in flight may follow each other. Theory: docs/theory/sweep.md, [S-3], [S-5],
/// [S-6].

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/dynamics/thread_team.hpp"

#include <algorithm>
#include <vector>

namespace crossbeam {

class StepOrder {
 public:
  /// One stage's part of a step: levels whose forces begin, the stage, and levels that have all their
  /// forces then.
  struct Place {
    int clear_begin, clear_end, stage, finish_begin, finish_end;
  };

  StepOrder() = default;

  /// Level after level, but the stage that two bands share, their seam, after the one that follows it,
  /// so that every node sums its forces as with threads.
  explicit StepOrder(int levels) : levels_(levels) {
    // As many bands whatever the number of threads: the order of all sums is then the same.
    const int bands = std::clamp(levels / least_band, 1, most_bands);
    for (int band = 0; band <= bands; ++band) band_start_.push_back(levels * band / bands);
    for (int band = 0; band < bands; ++band) {
      const int first = band_start_[band], last = band_start_[band + 1];
      for (int level = first; level < last; ++level) {
        if (band == 0 || level > first + 1) {
          const int finish_end = level + 1 == levels ? level + 1 : level;
          places_.push_back({level, level + 1, level, maximum(level - 1, 0), finish_end});
        } else if (level > first) {
          places_.push_back({first, level + 1, level, level, level});
          places_.push_back({first, first, first, first - 1, first + 1});
        }
      }
    }
    find_lag();
  }

  [[nodiscard]] int levels() const { return levels_; }
  [[nodiscard]] int bands() const { return static_cast<int>(band_start_.size()) - 1; }
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }
  /// Places between a step in flight and the next one, whose turn comes after its own.
  [[nodiscard]] int lag() const { return lag_; }

  /// task(place) for all places. One thread takes them in their order. Several take the bands beside
  /// each other, each without its seam, and then the seams.
  template <class Task>
  void share(ThreadTeam& team, const Task& task) const {
    if (team.threads() == 1) {
      for (const Place& place : places_) task(place);
      return;
    }
    const auto seam = [this](int band) { return band > 0 ? band_start_[band] + 1 : -1; };
    team.run(bands(), [&](int band) {
      for (int p = band_start_[band]; p < band_start_[band + 1]; ++p)
        if (p != seam(band)) task(places_[p]);
    });
    team.run(bands() - 1, [&](int k) { task(places_[seam(k + 1)]); });
  }

  /// task(place, flight) for all places of `flights` steps: a step takes a place where the one before
  /// has finished all that the place touches.
  template <class Task>
  void follow(int flights, const Task& task) const {
    const int count = static_cast<int>(places_.size());
    for (int now = 0; now < count + lag_ * (flights - 1); ++now)
      for (int flight = 0, p = now; flight < flights && p >= 0; ++flight, p -= lag_)
        if (p < count) task(places_[p], flight);
  }

 private:
  /// Levels of a band at least: the seams between bands are the more work the narrower they are.
  static constexpr int least_band = 6, most_bands = 64;

  void find_lag() {
    std::vector<int> finished(static_cast<std::size_t>(levels_));
    const int count = static_cast<int>(places_.size());
    for (int p = 0; p < count; ++p)
      for (int l = places_[p].finish_begin; l < places_[p].finish_end; ++l) finished[l] = p;
    for (int p = 0; p < count; ++p)
      for (int l = maximum(places_[p].stage - 1, 0);
           l < maximum(places_[p].stage + 1, places_[p].clear_end); ++l)
        lag_ = maximum(lag_, finished[l] - p);
  }

  int levels_ = 0, lag_ = 1;
  std::vector<int> band_start_;  // first level, and first place, of every band; their count
  std::vector<Place> places_;
};

}  // namespace crossbeam
