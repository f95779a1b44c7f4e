// SPDX-License-Identifier: Apache-2.0
// Margin buckets: the sign of a pair's margin, and log2 of its size in ulps of the pair's largest coordinate.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

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
GRAZE_HD inline int floor_log2(double x) {
  std::uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return static_cast<int>(bits >> 52) - 1023;
}

// log2 of the ulp of the pair's largest coordinate in magnitude: in [-149, 104] for float32, [-1074, 971] for double.
// Requires: finite coordinates.
GRAZE_HD inline int log2_ulp(const Pair& pair) {
  std::uint32_t largest = 0;
  const float* c = &pair.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    std::uint32_t bits;
    memcpy(&bits, &c[i], sizeof bits);
    bits &= 0x7fffffffu;
    if (bits > largest) largest = bits;
  }
  const int exponent = static_cast<int>(largest >> 23);
  return (exponent == 0 ? 1 : exponent) - 150;
}
GRAZE_HD inline int log2_ulp(const DoublePair& pair) {
  std::uint64_t largest = 0;
  const double* c = &pair.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    std::uint64_t bits;
    memcpy(&bits, &c[i], sizeof bits);
    bits &= 0x7fffffffffffffffu;
    if (bits > largest) largest = bits;
  }
  const int exponent = static_cast<int>(largest >> 52);
  return (exponent == 0 ? 1 : exponent) - 1075;
}

}  // namespace graze
