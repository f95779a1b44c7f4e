// SPDX-License-Identifier: Apache-2.0
// P. Guigue and O. Devillers, Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates,
// Journal of Graphics Tools 8(1), 2003. The paper's p1 q1 r1 are a, and its p2 q2 r2 are b.
#pragma once

#include "core/algorithms/algorithm.h"
#include "core/algorithms/vec2.h"

namespace graze {
inline namespace GRAZE_FP {
namespace guigue_devillers_2003 {

// The vertex order that puts the lone vertex first: the vertex alone on its side of the other triangle's plane, or
// alone in that plane. flip: turn the other triangle over, so that this vertex has the largest signed distance.
struct Canonical {
  int first;  // 0, 1 or 2; -1 if all three vertices lie in the plane
  bool flip;
};

template <class Real>
GRAZE_HD Canonical canonical(const Real (&d)[3]) {
  const Real zero(0);
  if (d[0] > zero) return d[1] > zero ? Canonical{2, true} : d[2] > zero ? Canonical{1, true} : Canonical{0, false};
  if (d[0] < zero) return d[1] < zero ? Canonical{2, false} : d[2] < zero ? Canonical{1, false} : Canonical{0, true};
  if (d[1] < zero) return d[2] < zero ? Canonical{0, false} : Canonical{1, true};
  if (d[1] > zero) return d[2] > zero ? Canonical{0, true} : Canonical{1, false};
  return d[2] > zero ? Canonical{2, false} : d[2] < zero ? Canonical{2, true} : Canonical{-1, false};
}

// Positive when r lies to the left of the line from p to q.
template <class Real, class Policy>
GRAZE_HD Real orient2d(Vec2<Real> p, Vec2<Real> q, Vec2<Real> r, const Policy& policy, int question) {
  return policy.snap(At(Site::orientation, question), (p.x - r.x) * (q.y - r.y) - (p.y - r.y) * (q.x - r.x));
}

// The paper's figure 9: p1 lies in the region of vertex p2, beyond edges r2p2 and q2r2.
template <class Real, class Policy>
GRAZE_HD bool vertex_region(Vec2<Real> p1, Vec2<Real> q1, Vec2<Real> r1, Vec2<Real> p2, Vec2<Real> q2, Vec2<Real> r2,
                            const Policy& policy) {
  const Real zero(0);
  if (orient2d(r2, p2, q1, policy, 22) >= zero) {
    if (orient2d(r2, q2, q1, policy, 23) <= zero) {
      if (orient2d(p1, p2, q1, policy, 24) > zero) return orient2d(p1, q2, q1, policy, 25) <= zero;
      return orient2d(p1, p2, r1, policy, 26) >= zero && orient2d(q1, r1, p2, policy, 27) >= zero;
    }
    return orient2d(p1, q2, q1, policy, 28) <= zero && orient2d(r2, q2, r1, policy, 29) <= zero &&
           orient2d(q1, r1, q2, policy, 30) >= zero;
  }
  if (orient2d(r2, p2, r1, policy, 31) < zero) return false;
  if (orient2d(q1, r1, r2, policy, 32) >= zero) return orient2d(p1, p2, r1, policy, 33) >= zero;
  return orient2d(q1, r1, q2, policy, 34) >= zero && orient2d(r2, r1, q2, policy, 35) >= zero;
}

// The paper's figure 10: p1 lies in the region of edge r2p2.
template <class Real, class Policy>
GRAZE_HD bool edge_region(Vec2<Real> p1, Vec2<Real> q1, Vec2<Real> r1, Vec2<Real> p2, Vec2<Real> r2,
                          const Policy& policy) {
  const Real zero(0);
  if (orient2d(r2, p2, q1, policy, 13) >= zero) {
    if (orient2d(p1, p2, q1, policy, 14) >= zero) return orient2d(p1, q1, r2, policy, 15) >= zero;
    return orient2d(q1, r1, p2, policy, 16) >= zero && orient2d(r1, p1, p2, policy, 17) >= zero;
  }
  return orient2d(r2, p2, r1, policy, 18) >= zero && orient2d(p1, p2, r1, policy, 19) >= zero &&
         (orient2d(p1, r1, r2, policy, 20) >= zero || orient2d(q1, r1, r2, policy, 21) >= zero);
}

// Requires: both triangles counterclockwise.
template <class Real, class Policy>
GRAZE_HD bool counterclockwise_intersect(Vec2<Real> p1, Vec2<Real> q1, Vec2<Real> r1, Vec2<Real> p2, Vec2<Real> q2,
                                         Vec2<Real> r2, const Policy& policy) {
  const Real zero(0);
  const bool left_of_pq = orient2d(p2, q2, p1, policy, 10) >= zero;
  choose(policy, 5, left_of_pq);
  const bool left_of_qr = orient2d(q2, r2, p1, policy, 11) >= zero;
  choose(policy, 6, left_of_qr);
  const bool left_of_rp = orient2d(r2, p2, p1, policy, 12) >= zero;
  choose(policy, 7, left_of_rp);
  if (left_of_pq && left_of_qr) return left_of_rp || edge_region(p1, q1, r1, p2, r2, policy);
  if (left_of_pq && left_of_rp) return edge_region(p1, q1, r1, r2, q2, policy);
  if (left_of_qr && left_of_rp) return edge_region(p1, q1, r1, q2, p2, policy);
  if (left_of_pq) return vertex_region(p1, q1, r1, p2, q2, r2, policy);
  if (left_of_qr) return vertex_region(p1, q1, r1, q2, r2, p2, policy);
  return vertex_region(p1, q1, r1, r2, p2, q2, policy);
}

template <class Real, class Policy>
GRAZE_HD bool coplanar_intersect(const Vec3<Real>& normal, const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3],
                                 const Policy& policy) {
  const int axis = chosen(policy, 2, dominant_axis(normal));
  const Vec2<Real> p1 = drop(a[0], axis), q1 = drop(a[1], axis), r1 = drop(a[2], axis);
  const Vec2<Real> p2 = drop(b[0], axis), q2 = drop(b[1], axis), r2 = drop(b[2], axis);
  const bool turn1 = orient2d(p1, q1, r1, policy, 8) < Real(0);
  choose(policy, 3, turn1);
  const bool turn2 = orient2d(p2, q2, r2, policy, 9) < Real(0);
  choose(policy, 4, turn2);
  return counterclockwise_intersect(p1, turn1 ? r1 : q1, turn1 ? q1 : r1, p2, turn2 ? r2 : q2, turn2 ? q2 : r2, policy);
}

}  // namespace guigue_devillers_2003

struct GuigueDevillers2003 {
  static constexpr AlgorithmInfo kInfo{
      "guigue_devillers_2003",
      "Guigue and Devillers 2003",
      "all orientations zero: 2D orientation tests, projected along the normal's largest axis",
      "assumes none",
      "changes rounding",
      true};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    using namespace guigue_devillers_2003;
    const Real zero(0);
    Real da[3], db[3];
    const Vec3<Real> n2 = cross(b[0] - b[2], b[1] - b[2]);
    for (int i = 0; i < 3; ++i) da[i] = policy.snap(At(Site::plane_distance, 3 + i), dot(a[i] - b[2], n2));
    if (da[0] * da[1] > zero && da[0] * da[2] > zero) return Verdict::disjoint;

    const Vec3<Real> n1 = cross(a[1] - a[0], a[2] - a[0]);
    for (int i = 0; i < 3; ++i) db[i] = policy.snap(At(Site::plane_distance, i), dot(b[i] - a[2], n1));
    if (db[0] * db[1] > zero && db[0] * db[2] > zero) return Verdict::disjoint;

    // Turning b over swaps its last two vertices and therefore their distances. The same holds for a.
    const Canonical ca = canonical(da);
    choose(policy, 0, 2 * ca.first + 2 + ca.flip);
    if (ca.first < 0) return verdict_of(coplanar_intersect(n1, a, b, policy));
    const int swap = ca.flip ? 1 : 0;
    const int ib[3] = {0, 1 + swap, 2 - swap};
    const Real db_turned[3] = {db[0], db[ib[1]], db[ib[2]]};
    const Canonical cb = canonical(db_turned);
    choose(policy, 1, 2 * cb.first + 2 + cb.flip);
    if (cb.first < 0) return verdict_of(coplanar_intersect(n1, a, b, policy));

    const Vec3<Real>& p1 = a[ca.first];
    const Vec3<Real>& q1 = a[(ca.first + (cb.flip ? 2 : 1)) % 3];
    const Vec3<Real>& r1 = a[(ca.first + (cb.flip ? 1 : 2)) % 3];
    const Vec3<Real>& p2 = b[ib[cb.first]];
    const Vec3<Real>& q2 = b[ib[(cb.first + 1) % 3]];
    const Vec3<Real>& r2 = b[ib[(cb.first + 2) % 3]];
    if (policy.snap(At(Site::orientation, 6), dot(q2 - q1, cross(p2 - q1, p1 - q1))) > zero) return Verdict::disjoint;
    return verdict_of(!(policy.snap(At(Site::orientation, 7), dot(r2 - p1, cross(p2 - p1, r1 - p1))) > zero));
  }

  // Coplanar determinants are numbered in the order of the functions above: the orientations of both triangles, the
  // place of a's first vertex, then the edge region and the vertex region.
  template <class Questions>
  static void list(Questions& questions) {
    questions.plane_distances();
    for (const char* of : {"det(p1 q1 p2 q2)", "det(p1 r1 p2 r2)"}) questions.value(Site::orientation, 3, of);
    for (const char* of : {"turn.a", "turn.b"}) questions.value(Site::orientation, 2, of);
    for (int i = 0; i < 3; ++i) questions.value(Site::orientation, 2, "place", i);
    for (int i = 0; i < 9; ++i) questions.value(Site::orientation, 2, "edge_region", i);
    for (int i = 0; i < 14; ++i) questions.value(Site::orientation, 2, "vertex_region", i);
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
