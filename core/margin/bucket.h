// SPDX-License-Identifier: Apache-2.0
// Margin buckets: the sign of a pair's margin, and log2 of its size in ulps of the pair's largest coordinate.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "core/exact/grid.h"
#include "core/pair.h"

namespace graze {

// 0: the margin is zero. ±(k - kBucketLowest + 1): 2^k <= |margin| / ulp < 2^(k+1), positive when disjoint.
// The first and the last exponent have no outer limit. A bucket is at least -kBucketMost and at most kBucketMost.
using Bucket = std::int8_t;

inline constexpr int kBucketLowest = -32;
inline constexpr int kBucketHighest = 31;
inline constexpr int kBucketMost = kBucketHighest - kBucketLowest + 1;
inline constexpr int kBucketCount = 2 * kBucketMost + 1;

// Returns: the bucket of a margin with this sign (±1) and floor(log2(|margin| / ulp)).
GRAZE_HD constexpr Bucket make_bucket(int sign, int log2_ulps) {
  const int k = log2_ulps < kBucketLowest ? kBucketLowest : log2_ulps > kBucketHighest ? kBucketHighest : log2_ulps;
  return static_cast<Bucket>(sign * (k - kBucketLowest + 1));
}

constexpr int sign_of(Bucket bucket) { return (bucket > 0) - (bucket < 0); }

// The bucket's name in summaries: "0", "+2^5", "-2^-3".
inline std::string name_of_bucket(Bucket bucket) {
  if (bucket == 0) return "0";
  const int k = (bucket < 0 ? -bucket : bucket) + kBucketLowest - 1;
  return (bucket < 0 ? "-2^" : "+2^") + std::to_string(k);
}

// floor(log2(x)) for a positive normal x; for zero, a smaller value than for any such x.
GRAZE_HD inline int floor_log2(double x) { return static_cast<int>(exact::detail::bits_of(x) >> 52) - 1023; }

// log2 of the ulp of the pair's largest coordinate in magnitude: in [-149, 104] for float32, [-1074, 971] for double.
// Requires: finite coordinates.
template <class Real>
GRAZE_HD int log2_ulp(const BasicPair<Real>& pair) {
  using F = exact::detail::Format<Real>;
  typename F::Bits largest = 0;
  const Real* c = &pair.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    const typename F::Bits bits = exact::detail::bits_of(c[i]) & ~F::kSign;
    if (bits > largest) largest = bits;
  }
  const int exponent = static_cast<int>(largest >> F::kFraction);
  return (exponent == 0 ? 1 : exponent) - F::kBias - F::kFraction;
}

}  // namespace graze
