// SPDX-License-Identifier: Apache-2.0
// The margin's bucket. Certified double-precision bounds nearly always decide it, otherwise integers. Nothing is
// rounded.
#include "core/margin/margin.h"
#include "oracle/exact_margin.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using Int128 = __int128;

// Whether the intersecting hulls only touch: some nonzero axis among these has no overlap.
// Exact: always. An axis n has degree two, and an overlap n . (p - q) of two vertices has degree three (kSmallBits).
bool touches(const SmallPair& small, std::uint32_t axes) {
  Vec3<Int128> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = {small.a[i].x, small.a[i].y, small.a[i].z};
    b[i] = {small.b[i].x, small.b[i].y, small.b[i].z};
  }
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if ((axes >> axis & 1u) == 0) continue;
    const Vec3<Int128> n = integer_direction(a, b, axis);
    if ((n.x != 0 || n.y != 0 || n.z != 0) && integer_overlap(a, b, axis, n) == 0) return true;
  }
  return false;
}

}  // namespace

Bucket margin_bucket(const Pair& pair, Verdict verdict) {
  const int ulp = log2_ulp(pair);
  const MarginBounds bounds = margin_bounds(pair, verdict);
  Bucket bucket;
  if (bucket_from_bounds(bounds, verdict, ulp, bucket)) return bucket;

  const Grid grid = grid_of(pair);
  if (verdict == Verdict::intersects) {
    if (grid.is_small() && touches(small_integers(pair, grid), bounds.axes)) return 0;
    const SquaredMargin depth = exact_depth(large_integers(pair, grid), grid.exponent, bounds.axes);
    return depth.numerator == 0 ? Bucket{0} : make_bucket(-1, floor_log2(depth) - ulp);
  }
  // Most often the distance is a power of two. The rounded lower bound just misses it; an exact lower bound does not.
  const LargePair large = large_integers(pair, grid);
  const SquaredMargin lower = exact_separation(large, grid.exponent, bounds.direction);
  if (lower.numerator != 0) {
    const Bucket nearest = make_bucket(1, floor_log2(lower) - ulp);
    if (nearest == make_bucket(1, graze::floor_log2(bounds.hi) - ulp)) return nearest;
  }
  return make_bucket(1, floor_log2(exact_distance(large, grid.exponent)) - ulp);
}

Bucket margin_bucket(const DoublePair& pair, Verdict verdict) {
  const Grid grid = grid_of(pair);
  const LargePair large = large_integers(pair, grid);
  const bool apart = verdict == Verdict::disjoint;
  const SquaredMargin margin =
      apart ? exact_distance(large, grid.exponent) : exact_depth(large, grid.exponent, kAllAxes);
  if (margin.numerator == 0) return 0;
  return make_bucket(apart ? 1 : -1, floor_log2(margin) - log2_ulp(pair));
}

}  // namespace graze::oracle
