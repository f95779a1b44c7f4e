// SPDX-License-Identifier: Apache-2.0
// Examines the Minkowski difference D = { x - y : x in a, y in b } by its projections on axes. D contains the origin
// exactly when a and b intersect.
#pragma once

#include "core/exact/triangles.h"
#include "core/exact/vector.h"

namespace graze::exact::detail {

// Findings from the axes examined so far.
struct AxisEvidence {
  bool separated = false;
  bool touching = false;            // the origin lies on a face of D that is not all of D
  bool flat = true;                 // D has no volume
  bool coplanar = true;             // the hull of all six points has no volume
  unsigned face_a = 7, face_b = 7;  // the vertices that may belong to the common set

  // Examines an axis, given the vertices' projections on it.
  template <class T>
  GRAZE_HD void look(const T (&a)[3], const T (&b)[3]) {
    const T least_a = least(a), most_a = most(a), least_b = least(b), most_b = most(b);
    const bool extends = least_a < most_a || least_b < most_b;
    separated = separated || most_a < least_b || most_b < least_a;
    flat = flat && !extends;
    coplanar = coplanar && !extends && least_a == least_b;
    if (most_a == least_b) touch(a, b, most_a, extends);
    if (most_b == least_a) touch(a, b, least_a, extends);
  }

  template <class T>
  GRAZE_HD void touch(const T (&a)[3], const T (&b)[3], const T& at, bool extends) {
    touching = touching || extends;
    for (unsigned i = 0; i < 3; ++i) {
      if (!(a[i] == at)) face_a &= ~(1u << i);
      if (!(b[i] == at)) face_b &= ~(1u << i);
    }
  }
};

template <class Numbers>
GRAZE_HD void look_along(const Triangles<Numbers>& t, const Vec<typename Numbers::M>& n, AxisEvidence& seen) {
  using T = typename Numbers::T;
  T a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = dot<T>(n, t.a[i] - t.a[0]);
    b[i] = dot<T>(n, t.b[i] - t.a[0]);
  }
  seen.look(a, b);
}

// Projects the triangles on a coordinate plane, and examines the axes perpendicular to each edge there.
template <class Numbers>
GRAZE_HD void look_in_plane(const Triangles<Numbers>& t, typename Numbers::D VecOf<Numbers>::*x,
                            typename Numbers::D VecOf<Numbers>::*y, AxisEvidence& seen) {
  using M = typename Numbers::M;
  for (int edge = 0; edge < 6; ++edge) {
    const VecOf<Numbers>* v = edge < 3 ? t.a : t.b;
    const int from = edge % 3, to = from == 2 ? 0 : from + 1;
    const VecOf<Numbers> e = v[to] - v[from];
    M a[3], b[3];
    for (int i = 0; i < 3; ++i) {
      const VecOf<Numbers> p = t.a[i] - t.a[0], q = t.b[i] - t.a[0];
      a[i] = M(e.*x) * (p.*y) - M(e.*y) * (p.*x);
      b[i] = M(e.*x) * (q.*y) - M(e.*y) * (q.*x);
    }
    seen.look(a, b);
  }
}

// Examines the axes that suffice if D lies in a plane through the origin, with normal n. Dropping a coordinate whose
// axis is not perpendicular to n does not flatten D; D's edges are edges of a and b. If n is zero, D is a segment or a
// point, and some projection or some coordinate shows whether the origin is outside D.
template <class Numbers>
GRAZE_HD void look_flat(const Triangles<Numbers>& t, const NormalOf<Numbers>& n, AxisEvidence& seen) {
  using D = typename Numbers::D;
  using V = VecOf<Numbers>;
  const typename Numbers::M zero(0);
  const bool none = is_zero(n);
  if (none || !(n.z == zero)) look_in_plane<Numbers>(t, &V::x, &V::y, seen);
  if (none || (n.z == zero && !(n.x == zero))) look_in_plane<Numbers>(t, &V::y, &V::z, seen);
  if (none || (n.z == zero && n.x == zero)) look_in_plane<Numbers>(t, &V::z, &V::x, seen);
  if (!none) return;
  D V::*const axes[3] = {&V::x, &V::y, &V::z};
  for (D V::*x : axes) {
    const D a[3] = {t.a[0].*x, t.a[1].*x, t.a[2].*x}, b[3] = {t.b[0].*x, t.b[1].*x, t.b[2].*x};
    seen.look(a, b);
  }
}

// Examines the axes that decide a pair. If D has a volume, its faces are perpendicular to 11 axes: both normals and the
// edges' cross products. If D is flat, these axes show whether D's plane contains the origin. Extra axes do no harm.
template <class Numbers>
GRAZE_HD AxisEvidence look(const Triangles<Numbers>& t) {
  AxisEvidence seen;
  const typename Numbers::M zero(0);
  NormalOf<Numbers> n{zero, zero, zero};
  for (int axis = 0; axis < 11; ++axis) {
    const int i = axis / 3, j = axis % 3;
    const NormalOf<Numbers> along =
        axis == 10  ? normal<Numbers>(t.a)
        : axis == 9 ? normal<Numbers>(t.b)
                    : cross<typename Numbers::M>(t.a[i == 2 ? 0 : i + 1] - t.a[i], t.b[j == 2 ? 0 : j + 1] - t.b[j]);
    look_along<Numbers>(t, along, seen);
    if (is_zero(n)) n = along;
  }
  if (seen.separated || !seen.flat) return seen;
  AxisEvidence in_plane;
  look_flat<Numbers>(t, n, in_plane);
  in_plane.flat = true;
  in_plane.coplanar = seen.coplanar;
  return in_plane;
}

}  // namespace graze::exact::detail
