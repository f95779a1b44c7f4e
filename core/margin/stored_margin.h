// SPDX-License-Identifier: Apache-2.0
// The margin of a pair of doubles that is wide already as float32 stores the pair.
#pragma once

#include "core/margin/bucket.h"

namespace graze {

// The bucket of a pair of doubles, from that of the stored pair. Storing moves each vertex by less than an ulp of
// float32. The distance of two hulls, and the depth, which is the least translation that separates them, change by no
// more than the vertices of both move. So a margin of 2^kWide such ulps stays above 2^(kWide - 1), which are more than
// 2^kBucketHighest ulps of double.
// Requires: storing does not change the verdict.   Returns: `open` if the stored margin is not wide.
GRAZE_HD constexpr Bucket wide_bucket(Bucket of_stored, Bucket open) {
  constexpr int kWide = 5;
  static_assert(kWide - 1 + 29 >= kBucketHighest);
  const int size = of_stored < 0 ? -of_stored : of_stored;
  return size < make_bucket(1, kWide) ? open : make_bucket(of_stored < 0 ? -1 : 1, kBucketHighest);
}

}  // namespace graze
