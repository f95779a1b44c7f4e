// SPDX-License-Identifier: Apache-2.0
// Certified double-precision bounds on a pair's margin, given its verdict. The bounds nearly always decide the bucket.
#pragma once

#include "core/margin/bucket.h"
#include "core/margin/depth.h"
#include "core/margin/directions.h"
#include "core/margin/distance.h"
#include "core/margin/frame.h"
#include "core/pair.h"
#include "core/verdict.h"

namespace graze {
inline namespace GRAZE_FP {

// Certified bounds on |margin|. Real: double, or DoubleDouble, whose bounds are tighter after much cancellation.
// Requires: finite floats, or doubles on the grid of floats; verdict is the pair's true verdict, not declined.
template <class Real = double, class Coordinate>
GRAZE_HD MarginBounds margin_bounds(const BasicPair<Coordinate>& pair, Verdict verdict) {
  const MarginFrame<Real> frame = make_margin_frame<Real>(pair);
  return verdict == Verdict::disjoint ? distance_bounds(frame) : depth_bounds(frame);
}

// Whether the bounds allow only one bucket, and which one. The margin of a disjoint pair is known not to be zero.
GRAZE_HD inline bool bucket_from_bounds(const MarginBounds& bounds, Verdict verdict, int log2_ulp, Bucket& bucket) {
  const int sign = verdict == Verdict::disjoint ? 1 : -1;
  bucket = 0;
  if (sign < 0 && bounds.hi == 0) return true;
  if (sign < 0 && bounds.lo <= 0) return false;
  bucket = make_bucket(sign, floor_log2(bounds.hi) - log2_ulp);
  return bucket == make_bucket(sign, floor_log2(bounds.lo) - log2_ulp);
}

}  // namespace GRAZE_FP
}  // namespace graze
