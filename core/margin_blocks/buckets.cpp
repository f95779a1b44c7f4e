// SPDX-License-Identifier: Apache-2.0
// This file uses Google Highway like core/exact_blocks/decide.cpp. Rounding of the bounds does not affect the buckets
// that they decide.
#include "core/margin_blocks/buckets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/margin_blocks/buckets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/exact/exact.h"

HWY_BEFORE_NAMESPACE();
namespace graze::margin_blocks {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace detail = exact::detail;

#if HWY_MAX_BYTES >= 32 && !HWY_HAVE_SCALABLE
#include "core/exact_blocks/vectors-inl.h"
#include "core/margin_blocks/bounds-inl.h"

// floor(log2(x)) of positive numbers.
HWY_INLINE VI floor_log2_of(V x) { return hn::Sub(hn::ShiftRight<52>(hn::BitCast(di, x)), hn::Set(di, 1023)); }

// Like make_bucket, without the sign.
HWY_INLINE VI size_of_bucket(VI log2_margin, VI log2_ulp) {
  const VI k = hn::Sub(log2_margin, log2_ulp);
  return hn::Add(hn::Min(hn::Max(k, hn::Set(di, kBucketLowest)), hn::Set(di, kBucketHighest)),
                 hn::Set(di, 1 - kBucketLowest));
}

constexpr unsigned kAll = (1u << kAtOnce) - 1;

struct Numbers {
  std::uint32_t pair[kAtOnce];
};

HWY_INLINE Coordinates coordinates_at(const float* pairs, const Numbers& numbers) {
  const float* where[kAtOnce];
  for (std::size_t i = 0; i < kAtOnce; ++i) where[i] = pairs + std::size_t{numbers.pair[i]} * kNumbers;
  return Coordinates(where);
}

// Writes the buckets that the bounds decide. squares: whether these are bounds on the squared margins.   Returns: a
// mask of the buckets that it wrote.
HWY_INLINE unsigned settle(const Bounds& bounds, bool squares, V largest, std::int64_t sign, const Numbers& numbers,
                           unsigned which, Bucket* buckets) {
  const auto log2 = [&](V x) HWY_ATTR { return squares ? hn::ShiftRight<1>(floor_log2_of(x)) : floor_log2_of(x); };
  const VI ulp = hn::Max(hn::Sub(floor_log2_of(largest), hn::Set(di, 23)), hn::Set(di, -149));
  const VI low = size_of_bucket(log2(bounds.lo), ulp), high = size_of_bucket(log2(bounds.hi), ulp);
  const M sound = hn::And(hn::Gt(bounds.lo, hn::Zero(d)),
                          hn::And(hn::Le(bounds.lo, bounds.hi), hn::Lt(bounds.hi, number(INFINITY))));
  const unsigned settled = which & bits(hn::And(sound, hn::RebindMask(d, hn::Eq(low, high))));
  HWY_ALIGN std::int64_t sizes[kAtOnce];
  hn::Store(low, di, sizes);
  for (unsigned left = settled; left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(left));
    buckets[numbers.pair[i]] = static_cast<Bucket>(sign * sizes[i]);
  }
  return settled;
}

HWY_ATTR void measure_gaps(const float* pairs, const Numbers& numbers, Bucket* buckets) {
  const Frame frame(coordinates_at(pairs, numbers));
  settle(distance_bounds(frame), false, frame.largest, 1, numbers, kAll, buckets);
}

HWY_ATTR void measure_depths(const float* pairs, const Numbers& numbers, Bucket* buckets) {
  const Coordinates coordinates = coordinates_at(pairs, numbers);
  const Frame frame(coordinates);
  const unsigned exact = bits(frame.exact);
  unsigned open = kAll;
  if (exact != 0) open &= ~settle(squared_depth_bounds(frame), true, frame.largest, -1, numbers, exact, buckets);
  if (open == 0) return;
  const OnGrid fine(coordinates, kBitsOfBoth);
  open &= fine.within;
  if (open != 0) open &= touch<DoubleAndInteger>(fine);
  for (; open != 0; open &= open - 1) buckets[numbers.pair[std::countr_zero(open)]] = 0;
}

// Takes kAtOnce pairs with the same verdict at a time. The last group is padded with its first pair.
HWY_ATTR void measure_all(const float* pairs, std::size_t count, const std::uint64_t* intersects, Bucket* buckets) {
  std::fill_n(buckets, count, kOpenBucket);
  Numbers waiting[2] = {};
  std::size_t filled[2] = {};
  const auto measure = [&](bool verdict) HWY_ATTR {
    Numbers& numbers = waiting[verdict];
    const std::size_t some = filled[verdict];
    if (some == 0) return;
    std::fill(numbers.pair + some, numbers.pair + kAtOnce, numbers.pair[0]);
    (verdict ? measure_depths : measure_gaps)(pairs, numbers, buckets);
    filled[verdict] = 0;
  };
  for (std::size_t i = 0; i < count; ++i) {
    const bool verdict = intersects[i / 64] >> i % 64 & 1;
    waiting[verdict].pair[filled[verdict]++] = static_cast<std::uint32_t>(i);
    if (filled[verdict] == kAtOnce) measure(verdict);
  }
  measure(false);
  measure(true);
}

#else

void measure_all(const float*, std::size_t count, const std::uint64_t*, Bucket* buckets) {
  std::fill_n(buckets, count, kOpenBucket);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace graze::margin_blocks
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graze {
namespace margin_blocks {
HWY_EXPORT(measure_all);
}

void margin_buckets(const float* pairs, std::size_t count, const std::uint64_t* intersects, Bucket* buckets) {
  using namespace margin_blocks;
  HWY_DYNAMIC_DISPATCH(measure_all)(pairs, count, intersects, buckets);
}

}  // namespace graze
#endif
