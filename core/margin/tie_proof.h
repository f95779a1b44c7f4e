// SPDX-License-Identifier: Apache-2.0
// Proves in integers that a distance is at least a given power of two. Needed for distances very close to a power of
// two ulps, which the bounds of core/margin/margin.h leave undecided.
#pragma once

#include <cstdint>

#include "core/exact/grid.h"
#include "core/exact/numbers.h"
#include "core/exact/triangles.h"
#include "core/exact/vector.h"
#include "core/exact/wide_integer.h"
#include "core/margin/directions.h"

namespace graze {
namespace tie_proof {

template <class Big>
using Vector = exact::detail::Vec<Big>;

template <int N>
GRAZE_HD exact::detail::Wide<N> shifted_up(const exact::detail::Wide<N>& x, int bits) {
  exact::detail::Wide<N> result;
  const int limbs = bits / 64, rest = bits % 64;
  for (int i = N - 1; i >= limbs; --i) {
    result.limb[i] = x.limb[i - limbs] << rest;
    if (rest != 0 && i > limbs) result.limb[i] |= x.limb[i - limbs - 1] >> (64 - rest);
  }
  return result;
}

// Direction number d of core/margin/directions.h.
template <class Big>
GRAZE_HD Vector<Big> direction(const Vector<Big> (&a)[3], const Vector<Big> (&b)[3], int d) {
  using exact::detail::cross;
  const auto edge = [](const Vector<Big>(&v)[3], int i) { return v[i == 2 ? 0 : i + 1] - v[i]; };
  if (d == kNormalA) return cross<Big>(edge(a, 0), edge(a, 1));
  if (d == kNormalB) return cross<Big>(edge(b, 0), edge(b, 1));
  if (d < kSeparatingAxes) return cross<Big>(edge(a, d / 3), edge(b, d % 3));
  const int first = d < kFromEdgeB ? kFromEdgeA : d < kFromVertex ? kFromEdgeB : kFromVertex;
  const int i = (d - first) / 3, j = (d - first) % 3;
  const Vector<Big> between = b[j] - a[i];
  if (first == kFromVertex) return between;
  const Vector<Big> e = first == kFromEdgeA ? edge(a, i) : edge(b, j);
  return cross<Big>(cross<Big>(e, between), e);
}

}  // namespace tie_proof

// Whether the disjoint triangles are at least 2^exponent apart along direction d (of core/margin/directions.h). Bits on
// the grid of floats: coordinates at most kIntBits = 40, a direction 3 * 41 + 4, the gap along it 170, its square 340
// of 512. For doubles: coordinates at most kMediumBits = 61, a direction 3 * 62 + 4, the gap along it 254, its square
// 508, shifted by 400, of 1024. Returns: false also if the numbers are too large to tell.
template <class Real>
GRAZE_HD bool are_apart_by(const Real* a, const Real* b, int d, int exponent) {
  using namespace tie_proof;
  using exact::detail::Int128;
  constexpr bool kFloats = sizeof(Real) == sizeof(float);
  constexpr int kLimbs = kFloats ? 8 : 16, kBits = kFloats ? exact::detail::kIntBits : exact::detail::kMediumBits;
  constexpr int kMostShift = kFloats ? 120 : 200, kLeastShift = kFloats ? -80 : -200;
  using Big = exact::detail::Wide<kLimbs>;
  const exact::detail::Grid grid = exact::detail::grid_of(a, b);
  const int shift = exponent - grid.exponent;
  if (grid.bits > kBits || shift > kMostShift || shift < kLeastShift) return false;
  const auto t = exact::detail::triangles<exact::detail::NarrowNumbers>(a, b, grid.exponent);
  Vector<Big> va[3], vb[3];
  for (int i = 0; i < 3; ++i) {
    va[i] = {Big(Int128{t.a[i].x}), Big(Int128{t.a[i].y}), Big(Int128{t.a[i].z})};
    vb[i] = {Big(Int128{t.b[i].x}), Big(Int128{t.b[i].y}), Big(Int128{t.b[i].z})};
  }
  const Vector<Big> n = direction<Big>(va, vb, d);
  Big at_a[3], at_b[3];
  for (int i = 0; i < 3; ++i) {
    at_a[i] = exact::detail::dot<Big>(n, va[i] - va[0]);
    at_b[i] = exact::detail::dot<Big>(n, vb[i] - va[0]);
  }
  const Big above = exact::detail::least(at_b) - exact::detail::most(at_a);
  const Big below = exact::detail::least(at_a) - exact::detail::most(at_b);
  const Big gap = above > below ? above : below;
  if (!(gap > Big(0))) return false;
  const Big gap2 = gap * gap, n2 = exact::detail::dot<Big>(n, n);
  return shift < 0 ? !(shifted_up(gap2, -2 * shift) < n2) : !(gap2 < shifted_up(n2, 2 * shift));
}

}  // namespace graze
