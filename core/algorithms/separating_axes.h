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
                                       "not mentioned; zero axes never separate, so degenerate pairs have too few axes",
                                       "changes rounding",
                                       true};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    const Vec3<Real> ea[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
    const Vec3<Real> eb[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
    const Vec3<Real> na = cross(ea[0], ea[1]), nb = cross(eb[0], eb[1]);
    if (separates(na, a, b, policy, 0) || separates(nb, a, b, policy, 2)) return Verdict::disjoint;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (separates(cross(ea[i], eb[j]), a, b, policy, 4 + 6 * i + 2 * j)) return Verdict::disjoint;
      }
    }
    for (int i = 0; i < 3; ++i) {
      if (separates(cross(na, ea[i]), a, b, policy, 22 + 4 * i) ||
          separates(cross(nb, eb[i]), a, b, policy, 24 + 4 * i))
        return Verdict::disjoint;
    }
    return Verdict::intersects;
  }

 private:
  template <class Real, class Policy>
  GRAZE_HD static bool separates(const Vec3<Real>& axis, const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3],
                                 const Policy& policy, int question) {
    return !overlap(project(axis, a), project(axis, b), policy, question);
  }

 public:
  template <class Questions>
  static void list(Questions& questions) {
    for (const char* axis : {"normal_a", "normal_b"}) questions.overlap(3, axis);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) questions.overlap(3, "edges", i, j);
    }
    for (int i = 0; i < 3; ++i) {
      for (const char* axis : {"in_plane_a", "in_plane_b"}) questions.overlap(4, axis, i);
    }
  }

  // The verdict `disjoint` depends only on the comparisons along the axis that separates.
  static constexpr bool kDisjointByOneAxis = true;
};

}  // namespace GRAZE_FP
}  // namespace graze
