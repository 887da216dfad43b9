#pragma once
/// @file
/// The generator of random states, its seed printed by every failing test.

#include "crossbeam/verification/random.hpp"

#include <doctest/doctest.h>

/// A generator called `name`; its seed is part of every failure message of the scope.
#define VERIFY_RANDOM(name, fixed_seed) \
  ::verify::Random name(fixed_seed);    \
  const auto name##_seed = name.seed(); \
  CAPTURE(name##_seed)

namespace verify {
using crossbeam::verification::Random;
}  // namespace verify
