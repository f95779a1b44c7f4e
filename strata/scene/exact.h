// SPDX-License-Identifier: Apache-2.0
// Exact contacts and exactly coplanar pairs, whose coordinates lie on the scene's grid, or are multiples of an ulp of
// the scene's largest coordinate. On a decimal grid, the contacts are exact for the decimal numbers, before rounding.
#pragma once

#include "strata/coplanar.h"
#include "strata/scene/place.h"

namespace graze::strata::in_scene {
inline namespace GRAZE_FP {

// How far integer coordinates may reach on each axis.
template <class Integer>
struct Reach {
  Integer axis[3];
};

// `most` on each axis, or less on axes where `widths` times `most` does not fit into the extent.
template <class Integer>
GRAZE_HD Reach<Integer> reach_within(const Scene& scene, Integer most, double widths) {
  Reach<Integer> reach{{most, most, most}};
  for (int axis = 0; axis < 3; ++axis) {
    const double room = (component(scene.last, axis) - component(scene.first, axis)) / widths;
    if (room < static_cast<double>(most)) reach.axis[axis] = static_cast<Integer>(room);
  }
  return reach;
}

GRAZE_HD inline Vec draw_whole(auto& draws, const auto& reach, int times = 1) {
  return {static_cast<double>(draws.integer(reach.axis[0] * times)),
          static_cast<double>(draws.integer(reach.axis[1] * times)),
          static_cast<double>(draws.integer(reach.axis[2] * times))};
}

// A random longest edge, in grid steps.
GRAZE_HD inline double draw_edge_in_steps(auto& draws, const Scene& scene) {
  const double edge = draw_from(draws, scene.edges, {});
  return scene.exact.decimal ? edge * scene.exact.scale : edge / scene.exact.scale;
}

// A whole number near x.
GRAZE_INLINE double whole(const Draws&, double x) { return nearest_whole(x); }
GRAZE_INLINE double whole(const DoubleDraws&, double x) { return static_cast<double>(static_cast<std::int64_t>(x)); }

// Moves a draft with integer coordinates to a random place in the extent.
template <class D>
GRAZE_HD BasicPair<typename D::Real> finished_on_grid(D& draws, const Scene& scene, Draft draft) {
  if constexpr (D::kBits == 53) {  // makes coordinates begin at 0, so that no sum below needs a 54th bit
    const Vec least{span_of(draft, 0).low, span_of(draft, 1).low, span_of(draft, 2).low};
    move(draft, least * -1.0);
  }
  Vec to{0, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const Interval span = span_of(draft, axis);
    const double low = component(scene.first, axis) - span.low, high = component(scene.last, axis) - span.high;
    component(to, axis) = clamped(whole(draws, low + (high - low) * draws.positive()), low, high);
  }
  Draft placed;
  for (int i = 0; i < 3; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      component(placed.a[i], axis) = point_of(scene.exact, component(draft.a[i], axis) + component(to, axis));
      component(placed.b[i], axis) = point_of(scene.exact, component(draft.b[i], axis) + component(to, axis));
    }
  }
  return shuffled(draws, rounded(draws, placed));
}

inline constexpr int kWeight = 8;         // the largest multiple of a step
inline constexpr double kEdgeSteps = 42;  // longest edge divided by the reach of a step: 24 * sqrt(3)

GRAZE_HD inline double draw_weight(auto& draws) { return 1.0 + draws.below(kWeight); }

// An edge through the origin along e, or a vertex at the origin; the rest of the triangle lies on the given side.
GRAZE_HD inline void put_exact_edge(auto& draws, const auto& reach, const Vec& e, const Vec& side, Vec (&triangle)[3]) {
  const double back = draw_weight(draws);
  const double forth = draw_weight(draws);
  triangle[0] = e * -back;
  triangle[1] = e * forth;
  triangle[2] = toward(side, draw_whole(draws, reach, kWeight));
}

GRAZE_HD inline void put_exact_vertex(auto& draws, const auto& reach, const Vec& side, Vec (&triangle)[3]) {
  triangle[0] = {0, 0, 0};
  triangle[1] = toward(side, draw_whole(draws, reach, kWeight));
  triangle[2] = toward(side, draw_whole(draws, reach, kWeight));
}

// Half of the pairs touch exactly. In the other half, one coordinate of b[0] is one step too large or too small.
template <class D>
GRAZE_HD BasicPair<typename D::Real> exact_contact(D& draws, const Scene& scene) {
  const Touch touch = static_cast<Touch>(draws.below(3));
  // At most 2^14 steps, so that the products that determine sides are exact. With doubles, edges may have more steps;
  // their products are rounded, but that hardly ever changes a sign.
  const double most = clamped(draw_edge_in_steps(draws, scene) / kEdgeSteps, 1, D::kBits == 53 ? 0x1p46 : 0x1p14);
  const auto reach = reach_within(scene, static_cast<typename D::Integer>(most), 4 * kWeight + 2);
  const Vec u = draw_whole(draws, reach);
  const Vec v = draw_whole(draws, reach);
  const Vec away = cross(u, v), back = away * -1.0;
  Draft draft;
  if (touch == Touch::vertex_face) {
    const double w0 = draw_weight(draws);
    const double w1 = draw_weight(draws);
    const double w2 = draw_weight(draws);
    draft.a[0] = u * w1 - v * w2;
    draft.a[1] = u * -w0;
    draft.a[2] = v * w0;
  } else {
    put_exact_edge(draws, reach, u, back, draft.a);
  }
  if (touch == Touch::edge_edge) {
    put_exact_edge(draws, reach, v, away, draft.b);
  } else {
    put_exact_vertex(draws, reach, away, draft.b);
  }
  if (draws.coin()) {
    const double step = draws.sign();
    const int axis = draws.between(0, 2);
    if (reach.axis[axis] > 0) component(draft.b[0], axis) += step;
  }
  return finished_on_grid(draws, scene, draft);
}

// Two triangles in a tilted plane. The bits of an edge are split at random between the chart and the grid pair.
template <class D>
GRAZE_HD BasicPair<typename D::Real> coplanar_wide(D& draws, const Scene& scene) {
  constexpr bool kWide = D::kBits == 53;
  const auto most =
      static_cast<typename D::Integer>(clamped(draw_edge_in_steps(draws, scene) / 8, 8, kWide ? 0x1p50 : 0x1p22));
  int bits = 3;
  while (bits < (kWide ? 28 : 19) && (2 << bits) <= most) ++bits;
  bits = draws.between(3, bits);
  const auto reach = reach_within(scene, most >> bits, 4.0 * ((1 << bits) + 1));
  const Chart chart{{0, 0, 0}, draw_whole(draws, reach), draw_whole(draws, reach)};
  return finished_on_grid(draws, scene, laid(chart, draw_grid_pair(draws, 1 << bits)));
}

// Two triangles whose six vertices are grid points in a cube.
GRAZE_HD inline auto lattice(auto& draws, const Scene& scene) {
  const double edge = scene.edges.at[kQuantiles - 1] * 0.57735;  // a cube's edge divided by its diagonal
  const double steps = scene.exact.decimal ? edge * scene.exact.scale : edge / scene.exact.scale;
  const Reach<int> reach = reach_within(scene, static_cast<int>(steps), 1);
  Draft draft;
  for (int i = 0; i < 6; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double n = draws.below(static_cast<std::uint32_t>(reach.axis[axis]) + 1);
      component(i < 3 ? draft.a[i] : draft.b[i - 3], axis) = n;
    }
  }
  return finished_on_grid(draws, scene, draft);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata::in_scene
