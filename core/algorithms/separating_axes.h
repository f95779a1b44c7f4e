// SPDX-License-Identifier: Apache-2.0
// Separating axes. Theorem: Gottschalk, Lin, Manocha 1996 (OBBTree). Triangles: Schneider and Eberly 2002, section 7.7.
// Axes: both face normals, the nine cross products of edges, and the six in-plane edge normals.
#pragma once

#include "core/algorithms/algorithm.h"
#include "core/algorithms/range.h"

namespace graze {
inline namespace GRAZE_FP {

struct SeparatingAxes {
  static constexpr AlgorithmInfo kInfo{"separating_axes",
                                       "Gottschalk, Lin, Manocha 1996; Schneider and Eberly 2002, section 7.7",
                                       "the in-plane edge normals separate",
                                       "says nothing; zero axes never separate, so degenerate pairs lack axes",
                                       "depends in rounding",
                                       true};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    const Vec3<Real> ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Vec3<Real> eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Vec3<Real> na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
    if (separates(na, a, b, policy) || separates(nb, a, b, policy)) return Verdict::disjoint;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (separates(cross(ea[i], eb[j]), a, b, policy)) return Verdict::disjoint;
      }
    }
    for (int i = 0; i < 3; ++i) {
      if (separates(cross(na, ea[i]), a, b, policy) || separates(cross(nb, eb[i]), a, b, policy))
        return Verdict::disjoint;
    }
    return Verdict::intersects;
  }

 private:
  template <class Real, class Policy>
  GRAZE_HD static bool separates(const Vec3<Real>& axis, const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3],
                                 const Policy& policy) {
    return !overlap(project(axis, a), project(axis, b), policy);
  }

 public:
  // A verdict of disjoint depends only on the comparisons along the axis that separates.
  static constexpr bool kDisjointByOneAxis = true;
};

}  // namespace GRAZE_FP
}  // namespace graze
