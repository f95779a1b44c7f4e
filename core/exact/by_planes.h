// SPDX-License-Identifier: Apache-2.0
// The decision by planes, for pairs in general position: the sides of the vertices, then two orientations.
// Reference: Guigue and Devillers 2003.
#pragma once

#include "core/exact/sides.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

// The sides of q's vertices relative to the plane of p, whose normal is n.
template <class Numbers>
GRAZE_HD Sides sides(const VecOf<Numbers> (&p)[3], const NormalOf<Numbers>& n, const VecOf<Numbers> (&q)[3],
                     const Numbers& numbers) {
  Sides s;
  for (unsigned i = 0; i < 3; ++i) {
    const auto height = dot<typename Numbers::T>(n, q[i] - p[0]);
    s.above |= unsigned{numbers.positive(height)} << i;
    s.below |= unsigned{numbers.negative(height)} << i;
    s.in |= unsigned{numbers.zero(height)} << i;
  }
  return s;
}

// (s - o) . ((q - o) x (r - o)).
template <class Numbers>
GRAZE_HD typename Numbers::T determinant(const VecOf<Numbers>& o, const VecOf<Numbers>& q, const VecOf<Numbers>& r,
                                         const VecOf<Numbers>& s) {
  return dot<typename Numbers::T>(cross<typename Numbers::M>(q - o, r - o), s - o);
}

// Whether the line of a segment p crosses triangle q, which is proper. p has vertices on both sides of q's plane, or in
// the plane and on one side. The line crosses q if it passes no two of q's edges on different sides.
template <class Numbers>
GRAZE_HD Finding by_line(const VecOf<Numbers> (&p)[3], const Sides& of_p, const VecOf<Numbers> (&q)[3],
                         const Numbers& numbers) {
  const unsigned first = of_p.above != 0 ? of_p.above : of_p.in, second = of_p.below != 0 ? of_p.below : of_p.in;
  const VecOf<Numbers> from = pick(p, first & 1   ? 0
                                      : first & 2 ? 1
                                                  : 2),
                       to = pick(p, second & 1   ? 0
                                    : second & 2 ? 1
                                                 : 2);
  bool left = false, right = false;
  for (int i = 0; i < 3; ++i) {
    const auto side = determinant<Numbers>(from, to, q[i], q[i == 2 ? 0 : i + 1]);
    left = left || numbers.positive(side);
    right = right || numbers.negative(side);
  }
  return left && right ? Finding::disjoint : Finding::intersects;
}

// Returns unsure if neither triangle has a plane, and for coplanar pairs if the numbers round.
template <class Numbers>
GRAZE_HD Finding by_planes(const Triangles<Numbers>& t, const Numbers& numbers = {}) {
  const NormalOf<Numbers> normal_a = normal<Numbers>(t.a);
  const Sides of_b = sides(t.a, normal_a, t.b, numbers);
  if (of_b.one_side()) return Finding::disjoint;
  if (of_b.in == 7 && numbers.is_proper(normal_a)) return Finding::coplanar;
  const NormalOf<Numbers> normal_b = normal<Numbers>(t.b);
  const Sides of_a = sides(t.b, normal_b, t.a, numbers);
  if (of_a.one_side()) return Finding::disjoint;
  if (!of_a.known() || !of_b.known()) return Finding::unsure;
  if (of_a.in == 7 && numbers.is_proper(normal_b)) return Finding::coplanar;
  if (of_b.in == 7 && numbers.is_proper(normal_b)) return by_line(t.a, of_a, t.b, numbers);  // a is a segment
  if (of_a.in == 7 && numbers.is_proper(normal_a)) return by_line(t.b, of_b, t.a, numbers);
  if (of_a.in == 7 || of_b.in == 7) return Finding::unsure;

  const Turn turn = lone_vertices(of_a, of_b);
  const VecOf<Numbers> a0 = pick(t.a, turn.a[0]), b0 = pick(t.b, turn.b[0]);
  const auto first = determinant<Numbers>(pick(t.a, turn.a[1]), b0, a0, pick(t.b, turn.b[1]));
  const auto second = determinant<Numbers>(a0, b0, pick(t.a, turn.a[2]), pick(t.b, turn.b[2]));
  if (numbers.positive(first) || numbers.positive(second)) return Finding::disjoint;
  if (numbers.negative(first) && numbers.negative(second)) {
    return (of_a.in | of_b.in) == 0 ? Finding::crosses : Finding::intersects;
  }
  const bool known =
      (numbers.negative(first) || numbers.zero(first)) && (numbers.negative(second) || numbers.zero(second));
  return known ? Finding::intersects : Finding::unsure;
}

}  // namespace graze::exact::detail
