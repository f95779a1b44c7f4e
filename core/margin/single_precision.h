// SPDX-License-Identifier: Apache-2.0
// Two quick attempts to find a pair's margin bucket, for GPUs, where double precision, roots and quotients are slow.
// The bounds are certified, as in core/margin/margin.h, and much cheaper, but leave more pairs undecided. Disjoint
// triangles: the nearest features are guessed, and only the guess is certified. Intersecting triangles: single
// precision finds the axes that may have the least overlap, and only these are computed in double.
#pragma once

#include <cmath>

#include "core/exact/error_bound.h"
#include "core/exact/grid.h"
#include "core/margin/bucket.h"
#include "core/margin/corners.h"
#include "core/margin/guessed_distance.h"
#include "core/margin/margin.h"
#include "core/margin/nearest_features.h"
#include "core/margin/quick_depth.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze {
inline namespace GRAZE_FP {
namespace first_attempt {

GRAZE_HD inline Vec extent_of(const Pair& pair) {
  const auto extent = exact::detail::extent_of(&pair.a[0].x, &pair.b[0].x);
  return {extent.x, extent.y, extent.z};
}

// Whether float's range suffices for determinants, for products of six differences, and for the errors of determinants;
// underflow is then negligible compared with those errors.
GRAZE_HD inline bool fits_single(const Vec& extent) {
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  const auto sensible = [](double r) { return r == 0 || r >= 0x1p-30; };
  return largest >= 0x1p-15 && largest <= 0x1p15 && sensible(extent.x) && sensible(extent.y) && sensible(extent.z);
}

GRAZE_HD inline bool bucket_of(const MarginBounds& bounds, Verdict verdict, int log2_ulp, Bucket& bucket) {
  // Differences of scaled coordinates may be as small as 2^-277. Squared lengths do not underflow, but products of
  // more factors may. Such a lo is not a bound, but it is not in (0, hi] either, so the result is false.
  return bounds.lo > 0 && bounds.lo <= bounds.hi && bounds.hi < INFINITY &&
         bucket_from_bounds(bounds, verdict, log2_ulp, bucket);
}

}  // namespace first_attempt

// The bucket, if bounds decide it. Single precision selects what to compute in double.
// Requires: finite coordinates; verdict is the pair's true verdict, not declined.
GRAZE_HD inline bool bucket_by_single(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace first_attempt;
  const Vec extent = extent_of(pair);
  if (!fits_single(extent)) return false;
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    const Nearest<float> nearest = seem_nearest(pair.a, pair.b);
    const auto largest = static_cast<float>(greater(extent.x, greater(extent.y, extent.z)));
    if (nearest.next < 0x1p-44f * largest * largest) return false;  // the choice may be due to rounding
    bounds = distance_bounds(pair.a, pair.b, nearest.features);
  } else {
    float lo, hi;
    depth_in_single(pair.a, pair.b, {float(extent.x), float(extent.y), float(extent.z)}, lo, hi);
    bounds = {lo, hi, 0, 0};
  }
  return bucket_of(bounds, verdict, log2_ulp(pair), bucket);
}

// Like bucket_by_single, with all computation in double.
GRAZE_HD inline bool bucket_by_double(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace first_attempt;
  const Vec extent = extent_of(pair);
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  if (!(largest > 0)) return false;
  // Scales the extent into [1, 2). Scaling is exact, so differences still have one rounding.
  const int exponent = floor_log2(largest);
  const double scale = exact::detail::power_of_two(-exponent);
  Corners<double> a, b;
  for (int i = 0; i < 3; ++i) {
    a[i] = widen(pair.a[i]) * scale;
    b[i] = widen(pair.b[i]) * scale;
  }
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    bounds = distance_bounds(a, b, seem_nearest(a, b).features);
  } else {
    float lo, hi;
    depth_in_double(a, b, extent * scale, lo, hi);
    bounds = {lo, hi, 0, 0};
  }
  return bucket_of(bounds, verdict, log2_ulp(pair) - exponent, bucket);
}

}  // namespace GRAZE_FP
}  // namespace graze
