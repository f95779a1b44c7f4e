// SPDX-License-Identifier: Apache-2.0
// A triangle within a larger one, or just outside it. Both triangles are drawn on a chart whose grid gives the larger
// triangle's barycentric coordinates. So for integers, containment and contact are exact at every ratio of sizes. In
// some pairs, the smaller triangle's vertices are then moved to both sides of the larger one's plane.
#pragma once

#include "strata/coplanar.h"

namespace graze::strata {
inline namespace GRAZE_FP {

// A triangle within the triangle (0, 0), (size, 0), (0, size) or, if `turned`, within the triangle (size, size),
// (0, size), (size, 0). Each vertex is within size / 4 of its own corner, so the three are never collinear.
GRAZE_HD inline void put_inner(auto& draws, int size, bool turned, GridPoint (&inner)[3]) {
  const int inset = draws.coin() ? size / 4 : size >> draws.between(2, 20);
  for (int m = 0; m < 3; ++m) {
    const int i = draws.between(0, inset);
    const int j = draws.between(0, inset);
    inner[m] = {m == 1 ? size - i - j : i, m == 2 ? size - i - j : j};
    if (turned) inner[m] = {size - inner[m].i, size - inner[m].j};
  }
  if (draws.below(4) == 0 && !turned) inner[0].i = inner[2].i = 0;
}

// A is (0, 0), (reach, 0), (0, reach), where reach is 2^bits. B has about the given size. In three pairs out of four, B
// lies within A; in the others it lies beyond A's edge i = 0. In at least a third of the pairs, B has a vertex or an
// edge on A's edge i = 0.
// Requires: 1 <= size <= reach.   Returns: points with |i| + |j| <= 2 * reach.
GRAZE_HD inline GridPair draw_nested_grid_pair(auto& draws, int bits, int size) {
  const int reach = 1 << bits;
  GridPair pair{{{0, 0}, {reach, 0}, {0, reach}}, {}};
  const bool turned = draws.coin() && 2 * size <= reach;
  put_inner(draws, size, turned, pair.b);
  const int room = reach - (turned ? 2 * size : size);
  const bool outside = draws.below(4) == 0;
  int gap = draws.below(3) == 0 ? 0 : 1 << draws.between(0, bits);
  if (!outside && gap > room) gap = room;
  const bool at_corner = draws.below(4) == 0;
  const int up = at_corner ? 0 : draws.between(0, outside ? room : room - gap);
  int least = pair.b[0].i;
  for (const GridPoint& point : pair.b) least = point.i < least ? point.i : least;
  for (GridPoint& point : pair.b) {
    const int from_edge = point.i - least + gap;
    point = {outside ? -from_edge : from_edge, point.j + up};
  }
  return pair;
}

// Half of the pairs are exact, in integers that are small or have up to 24 bits (doubles: 53). The other half have
// real coordinates before rounding. B's size is 2^0 … 2^-20 of A's size. In three pairs out of four, B lies in A's
// plane; in the others, B has vertices on both sides of that plane.
template <class D>
GRAZE_HD auto nested(D& draws) {
  using Integer = typename D::Integer;
  const bool exact = draws.coin();
  const int digits = exact ? draws.between(2, draws.kBits - 2) : 20;
  const int bits = exact ? draws.between(2, digits < 20 ? digits : 20) : 20;
  const Integer step = Integer{1} << (digits - bits);
  const double unit = exact ? static_cast<double>(step) : 1.0 / kRealReach;
  Chart chart;
  if (exact) {  // all sums are within ±2^24: 2^22 for the place, 2^23 for the grid, 2^22 for the lift
    chart = {draws.integers(Integer{1} << digits), draws.integers(step), draws.integers(step)};
  } else {
    chart = draw_real_chart(draws);
  }
  const bool along_axes = draws.below(4) == 0;
  const int normal = draws.between(0, 2);
  if (along_axes || cross(chart.u, chart.v) == Vec{0, 0, 0}) chart = axis_chart(chart.origin, normal, unit);
  const int size = 1 << draws.between(0, bits);
  Draft draft = laid(chart, draw_nested_grid_pair(draws, bits, size));
  if (draws.below(4) == 0) {
    const Vec lift = unit_axis(dominant_axis(cross(chart.u, chart.v))) * unit;
    const double above = draws.between(1, size);
    const double below = draws.between(1, size);
    const double side = draws.integer(1);
    const double third = draws.between(1, size);
    draft.b[0] = draft.b[0] + lift * above;
    draft.b[1] = draft.b[1] - lift * below;
    draft.b[2] = draft.b[2] + lift * (side * third);
  }
  return shuffled(draws, rounded(draws, draft));
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
