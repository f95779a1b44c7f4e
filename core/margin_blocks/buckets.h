// SPDX-License-Identifier: Apache-2.0
// Buckets of many pairs' margins side by side: certified as core/margin/margin.h is, at a fraction of its time, and now
// and then open.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/margin/bucket.h"

namespace graze {

inline constexpr Bucket kOpenBucket = 127;

// Writes each pair's bucket, or kOpenBucket where it is not settled. pairs: 18 floats each; bit i % 64 of word i / 64
// of `intersects` is the true verdict of pair i. Requires: finite coordinates.
void margin_buckets(const float* pairs, std::size_t count, const std::uint64_t* intersects, Bucket* buckets);

}  // namespace graze
