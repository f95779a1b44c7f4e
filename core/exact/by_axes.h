// SPDX-License-Identifier: Apache-2.0
// The decision by axes: separating axes of the Minkowski difference of a and b. This decision handles proper, coplanar
// and degenerate pairs alike, and also finds the contact, the margin's sign and the hulls.
// Reference for the theorem: Gottschalk, Lin and Manocha 1996 (OBBTree).
#pragma once

#include "core/exact/axes.h"
#include "core/exact/relation.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

// Rank of up to four vectors.
template <class Numbers>
GRAZE_HD int rank(const VecOf<Numbers> (&v)[4]) {
  using M = typename Numbers::M;
  using T = typename Numbers::T;
  int most_so_far = 0;
  for (int i = 0; i < 4; ++i) {
    if (is_zero(v[i])) continue;
    most_so_far = most_so_far < 1 ? 1 : most_so_far;
    for (int j = 0; j < i; ++j) {
      const Vec<M> n = cross<M>(v[i], v[j]);
      if (is_zero(n)) continue;
      most_so_far = most_so_far < 2 ? 2 : most_so_far;
      for (int k = 0; k < j; ++k) {
        if (!(dot<T>(n, v[k]) == T(0))) return 3;
      }
    }
  }
  return most_so_far;
}

// Two directions that span the hull of the vertices in the mask. A direction that is not needed is zero.
template <class D>
GRAZE_HD void directions(const Vec<D> (&v)[3], unsigned mask, Vec<D>& first, Vec<D>& second) {
  const int from = mask & 1 ? 0 : mask & 2 ? 1 : 2;
  first = mask & 2 ? v[1] - v[from] : v[0] - v[0];
  second = mask & 4 ? v[2] - v[from] : v[0] - v[0];
}

// If a and b intersect, the origin lies inside one face F of D. F is the difference of a face A of a and a face B of b;
// the interiors of A and B meet. The common set of a and b is that of A and B; its dimension is dim A + dim B - dim F.
template <class Numbers>
GRAZE_HD Relation by_axes(const Triangles<Numbers>& t) {
  const AxisEvidence seen = look<Numbers>(t);
  VecOf<Numbers> v[4];
  const VecOf<Numbers> zero = t.a[0] - t.a[0];
  const auto dimension = [&](unsigned in_a, unsigned in_b) {
    v[0] = v[1] = v[2] = v[3] = zero;
    if (in_a) directions(t.a, in_a, v[0], v[1]);
    if (in_b) directions(t.b, in_b, v[2], v[3]);
    return rank<Numbers>(v);
  };
  Relation r;
  r.hulls = {dimension(7, 0), dimension(0, 7), seen.coplanar};
  if (seen.separated) return r;
  r.verdict = Verdict::intersects;
  r.margin_sign = seen.flat || seen.touching ? 0 : -1;
  r.contact = contact_of(dimension(seen.face_a, 0) + dimension(0, seen.face_b) - dimension(seen.face_a, seen.face_b));
  return r;
}

}  // namespace graze::exact::detail
