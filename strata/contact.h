// SPDX-License-Identifier: Apache-2.0
// Builds pairs around a point of contact. A feature (vertex, edge or face) of each triangle contains the point. The
// rest of A lies on one side, and the rest of B on the other. With real coordinates, rounding turns the contact into a
// near contact; with integer coordinates, it stays exact.
#pragma once

#include "strata/draws.h"

namespace graze::strata {
inline namespace GRAZE_FP {

// The ranges of a contact's numbers. Neither double nor float32 ever rounds the integers, because
// place + 2 * weight * step <= 2^bits, where bits is wide_bits() of the draws.
template <class D>
struct Grain {
  typename D::Integer place;  // integers: the contact lies within ±place; reals: 0, and the contact lies within ±1/2
  typename D::Integer step;   // steps (the vectors that weights multiply) lie within ±step; reals: ±1
  int weight;                 // weights are 1 … weight; reals: (0, 1]
};

// Grains are functions, because device code cannot refer to constants of class type.
template <class D>
GRAZE_INLINE Grain<D> real_grain(const D&) {
  return {0, 0, 0};
}
template <class D>
GRAZE_INLINE Grain<D> small_grain(const D&) {
  return {4, 2, 3};
}

// Coordinates of float32 use all 24 bits, so products of three differences need 60 to 75 bits. Coordinates of doubles
// use 16 to 53 bits.
template <class D>
GRAZE_INLINE Grain<D> wide_grain(D& draws) {
  using Integer = typename D::Integer;
  const int bits = draws.wide_bits();
  return {(Integer{1} << (bits - 1)) - 2, Integer{1} << draws.between(bits - 10, bits - 5), 8};
}

GRAZE_INLINE Vec draw_place(auto& draws, const auto& grain) {
  return grain.place > 0 ? draws.integers(grain.place) : draws.reals() * 0.5;
}
GRAZE_INLINE Vec draw_step(auto& draws, const auto& grain) {
  return grain.place > 0 ? draws.integers(grain.step) : draws.reals();
}
GRAZE_INLINE Vec draw_arm(auto& draws, const auto& grain) {
  return grain.place > 0 ? draws.integers(grain.step * grain.weight) : draws.reals();
}
GRAZE_INLINE double draw_weight(auto& draws, const auto& grain) {
  return grain.place > 0 ? 1.0 + draws.below(static_cast<std::uint32_t>(grain.weight)) : draws.positive();
}

// How flat a triangle is. A sliver's height is a small fraction of its length. A sliver's third vertex is near an end
// of the longest edge (needle) or anywhere along that edge (cap).
struct Shape {
  double height = 1;
  bool sliver = false;
  bool needle = false;
};

// The third vertex, relative to p, on the given side; for a sliver, close to the edge from e * low to e * high.
GRAZE_INLINE Vec draw_third(auto& draws, const auto& grain, const Shape& shape, const Vec& side, const Vec& e,
                            double low, double high) {
  const Vec arm = toward(side, draw_arm(draws, grain));
  if (!shape.sliver) return arm;
  const double foot = shape.needle ? high : low + draws.positive() * (high - low);
  return e * foot + arm * shape.height;
}

// A triangle whose vertex [0] is p.
GRAZE_INLINE void put_vertex(auto& draws, const auto& grain, const Shape& shape, const Vec& p, const Vec& side,
                             Vec (&triangle)[3]) {
  const Vec arm = toward(side, draw_arm(draws, grain));
  triangle[0] = p;
  triangle[1] = p + arm;
  triangle[2] = p + draw_third(draws, grain, shape, side, arm, 0, 1);
}

// A triangle whose edge [0][1] passes through p in the direction of e.
GRAZE_INLINE void put_edge(auto& draws, const auto& grain, const Shape& shape, const Vec& p, const Vec& e,
                           const Vec& side, Vec (&triangle)[3]) {
  const double back = draw_weight(draws, grain);
  const double forth = draw_weight(draws, grain);
  triangle[0] = p - e * back;
  triangle[1] = p + e * forth;
  triangle[2] = p + draw_third(draws, grain, shape, side, e, -back, forth);
}

// A triangle that contains p, in the plane of s and t: w0 * (a0 - p) + w1 * (a1 - p) + w2 * (a2 - p) = 0.
GRAZE_INLINE void put_face(auto& draws, const auto& grain, const Vec& p, const Vec& s, const Vec& t,
                           Vec (&triangle)[3]) {
  const double w0 = draw_weight(draws, grain);
  const double w1 = draw_weight(draws, grain);
  const double w2 = draw_weight(draws, grain);
  triangle[0] = p + s * w1 - t * w2;
  triangle[1] = p - s * w0;
  triangle[2] = p + t * w0;
}

enum class Touch { vertex_face, edge_edge, vertex_edge, vertex_vertex };

// Two triangles that meet only at p before rounding. The touching feature of B includes b[0].
struct Contact {
  Draft draft;
  Vec p;
  Vec away;  // the direction that separates B from A; its largest component is ±1
};

// Real coordinates stay within ±5/2.
GRAZE_INLINE Contact draw_contact(auto& draws, Touch touch, const auto& grain, const Shape& shape_a = {},
                                  const Shape& shape_b = {}) {
  Contact contact;
  const Vec p = draw_place(draws, grain);
  const Vec u = draw_step(draws, grain);
  Vec v = draw_step(draws, grain);
  if (touch == Touch::vertex_face && shape_a.sliver) {
    const double ratio = shape_a.needle ? -1 : draws.positive();
    v = u * ratio + v * shape_a.height;
  }
  // u is along A's edge and v along B's edge, or both span A's face. If a vertex touches an edge, the separating
  // direction may be any perpendicular to that edge; if two vertices touch, it may be any direction.
  const Vec away = normalised(touch == Touch::vertex_vertex ? v : cross(u, v));
  const Vec back = away * -1.0;
  if (touch == Touch::vertex_face) {
    put_face(draws, grain, p, u, v, contact.draft.a);
  } else if (touch == Touch::vertex_vertex) {
    put_vertex(draws, grain, shape_a, p, back, contact.draft.a);
  } else {
    put_edge(draws, grain, shape_a, p, u, back, contact.draft.a);
  }
  if (touch == Touch::edge_edge) {
    put_edge(draws, grain, shape_b, p, v, away, contact.draft.b);
  } else {
    put_vertex(draws, grain, shape_b, p, away, contact.draft.b);
  }
  contact.p = p;
  contact.away = away;
  return contact;
}

// Moves B away from the contact or into A. Half of the pushes are gaps of ±2^-1 … ±2^-40 of the triangles' size
// (doubles: ±2^-100), applied before rounding. The other half move one coordinate of b[0] by 0 … ±8 ulps after
// rounding.
struct Push {
  double gap;
  int axis;
  int ulps;
};

GRAZE_INLINE Push draw_push(auto& draws) {
  if (draws.coin()) {
    const double sign = draws.sign();
    return {sign * power_of_two(-draws.between(1, draws.kGap)), 0, 0};
  }
  return {0, draws.between(0, 2), draws.integer(8)};
}

// Rounds the draft, moves b[0] by the push's ulps, and shuffles.
GRAZE_INLINE auto finished(auto& draws, const Draft& draft, const Push& push) {
  auto pair = rounded(draws, draft);
  auto& v = pair.b[0];
  v = {push.axis == 0 ? nudged(v.x, push.ulps) : v.x, push.axis == 1 ? nudged(v.y, push.ulps) : v.y,
       push.axis == 2 ? nudged(v.z, push.ulps) : v.z};
  return shuffled(draws, pair);
}

GRAZE_INLINE auto near_contact(auto& draws, Touch touch, const Shape& shape_a = {}, const Shape& shape_b = {}) {
  Contact contact = draw_contact(draws, touch, real_grain(draws), shape_a, shape_b);
  const Push push = draw_push(draws);
  move(contact.draft.b, contact.away * push.gap);
  return finished(draws, contact.draft, push);
}

GRAZE_INLINE Touch draw_touch(auto& draws) { return static_cast<Touch>(draws.below(4)); }

// Half of the pairs touch exactly. In the other half, one coordinate of b[0] is one unit too large or too small.
GRAZE_INLINE auto exact_contact(auto& draws) {
  const Touch touch = static_cast<Touch>(draws.below(3));  // the stratum shared_vertex draws equal vertices
  const auto grain = wide_grain(draws);
  Contact contact = draw_contact(draws, touch, grain);
  if (draws.coin()) {
    const double unit = draws.sign();
    component(contact.draft.b[0], draws.between(0, 2)) += unit;
  }
  return shuffled(draws, rounded(draws, contact.draft));
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
