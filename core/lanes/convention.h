// SPDX-License-Identifier: Apache-2.0
// Tells on which pairs a convention accepts either answer (Outside, in lanes.h).
#pragma once

#include "core/exact/relation.h"
#include "core/exact/shared_vertex.h"
#include "core/lanes/lanes.h"
#include "core/pair.h"

namespace graze {

// outside: the excluded kinds, as a bitwise OR of Outside flags.   Requires: finite coordinates; `truth` is the pair's
// truth.
template <class Real>
bool is_outside(unsigned outside, const BasicPair<Real>& pair, const Relation& truth) {
  const Hulls& hulls = truth.hulls;
  return (outside & kOutsideTouching && truth.touches() && truth.contact != Contact::area) ||
         (outside & kOutsideCoplanar && hulls.coplanar) ||
         (outside & kOutsideDegenerate && (hulls.dimension_a < 2 || hulls.dimension_b < 2)) ||
         (outside & kOutsideShared && exact::detail::shared_vertex(&pair.a[0].x, &pair.b[0].x) >= 0);
}

}  // namespace graze
