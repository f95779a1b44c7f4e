// SPDX-License-Identifier: Apache-2.0
// The thesis's first algorithm (Maffina 2012, section 3.1): plane-side rejects, then a 2D separating-axis test of the
// projections onto the first triangle's plane. Its logic is known to be wrong; it is kept as a known defect.
#pragma once

#include "core/algorithms/algorithm.h"
#include "core/algorithms/plane.h"
#include "core/algorithms/plane_projection.h"

namespace graze {
inline namespace GRAZE_FP {

struct ProjectedSat {
  static constexpr AlgorithmInfo kInfo{"projected_sat",
                                       "Maffina 2012, first version (section 3.1)",
                                       "the projections' 2D test decides",
                                       "not mentioned; a zero normal causes division by zero",
                                       "matters: projects onto the first triangle's plane",
                                       false,
                                       false};
  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    Real distance[3];
    const Plane<Real> plane_a(a);
    plane_distances(plane_a, b, policy, 0, distance);
    if (strictly_one_side(distance)) return Verdict::disjoint;
    plane_distances(Plane<Real>(b), a, policy, 3, distance);
    if (strictly_one_side(distance)) return Verdict::disjoint;
    return verdict_of(projections_intersect(a, b, plane_a, policy, 6));
  }

  template <class Questions>
  static void list(Questions& questions) {
    questions.plane_distances();
    questions.projections(2);
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
