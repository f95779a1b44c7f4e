// SPDX-License-Identifier: Apache-2.0
// Places pairs in a scene. A draft around the origin is moved into the extent, then rounded to the grid, then pushed by
// ulps or grid steps. Because of this order, near contacts stay near in ulps of the scene's coordinates.
#pragma once

#include "strata/contact.h"
#include "strata/scene/scene.h"

namespace graze::strata::in_scene {
inline namespace GRAZE_FP {

// Requires: |x| < 2^51.
GRAZE_INLINE double nearest_whole(double x) { return (x + 0x1.8p52) - 0x1.8p52; }

GRAZE_INLINE double clamped(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

GRAZE_INLINE double point_of(const Grid& grid, double n) { return grid.decimal ? n / grid.scale : n * grid.scale; }
GRAZE_INLINE double number_of(const Grid& grid, double x) {
  return nearest_whole(grid.decimal ? x * grid.scale : x / grid.scale);
}

// The coordinate as the scene stores it.
template <class Real>
GRAZE_INLINE Real stored(const Scene& scene, int axis, double x) {
  const double inside = clamped(x, component(scene.low, axis), component(scene.high, axis));
  return static_cast<Real>(scene.on_grid ? point_of(scene.grid, number_of(scene.grid, inside)) : inside);
}

// The coordinate moved by `steps` grid steps, but kept within the extent. If there is no grid, or if the grid steps do
// not change the coordinate, it is moved by ulps instead.
template <class Real>
GRAZE_INLINE Real pushed(const Scene& scene, int axis, Real x, int steps) {
  if (scene.on_grid) {
    const double n = number_of(scene.grid, static_cast<double>(x)) + steps;
    const Real y = stored<Real>(scene, axis, point_of(scene.grid, n));
    if (y != x) return y;
  }
  return stored<Real>(scene, axis, static_cast<double>(nudged(x, steps)));
}

template <class Real>
GRAZE_INLINE Vec3<Real> pushed(const Scene& scene, const Vec3<Real>& v, int axis, int steps) {
  return {axis == 0 ? pushed(scene, 0, v.x, steps) : v.x, axis == 1 ? pushed(scene, 1, v.y, steps) : v.y,
          axis == 2 ? pushed(scene, 2, v.z, steps) : v.z};
}

template <class Real>
GRAZE_INLINE Vec3<Real> stored(const Scene& scene, const Vec& v) {
  return {stored<Real>(scene, 0, v.x), stored<Real>(scene, 1, v.y), stored<Real>(scene, 2, v.z)};
}

template <class Real>
GRAZE_INLINE BasicPair<Real> stored(const Scene& scene, const Draft& draft) {
  return {{stored<Real>(scene, draft.a[0]), stored<Real>(scene, draft.a[1]), stored<Real>(scene, draft.a[2])},
          {stored<Real>(scene, draft.b[0]), stored<Real>(scene, draft.b[1]), stored<Real>(scene, draft.b[2])}};
}

struct Interval {
  double low, high;
};

GRAZE_INLINE Interval span_of(const Vec (&v)[3], int axis) {
  const double x = component(v[0], axis), y = component(v[1], axis), z = component(v[2], axis);
  const double low = x < y ? x : y, high = x < y ? y : x;
  return {z < low ? z : low, z > high ? z : high};
}

GRAZE_INLINE Interval span_of(const Draft& draft, int axis) {
  const Interval a = span_of(draft.a, axis), b = span_of(draft.b, axis);
  return {a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}

// Moves the draft to a random place in the extent, after flattening it along each axis on which it does not fit.
GRAZE_HD inline void place(auto& draws, const Scene& scene, Draft& draft) {
  Vec by{1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) {
    const Interval span = span_of(draft, axis);
    const double room = component(scene.high, axis) - component(scene.low, axis);
    if (span.high - span.low > room) component(by, axis) = room / (span.high - span.low);
  }
  scale(draft, by);
  Vec to{0, 0, 0};
  for (int axis = 0; axis < 3; ++axis) {
    const Interval span = span_of(draft, axis);
    const double low = component(scene.low, axis) - span.low, high = component(scene.high, axis) - span.high;
    component(to, axis) = low + (high - low) * draws.positive();
  }
  move(draft, to);
}

// Like `finished` in strata/contact.h, but within the scene.
template <class D>
GRAZE_HD BasicPair<typename D::Real> finished(D& draws, const Scene& scene, Draft& draft, const Push& push) {
  place(draws, scene, draft);
  BasicPair<typename D::Real> pair = stored<typename D::Real>(scene, draft);
  pair.b[0] = pushed(scene, pair.b[0], push.axis, push.ulps);
  return shuffled(draws, pair);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata::in_scene
