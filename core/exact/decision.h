// SPDX-License-Identifier: Apache-2.0
// The steps of the exact decision: the screen, a shared vertex, and the smallest kind of numbers that holds the pair.
#pragma once

#include "core/exact/by_axes.h"
#include "core/exact/by_planes.h"
#include "core/exact/numbers.h"
#include "core/exact/results.h"
#include "core/exact/screen.h"
#include "core/exact/shared_vertex.h"
#include "core/exact/triangles.h"

namespace graze::exact::detail {

// Requires: the numbers hold the pair's grid, which has this exponent.
template <class Numbers>
GRAZE_HD bool decide(const float* a, const float* b, int exponent) {
  const Triangles<Numbers> t = triangles<Numbers>(a, b, exponent);
  const Finding found = by_planes(t);
  if (found == Finding::unsure) return !look<Numbers>(t, true).separated;
  if (found != Finding::coplanar) return found != Finding::disjoint;
  const NormalOf<Numbers> n = normal<Numbers>(t.a);
  AxisEvidence seen;
  look_flat<Numbers>(t, is_zero(n) ? normal<Numbers>(t.b) : n, seen);
  return !seen.separated;
}

// The decision of pairs of which the screen is unsure. Wide integers only after a tighter bound of each determinant.
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
  const Finding found = by_planes(triangles<BoundedNumbers>(a, b));
  return found == Finding::unsure ? MultiwordNumbers::visit(grid, decide_in) : found != Finding::disjoint;
}

// The relation of pairs in general position: they cross, a plane or an edge of both parts them, or they share a vertex.
// Returns: false when that is not beyond doubt.
GRAZE_HD inline bool relate_quickly(const float* a, const float* b, Relation& r) {
  const Finding found = screen(a, b);
  if (found == Finding::unsure) {
    const int shared = shared_vertex(a, b);
    return shared >= 0 && relate_at_vertex(a, b, shared, r);
  }
  r = found == Finding::crosses ? Relation{true, 1, -1, 2, 2, false} : Relation{};
  // A determinant that is certainly not zero parts them: they are not coplanar.
  return found == Finding::crosses || (found == Finding::disjoint && both_proper(a, b));
}

}  // namespace graze::exact::detail
