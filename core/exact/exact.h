// SPDX-License-Identifier: Apache-2.0
// Exact triangle-triangle intersection for input in float32 or double, on host and device. Triangles are closed, may be
// segments or points, and may cross, touch, be coplanar, or share vertices or edges, with any finite coordinates,
// including subnormals and 1e308. This header needs only the C++ standard library and a compiler with 128-bit integers
// (GCC, Clang, nvcc).
//
// Method: two decisions, written as templates over a kind of numbers. Numbers that are not always exact report when
// they are not.
//   by_planes.h  Guigue and Devillers 2003: the sides of the vertices, then two orientations, for pairs in general
//                position. filter.h is a fast version in doubles with one error bound.
//   by_axes.h    separating axes of the Minkowski difference (theorem: Gottschalk, Lin and Manocha 1996), for proper,
//                coplanar and degenerate pairs alike.
//   numbers.h    doubles with an error bound (Shewchuk 1997), doubles where nothing rounds, and integers of 128 bits
//                and more, with the widths that each kind holds.
// The filter comes first. Among the pairs that the filter leaves open, those with a shared vertex intersect; each other
// pair goes to the smallest kind of exact numbers that holds the pair's grid (decision.h).
#pragma once

#include "core/exact/by_axes.h"
#include "core/exact/decision.h"
#include "core/exact/filter.h"
#include "core/exact/grid.h"
#include "core/exact/numbers.h"
#include "core/exact/relation.h"
#include "core/exact/triangles.h"

namespace graze::exact {
namespace detail {

template <class Real>
GRAZE_HD bool intersects(const Real* a, const Real* b, Stage* stage) {
  Stage decided = Stage::bounded;
  const Finding found = filter(a, b);
  const bool result = found == Finding::unsure ? decide_unsure(a, b, decided) : found != Finding::disjoint;
  if (stage) *stage = decided;
  return result;
}

template <class Real>
GRAZE_HD Relation relation(const Real* a, const Real* b) {
  Relation r;
  if (relate_quickly(a, b, r)) return r;
  const Grid grid = grid_of(a, b);
  const bool bounds_hold = sizeof(Real) == sizeof(float) || is_moderate(grid);
  if (bounds_hold && !KindsFor<Real>::Machine::hold(grid) && relate_by_bounds(a, b, r)) return r;
  return KindsFor<Real>::All::visit(
      grid, [&](auto numbers) { return by_axes(triangles<decltype(numbers)>(a, b, grid.exponent)); });
}

}  // namespace detail

// Whether the closed triangles a and b, given as three vertices x y z, share a point. `stage`: which numbers decided.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline bool intersects(const float* a, const float* b, Stage* stage = nullptr) {
  return detail::intersects(a, b, stage);
}
GRAZE_HD inline bool intersects(const double* a, const double* b, Stage* stage = nullptr) {
  return detail::intersects(a, b, stage);
}

// The verdict with contact, margin sign and hulls.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline Relation relation(const float* a, const float* b) { return detail::relation(a, b); }
GRAZE_HD inline Relation relation(const double* a, const double* b) { return detail::relation(a, b); }

}  // namespace graze::exact
