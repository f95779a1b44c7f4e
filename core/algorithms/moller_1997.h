// SPDX-License-Identifier: Apache-2.0
// T. Moller, A Fast Triangle-Triangle Intersection Test, Journal of Graphics Tools 2(2), 1997: the division-free
// variant. The paper's V is a, its U is b; du are b's distances to a's plane, dv are a's distances to b's.
#pragma once

#include "core/algorithms/algorithm.h"
#include "core/algorithms/vec2.h"

namespace graze {
inline namespace GRAZE_FP {
namespace moller_1997 {

// Whether segments pq and rs share a point. False for parallel segments: if they overlap, other edges cross.
template <class Real, class Policy>
GRAZE_HD bool segments_cross(Vec2<Real> p, Vec2<Real> q, Vec2<Real> r, Vec2<Real> s, const Policy& policy,
                             int question) {
  const Real zero(0);
  const Real ax = q.x - p.x, ay = q.y - p.y, bx = r.x - s.x, by = r.y - s.y, cx = p.x - r.x, cy = p.y - r.y;
  Real f = ay * bx - ax * by;
  see(policy, question, f);
  Real d = by * cx - bx * cy;
  see(policy, question + 1, d);
  if ((f > zero && d >= zero && d <= f) || (f < zero && d <= zero && d >= f)) {
    Real e = ax * cy - ay * cx;
    see(policy, question + 2, e);
    return f > zero ? e >= zero && e <= f : e <= zero && e >= f;
  }
  return false;
}

// Value at p of the implicit equation of the line through q and r.
template <class Real>
GRAZE_HD Real line_side(Vec2<Real> q, Vec2<Real> r, Vec2<Real> p) {
  const Real a = r.y - q.y, b = -(r.x - q.x);
  const Real c = -a * q.x - b * q.y;
  return a * p.x + b * p.y + c;
}

template <class Real, class Policy>
GRAZE_HD bool strictly_inside(Vec2<Real> p, const Vec2<Real> (&t)[3], const Policy& policy, int question) {
  Real d0 = line_side(t[0], t[1], p);
  see(policy, question, d0);
  Real d1 = line_side(t[1], t[2], p);
  see(policy, question + 1, d1);
  Real d2 = line_side(t[2], t[0], p);
  see(policy, question + 2, d2);
  return d0 * d1 > Real(0) && d0 * d2 > Real(0);
}

template <class Real, class Policy>
GRAZE_HD bool coplanar_intersect(const Vec3<Real>& normal, const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3],
                                 const Policy& policy) {
  const int axis = chosen(policy, 3, dominant_axis(normal));
  const Vec2<Real> u[3] = {drop(a[0], axis), drop(a[1], axis), drop(a[2], axis)};
  const Vec2<Real> v[3] = {drop(b[0], axis), drop(b[1], axis), drop(b[2], axis)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (segments_cross(u[i], u[(i + 1) % 3], v[j], v[(j + 1) % 3], policy, 8 + 9 * i + 3 * j)) return true;
    }
  }
  return strictly_inside(u[0], v, policy, 35) || strictly_inside(v[0], u, policy, 38);
}

// The part of the common line in a triangle: on the line's largest axis, it ends at `at + p / x0` and `at + q / x1`.
template <class Real>
struct Section {
  Real at, p, q, x0, x1;
};

// Requires: the vertex `alone` is alone on its side; t are the vertices' coordinates along the line's largest axis.
template <class Real>
GRAZE_HD Section<Real> section_from(const Real (&t)[3], const Real (&d)[3], int alone) {
  const int i = alone == 0 ? 1 : 0;
  const int j = alone == 2 ? 1 : 2;
  return {t[alone], (t[i] - t[alone]) * d[alone], (t[j] - t[alone]) * d[alone], d[alone] - d[i], d[alone] - d[j]};
}

// Index of the vertex that is alone on its side of the other plane; -1 if all three lie in that plane.
template <class Real>
GRAZE_HD int alone_vertex(const Real (&d)[3]) {
  const Real zero(0);
  if (d[0] * d[1] > zero) return 2;
  if (d[0] * d[2] > zero) return 1;
  if (d[1] * d[2] > zero || d[0] != zero) return 0;
  return d[1] != zero ? 1 : d[2] != zero ? 2 : -1;
}

}  // namespace moller_1997

struct Moller1997 {
  static constexpr AlgorithmInfo kInfo{
      "moller_1997",
      "Moller 1997, division-free variant",
      "all distances zero: edge against edge and vertex in triangle, projected along the normal's largest axis",
      "assumes none",
      "changes rounding",
      true};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    using namespace moller_1997;
    const Real zero(0);
    Real du[3], dv[3];
    const Vec3<Real> n1 = cross(a[1] - a[0], a[2] - a[0]);
    const Real d1 = -dot(n1, a[0]);
    for (int i = 0; i < 3; ++i) du[i] = policy.snap(At(Site::plane_distance, i), dot(n1, b[i]) + d1);
    if (du[0] * du[1] > zero && du[0] * du[2] > zero) return Verdict::disjoint;

    const Vec3<Real> n2 = cross(b[1] - b[0], b[2] - b[0]);
    const Real d2 = -dot(n2, b[0]);
    for (int i = 0; i < 3; ++i) dv[i] = policy.snap(At(Site::plane_distance, 3 + i), dot(n2, a[i]) + d2);
    if (dv[0] * dv[1] > zero && dv[0] * dv[2] > zero) return Verdict::disjoint;

    const int axis = chosen(policy, 0, dominant_axis(cross(n1, n2)));
    const Real ta[3] = {component(a[0], axis), component(a[1], axis), component(a[2], axis)};
    const Real tb[3] = {component(b[0], axis), component(b[1], axis), component(b[2], axis)};
    const int alone_a = alone_vertex(dv), alone_b = alone_vertex(du);
    choose(policy, 1, alone_a + 1);
    choose(policy, 2, alone_b + 1);
    if (alone_a < 0 || alone_b < 0) return verdict_of(coplanar_intersect(n1, a, b, policy));

    // Scales both sections by the product of all four x0 and x1 to avoid divisions.
    const Section<Real> s = section_from(ta, dv, alone_a), t = section_from(tb, du, alone_b);
    const Real xx = s.x0 * s.x1, yy = t.x0 * t.x1, xxyy = xx * yy;
    const Real s_at = s.at * xxyy, t_at = t.at * xxyy;
    const Real s0 = s_at + s.p * s.x1 * yy, s1 = s_at + s.q * s.x0 * yy;
    const Real t0 = t_at + t.p * xx * t.x1, t1 = t_at + t.q * xx * t.x0;
    const bool apart = policy.less(At(Site::separation, 6), s0 < s1 ? s1 : s0, t0 < t1 ? t0 : t1) ||
                       policy.less(At(Site::separation, 7), t0 < t1 ? t1 : t0, s0 < s1 ? s0 : s1);
    return verdict_of(!apart);
  }

  template <class Questions>
  static void list(Questions& questions) {
    questions.plane_distances();
    questions.overlap(13, "sections");  // a length times four differences of distances, each of degree 3
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        for (const char* of : {"f", "d", "e"}) questions.own(2, "edges", i, j, of);
      }
    }
    for (const char* of : {"a[0] in b", "b[0] in a"}) {
      for (int i = 0; i < 3; ++i) questions.own(2, of, i);
    }
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
