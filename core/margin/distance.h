// SPDX-License-Identifier: Apache-2.0
// Certified bounds on the distance between two disjoint triangles. No separation is larger than the distance, and no
// connection is shorter.
#pragma once

#include <cmath>

#include "core/margin/bucket.h"
#include "core/margin/directions.h"
#include "core/margin/frame.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

// Lower bound on the distance: the separation along any direction is at most the distance. The computed direction d
// counts as exact, and all points are relative to a vertex of its feature. A vertex's projection has an error of (1 for
// the difference, 3 roundings) kRoundoff sum(|n| * |difference|); 6 leaves slack.
template <class Real>
GRAZE_HD double separation(const MarginFrame<Real>& f, int d) {
  const Vec3<Real> n = direction(f, d), weight = magnitudes(n) * Real(6 * kRoundoff<Real>);
  const int i_of_d = d == kNormalA ? 0 : (d < kFromEdgeA ? d : (d - kFromEdgeA) % 9) / 3;
  const Vec3<Real> from = d == kNormalB ? f.b[0] : f.a[i_of_d];
  Interval<Real> least_a = {INFINITY, INFINITY}, most_a = {-INFINITY, -INFINITY}, least_b = least_a, most_b = most_a;
  for (int i = 0; i < 3; ++i) {
    const Vec3<Real> a = f.a[i] - from, b = f.b[i] - from;
    include(least_a, most_a, dot(n, a), dot(weight, magnitudes(a)));
    include(least_b, most_b, dot(n, b), dot(weight, magnitudes(b)));
  }
  const double gap = as_double(greater(least_b.lo - most_a.hi, least_a.lo - most_b.hi));
  return gap > 0 ? gap / sqrt(as_double(dot(n, n))) * (1 - 8 * kHalfUlp) : 0;  // 7 roundings at most
}

// The shortest connection found so far: its squared length and the sum of its terms' magnitudes, both as computed, and
// the direction along which the triangles should then be separated.
template <class Real>
struct Connection {
  Real squared, terms;
  int direction;
};

template <class Real>
GRAZE_HD void shorten(Connection<Real>& best, const Vec3<Real>& w, const Vec3<Real>& u, const Vec3<Real>& v,
                      int towards) {
  const Vec3<Real> sum = w + u + v;
  const Real squared = dot(sum, sum);
  if (!(squared < best.squared)) return;
  const Vec3<Real> terms = magnitudes(w) + magnitudes(u) + magnitudes(v);
  best = {squared, terms.x + terms.y + terms.z, towards};
}

// Connects point `at` (relative to the edge's start) to the foot of its perpendicular, if the foot lies on the edge.
template <class Real>
GRAZE_HD void connect_to_edge(Connection<Real>& best, const Vec3<Real>& at, const Vec3<Real>& edge, int towards) {
  const Real along = dot(at, edge), length2 = dot(edge, edge);
  if (along > 0 && along < length2) shorten(best, at, edge * (-along / length2), {0, 0, 0}, towards);
}

// Connects point `at` (relative to the face's vertex 0) to its projection, if that lies in the face with edges u and v.
template <class Real>
GRAZE_HD void connect_to_face(Connection<Real>& best, const Vec3<Real>& at, const Vec3<Real>& u, const Vec3<Real>& v,
                              const Vec3<Real>& n, const Real& n2, int towards) {
  const Real s = dot(cross(at, v), n), t = dot(cross(u, at), n);
  if (s >= 0 && t >= 0 && s + t <= n2 && n2 > 0) shorten(best, at, u * (-s / n2), v * (-t / n2), towards);
}

// Connects the nearest interior points of the edges u and v; w is the start of v relative to the start of u.
template <class Real>
GRAZE_HD void connect_edges(Connection<Real>& best, const Vec3<Real>& w, const Vec3<Real>& u, const Vec3<Real>& v,
                            int towards) {
  const Vec3<Real> n = cross(u, v);
  const Real n2 = dot(n, n), s = dot(cross(w, v), n), t = dot(cross(w, u), n);
  if (s > 0 && t > 0 && s < n2 && t < n2) shorten(best, w, u * (-s / n2), v * (t / n2), towards);
}

template <class Real>
GRAZE_HD Connection<Real> shortest_connection(const MarginFrame<Real>& f) {
  Connection<Real> best = {INFINITY, 0, 0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3<Real> between = f.b[j] - f.a[i];
      const int feature = 3 * i + j;
      shorten(best, between, {0, 0, 0}, {0, 0, 0}, kFromVertex + feature);
      connect_to_edge(best, between, f.edge_a[i], kFromEdgeA + feature);
      connect_to_edge(best, between * Real(-1), f.edge_b[j], kFromEdgeB + feature);
      connect_edges(best, between, f.edge_a[i], f.edge_b[j], feature);
    }
  }
  const Vec3<Real> normal_a = cross(f.edge_a[0], f.edge_a[1]), normal_b = cross(f.edge_b[0], f.edge_b[1]);
  const Real a2 = dot(normal_a, normal_a), b2 = dot(normal_b, normal_b);
  for (int i = 0; i < 3; ++i) {
    connect_to_face(best, f.b[i] - f.a[0], f.edge_a[0], f.edge_a[2] * Real(-1), normal_a, a2, kNormalA);
    connect_to_face(best, f.a[i] - f.b[0], f.edge_b[0], f.edge_b[2] * Real(-1), normal_b, b2, kNormalB);
  }
  return best;
}

template <class Real>
GRAZE_HD MarginBounds distance_bounds(const MarginFrame<Real>& f) {
  const Connection<Real> best = shortest_connection(f);
  // A connection w + s u + t v joins two points of the triangles for any parameters in [0, 1]. For a face, s + t may be
  // up to 1 + 2 kRoundoff; s and t are then too large by that factor. Each component is off by at most (2 for that, 1
  // for the differences, 1 for the products, 2 for the sums) kRoundoff (|w| + |s u| + |t v|).
  const double terms = as_double(best.terms);
  const double hi = sqrt(as_double(best.squared)) * (1 + 8 * kHalfUlp) + 8 * kRoundoff<Real> * terms;
  MarginBounds bounds = {separation(f, best.direction), hi, best.direction, 0};
  // If two kinds of connection tie, rounding may have selected the wrong direction.
  for (int d = 0; d < kDirections && floor_log2(bounds.lo) != floor_log2(hi) && bounds.lo < 0.999 * hi; ++d) {
    const double lo = separation(f, d);
    if (lo > bounds.lo) bounds = {lo, hi, d, 0};
  }
  return bounds;
}

}  // namespace GRAZE_FP
}  // namespace graze
