// SPDX-License-Identifier: Apache-2.0
// The thesis's first algorithm (Maffina 2012, section 3.1): plane-side rejects, then a 2D separating-axis test of
// the projections onto the first triangle's plane. Known to be wrong by logic; kept as a planted defect.
#pragma once

#include <cmath>

#include "core/algorithms/algorithm.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct Plane {
  Vec3<Real> normal;  // (v1 - v0) x (v2 - v0), not normalised
  Vec3<Real> point;   // v0
  Real d;             // normal . (0 - point)

  GRAZE_HD explicit Plane(const Vec3<Real> (&v)[3])
      : normal(cross(v[1] - v[0], v[2] - v[0])), point(v[0]), d(distance({Real(0), Real(0), Real(0)})) {}

  // Signed distance of v times |normal|.
  GRAZE_HD Real distance(const Vec3<Real>& v) const { return dot(normal, v - point); }
};

template <class Real>
GRAZE_HD bool strictly_one_side(const Real (&distance)[3]) {
  const Real zero(0);
  return (distance[0] > zero && distance[1] > zero && distance[2] > zero) ||
         (distance[0] < zero && distance[1] < zero && distance[2] < zero);
}

template <class Real>
GRAZE_HD Vec3<Real> normalised(const Vec3<Real>& v) {
  using std::sqrt;
  const Real length = sqrt(dot(v, v));
  return {v.x / length, v.y / length, v.z / length};
}

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
    range.lo = t < range.lo ? t : range.lo;  // selections, not branches: which vertex is extreme is anyone's guess
    range.hi = t > range.hi ? t : range.hi;
  }
  return range;
}

template <class Real, class Policy>
GRAZE_HD bool overlap(const Range<Real>& s, const Range<Real>& t, const Policy& policy) {
  return !policy.less(Site::separation, s.hi, t.lo) && !policy.less(Site::separation, t.hi, s.lo);
}

// Projects both triangles onto the plane and separates them along the six in-plane edge normals.
// Reference: Maffina 2012, sections 3.1.2 and 3.1.3 (the listing is lost; the text describes it).
template <class Real, class Policy>
GRAZE_HD bool projections_intersect(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Plane<Real>& plane,
                                    const Policy& policy) {
  const Vec3<Real> n = normalised(plane.normal);
  Vec3<Real> pa[3], pb[3];
  for (int i = 0; i < 3; ++i) {
    pa[i] = a[i] - n * (dot(a[i], n) + plane.d);
    pb[i] = b[i] - n * (dot(b[i], n) + plane.d);
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3<Real> edge_normal_a = cross(n, pa[(i + 1) % 3] - pa[i]);
    if (!overlap(project(edge_normal_a, pa), project(edge_normal_a, pb), policy)) return false;
    const Vec3<Real> edge_normal_b = cross(n, pb[(i + 1) % 3] - pb[i]);
    if (!overlap(project(edge_normal_b, pa), project(edge_normal_b, pb), policy)) return false;
  }
  return true;
}

// Signed distances of the vertices v to the plane, each through the policy.
template <class Real, class Policy>
GRAZE_HD void plane_distances(const Plane<Real>& plane, const Vec3<Real> (&v)[3], const Policy& policy,
                              Real (&distance)[3]) {
  for (int i = 0; i < 3; ++i) distance[i] = policy.snap(Site::plane_distance, plane.distance(v[i]));
}

struct ProjectedSat {
  static constexpr AlgorithmInfo kInfo{"projected_sat",
                                       "Maffina 2012, first version (section 3.1)",
                                       "the projections' 2D test decides",
                                       "says nothing; a zero normal divides by zero",
                                       "depends: projects onto the first triangle's plane",
                                       false};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    Real distance[3];
    const Plane<Real> plane_a(a);
    plane_distances(plane_a, b, policy, distance);
    if (strictly_one_side(distance)) return Verdict::disjoint;
    plane_distances(Plane<Real>(b), a, policy, distance);
    if (strictly_one_side(distance)) return Verdict::disjoint;
    return verdict_of(projections_intersect(a, b, plane_a, policy));
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
