// SPDX-License-Identifier: Apache-2.0
// The strata that draw coordinates without a construction, and the switch that selects a stratum. The other strata are
// in contact.h, coplanar.h, doubles.h, nested.h, shapes.h and scale.h.
#include "strata/contact.h"
#include "strata/coplanar.h"
#include "strata/doubles.h"
#include "strata/draws.h"
#include "strata/nested.h"
#include "strata/scale.h"
#include "strata/shapes.h"

namespace graze::strata {
inline namespace GRAZE_FP {

template <class D>
GRAZE_HD Vec3<typename D::Real> draw_uniform(D& draws) {
  return {draws.real_float(), draws.real_float(), draws.real_float()};
}

template <class D>
GRAZE_HD BasicPair<typename D::Real> uniform(D& draws) {
  return {{draw_uniform(draws), draw_uniform(draws), draw_uniform(draws)},
          {draw_uniform(draws), draw_uniform(draws), draw_uniform(draws)}};
}

// The thesis's listing: `(rand()%80 - 40)/10.0f` for each axis, and `x + rand()%5` for each coordinate. The listing
// computes in float; this function computes in the coordinate type.
template <class D>
GRAZE_HD auto thesis_against(D& draws, BasicPair<typename D::Real> pair) {
  using Real = typename D::Real;
  Real base[3];
  for (Real& x : base) x = static_cast<Real>(draws.between(-40, 39)) / Real{10};
  for (Vec3<Real>& vertex : pair.b) {
    for (int axis = 0; axis < 3; ++axis) component(vertex, axis) = base[axis] + static_cast<Real>(draws.below(5));
  }
  return pair;
}

GRAZE_HD inline auto thesis(auto& draws) { return thesis_against(draws, {{{2, -2, 4}, {1, 5, -2}, {1, -3, -3}}, {}}); }

GRAZE_HD inline auto thesis_special(auto& draws) {
  return thesis_against(draws, {{{0, -2, 6}, {0, 5, 0}, {0, -3, 0}}, {}});
}

template <class D>
GRAZE_HD Vec3<typename D::Real> draw_lattice(D& draws) {
  using Real = typename D::Real;
  return {static_cast<Real>(draws.integer(1)), static_cast<Real>(draws.integer(1)),
          static_cast<Real>(draws.integer(1))};
}

template <class D>
GRAZE_HD BasicPair<typename D::Real> lattice(D& draws) {
  return {{draw_lattice(draws), draw_lattice(draws), draw_lattice(draws)},
          {draw_lattice(draws), draw_lattice(draws), draw_lattice(draws)}};
}

// Draws a pair of one stratum. Only the code of that stratum is compiled.
template <Stratum stratum, class D>
GRAZE_HD BasicPair<typename D::Real> draw_stratum(D draws) {
  using strata::Touch;
#define GRAZE_STRATUM(name, group, kind, axis, draw, what) \
  if constexpr (stratum == Stratum::name) {                \
    return strata::draw;                                   \
  } else
#include "strata/strata.inc"

#include "strata/double_strata.inc"
#undef GRAZE_STRATUM
  { return {}; }
}

template <class D>
GRAZE_HD BasicPair<typename D::Real> generate_by(D draws, Stratum stratum) {
  switch (stratum) {
#define GRAZE_STRATUM(name, ...) \
  case Stratum::name:            \
    return draw_stratum<Stratum::name>(draws);
#include "strata/strata.inc"
    default:
      break;
  }
  if constexpr (sizeof(typename D::Real) == sizeof(double)) {
    switch (stratum) {
#include "strata/double_strata.inc"
#undef GRAZE_STRATUM
      default:
        break;
    }
  }
  return {};
}

template <Stratum stratum, class D>
GRAZE_HD BasicPair<typename D::Real> generate_one(std::uint64_t seed, std::uint64_t index) {
  return draw_stratum<stratum>(D(seed, static_cast<std::uint32_t>(stratum), index));
}

GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, std::uint64_t index) {
  return generate_by(Draws(seed, static_cast<std::uint32_t>(stratum), index), stratum);
}

GRAZE_HD inline DoublePair generate_doubles(std::uint64_t seed, Stratum stratum, std::uint64_t index) {
  return generate_by(DoubleDraws(seed, static_cast<std::uint32_t>(stratum), index), stratum);
}

}  // namespace GRAZE_FP
}  // namespace graze::strata
