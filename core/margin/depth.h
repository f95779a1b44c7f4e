// SPDX-License-Identifier: Apache-2.0
// Certified bounds of the depth of two intersecting triangles: the least overlap along 11 axes, to which the faces of
// their Minkowski difference are square.
#pragma once

#include <cmath>

#include "core/margin/directions.h"
#include "core/margin/frame.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

// An upper bound, up to rounding, of |axis - exact| / (5 kHalfUlp) per component: with exact edges the accurate
// cross product is itself relatively exact; otherwise each product carries the errors of its two factors.
GRAZE_HD inline Vec3<double> axis_weight(const MarginFrame& f, int axis, const Vec3<double>& n) {
  if (f.exact) return magnitudes(n);
  const Vec3<double> u = magnitudes(axis == kNormalB ? f.edge_b[0] : f.edge_a[axis == kNormalA ? 0 : axis / 3]);
  const Vec3<double> v = magnitudes(axis == kNormalA ? f.edge_a[1] : f.edge_b[axis == kNormalB ? 1 : axis % 3]);
  return {u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x};
}

// Bounds of min(max n.a - min n.b, max n.b - min n.a) along a separating axis, which n is up to 5 kHalfUlp weight;
// |n| <= weight (1 + 5 kHalfUlp). A projection is off by at most (5 for n, 1 for the difference, 3 roundings)
// kHalfUlp sum(weight * |difference|); two roundings on the way to the overlap make that 11, and 12 has slack.
GRAZE_HD inline Interval overlap(const MarginFrame& f, int axis, const Vec3<double>& n, const Vec3<double>& weight) {
  Vec3<double> seen[3];
  const int own = seen_from_axis(f.a, f.b, axis, seen);
  double along[3], error[3];
  for (int k = 0; k < 3; ++k) {
    along[k] = dot(n, seen[k]);
    error[k] = 12 * kHalfUlp * dot(weight, magnitudes(seen[k]));
  }
  // The feature itself is at zero; the first projection belongs to either side.
  Interval least = {along[1] - error[1], along[1] + error[1]}, most = least, own_least = {0, 0}, own_most = {0, 0};
  include(least, most, along[2], error[2]);
  if (own == 1) include(own_least, own_most, along[0], error[0]);
  if (own == 0) include(least, most, along[0], error[0]);
  return {lesser(own_most.lo - least.hi, most.lo - own_least.hi),
          lesser(own_most.hi - least.lo, most.hi - own_least.lo)};
}

GRAZE_HD inline MarginBounds depth_bounds(const MarginFrame& f) {
  MarginBounds bounds = {INFINITY, INFINITY, 0, 0};
  double lowest[kSeparatingAxes];
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    const Vec3<double> n = direction(f, axis), weight = axis_weight(f, axis, n);
    const double weight_length = sqrt(dot(weight, weight));
    lowest[axis] = INFINITY;
    if (weight_length == 0) continue;  // parallel edges, or a flat triangle's normal: not an axis
    const double length = sqrt(dot(n, n)), length_error = 12 * kHalfUlp * weight_length;  // 5 + 3 roundings, slack
    const Interval o = overlap(f, axis, n, weight);
    lowest[axis] = greater(0.0, o.lo / (length + length_error) * (1 - 4 * kHalfUlp));
    bounds.lo = lesser(bounds.lo, lowest[axis]);
    if (length > length_error) bounds.hi = lesser(bounds.hi, o.hi / (length - length_error) * (1 + 4 * kHalfUlp));
  }
  if (bounds.lo == INFINITY) return {0, 0, 0, 0};  // no axis: both triangles lie on one line, or on parallel ones
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if (lowest[axis] <= bounds.hi && lowest[axis] < INFINITY) bounds.axes |= 1u << axis;
  }
  return bounds;
}

}  // namespace GRAZE_FP
}  // namespace graze
