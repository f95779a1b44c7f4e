// SPDX-License-Identifier: Apache-2.0
// Certified bounds on the depth of two intersecting triangles: the least overlap along 11 axes. The faces of the
// triangles' Minkowski difference are perpendicular to these axes.
#pragma once

#include <cmath>

#include "core/margin/directions.h"
#include "core/margin/frame.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

// Upper bound, up to rounding, on |axis - exact| / (5 kRoundoff) per component. If the edges are exact, the accurate
// cross product has a small relative error. Otherwise each product carries the errors of its two factors.
template <class Real>
GRAZE_HD Vec3<Real> axis_weight(const MarginFrame<Real>& f, int axis, const Vec3<Real>& n) {
  if (f.exact) return magnitudes(n);
  const Vec3<Real> u = magnitudes(axis == kNormalB ? f.edge_b[0] : f.edge_a[axis == kNormalA ? 0 : axis / 3]);
  const Vec3<Real> v = magnitudes(axis == kNormalA ? f.edge_a[1] : f.edge_b[axis == kNormalB ? 1 : axis % 3]);
  return {u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x};
}

// Bounds on min(max n.a - min n.b, max n.b - min n.a) along a separating axis. n is off by up to 5 kRoundoff weight,
// and |n| <= weight (1 + 5 kRoundoff). A projection is off by at most (5 for n, 1 for the difference, 3 roundings)
// kRoundoff sum(weight * |difference|). With two more roundings in the overlap, the total is 11; 12 leaves slack.
template <class Real>
GRAZE_HD Interval<Real> overlap(const MarginFrame<Real>& f, int axis, const Vec3<Real>& n, const Vec3<Real>& weight) {
  Vec3<Real> seen[3];
  const int own = seen_from_axis(f.a, f.b, axis, seen);
  Real along[3], error[3];
  for (int k = 0; k < 3; ++k) {
    along[k] = dot(n, seen[k]);
    error[k] = Real(12 * kRoundoff<Real>) * dot(weight, magnitudes(seen[k]));
  }
  // The feature itself projects to zero. seen[0] belongs to the feature's triangle if `own` is 1, else to the other.
  Interval<Real> least = {along[1] - error[1], along[1] + error[1]}, most = least;
  Interval<Real> own_least = {0, 0}, own_most = {0, 0};
  include(least, most, along[2], error[2]);
  if (own == 1) include(own_least, own_most, along[0], error[0]);
  if (own == 0) include(least, most, along[0], error[0]);
  return {lesser(own_most.lo - least.hi, most.lo - own_least.hi),
          lesser(own_most.hi - least.lo, most.hi - own_least.lo)};
}

template <class Real>
GRAZE_HD MarginBounds depth_bounds(const MarginFrame<Real>& f) {
  MarginBounds bounds = {INFINITY, INFINITY, 0, 0};
  double lowest[kSeparatingAxes];
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    const Vec3<Real> n = direction(f, axis), weight = axis_weight(f, axis, n);
    const double weight_length = sqrt(as_double(dot(weight, weight)));
    lowest[axis] = INFINITY;
    if (weight_length == 0) continue;  // parallel edges, or a flat triangle's normal: not an axis
    // 12 is 5 for n, 3 roundings, and slack. The factors 1 ± 8 kHalfUlp cover the roots, which are only doubles.
    const double length = sqrt(as_double(dot(n, n))), length_error = 12 * kRoundoff<Real> * weight_length;
    const Interval<Real> o = overlap(f, axis, n, weight);
    lowest[axis] = greater(0.0, as_double(o.lo) / (length + length_error) * (1 - 8 * kHalfUlp));
    bounds.lo = lesser(bounds.lo, lowest[axis]);
    const double hi = as_double(o.hi) / (length - length_error) * (1 + 8 * kHalfUlp);
    if (length > length_error) bounds.hi = lesser(bounds.hi, hi);
  }
  if (bounds.lo == INFINITY) return {0, 0, 0, 0};  // no axis: both triangles lie on one line or on parallel lines
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if (lowest[axis] <= bounds.hi && lowest[axis] < INFINITY) bounds.axes |= 1u << axis;
  }
  return bounds;
}

}  // namespace GRAZE_FP
}  // namespace graze
