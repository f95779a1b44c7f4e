// SPDX-License-Identifier: Apache-2.0
// The strata that need no construction, and the choice among all. The others: contact.h, coplanar.h, shapes.h, scale.h.
#include "strata/contact.h"
#include "strata/coplanar.h"
#include "strata/draws.h"
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
GRAZE_HD inline Pair thesis(Draws& draws) {
  Pair pair{{{2, -2, 4}, {1, 5, -2}, {1, -3, -3}}, {}};
  float base[3];
  for (float& x : base) x = static_cast<float>(draws.between(-40, 39)) / 10.0f;
  for (Vec3<float>& vertex : pair.b) {
    for (int axis = 0; axis < 3; ++axis) component(vertex, axis) = base[axis] + static_cast<float>(draws.below(5));
  }
  return pair;
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
    case Stratum::uniform:
      return strata::uniform(draws);
    case Stratum::thesis:
      return strata::thesis(draws);
    case Stratum::near_vertex_face:
      return strata::near_contact(draws, Touch::vertex_face);
    case Stratum::near_edge_edge:
      return strata::near_contact(draws, Touch::edge_edge);
    case Stratum::near_vertex_edge:
      return strata::near_contact(draws, Touch::vertex_edge);
    case Stratum::near_vertex_vertex:
      return strata::near_contact(draws, Touch::vertex_vertex);
    case Stratum::coplanar_lattice:
      return strata::coplanar_lattice(draws);
    case Stratum::coplanar_wide:
      return strata::coplanar_wide(draws);
    case Stratum::exact_contact:
      return strata::exact_contact(draws);
    case Stratum::coplanar_rounded:
      return strata::coplanar_rounded(draws);
    case Stratum::parallel:
      return strata::parallel(draws);
    case Stratum::sliver:
      return strata::sliver(draws);
    case Stratum::degenerate:
      return strata::degenerate(draws);
    case Stratum::shared_vertex:
      return strata::shared_vertex(draws);
    case Stratum::shared_edge:
      return strata::shared_edge(draws);
    case Stratum::far_from_origin:
      return strata::far_from_origin(draws);
    case Stratum::extreme_scale:
      return strata::extreme_scale(draws);
    case Stratum::mixed_scale:
      return strata::mixed_scale(draws);
    case Stratum::lattice:
      return strata::lattice(draws);
  }
  return {};
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
