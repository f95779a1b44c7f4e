// SPDX-License-Identifier: Apache-2.0
// Steps of the exact decision: the filter, a shared vertex, and the smallest kind of numbers that holds the pair.
#pragma once

#include "core/exact/by_planes.h"
#include "core/exact/filter.h"
#include "core/exact/numbers.h"
#include "core/exact/relation.h"
#include "core/exact/shared_vertex.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

// An axis not perpendicular to the normal of a plane: projected along it, triangles in the plane do not collapse.
template <class M>
GRAZE_HD unsigned axis_to_drop(const Vec<M>& n) {
  return !(n.z == M(0)) ? 2 : !(n.x == M(0)) ? 0 : 1;
}

template <class T>
GRAZE_HD T component(const Vec<T>& v, unsigned axis) {
  return pick(v.x, v.y, v.z, axis);
}

// A vertex projected along an axis. A triangle turns left if its normal's component along the axis is positive.
template <class D>
struct Flat {
  D x, y;
};

template <class D>
GRAZE_HD Flat<D> flatten(const Vec<D>& v, unsigned axis) {
  return {component(v, axis == 2 ? 0 : axis + 1), component(v, axis == 0 ? 2 : axis - 1)};
}

// Whether some edge of p has all of q strictly on its outer side. `left` tells which way p turns. A segment has edges
// in both directions, so for a segment either value works.
template <class Numbers, class D>
GRAZE_HD bool edge_parts(const Flat<D> (&p)[3], bool left, const Flat<D> (&q)[3]) {
  bool parts = false;
  for (int i = 0; i < 3; ++i) {
    const Flat<D>&from = p[i], &to = p[i == 2 ? 0 : i + 1];
    const D x = to.x - from.x, y = to.y - from.y;
    bool all = true;
    for (const Flat<D>& v : q) {
      const int side = sign_of_minor<Numbers>(x, v.y - from.y, y, v.x - from.x);
      all = all && (left ? side < 0 : side > 0);
    }
    parts = parts || all;
  }
  return parts;
}

// Requires: all vertices lie in a plane with normal n; two segments are not parallel. of_a and of_b are the normals of
// a and b; for a segment, they are arbitrary.
template <class Numbers>
GRAZE_HD bool meet_in_plane(const Triangles<Numbers>& t, const NormalOf<Numbers>& n, const NormalOf<Numbers>& of_a,
                            const NormalOf<Numbers>& of_b) {
  const unsigned axis = axis_to_drop(n);
  Flat<typename Numbers::D> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = flatten(t.a[i], axis);
    b[i] = flatten(t.b[i], axis);
  }
  const typename Numbers::M zero(0);
  return !edge_parts<Numbers>(a, component(of_a, axis) > zero, b) &&
         !edge_parts<Numbers>(b, component(of_b, axis) > zero, a);
}

// Requires: both triangles are segments or points.
template <class Numbers>
GRAZE_HD bool segments_meet(const Triangles<Numbers>& t) {
  using M = typename Numbers::M;
  const auto same = [](const VecOf<Numbers>& u, const VecOf<Numbers>& v) {
    return u.x == v.x && u.y == v.y && u.z == v.z;
  };
  const auto along = [&](const VecOf<Numbers>(&v)[3]) {
    return same(v[1], v[0]) ? v[2] - v[0] : v[1] - v[0];
  };  // zero for a point
  const VecOf<Numbers> of_a = along(t.a), of_b = along(t.b), between = t.b[0] - t.a[0];
  const NormalOf<Numbers> n = cross<M>(of_a, of_b);
  if (!is_zero(n)) return dot<typename Numbers::T>(n, between) == typename Numbers::T(0) && meet_in_plane(t, n, n, n);
  // The segments are parallel, or one is a point. On one line, they meet if their ranges overlap in each coordinate.
  const bool a_is_point = same(t.a[1], t.a[0]) && same(t.a[2], t.a[0]);
  if (!is_zero(cross<M>(a_is_point ? of_b : of_a, between))) return false;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const typename Numbers::D a[3] = {component(t.a[0], axis), component(t.a[1], axis), component(t.a[2], axis)},
                              b[3] = {component(t.b[0], axis), component(t.b[1], axis), component(t.b[2], axis)};
    if (most(a) < least(b) || most(b) < least(a)) return false;
  }
  return true;
}

// Requires: the numbers hold the pair's grid, which has this exponent.
template <class Numbers, class Real>
GRAZE_HD bool decide(const Real* a, const Real* b, int exponent) {
  const Triangles<Numbers> t = triangles<Numbers>(a, b, exponent);
  const Finding found = by_planes(t);
  if (found == Finding::unsure) return segments_meet(t);
  if (found != Finding::coplanar) return found != Finding::disjoint;
  const NormalOf<Numbers> n = normal<Numbers>(t.a), m = normal<Numbers>(t.b);
  return meet_in_plane(t, is_zero(n) ? m : n, n, m);
}

// The decision by planes for pairs that do not fit in machine numbers. Each determinant is first computed in `Near`
// numbers, with its own bound. If its sign remains unknown, usually because it is zero, exact numbers compute it.
// Returns: unsure if all vertices of one triangle lie in the plane of the other.
template <class Near, class Numbers, class Real>
GRAZE_HD Finding by_planes_one_by_one(const Real* a, const Real* b, int exponent, Stage& stage) {
  const Near bounded;
  const Numbers exact;
  const Triangles<Near> near = triangles<Near>(a, b);
  const PlaceOf<Real> place = place_of<Real>(exponent);
  const auto exactly = [&](const Vec<Real>& o, const Vec<Real>& q, const Vec<Real>& r, const Vec<Real>& s) {
    stage = Numbers::kStage;
    return determinant<Numbers>(on_grid<Numbers>(o, place), on_grid<Numbers>(q, place), on_grid<Numbers>(r, place),
                                on_grid<Numbers>(s, place));
  };
  const auto settle = [&](Sides& sides, const Real* p, const Real* q) {
    for (unsigned open = 7 & ~(sides.above | sides.below | sides.in); open != 0; open &= open - 1) {
      const unsigned bit = open & (0 - open);
      const auto height = exactly(vertex(p, 0), vertex(p, 1), vertex(p, 2), vertex(q, bit >> 1));
      (exact.positive(height) ? sides.above : exact.negative(height) ? sides.below : sides.in) |= bit;
    }
  };
  Sides of_b = sides(near.a, normal<Near>(near.a), near.b, bounded);
  if (of_b.one_side()) return Finding::disjoint;
  Sides of_a = sides(near.b, normal<Near>(near.b), near.a, bounded);
  if (of_a.one_side()) return Finding::disjoint;
  settle(of_b, a, b);
  if (of_b.one_side()) return Finding::disjoint;
  settle(of_a, b, a);
  if (of_a.one_side()) return Finding::disjoint;
  if (of_a.in == 7 || of_b.in == 7) return Finding::unsure;

  const Turn turn = lone_vertices(of_a, of_b);
  for (unsigned k = 1; k < 3; ++k) {  // tests whether an edge of each triangle separates the pair
    const unsigned o = k == 1 ? turn.a[1] : turn.a[0], r = k == 1 ? turn.a[0] : turn.a[2],
                   s = k == 1 ? turn.b[1] : turn.b[2];
    const auto nearly = determinant<Near>(pick(near.a, o), pick(near.b, turn.b[0]), pick(near.a, r), pick(near.b, s));
    if (bounded.positive(nearly)) return Finding::disjoint;
    if (bounded.negative(nearly) || bounded.zero(nearly)) continue;
    if (exact.positive(exactly(vertex(a, o), vertex(b, turn.b[0]), vertex(a, r), vertex(b, s))))
      return Finding::disjoint;
  }
  return Finding::intersects;
}

// Decides a pair that the filter could not decide.
template <class Real>
GRAZE_HD bool decide_unsure(const Real* a, const Real* b, Stage& stage) {
  using Machine = typename KindsFor<Real>::Machine;
  using Multiword = typename KindsFor<Real>::Multiword;
  stage = Stage::bounded;
  if (shared_vertex(a, b) >= 0) return true;
  const Grid grid = grid_of(a, b);
  const auto decide_in = [&](auto numbers) {
    using Numbers = decltype(numbers);
    stage = Numbers::kStage;
    return decide<Numbers>(a, b, grid.exponent);
  };
  if (Machine::hold(grid)) return Machine::visit(grid, decide_in);
  if (sizeof(Real) > sizeof(float) && !is_moderate(grid)) return Multiword::visit(grid, decide_in);
  const Finding found = Multiword::visit(grid, [&](auto numbers) {
    return by_planes_one_by_one<BoundedNumbers, decltype(numbers)>(a, b, grid.exponent, stage);
  });
  return found == Finding::unsure ? Multiword::visit(grid, decide_in) : found != Finding::disjoint;
}

// The relation of a pair in general position, given the finding of a decision by planes.
// Returns: false if the finding does not determine it.
template <class Real>
GRAZE_HD bool relation_of(Finding found, const Real* a, const Real* b, Relation& r) {
  r = found == Finding::crosses ? Relation{Verdict::intersects, Contact::segment, -1, {}} : Relation{};
  // If proper triangles are found disjoint, a determinant is nonzero, so the triangles are not coplanar.
  return found == Finding::crosses || (found == Finding::disjoint && both_proper(a, b));
}

// The relation of a pair in general position: the triangles cross, share a vertex, or are separated by the plane of one
// of them or by a plane along an edge of each.   Returns: false if rounding leaves the relation in doubt.
template <class Real>
GRAZE_HD bool relate_quickly(const Real* a, const Real* b, Relation& r) {
  const Finding found = filter(a, b);
  if (found == Finding::unsure) {
    const int shared = shared_vertex(a, b);
    return shared >= 0 && relate_at_vertex(a, b, shared, r);
  }
  return relation_of(found, a, b, r);
}

// Like relate_quickly, but without shared vertices. Each determinant has its own bound, so fewer pairs are in doubt.
// Requires: floats, or doubles on a moderate grid.
template <class Real>
GRAZE_HD bool relate_by_bounds(const Real* a, const Real* b, Relation& r) {
  return relation_of(by_planes(triangles<BoundedNumbers>(a, b)), a, b, r);
}

}  // namespace graze::exact::detail
