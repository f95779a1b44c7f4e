// SPDX-License-Identifier: Apache-2.0
// Certified bounds on the depth of intersecting triangles, in double, from all axes or only from the axes that single
// precision leaves as candidates for the least overlap.
#pragma once

#include <cmath>

#include "core/exact/grid.h"
#include "core/margin/corners.h"
#include "core/margin/directions.h"
#include "core/margin/frame.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {
namespace first_attempt {

// Two numbers of an axis: the overlap of the projections times the axis's length, and the axis's squared length.
template <class Real>
struct Overlap {
  Real along, n2;
};

// The axis is perpendicular to the first edges of a and b if `edges`, else to a's face. The edge of a projects to 0.
template <class Real>
GRAZE_HD Overlap<Real> overlap_along(const Corners<Real>& a, const Corners<Real>& b, bool edges) {
  const Vec3<Real> u = a[1] - a[0], v = a[2] - a[0], w = b[1] - b[0];
  const Vec3<Real> n = cross(u, {edges ? w.x : v.x, edges ? w.y : v.y, edges ? w.z : v.z});
  const Real third = edges ? dot(n, v) : Real(0);
  const Real p = dot(n, b[0] - a[0]), q = dot(n, b[2] - a[0]), r = edges ? p : dot(n, b[1] - a[0]);
  const Real own_least = third < 0 ? third : Real(0), own_most = third > 0 ? third : Real(0);
  Real least = p < q ? p : q, most = p < q ? q : p;
  least = r < least ? r : least;
  most = r > most ? r : most;
  const Real over = own_most - least, under = most - own_least;
  return {over < under ? over : under, dot(n, n)};
}

// Factors that cover all single-precision roundings of a bound, upwards and downwards.
constexpr float kUp = 1 + 0x1p-19f, kDown = 1 - 0x1p-19f;

// u is the unit roundoff. A projection on an axis is a determinant of three differences, so the bound of
// core/exact/error_bound.h holds for it. An overlap has the errors of two projections and a rounding: 2 * 6 * 8 + 2. A
// component of an axis is off by (3 + 1) u times two products.
template <class Real>
struct AxisErrors {
  Real overlap;
  float length;
  GRAZE_HD AxisErrors(const Vec3<Real>& r, double u)
      : overlap(static_cast<Real>(98 * u) * r.x * r.y * r.z),
        length(static_cast<float>(static_cast<Real>(8 * u) * (r.y * r.z + r.z * r.x + r.x * r.y)) * 1.0001f) {}
};

// lo <= depth along the axis <= hi; 0 and infinity if nothing is known.
template <class Real>
GRAZE_HD void depth_bounds(const Overlap<Real>& seen, const AxisErrors<Real>& errors, float& lo, float& hi) {
  const float n2 = static_cast<float>(seen.n2);
  const float least = static_cast<float>(seen.along - errors.overlap),
              most = static_cast<float>(seen.along + errors.overlap);
  const bool tiny = !(n2 > 0x1p-100f), subnormal = !(least > 0x1p-100f);
  const float length = tiny ? 0x1p-49f : n2 * reciprocal_root(n2);
  lo = subnormal ? 0 : least * reciprocal(length * kUp + errors.length) * kDown;
  const float least_length = length * kDown - errors.length;
  hi = tiny || subnormal || !(least_length > 0) ? INFINITY : most * reciprocal(least_length) * kUp;
}

// Axis number `axis` of core/margin/directions.h, in double.
template <class Real>
GRAZE_HD void depth_along(const Corners<Real>& a, const Corners<Real>& b, int axis, const AxisErrors<double>& errors,
                          float& lo, float& hi) {
  const bool edges = axis < kNormalA, exchange = axis == kNormalB;
  Corners<Real> first, second;
  choose(exchange, b, a, first);
  choose(exchange, a, b, second);
  Corners<double> turned_a, turned_b;
  turn(first, edges ? axis / 3 : 0, turned_a);
  turn(second, edges ? axis % 3 : 0, turned_b);
  depth_bounds(overlap_along(turned_a, turned_b, edges), errors, lo, hi);
}

// Calls visit(k, overlap along axis k), for all axes of core/margin/directions.h.
template <class Real, class Visit>
GRAZE_HD void for_each_axis(const Corners<Real>& a, const Corners<Real>& b, const Visit& visit) {
  GRAZE_UNROLL
  for (int k = 0; k < kNormalA; ++k) {
    const int i = k / 3, j = k % 3;
    visit(k, overlap_along({a[i], a[(i + 1) % 3], a[(i + 2) % 3]}, {b[j], b[(j + 1) % 3], b[(j + 2) % 3]}, true));
  }
  visit(kNormalA, overlap_along(a, b, false));
  visit(kNormalB, overlap_along(b, a, false));
}

// lo <= depth <= hi. Single precision rules out axes; the rest are computed in double, or lo is 0 if too many remain.
GRAZE_HD inline void depth_in_single(const Corners<float>& a, const Corners<float>& b, const Vec3<float>& extent,
                                     float& lo, float& hi) {
  const AxisErrors<float> errors(extent * 1.0001f, 0x1p-24);
  const AxisErrors<double> errors_in_double(widen(extent) * 1.0001, kHalfUlp);
  float lowest[kSeparatingAxes], least = INFINITY;
  int first = 0;
  for_each_axis(a, b, [&](int k, const Overlap<float>& seen) {
    float ignored;
    depth_bounds(seen, errors, lowest[k], ignored);
    first = lowest[k] < least ? k : first;
    least = lowest[k] < least ? lowest[k] : least;
  });
  depth_along(a, b, first, errors_in_double, lo, hi);
  unsigned left = 0;
  int count = 0;
  GRAZE_UNROLL
  for (int k = 0; k < kSeparatingAxes; ++k) {
    const bool open = k != first && !(lowest[k] >= lo);
    left |= (open ? 1u : 0u) << k;
    count += open;
  }
  if (count > 3) lo = 0;
  while (left != 0 && lo > 0) {
    const int k = exact::detail::trailing_zeros(left);
    left &= left - 1;
    float lo_k, hi_k;
    depth_along(a, b, k, errors_in_double, lo_k, hi_k);
    lo = lo_k < lo ? lo_k : lo;
    hi = hi_k < hi ? hi_k : hi;
  }
}

GRAZE_HD inline void depth_in_double(const Corners<double>& a, const Corners<double>& b, const Vec& extent, float& lo,
                                     float& hi) {
  const AxisErrors<double> errors(extent, kHalfUlp);
  lo = INFINITY;
  hi = INFINITY;
  for_each_axis(a, b, [&](int, const Overlap<double>& seen) {
    float lo_k, hi_k;
    depth_bounds(seen, errors, lo_k, hi_k);
    lo = lo_k < lo ? lo_k : lo;
    hi = hi_k < hi ? hi_k : hi;
  });
}

}  // namespace first_attempt
}  // namespace GRAZE_FP
}  // namespace graze
