// SPDX-License-Identifier: Apache-2.0
// Coplanar and parallel pairs: two triangles on a square grid, and a chart that maps the grid into space. With an
// integer chart nothing is rounded, so the pair is exactly coplanar. With a real chart, the pair is coplanar only
// before rounding.
#pragma once

#include "strata/draws.h"

namespace graze::strata {
inline namespace GRAZE_FP {

struct GridPoint {
  int i, j;
};

struct GridPair {
  GridPoint a[3];
  GridPoint b[3];
};

GRAZE_HD inline GridPoint draw_point(auto& draws, int reach) { return {draws.integer(reach), draws.integer(reach)}; }

GRAZE_HD inline GridPoint along(GridPoint p, GridPoint d, int times) { return {p.i + d.i * times, p.j + d.j * times}; }

// p + w or p - w, whichever lies to the left of d (side 1) or to the right of d (side -1). If w is parallel to d: p
// plus d turned by 90 degrees to that side.
GRAZE_HD inline GridPoint beside(GridPoint p, GridPoint d, int side, GridPoint w) {
  const std::int64_t turn = static_cast<std::int64_t>(d.i) * w.j - static_cast<std::int64_t>(d.j) * w.i;
  if (turn == 0) return along(p, {-d.j, d.i}, side);
  return along(p, w, turn * side < 0 ? -1 : 1);
}

// Two triangles on the grid, within ±(reach + 1). In half of the pairs the triangles are independent. In the other
// half, a vertex of B is on an edge of A or one grid step away from it.
// Requires: reach >= 8.
GRAZE_HD inline GridPair draw_grid_pair(auto& draws, int reach) {
  GridPair pair;
  if (draws.coin()) {
    for (GridPoint& point : pair.a) point = draw_point(draws, reach);
    for (GridPoint& point : pair.b) point = draw_point(draws, reach);
    return pair;
  }
  const int quarter = reach / 4;
  const GridPoint start = draw_point(draws, quarter);
  GridPoint d = draw_point(draws, reach / 8);
  if (d.i == 0 && d.j == 0) d.i = 1;
  const int length = draws.between(1, 4);
  const int at = draws.between(0, length);
  GridPoint touching = along(start, d, at);
  if (draws.coin()) {
    const int step = draws.coin() ? 1 : -1;
    (draws.coin() ? touching.i : touching.j) += step;
  }
  pair.a[0] = start;
  pair.a[1] = along(start, d, length);
  pair.a[2] = beside(start, d, 1, draw_point(draws, quarter));
  pair.b[0] = touching;
  pair.b[1] = beside(touching, d, -1, draw_point(draws, quarter));
  if (draws.below(4) == 0) pair.b[1] = along(touching, d, draws.coin() ? 1 : -1);  // along an edge of A
  pair.b[2] = beside(touching, d, -1, draw_point(draws, quarter));
  return pair;
}

// A plane with coordinates: grid point (i, j) lies at origin + i u + j v.
struct Chart {
  Vec origin, u, v;
};

GRAZE_HD inline Draft laid(const Chart& chart, const GridPair& pair) {
  Draft draft;
  for (int k = 0; k < 3; ++k) {
    draft.a[k] = chart.origin + chart.u * double(pair.a[k].i) + chart.v * double(pair.a[k].j);
    draft.b[k] = chart.origin + chart.u * double(pair.b[k].i) + chart.v * double(pair.b[k].j);
  }
  return draft;
}

// The plane through `origin` on which the given coordinate is constant.
GRAZE_HD inline Chart axis_chart(const Vec& origin, int normal, double step) {
  return {origin, unit_axis((normal + 1) % 3) * step, unit_axis((normal + 2) % 3) * step};
}

GRAZE_HD inline auto coplanar_lattice(auto& draws) {
  const Vec origin = draws.integers(4);
  Chart chart = axis_chart(origin, draws.between(0, 2), 1);
  if (draws.coin()) {
    const Vec u = draws.integers(2);
    const Vec v = draws.integers(2);
    if (!(cross(u, v) == Vec{0, 0, 0})) chart = {origin, u, v};
  }
  const Draft draft = laid(chart, draw_grid_pair(draws, 8));
  return shuffled(draws, rounded(draws, draft));
}

// A grid pair mapped by an integer chart, within ±(2^place + 2^(bits - 1)). A product of a grid point and the chart has
// bits - 2 bits, split at random between the two factors.
template <class D>
GRAZE_HD Draft draw_wide_coplanar(D& draws, int bits, int place) {
  using Integer = typename D::Integer;
  const int grid_bits = draws.between(4, bits < 33 ? bits - 5 : 28);
  const Integer step = Integer{1} << (bits - 2 - grid_bits);
  const Chart chart{draws.integers(Integer{1} << place), draws.integers(step), draws.integers(step)};
  return laid(chart, draw_grid_pair(draws, (1 << grid_bits) - 1));
}

GRAZE_HD inline auto coplanar_wide(auto& draws) {
  const int bits = draws.wide_bits();
  const Draft draft = draw_wide_coplanar(draws, bits, bits - 1);
  return shuffled(draws, rounded(draws, draft));
}

inline constexpr int kRealReach = 1 << 20;  // a real chart's grid, fine enough to be almost continuous

GRAZE_HD inline Draft draw_real_coplanar(auto& draws, const Chart& chart) {
  return laid(chart, draw_grid_pair(draws, kRealReach));
}

GRAZE_HD inline Chart draw_real_chart(auto& draws) {
  const double step = 1.0 / kRealReach;
  return {draws.reals(), draws.reals() * step, draws.reals() * step};
}

GRAZE_HD inline auto coplanar_rounded(auto& draws) {
  const Draft draft = draw_real_coplanar(draws, draw_real_chart(draws));
  return shuffled(draws, rounded(draws, draft));
}

template <class D>
GRAZE_HD auto parallel(D& draws) {
  switch (draws.below(3)) {
    case 0: {  // tilted planes, parallel before rounding; their distance is 1 … 2^-40 (doubles: 2^-100)
      const Chart chart = draw_real_chart(draws);
      Draft draft = draw_real_coplanar(draws, chart);
      const double gap = draws.sign();
      move(draft.b, normalised(cross(chart.u, chart.v)) * (gap * power_of_two(-draws.between(0, draws.kGap))));
      return shuffled(draws, rounded(draws, draft));
    }
    case 1: {  // tilted planes, exactly parallel, moved by up to one unit in a coordinate or by any vector
      const int bits = draws.wide_bits();
      Draft draft = draw_wide_coplanar(draws, bits, bits - 2);
      Vec by = draws.integers(typename D::Integer{1} << draws.between(0, bits - 2));
      const double units = draws.integer(1);
      if (draws.coin()) by = unit_axis(draws.between(0, 2)) * units;
      move(draft.b, by);
      return shuffled(draws, rounded(draws, draft));
    }
    default: {  // axis-aligned planes, exactly parallel, moved by up to 4 ulps
      const int normal = draws.between(0, 2);
      const Vec origin = draws.reals();
      auto pair = rounded(draws, draw_real_coplanar(draws, axis_chart(origin, normal, 1.0 / kRealReach)));
      const int ulps = draws.integer(4);
      for (auto& vertex : pair.b) component(vertex, normal) = nudged(component(vertex, normal), ulps);
      return shuffled(draws, pair);
    }
  }
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
