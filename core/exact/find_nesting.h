// SPDX-License-Identifier: Apache-2.0
// Finds which triangle lies inside the other, from the signs of determinants in one kind of numbers.
#pragma once

#include "core/exact/decision.h"
#include "core/exact/nesting.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

enum class Answer { no, yes, unknown };

// Whether the line crosses the triangle q: it passes no two of q's edges on different sides.
template <class Numbers>
GRAZE_HD Answer line_crosses(const VecOf<Numbers>& from, const VecOf<Numbers>& to, const VecOf<Numbers> (&q)[3],
                             const Numbers& numbers) {
  bool left = false, right = false, open = false;
  for (int i = 0; i < 3; ++i) {
    const auto side = determinant<Numbers>(from, to, q[i], q[i == 2 ? 0 : i + 1]);
    const bool positive = numbers.positive(side), negative = numbers.negative(side);
    left = left || positive;
    right = right || negative;
    open = open || !(positive || negative || numbers.zero(side));
  }
  return left && right ? Answer::no : open ? Answer::unknown : Answer::yes;
}

// Whether the part of p in q's plane lies in q. That part ends where edges of p reach the plane.
// Requires: p reaches the plane of q and does not lie in it.
template <class Numbers>
GRAZE_HD Answer cut_inside(const VecOf<Numbers> (&p)[3], const Sides& of_p, const VecOf<Numbers> (&q)[3],
                           const Numbers& numbers) {
  Answer answer = Answer::yes;
  for (int i = 0; i < 3; ++i) {
    const int j = i == 2 ? 0 : i + 1;
    const unsigned ends = 1u << i | 1u << j;
    if ((of_p.above & ends) == ends || (of_p.below & ends) == ends || (of_p.in & ends) == ends) continue;
    const Answer here = line_crosses(p[i], p[j], q, numbers);
    if (here == Answer::no) return here;
    if (here == Answer::unknown) answer = here;
  }
  return answer;
}

// Requires: two proper triangles that are not coplanar and meet in a segment.   Returns: whether the nesting is known.
template <class Numbers>
GRAZE_HD bool nesting_in_space(const Triangles<Numbers>& t, Nesting& nesting, const Numbers& numbers = {}) {
  const Sides of_b = sides(t.a, normal<Numbers>(t.a), t.b, numbers);
  const Sides of_a = sides(t.b, normal<Numbers>(t.b), t.a, numbers);
  if (!of_a.known() || !of_b.known()) return false;
  const Answer a = cut_inside(t.a, of_a, t.b, numbers), b = cut_inside(t.b, of_b, t.a, numbers);
  nesting = a == b ? Nesting::none : a == Answer::yes ? Nesting::a_in_b : Nesting::b_in_a;
  return a != Answer::unknown && b != Answer::unknown;
}

// Whether p lies in q, which may be a segment or a point. p lies in q if, in each projection, no two edges of q have p
// on different sides, and p lies in the box of q.   Requires: one plane holds q and p; exact numbers.
template <class Numbers>
GRAZE_HD bool lies_in(const VecOf<Numbers>& p, const VecOf<Numbers> (&q)[3]) {
  using D = typename Numbers::D;
  bool inside = true;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Flat<D> at = flatten(p, axis), v[3] = {flatten(q[0], axis), flatten(q[1], axis), flatten(q[2], axis)};
    bool left = false, right = false;
    for (int i = 0; i < 3; ++i) {
      const Flat<D>&from = v[i], &to = v[i == 2 ? 0 : i + 1];
      const int side = sign_of_minor<Numbers>(to.x - from.x, at.y - from.y, to.y - from.y, at.x - from.x);
      left = left || side > 0;
      right = right || side < 0;
    }
    const D coordinate = component(p, axis),
            of_q[3] = {component(q[0], axis), component(q[1], axis), component(q[2], axis)};
    inside = inside && !(left && right) && !(coordinate < least(of_q)) && !(coordinate > most(of_q));
  }
  return inside;
}

// Requires: one plane holds both triangles; exact numbers.
template <class Numbers>
GRAZE_HD Nesting nesting_in_plane(const Triangles<Numbers>& t) {
  bool a = true, b = true;
  for (int i = 0; i < 3; ++i) {
    a = a && lies_in<Numbers>(t.a[i], t.b);
    b = b && lies_in<Numbers>(t.b[i], t.a);
  }
  return a && b ? Nesting::same : a ? Nesting::a_in_b : b ? Nesting::b_in_a : Nesting::none;
}

// Whether pairs with this relation can be nested.
GRAZE_HD constexpr bool may_nest(const Relation& r) {
  return r.intersects() && (r.hulls.coplanar || (r.contact == Contact::segment && r.hulls == Hulls{2, 2, false}));
}

// Requires: the numbers are exact and hold the pair; r is its relation.
template <class Numbers>
GRAZE_HD Nesting nesting(const Triangles<Numbers>& t, const Relation& r) {
  Nesting result = Nesting::none;
  if (!may_nest(r)) return result;
  if (r.hulls.coplanar) return nesting_in_plane(t);
  nesting_in_space(t, result);
  return result;
}

// Like nesting, but in doubles with error bounds.
// Requires: floats, or doubles on a moderate grid.   Returns: false if rounding leaves the nesting in doubt.
template <class Real>
GRAZE_HD bool nesting_quickly(const Real* a, const Real* b, const Relation& r, Nesting& nesting) {
  nesting = Nesting::none;
  if (!may_nest(r)) return true;
  return !r.hulls.coplanar && nesting_in_space(triangles<BoundedNumbers>(a, b), nesting);
}

}  // namespace graze::exact::detail
