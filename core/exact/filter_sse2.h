// SPDX-License-Identifier: Apache-2.0
// The filter with SSE2; see core/exact/filter.h. The tests of a against b and of b against a are the same computation,
// so they are done at once.
#pragma once

#include <emmintrin.h>

#include <cstdint>

#include "core/exact/error_bound.h"
#include "core/exact/sides.h"
#include "core/exact/vector.h"

namespace graze::exact::detail::sse2 {

using Two = double __attribute__((vector_size(16)));

// Bit i is set if part i of x exceeds its bound.
inline unsigned exceeds(Two x, Two bound) { return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(x, bound))); }

inline unsigned signs(Two x) { return static_cast<unsigned>(_mm_movemask_pd(x)); }

inline Two exchanged(Two x) { return _mm_shuffle_pd(x, x, 1); }

inline Vec<Two> exchanged(const Vec<Two>& v) { return {exchanged(v.x), exchanged(v.y), exchanged(v.z)}; }

inline Two least(Two x, Two y) { return _mm_min_pd(x, y); }

inline Two most(Two x, Two y) { return _mm_max_pd(x, y); }

inline Two magnitude(Two x) { return _mm_andnot_pd(_mm_set1_pd(-0.0), x); }

// The coordinates of a triangle as doubles, two at a time.
struct Widened {
  Two two[5];  // coordinates 0 and 1, 2 and 3, 4 and 5, 6 and 7, 8 and 8

  explicit Widened(const float* v) {
    for (int i = 0; i < 4; ++i)
      two[i] = _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(v + 2 * i))));
    two[4] = _mm_set1_pd(v[8]);
  }
  explicit Widened(const double* v) {
    for (int i = 0; i < 4; ++i) two[i] = _mm_loadu_pd(v + 2 * i);
    two[4] = _mm_set1_pd(v[8]);
  }

  void store(double* to) const {
    for (int i = 0; i < 5; ++i) _mm_storeu_pd(to + 2 * i, two[i]);
  }
};

// Coordinate i of both triangles.
inline Two both(const Widened& l, const Widened& r, int i) {
  return i % 2 == 0 ? _mm_unpacklo_pd(l.two[i / 2], r.two[i / 2]) : _mm_unpackhi_pd(l.two[i / 2], r.two[i / 2]);
}

// Two vertices as one vector; each of its coordinates has two parts.
inline Vec<Two> both(const double* l, const double* r) { return {Two{l[0], r[0]}, Two{l[1], r[1]}, Two{l[2], r[2]}}; }

// Computes determinant_error<Real>(extent_of(a, b)) in both parts. v: the vertices of both triangles.
template <class Real>
Two determinant_error(const Vec<Two> (&v)[3]) {
  const Vec<Two> low{least(least(v[0].x, v[1].x), v[2].x), least(least(v[0].y, v[1].y), v[2].y),
                     least(least(v[0].z, v[1].z), v[2].z)};
  const Vec<Two> high{most(most(v[0].x, v[1].x), v[2].x), most(most(v[0].y, v[1].y), v[2].y),
                      most(most(v[0].z, v[1].z), v[2].z)};
  const Two xy = most(_mm_unpacklo_pd(high.x, high.y), _mm_unpackhi_pd(high.x, high.y)) -
                 least(_mm_unpacklo_pd(low.x, low.y), _mm_unpackhi_pd(low.x, low.y));
  const Two z = most(high.z, exchanged(high.z)) - least(low.z, exchanged(low.z));
  const Two error = 6 * kDeterminantError * xy * exchanged(xy) * z;
  if constexpr (sizeof(Real) == sizeof(float)) return error;
  const Two holds = _mm_cmple_pd(most(most(xy, exchanged(xy)), z), _mm_set1_pd(kMostExtent));
  return _mm_or_pd(_mm_and_pd(holds, error + kDeterminantUnderflow),
                   _mm_andnot_pd(holds, _mm_set1_pd(__builtin_inf())));
}

// lone_vertices as a table, for pairs without a vertex in the other triangle's plane. Index: bit 2 i is set if vertex i
// of a is below b, bit 2 i + 1 if vertex i of b is below a. Values: the indices of the vertices' first coordinates.
struct Turns {
  std::uint8_t a[64][4] = {}, b[64][4] = {};

  constexpr Turns() {
    for (unsigned i = 0; i < 64; ++i) {
      const unsigned below_a = (i & 1) | (i >> 1 & 2) | (i >> 2 & 4),
                     below_b = (i >> 1 & 1) | (i >> 2 & 2) | (i >> 3 & 4);
      const Turn turn = lone_vertices({7 & ~below_a, below_a, 0}, {7 & ~below_b, below_b, 0});
      for (unsigned k = 0; k < 3; ++k) {
        a[i][k] = static_cast<std::uint8_t>(3 * turn.a[k]);
        b[i][k] = static_cast<std::uint8_t>(3 * turn.b[k]);
      }
    }
  }
};
inline constexpr Turns kTurns;

// This function branches only where most pairs of one kind take the same branch, because a mispredicted branch costs as
// much as all the code after it.
template <class Real>
Finding filter(const Real* a, const Real* b) {
  const Widened wide_a(a), wide_b(b);
  alignas(16) double at_a[10], at_b[10];
  wide_a.store(at_a);
  wide_b.store(at_b);
  Vec<Two> v[3];
  for (int i = 0; i < 3; ++i)
    v[i] = {both(wide_a, wide_b, 3 * i), both(wide_a, wide_b, 3 * i + 1), both(wide_a, wide_b, 3 * i + 2)};
  const Two bound = determinant_error<Real>(v);
  // The heights of a's vertices over b's plane, and of b's vertices over a's plane.
  const Vec<Two> n = exchanged(cross<Two>(v[1] - v[0], v[2] - v[0])), from = exchanged(v[0]);
  const Two height[3] = {dot<Two>(n, v[0] - from), dot<Two>(n, v[1] - from), dot<Two>(n, v[2] - from)};
  const Two lowest = least(least(height[0], height[1]), height[2]);
  const Two highest = most(most(height[0], height[1]), height[2]);
  if ((exceeds(lowest, bound) | exceeds(-highest, bound)) != 0) return Finding::disjoint;
  const Two nearest = least(least(magnitude(height[0]), magnitude(height[1])), magnitude(height[2]));
  if (exceeds(nearest, bound) != 3) return Finding::unsure;

  const unsigned below = signs(height[0]) | signs(height[1]) << 2 | signs(height[2]) << 4;
  const auto &turn_a = kTurns.a[below], &turn_b = kTurns.b[below];
  const double *a0 = at_a + turn_a[0], *b0 = at_b + turn_b[0];
  const Vec<Two> o = both(at_a + turn_a[1], a0), p = both(b0, b0), q = both(a0, at_a + turn_a[2]),
                 r = both(at_b + turn_b[1], at_b + turn_b[2]);
  const Two between = dot<Two>(cross<Two>(p - o, q - o), r - o);
  const unsigned beside = exceeds(between, bound) != 0, crosses = exceeds(-between, bound) == 3;
  constexpr Finding kFindings[] = {Finding::unsure, Finding::disjoint, Finding::crosses};
  return kFindings[beside | crosses << 1];
}

}  // namespace graze::exact::detail::sse2
