// SPDX-License-Identifier: Apache-2.0
// Guesses the nearest features of two triangles, in single or double precision. Nothing here is certified.
#pragma once

#include <cmath>

#include "core/margin/corners.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {
namespace first_attempt {

// Two features: two edges; a face and a vertex of the other triangle; an edge and a vertex of the other; two vertices.
// i is a vertex of a, or the edge of a that begins there, or 0 for a's face. j is the same for b.
enum class Kind { edges, face_a, face_b, edge_a, edge_b, vertices };
struct Features {
  Kind kind;
  int i, j;
};

// The nearest features so far, their squared distance, and the squared distance of the next nearest.
template <class Real>
struct Nearest {
  Features features = {Kind::vertices, 0, 0};
  Real squared = INFINITY, next = INFINITY;

  GRAZE_HD void consider(Real at, bool valid, const Features& candidate) {
    const bool better = valid && at < squared;
    next = better ? squared : valid && at < next ? at : next;
    squared = better ? at : squared;
    features.kind = better ? candidate.kind : features.kind;
    features.i = better ? candidate.i : features.i;
    features.j = better ? candidate.j : features.j;
  }
};

// The features that seem nearest, subject to rounding and to the error of a reciprocal.
template <class Real>
GRAZE_HD Nearest<Real> seem_nearest(const Corners<Real>& a, const Corners<Real>& b) {
  Corners<Real> edge_a, edge_b;
  Real length_a[3], length_b[3], per_a[3], per_b[3];  // squares, and their reciprocals
  for (int i = 0; i < 3; ++i) {
    edge_a[i] = a[i == 2 ? 0 : i + 1] - a[i];
    edge_b[i] = b[i == 2 ? 0 : i + 1] - b[i];
    length_a[i] = dot(edge_a[i], edge_a[i]);
    length_b[i] = dot(edge_b[i], edge_b[i]);
    per_a[i] = reciprocal(length_a[i]);
    per_b[i] = reciprocal(length_b[i]);
  }
  const Vec3<Real> normal_a = cross(edge_a[0], edge_a[1]), normal_b = cross(edge_b[0], edge_b[1]);
  const Real n2_a = dot(normal_a, normal_a), n2_b = dot(normal_b, normal_b);
  const Real per_normal_a = reciprocal(n2_a), per_normal_b = reciprocal(n2_b);
  Nearest<Real> nearest;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3<Real> w = b[j] - a[i], across_a = cross(w, edge_a[i]), across_b = cross(w, edge_b[j]);
      nearest.consider(dot(w, w), true, {Kind::vertices, i, j});
      const Real at_a = dot(w, edge_a[i]), at_b = -dot(w, edge_b[j]);
      nearest.consider(dot(across_a, across_a) * per_a[i], at_a > 0 && at_a < length_a[i], {Kind::edge_a, i, j});
      nearest.consider(dot(across_b, across_b) * per_b[j], at_b > 0 && at_b < length_b[j], {Kind::edge_b, i, j});
      const Vec3<Real> n = cross(edge_a[i], edge_b[j]);
      const Real n2 = dot(n, n), s = dot(across_b, n), t = dot(across_a, n), gap = dot(w, n);
      nearest.consider(gap * gap * reciprocal(n2), s > 0 && t > 0 && s < n2 && t < n2, {Kind::edges, i, j});
      if (i == 0) {  // a vertex of b over a
        const Real u = -dot(cross(w, edge_a[2]), normal_a), v = dot(cross(edge_a[0], w), normal_a);
        const Real height = dot(w, normal_a);
        nearest.consider(height * height * per_normal_a, u >= 0 && v >= 0 && u + v <= n2_a, {Kind::face_a, 0, j});
      }
      if (j == 0) {  // a vertex of a over b; w points away from it
        const Real u = dot(cross(w, edge_b[2]), normal_b), v = -dot(cross(edge_b[0], w), normal_b);
        const Real height = dot(w, normal_b);
        nearest.consider(height * height * per_normal_b, u >= 0 && v >= 0 && u + v <= n2_b, {Kind::face_b, i, 0});
      }
    }
  }
  return nearest;
}

}  // namespace first_attempt
}  // namespace GRAZE_FP
}  // namespace graze
