// SPDX-License-Identifier: Apache-2.0
// Pairs of special triangles: slivers, degenerate triangles, and mesh neighbours that share vertices bit for bit.
#pragma once

#include "strata/contact.h"

namespace graze::strata {
inline namespace GRAZE_FP {

// The ratio of length to height is log-uniform in 2^10 … 2^23 (doubles: 2^51).
GRAZE_HD inline Shape draw_sliver_shape(auto& draws) {
  const double fraction = 0.5 + 0.5 * draws.positive();
  return {fraction * power_of_two(-draws.between(10, draws.kSliver)), true, draws.coin()};
}

GRAZE_HD inline auto sliver(auto& draws) {
  const Touch touch = draw_touch(draws);
  const Shape shape = draw_sliver_shape(draws);
  const std::uint32_t which = draws.below(3);  // the sliver is A, B or both
  return near_contact(draws, touch, which != 1 ? shape : Shape{}, which != 0 ? shape : Shape{});
}

// A segment along e that contains p or starts at p. The third vertex is an end of the segment, or exactly on its line.
GRAZE_HD inline void put_segment(auto& draws, const auto& grain, const Vec& p, const Vec& e, Vec (&triangle)[3]) {
  const double back = draws.coin() ? draw_weight(draws, grain) : 0;
  const double forth = draw_weight(draws, grain);
  triangle[0] = p - e * back;
  triangle[1] = p + e * forth;
  triangle[2] = triangle[draws.below(2)];
  if (draws.coin()) triangle[2] = p + e * double(draws.integer(grain.weight));
}

GRAZE_HD inline void put_point(const Vec& p, Vec (&triangle)[3]) { triangle[0] = triangle[1] = triangle[2] = p; }

// B is a segment or a point; A may also be a proper triangle. Both A and B contain a point p; in half of the pairs, B
// is then moved by one unit. Coordinates are integers, small or wide, so a segment's vertices are exactly collinear. At
// the end, the pair is scaled by a power of two.
GRAZE_HD inline auto degenerate(auto& draws) {
  const auto grain = draws.coin() ? small_grain(draws) : wide_grain(draws);
  const Vec p = draw_place(draws, grain);
  const Vec u = draw_step(draws, grain);
  const Vec v = draw_step(draws, grain);
  Draft draft;
  switch (draws.below(5)) {
    case 0:
      put_point(p, draft.a);
      break;
    case 1:
      put_segment(draws, grain, p, u, draft.a);
      break;
    case 2:
      put_vertex(draws, grain, {}, p, v, draft.a);
      break;
    case 3:
      put_edge(draws, grain, {}, p, u, v, draft.a);
      break;
    default:
      put_face(draws, grain, p, u, v, draft.a);
      break;
  }
  if (draws.below(4) == 0) {
    put_point(p, draft.b);
  } else {
    const Vec fresh = draw_step(draws, grain);
    // A segment along u is collinear with A's segment, along A's edge, or in the plane of A's face.
    put_segment(draws, grain, p, draws.below(3) == 0 ? u : fresh, draft.b);
  }
  if (draws.coin()) {
    const double unit = draws.sign();
    move(draft.b, unit_axis(draws.between(0, 2)) * unit);
  }
  scale(draft, power_of_two(-draws.between(0, draws.kBits)));
  return shuffled(draws, rounded(draws, draft));
}

// How far the neighbour's free vertices are from the first triangle's plane. Integers (exact): in the plane, or one
// unit off it in one coordinate. Reals: in the plane, or off it by 1 … 2^-30 (doubles: 2^-90) before rounding.
struct Fold {
  bool exact;
  Vec p, u, v;  // A is p, p + u, p + v
  double lift;
};

GRAZE_HD inline Fold draw_fold(auto& draws) {
  Fold fold;
  fold.exact = draws.coin();
  const auto grain = fold.exact ? wide_grain(draws) : real_grain(draws);
  fold.p = draw_place(draws, grain);
  fold.u = draw_step(draws, grain);
  fold.v = draw_step(draws, grain);
  fold.lift = power_of_two(fold.exact ? 0 : -draws.between(0, draws.kGap - 10));
  if (draws.coin()) fold.lift = 0;
  return fold;
}

// A point near p in A's plane, lifted by ±fold.lift. If the point is on the far side of the common edge, the triangles
// lie side by side; on A's side, they are folded onto each other.
GRAZE_HD inline Vec draw_free_vertex(auto& draws, const Fold& fold) {
  const double i = fold.exact ? draws.integer(8) : draws.real();
  const double j = fold.exact ? draws.integer(8) : draws.real();
  const Vec direction = fold.exact ? unit_axis(draws.between(0, 2)) : normalised(cross(fold.u, fold.v));
  return fold.p + fold.u * i + fold.v * j + direction * (fold.lift * draws.sign());
}

GRAZE_HD inline auto shared_vertex(auto& draws) {
  const Fold fold = draw_fold(draws);
  Draft draft{{fold.p, fold.p + fold.u, fold.p + fold.v}, {fold.p, {}, {}}};
  draft.b[1] = draw_free_vertex(draws, fold);
  draft.b[2] = draw_free_vertex(draws, fold);
  return shuffled(draws, rounded(draws, draft));
}

GRAZE_HD inline auto shared_edge(auto& draws) {
  const Fold fold = draw_fold(draws);
  Draft draft{{fold.p, fold.p + fold.u, fold.p + fold.v}, {fold.p, fold.p + fold.u, {}}};
  draft.b[2] = draw_free_vertex(draws, fold);
  return shuffled(draws, rounded(draws, draft));
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
