// SPDX-License-Identifier: Apache-2.0
// Projects two triangles onto a plane and tests separating axes in 2D. The thesis's two algorithms use it.
#pragma once

#include "core/algorithms/plane.h"
#include "core/algorithms/range.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

// Projects both triangles onto the plane and tests the six in-plane edge normals. Asks 12 questions.
// Reference: Maffina 2012, sections 3.1.2 and 3.1.3 (the listing is lost; the text describes it).
template <class Real, class Policy>
GRAZE_HD bool projections_intersect(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Plane<Real>& plane,
                                    const Policy& policy, int question) {
  const Vec3<Real> n = normalised(plane.normal);
  Vec3<Real> pa[3], pb[3];
  for (int i = 0; i < 3; ++i) {
    pa[i] = a[i] - n * (dot(a[i], n) + plane.d);
    pb[i] = b[i] - n * (dot(b[i], n) + plane.d);
  }
  for (int i = 0; i < 3; ++i) {
    const Vec3<Real> edge_normal_a = cross(n, pa[(i + 1) % 3] - pa[i]);
    if (!overlap(project(edge_normal_a, pa), project(edge_normal_a, pb), policy, question + 4 * i)) return false;
    const Vec3<Real> edge_normal_b = cross(n, pb[(i + 1) % 3] - pb[i]);
    if (!overlap(project(edge_normal_b, pa), project(edge_normal_b, pb), policy, question + 4 * i + 2)) return false;
  }
  return true;
}

}  // namespace GRAZE_FP
}  // namespace graze
