// SPDX-License-Identifier: Apache-2.0
// Clips one hull, a polygon, by the half-spaces whose intersection is the other hull. common_set.cpp uses it with
// rationals, and wasm/drawing.cpp with floating-point numbers of 113 bits.   Reference: Sutherland and Hodgman 1974.
#pragma once

#include <algorithm>
#include <vector>

#include "core/vec3.h"

namespace graze::oracle {

template <class Real>
using Polygon = std::vector<Vec3<Real>>;  // in order; two points are a segment

// The points x with dot(normal, x - at) >= 0.
template <class Real>
struct HalfSpace {
  Vec3<Real> normal, at;
};

template <class Real>
Vec3<Real> negative(const Vec3<Real>& v) {
  return {-v.x, -v.y, -v.z};
}

template <class Real>
Vec3<Real> normal_of(const Vec3<Real> (&p)[3]) {
  return cross(p[1] - p[0], p[2] - p[0]);
}

// The hull's extreme points.
template <class Real>
Polygon<Real> hull_of(const Vec3<Real> (&p)[3]) {
  if (normal_of(p) != Vec3<Real>{}) return {p[0], p[1], p[2]};
  const auto before = [](const Vec3<Real>& u, const Vec3<Real>& v) {
    return u.x != v.x ? u.x < v.x : u.y != v.y ? u.y < v.y : u.z < v.z;
  };
  const auto [low, high] = std::minmax_element(p, p + 3, before);
  return *low == *high ? Polygon<Real>{*low} : Polygon<Real>{*low, *high};
}

// Half-spaces whose intersection is the hull with these extreme points.
template <class Real>
std::vector<HalfSpace<Real>> half_spaces(const Polygon<Real>& hull) {
  std::vector<HalfSpace<Real>> all;
  const auto add_plane = [&](const Vec3<Real>& normal) {
    all.push_back({normal, hull[0]});
    all.push_back({negative(normal), hull[0]});
  };
  const Vec3<Real> axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (hull.size() == 3) {
    const Vec3<Real> normal = cross(hull[1] - hull[0], hull[2] - hull[0]);
    add_plane(normal);
    for (std::size_t i = 0; i < 3; ++i) all.push_back({cross(normal, hull[(i + 1) % 3] - hull[i]), hull[i]});
  } else if (hull.size() == 2) {
    const Vec3<Real> along = hull[1] - hull[0];
    for (const Vec3<Real>& axis : axes) add_plane(cross(axis, along));  // a zero normal excludes nothing
    all.push_back({along, hull[0]});
    all.push_back({negative(along), hull[1]});
  } else {
    for (const Vec3<Real>& axis : axes) add_plane(axis);
  }
  return all;
}

// The part of the polygon in the half-space.   height: computes dot(normal, x - at) for a half-space and a point x.
template <class Real, class Height>
Polygon<Real> clipped(const Polygon<Real>& polygon, const HalfSpace<Real>& half, const Height& height) {
  Polygon<Real> kept;
  // A segment is traversed in both directions, so its crossing is found twice.
  const auto keep = [&](const Vec3<Real>& p) {
    if (std::find(kept.begin(), kept.end(), p) == kept.end()) kept.push_back(p);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3<Real>&p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Real at_p = height(half, p), at_q = height(half, q);
    if (at_p >= 0) keep(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) keep(p + (q - p) * Real(at_p / (at_p - at_q)));
  }
  return kept;
}

// The common set's extreme points, in order.
template <class Real, class Height>
Polygon<Real> common_polygon(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Height& height) {
  Polygon<Real> common = hull_of(a);
  for (const HalfSpace<Real>& half : half_spaces(hull_of(b))) common = clipped(common, half, height);
  return common;
}

}  // namespace graze::oracle
