// SPDX-License-Identifier: Apache-2.0
// The numbered directions along which margins are measured, and bounds on a margin with their direction.
#pragma once

#include <cstdint>

#include "core/vec3.h"

namespace graze {

// Directions along which two triangles are compared. i and j run over 0..2; edge i goes from vertex i to i + 1.
//   3i + j: a's edge i x b's edge j     9, 10: normal of a, of b     (these 11 are the separating axes)
//   11 + 3i + j: from a's edge i, perpendicular to it, to b[j]     20 + 3i + j: from b's edge j to a[i]
//   29 + 3i + j: from a[i] to b[j]
inline constexpr int kNormalA = 9, kNormalB = 10, kSeparatingAxes = 11;
inline constexpr int kFromEdgeA = 11, kFromEdgeB = 20, kFromVertex = 29, kDirections = 38;

// lo <= |margin| <= hi.
struct MarginBounds {
  double lo, hi;
  int direction;       // disjoint: the separation along this direction is lo
  std::uint32_t axes;  // intersecting: bit i is set if axis i may have the least overlap
};

inline namespace GRAZE_FP {

// The vertices to project on an axis, relative to the feature that it is perpendicular to. That feature projects to
// zero. Axis of two edges: seen[0] is a's third vertex; seen[1] and seen[2] stand for b. Normal of a face:
// all three are the other triangle's vertices.   Returns: how many of these vertices are in the feature's triangle.
template <class Real>
GRAZE_HD int seen_from_axis(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], int axis, Vec3<Real> (&seen)[3]) {
  if (axis >= kNormalA) {
    for (int k = 0; k < 3; ++k) seen[k] = axis == kNormalA ? b[k] - a[0] : a[k] - b[0];
    return 0;
  }
  const int i = axis / 3, j = axis % 3;
  seen[0] = a[(i + 2) % 3] - a[i];
  seen[1] = b[j] - a[i];
  seen[2] = b[(j + 2) % 3] - a[i];
  return 1;
}

}  // namespace GRAZE_FP
}  // namespace graze
