#pragma once
/// @file
/// The explicit double-dome drape: from a case to its result.

#include "case.hpp"
#include "progress.hpp"
#include "result.hpp"

#include <array>
#include <functional>
#include <vector>

namespace crossbeam::drape {

/// Takes the frames of a run one after the other, each as soon as it is there: none is kept. The
/// first argument is DrapeResult::quads.
using FrameSink = std::function<void(const std::vector<std::array<int, 4>>& quads, const Frame&)>;

/// Runs a case to its end.
/// @param frames takes exactly `output.frames` frames at even steps, from the start to the end; of
///   a single one it is the end
/// @throws InputError for a field out of range; RunError when an element, the cell or the energy
///   ledger goes wrong on the way.
DrapeResult run(const DrapeCase& drape_case, const Progress& progress,
                const FrameSink& frames = {});

}  // namespace crossbeam::drape
