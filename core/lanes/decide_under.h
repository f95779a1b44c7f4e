// SPDX-License-Identifier: Apache-2.0
// Decides a pair with an algorithm under a policy other than zero, on host and device alike.
#pragma once

#include "core/lanes/tolerances.h"
#include "core/lanes/with_error_bound.h"
#include "core/verdict.h"

namespace graze {
inline namespace GRAZE_FP {

// Number is Real, or WithMagnitude<Real> if tolerances are relative.
template <class Algorithm, class Number, class Real>
GRAZE_HD Verdict decide_within(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Tolerances<Real>& tolerances) {
  Vec3<Number> p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = {Number(a[i].x), Number(a[i].y), Number(a[i].z)};
    q[i] = {Number(b[i].x), Number(b[i].y), Number(b[i].z)};
  }
  return Algorithm::decide(p, q, tolerances);
}

// Whether the triangle certainly has a nonzero area. Published algorithms promise nothing for triangles without area.
template <class Real>
GRAZE_HD bool certainly_proper(const Vec3<WithErrorBound<Real>> (&v)[3]) {
  const Vec3<WithErrorBound<Real>> normal = cross(v[1] - v[0], v[2] - v[0]);
  return normal.x.is_nonzero() || normal.y.is_nonzero() || normal.z.is_nonzero();
}

// The exact verdict, or declined. For `disjoint`, one axis that certainly separates is enough, despite other doubts.
// Exact: for algorithms that are right without rounding.
template <class Algorithm, class Real>
GRAZE_HD Verdict decide_bounded(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3]) {
  using Number = WithErrorBound<Real>;
  bool doubt = false;
  Vec3<Number> p[3], q[3];
  for (int i = 0; i < 3; ++i) {
    p[i] = {Number(a[i].x, &doubt), Number(a[i].y, &doubt), Number(a[i].z, &doubt)};
    q[i] = {Number(b[i].x, &doubt), Number(b[i].y, &doubt), Number(b[i].z, &doubt)};
  }
  if (!certainly_proper(p) || !certainly_proper(q)) return Verdict::declined;
  const Verdict verdict = Algorithm::decide(p, q, ExactZero{});
  if constexpr (requires { Algorithm::kDisjointByOneAxis; }) doubt = doubt && verdict != Verdict::disjoint;
  return doubt ? Verdict::declined : verdict;
}

}  // namespace GRAZE_FP
}  // namespace graze
