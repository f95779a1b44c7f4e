// SPDX-License-Identifier: Apache-2.0
// Pairs on which a convention accepts either answer (Outside, in lanes.h).
#pragma once

#include "core/exact/relation.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze {

template <class Real>
bool share_a_vertex(const BasicPair<Real>& pair) {
  for (const Vec3<Real>& a : pair.a) {
    for (const Vec3<Real>& b : pair.b) {
      if (a.x == b.x && a.y == b.y && a.z == b.z) return true;
    }
  }
  return false;
}

// outside: a sum of Outside.   Requires: finite coordinates; `truth` is the pair's truth.
template <class Real>
bool is_outside(unsigned outside, const BasicPair<Real>& pair, const Relation& truth) {
  const Hulls& hulls = truth.hulls;
  return (outside & kOutsideTouching && truth.touches() && truth.contact != Contact::area) ||
         (outside & kOutsideCoplanar && hulls.coplanar) ||
         (outside & kOutsideDegenerate && (hulls.dimension_a < 2 || hulls.dimension_b < 2)) ||
         (outside & kOutsideShared && share_a_vertex(pair));
}

}  // namespace graze
