// SPDX-License-Identifier: Apache-2.0
// Triangles that share a vertex, as neighbours in a mesh do. They always intersect; rounding cannot change that.
#pragma once

#include "core/exact/error_bound.h"
#include "core/exact/relation.h"
#include "core/exact/vector.h"

namespace graze::exact::detail {

// A vertex that a and b share, as 3 * its index in a + its index in b; -1 if there is none.
template <class Real>
GRAZE_HD int shared_vertex(const Real* a, const Real* b) {
  int found = -1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool same = a[3 * i] == b[3 * j] && a[3 * i + 1] == b[3 * j + 1] && a[3 * i + 2] == b[3 * j + 2];
      found = same ? 3 * i + j : found;
    }
  }
  return found;
}

// The relation of two triangles with a common vertex. Let p be the signs of the heights of b's other vertices over a's
// plane, and q those of a's over b's. If some plane through the vertex separates the triangles, they meet only in the
// vertex; otherwise they meet in a segment that ends there. Candidates are a's plane (p1 == p2), b's plane (q1 == q2),
// and the planes through an edge of each triangle; their determinants are the same four numbers.
// Returns: false if a sign is in doubt.
template <class Real>
GRAZE_HD bool relate_at_vertex(const Real* a, const Real* b, int shared, Relation& r) {
  const double error = determinant_error<Real>(extent_of(a, b));
  const unsigned i = static_cast<unsigned>(shared) / 3, j = static_cast<unsigned>(shared) % 3;
  const auto seen = [](const Real* v, unsigned k, const Vec<Real>& from) {
    const Vec<Real> at = vertex(v, k);
    return Vec<double>{double(at.x) - from.x, double(at.y) - from.y, double(at.z) - from.z};
  };
  const Vec<Real> from = vertex(a, i);
  const Vec<double> a1 = seen(a, (i + 1) % 3, from), a2 = seen(a, (i + 2) % 3, from);
  const Vec<double> b1 = seen(b, (j + 1) % 3, from), b2 = seen(b, (j + 2) % 3, from);
  const Vec<double> normal_a = cross<double>(a1, a2), normal_b = cross<double>(b1, b2);
  const double heights[4] = {dot<double>(normal_a, b1), dot<double>(normal_a, b2), dot<double>(normal_b, a1),
                             dot<double>(normal_b, a2)};
  unsigned above = 0;
  for (unsigned k = 0; k < 4; ++k) {
    if (!(heights[k] > error || heights[k] < -error)) return false;
    if (heights[k] > 0) above |= 1u << k;  // GCC 12 miscompiles `(heights[k] > 0) << k` with sanitizers
  }
  const bool p1 = above & 1, p2 = above >> 1 & 1, q1 = above >> 2 & 1, q2 = above >> 3 & 1;
  const bool parted = p1 == p2 || q1 == q2 || p1 == q1;
  r = {Verdict::intersects, parted ? Contact::point : Contact::segment, parted ? 0 : -1, {}};
  return true;
}

}  // namespace graze::exact::detail
