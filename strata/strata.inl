// SPDX-License-Identifier: Apache-2.0
// The strata that need no construction, and the choice among all. The others: contact.h, coplanar.h, nested.h,
// shapes.h, scale.h.
#include "strata/contact.h"
#include "strata/coplanar.h"
#include "strata/draws.h"
#include "strata/nested.h"
#include "strata/scale.h"
#include "strata/shapes.h"

namespace graze::strata {
inline namespace GRAZE_FP {

GRAZE_HD inline Vec3<float> draw_uniform(Draws& draws) {
  return {draws.real_float(), draws.real_float(), draws.real_float()};
}

GRAZE_HD inline Pair uniform(Draws& draws) {
  return {{draw_uniform(draws), draw_uniform(draws), draw_uniform(draws)},
          {draw_uniform(draws), draw_uniform(draws), draw_uniform(draws)}};
}

// The listing's `(rand()%80 - 40)/10.0f` per axis, and `x + rand()%5` per coordinate, in float, as it computes them.
GRAZE_HD inline Pair thesis_against(Draws& draws, Pair pair) {
  float base[3];
  for (float& x : base) x = static_cast<float>(draws.between(-40, 39)) / 10.0f;
  for (Vec3<float>& vertex : pair.b) {
    for (int axis = 0; axis < 3; ++axis) component(vertex, axis) = base[axis] + static_cast<float>(draws.below(5));
  }
  return pair;
}

GRAZE_HD inline Pair thesis(Draws& draws) { return thesis_against(draws, {{{2, -2, 4}, {1, 5, -2}, {1, -3, -3}}, {}}); }

GRAZE_HD inline Pair thesis_special(Draws& draws) {
  return thesis_against(draws, {{{0, -2, 6}, {0, 5, 0}, {0, -3, 0}}, {}});
}

GRAZE_HD inline Vec3<float> draw_lattice(Draws& draws) {
  return {static_cast<float>(draws.integer(1)), static_cast<float>(draws.integer(1)),
          static_cast<float>(draws.integer(1))};
}

GRAZE_HD inline Pair lattice(Draws& draws) {
  return {{draw_lattice(draws), draw_lattice(draws), draw_lattice(draws)},
          {draw_lattice(draws), draw_lattice(draws), draw_lattice(draws)}};
}

GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, std::uint64_t index) {
  using strata::Touch;
  strata::Draws draws(seed, static_cast<std::uint32_t>(stratum), index);
  switch (stratum) {
#define GRAZE_STRATUM(name, group, kind, axis, draw, what) \
  case Stratum::name:                                      \
    return strata::draw;
#include "strata/strata.inc"
#undef GRAZE_STRATUM
  }
  return {};
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
