// SPDX-License-Identifier: Apache-2.0
// Triangles that share a vertex, as neighbours in a mesh do: they intersect, whatever else is in doubt.
#pragma once

#include "core/exact/error_bound.h"
#include "core/exact/relation.h"
#include "core/exact/vector.h"

namespace graze::exact::detail {

// A vertex of a that is a vertex of b, as 3 * its place in a + that in b; -1 without one.
GRAZE_HD inline int shared_vertex(const float* a, const float* b) {
  int found = -1;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const bool same = a[3 * i] == b[3 * j] && a[3 * i + 1] == b[3 * j + 1] && a[3 * i + 2] == b[3 * j + 2];
      found = same ? 3 * i + j : found;
    }
  }
  return found;
}

// The relation of two triangles with one vertex in common, seen from it. Let p and q be the signs of the heights of b's
// other vertices over a's plane and of a's over b's. Some plane through the vertex leaves a on one side and b on the
// other if that of a does (p is the same twice), or that of b, or one spanned by an edge of each; the determinants of
// these are the same four numbers. Then the triangles meet in the vertex alone; else in a segment that ends there.
// Returns: false when a sign is in doubt.
GRAZE_HD inline bool relate_at_vertex(const float* a, const float* b, int shared, Relation& r) {
  const double error = determinant_error(extent_of(a, b));
  const unsigned i = static_cast<unsigned>(shared) / 3, j = static_cast<unsigned>(shared) % 3;
  const auto seen = [](const float* v, unsigned k, const Vec<float>& from) {
    const Vec<float> at = vertex(v, k);
    return Vec<double>{double(at.x) - from.x, double(at.y) - from.y, double(at.z) - from.z};
  };
  const Vec<float> from = vertex(a, i);
  const Vec<double> a1 = seen(a, (i + 1) % 3, from), a2 = seen(a, (i + 2) % 3, from);
  const Vec<double> b1 = seen(b, (j + 1) % 3, from), b2 = seen(b, (j + 2) % 3, from);
  const Vec<double> normal_a = cross<double>(a1, a2), normal_b = cross<double>(b1, b2);
  const double heights[4] = {dot<double>(normal_a, b1), dot<double>(normal_a, b2), dot<double>(normal_b, a1),
                             dot<double>(normal_b, a2)};
  unsigned above = 0;
  for (unsigned k = 0; k < 4; ++k) {
    if (!(heights[k] > error || heights[k] < -error)) return false;
    if (heights[k] > 0) above |= 1u << k;  // `(heights[k] > 0) << k` GCC 12 compiles wrongly with sanitizers
  }
  const bool p1 = above & 1, p2 = above >> 1 & 1, q1 = above >> 2 & 1, q2 = above >> 3 & 1;
  const bool parted = p1 == p2 || q1 == q2 || p1 == q1;
  r = {Verdict::intersects, parted ? Contact::point : Contact::segment, parted ? 0 : -1, {}};
  return true;
}

}  // namespace graze::exact::detail
