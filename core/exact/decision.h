// SPDX-License-Identifier: Apache-2.0
// The steps of the exact decision: the screen, a shared vertex, and the smallest kind of numbers that holds the pair.
#pragma once

#include "core/exact/axes.h"
#include "core/exact/by_planes.h"
#include "core/exact/numbers.h"
#include "core/exact/results.h"
#include "core/exact/screen.h"
#include "core/exact/shared_vertex.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

// A vertex in the projection that keeps a plane's triangles in shape: along an axis that is not square to its normal.
template <class D>
struct Flat {
  D x, y;
};

template <class D, class M>
GRAZE_HD Flat<D> flatten(const Vec<D>& v, const Vec<M>& n) {
  const bool along_z = !(n.z == M(0)), along_x = !(n.x == M(0));
  return {along_z ? v.x : along_x ? v.y : v.z, along_z ? v.y : along_x ? v.z : v.x};
}

// Whether an edge of p, which turns left or right, has all of q strictly on its other side.
template <class M, class D>
GRAZE_HD bool edge_parts(const Flat<D> (&p)[3], bool left, const Flat<D> (&q)[3]) {
  const M zero(0);
  bool parts = false;
  for (int i = 0; i < 3; ++i) {
    const Flat<D>&from = p[i], &to = p[i == 2 ? 0 : i + 1];
    const D x = to.x - from.x, y = to.y - from.y;
    bool all = true;
    for (const Flat<D>& v : q) {
      const M side = M(x) * (v.y - from.y) - M(y) * (v.x - from.x);
      all = all && (left ? side < zero : side > zero);
    }
    parts = parts || all;
  }
  return parts;
}

// Requires: coplanar triangles with area; n and m are their normals.
template <class Numbers>
GRAZE_HD bool coplanar_meet(const Triangles<Numbers>& t, const NormalOf<Numbers>& n, const NormalOf<Numbers>& m) {
  using M = typename Numbers::M;
  Flat<typename Numbers::D> a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = flatten(t.a[i], n);
    b[i] = flatten(t.b[i], n);
  }
  const M zero(0);
  const M of_a = !(n.z == zero)   ? n.z
                 : !(n.x == zero) ? n.x
                                  : n.y,
          of_b = !(n.z == zero)   ? m.z
                 : !(n.x == zero) ? m.x
                                  : m.y;
  return !edge_parts<M>(a, of_a > zero, b) && !edge_parts<M>(b, of_b > zero, a);
}

// Requires: two segments or points.
template <class Numbers>
GRAZE_HD bool segments_meet(const Triangles<Numbers>& t) {
  using T = typename Numbers::T;
  const auto along = [](const VecOf<Numbers>(&v)[3]) {  // zero of a point
    const VecOf<Numbers> edge = v[1] - v[0], zero = v[0] - v[0];
    return edge.x == zero.x && edge.y == zero.y && edge.z == zero.z ? v[2] - v[0] : edge;
  };
  const NormalOf<Numbers> n = cross<typename Numbers::M>(along(t.a), along(t.b));
  if (!(dot<T>(n, t.b[0] - t.a[0]) == T(0))) return false;
  AxisEvidence seen;
  look_flat<Numbers>(t, n, seen);
  return !seen.separated;
}

// Requires: the numbers hold the pair's grid, which has this exponent.
template <class Numbers>
GRAZE_HD bool decide(const float* a, const float* b, int exponent) {
  const Triangles<Numbers> t = triangles<Numbers>(a, b, exponent);
  const Finding found = by_planes(t);
  if (found == Finding::unsure) return segments_meet(t);
  if (found != Finding::coplanar) return found != Finding::disjoint;
  const NormalOf<Numbers> n = normal<Numbers>(t.a), m = normal<Numbers>(t.b);
  if (!is_zero(n) && !is_zero(m)) return coplanar_meet(t, n, m);
  AxisEvidence seen;  // a segment or a point in the plane of a triangle
  look_flat<Numbers>(t, is_zero(n) ? m : n, seen);
  return !seen.separated;
}

// The decision by planes for pairs that no machine number holds: each determinant in doubles with a bound of its own,
// and those that this leaves open, most of them zeros, in the wide numbers.
// Returns: unsure where all vertices of one lie in the plane of the other.
template <class Numbers>
GRAZE_HD Finding by_planes_one_by_one(const float* a, const float* b, int exponent, Stage& stage) {
  const BoundedNumbers bounded;
  const Numbers exact;
  const Triangles<BoundedNumbers> near = triangles<BoundedNumbers>(a, b);
  Triangles<Numbers> wide;
  const auto widen = [&] {
    if (stage != Numbers::kStage) wide = triangles<Numbers>(a, b, exponent);
    stage = Numbers::kStage;
  };
  const auto settle = [&](Sides& sides, const VecOf<Numbers>(&p)[3], const VecOf<Numbers>(&q)[3]) {
    for (unsigned i = 0; i < 3; ++i) {
      if (((sides.above | sides.below | sides.in) >> i & 1) != 0) continue;
      widen();
      const auto height = determinant<Numbers>(p[0], p[1], p[2], q[i]);
      (exact.positive(height) ? sides.above : exact.negative(height) ? sides.below : sides.in) |= 1u << i;
    }
  };
  Sides of_b = sides(near.a, normal<BoundedNumbers>(near.a), near.b, bounded);
  if (of_b.one_side()) return Finding::disjoint;
  Sides of_a = sides(near.b, normal<BoundedNumbers>(near.b), near.a, bounded);
  if (of_a.one_side()) return Finding::disjoint;
  settle(of_b, wide.a, wide.b);
  settle(of_a, wide.b, wide.a);
  if (of_b.one_side() || of_a.one_side()) return Finding::disjoint;
  if (of_a.in == 7 || of_b.in == 7) return Finding::unsure;

  const Turn turn = lone_vertices(of_a, of_b);
  for (unsigned k = 1; k < 3; ++k) {  // whether an edge of each parts them
    const auto between = [&]<class N>(const Triangles<N>& t, const N&) {
      return k == 1 ? determinant<N>(t.a[turn.a[1]], t.b[turn.b[0]], t.a[turn.a[0]], t.b[turn.b[1]])
                    : determinant<N>(t.a[turn.a[0]], t.b[turn.b[0]], t.a[turn.a[2]], t.b[turn.b[2]]);
    };
    const auto nearly = between(near, bounded);
    if (bounded.positive(nearly)) return Finding::disjoint;
    if (bounded.negative(nearly) || bounded.zero(nearly)) continue;
    widen();
    if (exact.positive(between(wide, exact))) return Finding::disjoint;
  }
  return Finding::intersects;
}

// The decision of pairs of which the screen is unsure.
GRAZE_HD inline bool decide_unsure(const float* a, const float* b, Stage& stage) {
  stage = Stage::bounded;
  if (shared_vertex(a, b) >= 0) return true;
  const Grid grid = grid_of(a, b);
  const auto decide_in = [&](auto numbers) {
    using Numbers = decltype(numbers);
    stage = Numbers::kStage;
    return decide<Numbers>(a, b, grid.exponent);
  };
  if (MachineNumbers::hold(grid)) return MachineNumbers::visit(grid, decide_in);
  const Finding found = MultiwordNumbers::visit(
      grid, [&](auto numbers) { return by_planes_one_by_one<decltype(numbers)>(a, b, grid.exponent, stage); });
  return found == Finding::unsure ? MultiwordNumbers::visit(grid, decide_in) : found != Finding::disjoint;
}

// The relation of a pair in general position of which a decision by planes found so much.
// Returns: false when that does not tell it.
GRAZE_HD inline bool relation_of(Finding found, const float* a, const float* b, Relation& r) {
  r = found == Finding::crosses ? Relation{true, 1, -1, 2, 2, false} : Relation{};
  // A determinant that is certainly not zero parts them: they are not coplanar.
  return found == Finding::crosses || (found == Finding::disjoint && both_proper(a, b));
}

// The relation of pairs in general position: they cross, a plane or an edge of both parts them, or they share a vertex.
// Returns: false when that is not beyond doubt.
GRAZE_HD inline bool relate_quickly(const float* a, const float* b, Relation& r) {
  const Finding found = screen(a, b);
  if (found == Finding::unsure) {
    const int shared = shared_vertex(a, b);
    return shared >= 0 && relate_at_vertex(a, b, shared, r);
  }
  return relation_of(found, a, b, r);
}

// The same where each determinant has a bound of its own: less is in doubt.
GRAZE_HD inline bool relate_by_bounds(const float* a, const float* b, Relation& r) {
  return relation_of(by_planes(triangles<BoundedNumbers>(a, b)), a, b, r);
}

}  // namespace graze::exact::detail
