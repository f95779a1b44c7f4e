// SPDX-License-Identifier: Apache-2.0
// Exact triangle-triangle intersection for float32 input, on host and device: closed triangles, segments and points;
// crossing, touching, coplanar, shared vertices and edges; any finite coordinates, subnormals and 1e38 included.
// Needs the C++ standard library only, and a compiler with 128-bit integers (GCC, Clang, nvcc).
//
// Method: two decisions, written over the numbers that they compute with, and numbers that are exact or say that they
// are not.
//   by_planes.h  Guigue and Devillers 2003: the sides of the vertices, then two orientations, for pairs in general
//                position. screen.h is the same in doubles with one error bound, written for speed.
//   by_axes.h    separating axes of the Minkowski difference (the theorem: Gottschalk, Lin and Manocha 1996): proper,
//                coplanar and degenerate pairs alike.
//   numbers.h    doubles with an error bound (Shewchuk 1997), doubles where nothing rounds, and integers of 128 and of
//                more bits, with the widths that each kind holds.
// First the screen. What it leaves open intersects where a vertex is shared, and otherwise goes to the smallest exact
// kind of numbers that holds the pair's grid: decision.h.
#pragma once

#include "core/exact/by_axes.h"
#include "core/exact/decision.h"
#include "core/exact/grid.h"
#include "core/exact/numbers.h"
#include "core/exact/relation.h"
#include "core/exact/screen.h"
#include "core/exact/triangles.h"

namespace graze::exact {

// Whether the closed triangles a and b, each three vertices x y z, share a point. In `stage`, which numbers decided.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline bool intersects(const float* a, const float* b, Stage* stage = nullptr) {
  using namespace detail;
  Stage decided = Stage::bounded;
  const Finding found = screen(a, b);
  const bool result = found == Finding::unsure ? decide_unsure(a, b, decided) : found != Finding::disjoint;
  if (stage) *stage = decided;
  return result;
}

// Contact, margin's sign and shape as well.
// Requires: finite coordinates.   Exact: always.
GRAZE_HD inline Relation relation(const float* a, const float* b) {
  using namespace detail;
  Relation r;
  if (relate_quickly(a, b, r)) return r;
  const Grid grid = grid_of(a, b);
  if (!MachineNumbers::hold(grid) && relate_by_bounds(a, b, r)) return r;
  return AllNumbers::visit(grid,
                           [&](auto numbers) { return by_axes(triangles<decltype(numbers)>(a, b, grid.exponent)); });
}

}  // namespace graze::exact
