#pragma once
/// @file
/// Derivatives tested by their rate (crossbeam/verification/taylor_test.hpp).

#include "crossbeam/verification/taylor_test.hpp"

namespace verify {
using crossbeam::verification::taylor_test;
using crossbeam::verification::TaylorResult;
}  // namespace verify
