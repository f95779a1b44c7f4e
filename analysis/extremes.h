// SPDX-License-Identifier: Apache-2.0
// Finds how extreme pairs may be before a lane errs more often, from its errors at each power of two.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace graze::analysis {

// Errors on the pairs at 2^exponent, or on the pairs from 2^exponent to the next exponent.
struct ErrorsAt {
  int exponent = 0;
  std::uint64_t errors = 0, pairs = 0;
};

inline constexpr std::uint64_t kFewPairs = 100;  // an exponent with fewer pairs shows nothing
inline constexpr double kRightShare = 1e-3;      // a lane that errs on at most this share is right
inline constexpr double kAsRight = 2;            // a lane that errs at most this many times as often is as right

// The result in one direction from the origin.
struct RightSide {
  int right = 0;             // the lane is shown to be as right up to this exponent
  int last = 0;              // the last exponent with any pairs, even too few
  std::optional<int> worse;  // the first exponent at which the lane is shown to be less right
};

// The range in which a lane is as right as at the origin (the exponent nearest to 0); see kAsRight. "Shown" means that
// the 95 % intervals of both shares prove it.
struct RightRange {
  ErrorsAt origin;
  bool settled = false;  // false: too few pairs at the origin to compare with
  RightSide down, up;
};

// Returns nothing if no exponent has kFewPairs pairs.   Requires: rising exponents.
std::optional<RightRange> right_range(std::span<const ErrorsAt> points);

}  // namespace graze::analysis
