// SPDX-License-Identifier: Apache-2.0
// Two first attempts at a pair's margin bucket: certified as core/margin/margin.h is, at a fraction of its cost, and
// undecided more often. Written for GPUs, where double precision, roots and quotients are slow. The nearest features of
// disjoint triangles are guessed, and only the guess is certified. For intersecting ones single precision finds which
// axes may be those of least overlap, and only these are computed in double.
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

// Whether single precision has the range: determinants, products of six differences, and the errors of determinants,
// beside which underflow is nothing.
GRAZE_HD inline bool fits_single(const Vec& extent) {
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  const auto sensible = [](double r) { return r == 0 || r >= 0x1p-30; };
  return largest >= 0x1p-15 && largest <= 0x1p15 && sensible(extent.x) && sensible(extent.y) && sensible(extent.z);
}

GRAZE_HD inline bool bucket_of(const MarginBounds& bounds, Verdict verdict, int log2_ulp, Bucket& bucket) {
  // Differences of scaled coordinates may be as small as 2^-277: the squares of lengths do not underflow, but products
  // of more may, and then a separation is no bound. It does not lie between 0 and the connection's length either.
  return bounds.lo > 0 && bounds.lo <= bounds.hi && bounds.hi < INFINITY &&
         bucket_from_bounds(bounds, verdict, log2_ulp, bucket);
}

}  // namespace first_attempt

// The bucket, if bounds decide it; single precision finds what to look at in double.
// Requires: finite coordinates; verdict is the pair's true verdict, not declined.
GRAZE_HD inline bool bucket_by_single(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace first_attempt;
  const Vec extent = extent_of(pair);
  if (!fits_single(extent)) return false;
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    const Nearest<float> nearest = seem_nearest(pair.a, pair.b);
    const auto largest = static_cast<float>(greater(extent.x, greater(extent.y, extent.z)));
    if (nearest.next < 0x1p-44f * largest * largest) return false;  // rounding may have chosen
    bounds = distance_bounds(pair.a, pair.b, nearest.features);
  } else {
    float lo, hi;
    depth_in_single(pair.a, pair.b, {float(extent.x), float(extent.y), float(extent.z)}, lo, hi);
    bounds = {lo, hi, 0, 0};
  }
  return bucket_of(bounds, verdict, log2_ulp(pair), bucket);
}

// The same, all in double.
GRAZE_HD inline bool bucket_by_double(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace first_attempt;
  const Vec extent = extent_of(pair);
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  if (!(largest > 0)) return false;
  // Scaled, so that the extent is in [1, 2); exact, and differences carry one rounding.
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
