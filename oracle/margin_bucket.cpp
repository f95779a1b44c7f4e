// SPDX-License-Identifier: Apache-2.0
// Finds the margin's bucket. Certified bounds, in double or, for pairs of doubles, in double-double, nearly always
// decide the bucket; exact integers decide the rest.
#include <cmath>

#include "core/margin/margin.h"
#include "core/margin/scaled_pair.h"
#include "oracle/exact_margin.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

// Whether the intersecting hulls only touch: along one of the given nonzero axes, they have no overlap.
// Exact: always. An axis n has degree two, and an overlap dot(n, p - q) of two vertices has degree three (kSmallBits).
bool touches(const SmallPair& small, std::uint32_t axes) {
  const auto& [a, b] = widened(small);
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if ((axes >> axis & 1u) == 0) continue;
    const Vec3<__int128> n = integer_direction(a, b, axis);
    if (!is_zero(n) && integer_overlap(a, b, axis, n) == 0) return true;
  }
  return false;
}

// Bounds on the margin, in units in which the pair's ulp is 2^ulp.
struct Bounds {
  MarginBounds margin;
  int ulp;
};

Bounds bounds_of(const Pair& pair, Verdict verdict) { return {margin_bounds(pair, verdict), log2_ulp(pair)}; }
Bounds bounds_of(const DoublePair& pair, Verdict verdict) {
  const ScaledPair scaled(pair);
  if (!scaled.fits) return {{0, INFINITY, 0, kAllAxes}, 0};
  return {margin_bounds<DoubleDouble>(scaled.pair, verdict), scaled.ulp};
}

template <class Real>
Bucket bucket_of(const BasicPair<Real>& pair, Verdict verdict) {
  const Bounds bounds = bounds_of(pair, verdict);
  Bucket bucket;
  if (bucket_from_bounds(bounds.margin, verdict, bounds.ulp, bucket)) return bucket;

  const Grid grid = grid_of(pair);
  const int ulp = log2_ulp(pair);
  if (verdict == Verdict::intersects) {
    if (grid.is_small() && touches(small_integers(pair, grid), bounds.margin.axes)) return 0;
    const SquaredMargin depth = exact_depth(large_integers(pair, grid), grid.exponent, bounds.margin.axes);
    return depth.numerator == 0 ? Bucket{0} : make_bucket(-1, floor_log2(depth) - ulp);
  }
  // If the bounds straddle a power of two, the distance is usually that power. The rounded lower bound lies just below
  // it; the exact lower bound does not.
  const LargePair large = large_integers(pair, grid);
  const SquaredMargin lower = exact_separation(large, grid.exponent, bounds.margin.direction);
  if (lower.numerator != 0) {
    const Bucket nearest = make_bucket(1, floor_log2(lower) - ulp);
    if (nearest == make_bucket(1, graze::floor_log2(bounds.margin.hi) - bounds.ulp)) return nearest;
  }
  return make_bucket(1, floor_log2(exact_distance(large, grid.exponent)) - ulp);
}

}  // namespace

Bucket margin_bucket(const Pair& pair, Verdict verdict) { return bucket_of(pair, verdict); }
Bucket margin_bucket(const DoublePair& pair, Verdict verdict) { return bucket_of(pair, verdict); }

}  // namespace graze::oracle
