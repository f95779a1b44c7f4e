// SPDX-License-Identifier: Apache-2.0
// Projections on an axis, and whether they overlap.
#pragma once

#include "core/epsilon_sites.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct Range {
  Real lo, hi;
};

// The range of direction . v over a triangle's vertices.
template <class Real>
GRAZE_HD Range<Real> project(const Vec3<Real>& direction, const Vec3<Real> (&v)[3]) {
  const Real first = dot(direction, v[0]);
  Range<Real> range{first, first};
  for (int i = 1; i < 3; ++i) {
    const Real t = dot(direction, v[i]);
    range.lo = t < range.lo ? t : range.lo;  // selections, because branches would be mispredicted
    range.hi = t > range.hi ? t : range.hi;
  }
  return range;
}

// Asks the policy two questions, `question` and the next one.
template <class Real, class Policy>
GRAZE_HD bool overlap(const Range<Real>& s, const Range<Real>& t, const Policy& policy, int question) {
  return !policy.less(At(Site::separation, question), s.hi, t.lo) &&
         !policy.less(At(Site::separation, question + 1), t.hi, s.lo);
}

}  // namespace GRAZE_FP
}  // namespace graze
