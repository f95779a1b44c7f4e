// SPDX-License-Identifier: Apache-2.0
// Certified bounds on the distance between disjoint triangles, from a guess of their nearest features. The bounds
// hold for any guess, and are tight if the guess is correct.
#pragma once

#include <cmath>

#include "core/margin/corners.h"
#include "core/margin/directions.h"
#include "core/margin/distance.h"
#include "core/margin/frame.h"
#include "core/margin/nearest_features.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {
namespace first_attempt {

// Whether the first vertices differ along only one coordinate axis, neither triangle reaches past its first vertex
// towards the other, and nothing was rounded. Then `distance` is exact, so even a power of two gets the right bucket.
GRAZE_HD inline bool joined_by_axis(const MarginFrame<double>& f, const Vec& between, double& distance) {
  const bool x = between.x != 0, y = between.y != 0, z = between.z != 0;
  if (x + y + z != 1) return false;
  const int axis = x ? 0 : y ? 1 : 2;
  const double length = component(between, axis), a0 = component(f.a[0], axis), b0 = component(f.b[0], axis);
  if (!(a0 + length == b0 && b0 - length == a0)) return false;  // the difference was rounded
  distance = fabs(length);
  const double sign = length < 0 ? -1 : 1;
  return sign * component(f.a[1], axis) <= sign * a0 && sign * component(f.a[2], axis) <= sign * a0 &&
         sign * component(f.b[1], axis) >= sign * b0 && sign * component(f.b[2], axis) >= sign * b0;
}

// Bounds from direction d of core/margin/directions.h: 0, kNormalA, kFromEdgeA or kFromVertex. lo: the separation along
// d. hi: the connection's length if it ends inside the features, else infinity.
template <int d>
GRAZE_HD MarginBounds bounds_of_first(const MarginFrame<double>& f) {
  Connection<double> best = {INFINITY, 0, 0};
  const Vec between = f.b[0] - f.a[0];
  if constexpr (d == 0) connect_edges(best, between, f.edge_a[0], f.edge_b[0], d);
  if constexpr (d == kFromEdgeA) connect_to_edge(best, between, f.edge_a[0], d);
  if constexpr (d == kNormalA) {
    const Vec normal = cross(f.edge_a[0], f.edge_a[1]);
    connect_to_face(best, between, f.edge_a[0], f.edge_a[2] * -1.0, normal, dot(normal, normal), d);
  }
  if constexpr (d == kFromVertex) {
    double distance;
    if (joined_by_axis(f, between, distance)) return {distance, distance, d, 0};
    shorten(best, between, {0, 0, 0}, {0, 0, 0}, d);
  }
  return {separation(f, d), sqrt(best.squared) * (1 + 8 * kHalfUlp) + 8 * kHalfUlp * best.terms, d, 0};
}

// Bounds on the distance between disjoint triangles. They always hold, and are tight if `nearest` is correct.
template <class Real>
GRAZE_HD MarginBounds distance_bounds(const Corners<Real>& a, const Corners<Real>& b, const Features& nearest) {
  const bool exchange = nearest.kind == Kind::face_b || nearest.kind == Kind::edge_b;
  Corners<Real> first, second;
  choose(exchange, b, a, first);
  choose(exchange, a, b, second);
  MarginFrame<double> f;
  f.exact = false;
  turn(first, exchange ? nearest.j : nearest.i, f.a);
  turn(second, exchange ? nearest.i : nearest.j, f.b);
  for (int k = 0; k < 3; ++k) {
    f.edge_a[k] = f.a[k == 2 ? 0 : k + 1] - f.a[k];
    f.edge_b[k] = f.b[k == 2 ? 0 : k + 1] - f.b[k];
  }
  switch (nearest.kind) {
    case Kind::edges:
      return bounds_of_first<0>(f);
    case Kind::face_a:
    case Kind::face_b:
      return bounds_of_first<kNormalA>(f);
    case Kind::edge_a:
    case Kind::edge_b:
      return bounds_of_first<kFromEdgeA>(f);
    default:
      return bounds_of_first<kFromVertex>(f);
  }
}

}  // namespace first_attempt
}  // namespace GRAZE_FP
}  // namespace graze
