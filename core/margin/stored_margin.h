// SPDX-License-Identifier: Apache-2.0
// The bucket of a pair of doubles whose margin is wide even after the pair is stored as float32.
#pragma once

#include "core/margin/bucket.h"

namespace graze {

// The bucket of a pair of doubles, from the bucket of the stored pair. Storing moves each vertex by less than an ulp of
// float32. The distance between the hulls and the depth (the least translation that separates them) change by at most
// the largest movement of a's vertices plus that of b's. So a margin of 2^kWide ulps of float32 stays above 2^(kWide -
// 1) of them, which is more than 2^kBucketHighest ulps of double.
// Requires: storing does not change the verdict.   Returns: `open` if the stored margin is not wide.
GRAZE_HD constexpr Bucket wide_bucket(Bucket of_stored, Bucket open) {
  constexpr int kWide = 5;
  static_assert(kWide - 1 + 29 >= kBucketHighest);
  const int size = of_stored < 0 ? -of_stored : of_stored;
  return size < make_bucket(1, kWide) ? open : make_bucket(of_stored < 0 ? -1 : 1, kBucketHighest);
}

}  // namespace graze
