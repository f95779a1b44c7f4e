// SPDX-License-Identifier: Apache-2.0
// How far pairs may be from ordinary ones before a lane errs more, shown by its errors at each power of two.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace graze::analysis {

// Errors on the pairs at 2^exponent, or from there to the next exponent.
struct ErrorsAt {
  int exponent = 0;
  std::uint64_t errors = 0, pairs = 0;
};

inline constexpr std::uint64_t kFewPairs = 100;  // fewer pairs at an exponent show nothing
inline constexpr double kRightShare = 1e-3;      // a lane that errs on at most this share is right
inline constexpr double kAsRight = 2;            // as right as another: errs at most this many times as often

// What is shown in one direction from the origin.
struct RightSide {
  int right = 0;             // as right up to this exponent: the last before the first that is not shown to be
  int last = 0;              // the last exponent with pairs, even if they are too few
  std::optional<int> worse;  // the first exponent at which the lane is shown to be less right
};

// The range in which a lane is as right as at the origin, the exponent nearest to 0. "Shown" means that the
// 95 % intervals of both shares say so.
struct RightRange {
  ErrorsAt origin;
  bool settled = false;  // false: too few pairs at the origin to compare with
  RightSide down, up;
};

// Nothing if no exponent has kFewPairs pairs.   Requires: rising exponents.
std::optional<RightRange> right_range(std::span<const ErrorsAt> points);

}  // namespace graze::analysis
