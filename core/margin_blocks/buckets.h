// SPDX-License-Identifier: Apache-2.0
// Margin buckets of many pairs at once, certified like those of core/margin/margin.h, in a fraction of the time; a few
// pairs remain undecided.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/margin/bucket.h"

namespace graze {

inline constexpr Bucket kOpenBucket = 127;

// Writes each pair's bucket, or kOpenBucket if it is undecided. pairs: 18 floats each. Bit i % 64 of word i / 64 of
// `intersects` is the true verdict of pair i.   Requires: finite coordinates.
void margin_buckets(const float* pairs, std::size_t count, const std::uint64_t* intersects, Bucket* buckets);

}  // namespace graze
