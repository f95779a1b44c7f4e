// SPDX-License-Identifier: Apache-2.0
// The thesis's final algorithm (Maffina 2012, section 3.2): Moller and Haines' interval overlap as presented in
// Schneider and Eberly, Geometric Tools for Computer Graphics (2002), pages 539 to 542.
#pragma once

#include "core/algorithms/algorithm.h"
#include "core/algorithms/plane.h"
#include "core/algorithms/plane_projection.h"
#include "core/algorithms/range.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct Line {
  Vec3<Real> point;
  Vec3<Real> direction;  // normalised
};

// The common line of two planes; `direction` is the cross product of their normals.
// Reference: Geometric Tools for Computer Graphics, section 11.5.1.
template <class Real, class Policy>
GRAZE_HD Line<Real> common_line(const Plane<Real>& p, const Plane<Real>& q, const Vec3<Real>& direction,
                                const Policy& policy) {
  const Real n_dot = dot(p.normal, q.normal);
  const Real p_square = dot(p.normal, p.normal);
  const Real q_square = dot(q.normal, q.normal);
  const Real denominator = n_dot * n_dot - p_square * q_square;
  Real s(0), t(0);
  if (chosen(policy, 0, denominator != Real(0))) {
    s = (q.d * n_dot - p.d * q_square) / denominator;
    t = (p.d * n_dot - q.d * p_square) / denominator;
  }
  const Vec3<Real> sum = p.normal * s + q.normal * t;
  return {{-sum.x, -sum.y, -sum.z}, normalised(direction)};
}

// The vertex that the interval formula needs last: the vertex that is alone on its side, or a vertex on the line. But a
// vertex on the line must not be last if the other two are on opposite sides.
// Reference: Maffina 2012, section 3.2.3 and figure 3.5.
template <class Real>
GRAZE_HD int vertex_to_put_last(const Real (&distance)[3]) {
  const Real zero(0);
  int positive = 0, negative = 0, first_positive = 2, first_negative = 2, first_zero = 2;
  for (int i = 2; i >= 0; --i) {
    if (distance[i] > zero) {
      ++positive;
      first_positive = i;
    } else if (distance[i] < zero) {
      ++negative;
      first_negative = i;
    } else {
      first_zero = i;
    }
  }
  const int on_line = 3 - positive - negative;
  if (on_line == 0) return positive == 2 ? first_negative : negative == 2 ? first_positive : 2;
  if (on_line == 1 && positive == 1 && negative == 1) return first_zero == 2 ? 0 : 2;
  return on_line == 3 ? 2 : first_zero;
}

// The part of the line within a triangle whose vertices have these signed distances to the other plane.
template <class Real, class Policy>
GRAZE_HD Range<Real> section(const Line<Real>& line, const Vec3<Real> (&v)[3], const Real (&distance)[3],
                             const Policy& policy, int choice) {
  const int last = chosen(policy, choice, vertex_to_put_last(distance));
  Vec3<Real> on_line[3];
  Real d[3];
  for (int i = 0; i < 3; ++i) {
    const int from = i == 2 ? last : i == last ? 2 : i;
    on_line[i] = line.point + line.direction * dot(line.direction, v[from] - line.point);
    d[i] = distance[from];
  }
  Real t[2];
  for (int i = 0; i < 2; ++i) {
    const Real difference = d[i] - d[2];
    const Real share = chosen(policy, choice + 1 + i, difference == Real(0)) ? Real(0) : d[i] / difference;
    t[i] = dot(line.direction, on_line[i] + (on_line[2] - on_line[i]) * share - line.point);
  }
  return t[0] < t[1] ? Range<Real>{t[0], t[1]} : Range<Real>{t[1], t[0]};
}

template <class Real, class Policy>
GRAZE_HD bool contains(const Range<Real>& range, const Real& t, const Policy& policy, int question) {
  return policy.at_most(At(Site::separation, question), range.lo, t) &&
         policy.at_most(At(Site::separation, question + 1), t, range.hi);
}

struct IntervalOverlap {
  static constexpr AlgorithmInfo kInfo{
      "interval_overlap",
      "Maffina 2012, final version (section 3.2), after Moller and Haines",
      "when the normals' cross product is exactly zero: 2D separating axes on the first plane",
      "the text says to handle them first; the published code does not",
      "changes rounding, and the plane onto which coplanar pairs are projected",
      false};

  template <class Real, class Policy = ExactZero>
  GRAZE_HD static Verdict decide(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], const Policy& policy = {}) {
    Real distance_a[3], distance_b[3];
    const Plane<Real> plane_a(a);
    plane_distances(plane_a, b, policy, 0, distance_b);
    if (strictly_one_side(distance_b)) return Verdict::disjoint;

    const Plane<Real> plane_b(b);
    const Vec3<Real> direction = cross(plane_a.normal, plane_b.normal);
    const Real zero(0);
    if (policy.snap(At(Site::parallel, 6), direction.x) == zero &&
        policy.snap(At(Site::parallel, 7), direction.y) == zero &&
        policy.snap(At(Site::parallel, 8), direction.z) == zero) {
      return verdict_of(projections_intersect(a, b, plane_a, policy, 17));
    }

    plane_distances(plane_b, a, policy, 3, distance_a);
    if (strictly_one_side(distance_a)) return Verdict::disjoint;
    const Line<Real> line = common_line(plane_a, plane_b, direction, policy);
    const Range<Real> s = section(line, a, distance_a, policy, 1), t = section(line, b, distance_b, policy, 4);
    return verdict_of(contains(s, t.lo, policy, 9) || contains(s, t.hi, policy, 11) || contains(t, s.lo, policy, 13) ||
                      contains(t, s.hi, policy, 15));
  }

  template <class Questions>
  static void list(Questions& questions) {
    questions.plane_distances();
    for (const char* of : {"direction.x", "direction.y", "direction.z"}) questions.value(Site::parallel, 4, of);
    for (const char* of : {"b.low in a", "b.high in a", "a.low in b", "a.high in b"}) questions.contained(1, of);
    questions.projections(2);
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
