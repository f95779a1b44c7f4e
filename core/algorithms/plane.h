// SPDX-License-Identifier: Apache-2.0
// A triangle's plane, and on which side of it points lie.
#pragma once

#include <cmath>

#include "core/epsilon_sites.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
GRAZE_HD Vec3<Real> normalised(const Vec3<Real>& v) {
  using std::sqrt;
  const Real length = sqrt(dot(v, v));
  return {v.x / length, v.y / length, v.z / length};
}

template <class Real>
struct Plane {
  Vec3<Real> normal;  // (v1 - v0) x (v2 - v0), not normalised
  Vec3<Real> point;   // v0
  Real d;             // normal . (0 - point)

  GRAZE_HD explicit Plane(const Vec3<Real> (&v)[3])
      : normal(cross(v[1] - v[0], v[2] - v[0])), point(v[0]), d(distance({Real(0), Real(0), Real(0)})) {}

  // Signed distance of v to the plane, times |normal|.
  GRAZE_HD Real distance(const Vec3<Real>& v) const { return dot(normal, v - point); }
};

template <class Real>
GRAZE_HD bool strictly_one_side(const Real (&distance)[3]) {
  const Real zero(0);
  return (distance[0] > zero && distance[1] > zero && distance[2] > zero) ||
         (distance[0] < zero && distance[1] < zero && distance[2] < zero);
}

// The vertices' signed distances to the plane, times |normal|, each snapped by the policy. Asks three questions.
template <class Real, class Policy>
GRAZE_HD void plane_distances(const Plane<Real>& plane, const Vec3<Real> (&v)[3], const Policy& policy, int question,
                              Real (&distance)[3]) {
  for (int i = 0; i < 3; ++i) distance[i] = policy.snap(At(Site::plane_distance, question + i), plane.distance(v[i]));
}

}  // namespace GRAZE_FP
}  // namespace graze
