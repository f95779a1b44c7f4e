// SPDX-License-Identifier: Apache-2.0
// The margin as the square root of a rational, computed with GMP integers and rounded once by MPFR.
#pragma once

#include <cstdint>

#include <gmpxx.h>

#include "core/margin/directions.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {

// |margin| = sqrt(numerator / denominator) * 2^exponent; denominator > 0.
struct SquaredMargin {
  mpz_class numerator;
  mpz_class denominator;
  int exponent;
};

// The distance between two disjoint closed hulls: the least distance over all pairs of their vertices, edges and faces.
// Exact: always.
SquaredMargin exact_distance(const LargePair& pair, int exponent);

// The least overlap of two intersecting hulls along the given axes, ignoring zero axes; zero if all axes are zero.
// axes: bit i selects separating axis i of core/margin/directions.h.   Exact: always.
inline constexpr std::uint32_t kAllAxes = (1u << kSeparatingAxes) - 1;
SquaredMargin exact_depth(const LargePair& pair, int exponent, std::uint32_t axes);

// The separation of the hulls along direction d of core/margin/directions.h, a lower bound on their distance; zero if
// they are not separated.   Exact: always.
SquaredMargin exact_separation(const LargePair& pair, int exponent, int d);

// floor(log2(|margin|)).   Requires: margin is not zero.   Exact: always.
int floor_log2(const SquaredMargin& margin);

// |margin|, rounded once to the nearest positive finite double, or 0 if the margin is 0. Nonzero margins of float32
// pairs lie in [2^-705, 2^130].
double rounded(const SquaredMargin& margin);

// The truth of a pair with this distance or depth. log2_ulp: log2 of the ulp of the pair's largest coordinate.
Truth truth_of(Verdict verdict, Contact contact, const Hulls& hulls, const SquaredMargin& size, int log2_ulp);

// Direction d of core/margin/directions.h, exactly, for any integer type.
template <class Int>
Vec3<Int> integer_direction(const Vec3<Int> (&a)[3], const Vec3<Int> (&b)[3], int d) {
  const auto edge = [](const Vec3<Int>(&p)[3], int i) { return p[(i + 1) % 3] - p[i]; };
  if (d == kNormalA) return cross(edge(a, 0), edge(a, 1));
  if (d == kNormalB) return cross(edge(b, 0), edge(b, 1));
  if (d < kSeparatingAxes) return cross(edge(a, d / 3), edge(b, d % 3));
  const int first = d < kFromEdgeB ? kFromEdgeA : d < kFromVertex ? kFromEdgeB : kFromVertex;
  const int i = (d - first) / 3, j = (d - first) % 3;
  const Vec3<Int> between = b[j] - a[i];
  if (first == kFromVertex) return between;
  const Vec3<Int> e = first == kFromEdgeA ? edge(a, i) : edge(b, j);
  return cross(cross(e, between), e);
}

// min(max n.a - min n.b, max n.b - min n.a), where n is separating axis `axis`.   Exact: if Int holds all products.
template <class Int>
Int integer_overlap(const Vec3<Int> (&a)[3], const Vec3<Int> (&b)[3], int axis, const Vec3<Int>& n) {
  Vec3<Int> seen[3];
  const int own = seen_from_axis(a, b, axis, seen);
  Int least[2] = {0, dot(n, seen[2])}, most[2] = {0, least[1]};
  for (int k = 0; k < 2; ++k) {
    const int side = k < own ? 0 : 1;
    const Int along = dot(n, seen[k]);
    if (along < least[side]) least[side] = along;
    if (along > most[side]) most[side] = along;
  }
  const Int one = most[0] - least[1], other = most[1] - least[0];
  return one < other ? one : other;
}

}  // namespace graze::oracle
