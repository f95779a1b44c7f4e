// SPDX-License-Identifier: Apache-2.0
// One triangle (the reference) prepared for tests against many: its box, and two slabs that contain it, each between
// two parallel planes. A triangle beyond a slab is disjoint. This test, in floats, rejects most disjoint triangles.
// The other triangles go to a filter in floats, and then to the filter of core/exact/filter.h.
//
// The slabs are the thinnest ones: perpendicular to the triangle's normal and, within its plane, to its longest edge.
// Their directions may be rounded in any way, because the reference's extent is computed along the stored direction.
// For a direction d, let |d| <= 1/4 be the sum of its components' magnitudes, and m the triangle's largest magnitude. A
// height d . v - middle is off by less than 4.001 2^-23 (|d| m + |middle|) in any rounding mode, plus 2^-146 if
// something underflows; nothing overflows.
#pragma once

#include <algorithm>

#include "core/exact/by_planes.h"
#include "core/exact/triangles.h"
#include "core/exact/vector.h"

namespace graze::exact {

// Heights of the reference, x v.x + y v.y + z v.z - middle, are within `half` of zero. For another triangle, `error`
// times the sum of its magnitudes bounds the rounding of its heights and of the comparison itself.
struct Slab {
  float x, y, z, middle, half, error;
};

inline constexpr int kSlabs = 2;

struct PreparedTriangle {
  float v[9];
  float low[3], high[3];  // its box
  Slab slabs[kSlabs];
};

namespace detail {

GRAZE_HD inline float magnitude(float x) {
#ifdef __CUDA_ARCH__
  return fabsf(x);
#else
  return __builtin_fabsf(x);
#endif
}

// lesser and greater require finite numbers. On a device, each is one instruction.
GRAZE_HD inline float lesser(float x, float y) {
#ifdef __CUDA_ARCH__
  return fminf(x, y);
#else
  return x < y ? x : y;
#endif
}

GRAZE_HD inline float greater(float x, float y) {
#ifdef __CUDA_ARCH__
  return fmaxf(x, y);
#else
  return x < y ? y : x;
#endif
}

inline Slab slab_along(const Vec<double>& direction, const float* v, bool rounded) {
  const auto size_of = [](double x) { return x < 0 ? -x : x; };
  const double size = 4 * (size_of(direction.x) + size_of(direction.y) + size_of(direction.z));
  Slab s{static_cast<float>(direction.x / size),
         static_cast<float>(direction.y / size),
         static_cast<float>(direction.z / size),
         0,
         0,
         0};
  double heights[3], terms = 0;
  for (int i = 0; i < 3; ++i) {
    const double x = double(s.x) * v[3 * i], y = double(s.y) * v[3 * i + 1], z = double(s.z) * v[3 * i + 2];
    heights[i] = x + y + z;
    const double sum = size_of(x) + size_of(y) + size_of(z);
    terms = sum > terms ? sum : terms;
  }
  const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
  s.middle = static_cast<float>(low / 2 + high / 2);
  const double half = std::max(high - s.middle, s.middle - low);
  // Covers the sums in doubles, the rounding to float, the part of `middle` in a height's error, and the addition of
  // the triangle's error in float.
  double slack = terms * 0x1p-50 + size_of(s.middle) * 0x1p-20 + 0x1p-140;
  // Rounding a vertex moves its height by at most 2^-23 |d| m, in any rounding mode, and 2^-149 where it underflows.
  if (rounded) slack += terms * 0x1p-22 + 0x1p-140;
  s.half = static_cast<float>(half + half * 0x1p-20 + slack);
  s.error = static_cast<float>((rounded ? 16 : 12) * 0x1p-24 * (size_of(s.x) + size_of(s.y) + size_of(s.z)));
  return s;
}

}  // namespace detail

// If the reference is not finite, no slab rejects a triangle and the filter in floats is unsure.
// rounded: the coordinates were rounded to float32, both those of the reference and those of the triangles that
// is_beyond takes. A rejected triangle is then disjoint even before rounding; the filter in floats does not apply.
inline PreparedTriangle prepare(const float* v, bool rounded = false) {
  using Direction = detail::Vec<double>;
  PreparedTriangle r;
  Direction at[3];
  bool finite = true;
  for (int i = 0; i < 9; ++i) {
    r.v[i] = v[i];
    finite = finite && detail::magnitude(v[i]) <= 0x1.fffffep+127f;
  }
  if (!finite) {
    const float none = __builtin_nanf("");
    for (Slab& s : r.slabs) s = {none, none, none, none, none, none};
    for (int i = 0; i < 3; ++i) r.low[i] = -(r.high[i] = __builtin_inff());
    return r;
  }
  for (int i = 0; i < 3; ++i) at[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  Direction longest{0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    const Direction edge = at[i == 2 ? 0 : i + 1] - at[i];
    longest = detail::dot<double>(edge, edge) > detail::dot<double>(longest, longest) ? edge : longest;
    const float x = r.v[i], y = r.v[i + 3], z = r.v[i + 6];
    r.low[i] = detail::lesser(detail::lesser(x, y), z);
    r.high[i] = detail::greater(detail::greater(x, y), z);
  }
  const Direction n = detail::cross<double>(at[1] - at[0], at[2] - at[0]);
  const bool flat = is_zero(n);  // a segment or a point: any direction will do
  r.slabs[0] = detail::slab_along(flat ? Direction{1, 0, 0} : n, v, rounded);
  r.slabs[1] = detail::slab_along(flat ? Direction{0, 1, 0} : detail::cross<double>(n, longest), v, rounded);
  return r;
}

// For doubles. The coordinates become differences from the reference's first vertex, because such a difference has a
// small relative error wherever the triangles are. is_beyond expects the other triangle in the same form.
inline PreparedTriangle prepare(const double* v) {
  float seen[9];
  for (int k = 0; k < 9; ++k) seen[k] = static_cast<float>(v[k] - v[k % 3]);
  return prepare(seen, true);
}

// The sum of the triangle's nine magnitudes. The sum is not finite if a magnitude is not, or if it overflows.
GRAZE_HD inline float size_of(const float* t) {
  float sum = detail::magnitude(t[0]);
  for (int i = 1; i < 9; ++i) sum += detail::magnitude(t[i]);
  return sum;
}

// Returns: true if the triangle is certainly beyond one of the slabs and therefore disjoint; false if it is not finite.
// Exact: in any rounding mode, with or without contraction.
GRAZE_HD inline bool is_beyond(const PreparedTriangle& r, const float* t) {
  using detail::bits_of, detail::lesser, detail::magnitude;
  const float size = size_of(t);
  bool beyond = false;
  for (int k = 0; k < kSlabs; ++k) {
    const Slab& s = r.slabs[k];
    const float a = s.x * t[0] + s.y * t[1] + s.z * t[2] - s.middle,
                b = s.x * t[3] + s.y * t[4] + s.z * t[5] - s.middle,
                c = s.x * t[6] + s.y * t[7] + s.z * t[8] - s.middle;
    const std::uint32_t signs = (bits_of(a) ^ bits_of(b)) | (bits_of(a) ^ bits_of(c));
    beyond |= (lesser(lesser(magnitude(a), magnitude(b)), magnitude(c)) > s.half + s.error * size) &
              (static_cast<std::int32_t>(signs) >= 0);
  }
  return beyond;
}

namespace detail {

// Floats with one error bound for all determinants of a pair.
struct FloatNumbers {
  using D = float;
  using M = float;
  using T = float;
  float bound;
  GRAZE_HD bool positive(float x) const { return x > bound; }
  GRAZE_HD bool negative(float x) const { return x < -bound; }
  GRAZE_HD bool zero(float) const { return false; }
  GRAZE_HD bool is_proper(const Vec<float>&) const { return false; }
};

// The filter in floats. As in core/exact/error_bound.h, with e = 2^-24, a determinant is off by less than 8 e times the
// sum of its six products, none larger than the product of the extents. Extents must lie between 2^-24 and 2^40. Then
// nothing overflows, and underflow adds less than 6 * 2^40 * 2^-150, a small part of the least bound, 48 * 2^-96.
// Returns: disjoint, crosses or unsure; unsure also for other extents and for coordinates that are not finite.
GRAZE_HD inline Finding filter_in_floats(const PreparedTriangle& r, const float* t) {
  float extent[3];
  for (int i = 0; i < 3; ++i) {
    extent[i] = greater(greater(r.high[i], t[i]), greater(t[i + 3], t[i + 6])) -
                lesser(lesser(r.low[i], t[i]), lesser(t[i + 3], t[i + 6]));
  }
  const float least = lesser(lesser(extent[0], extent[1]), extent[2]),
              most = greater(greater(extent[0], extent[1]), extent[2]);
  if (!(least >= 0x1p-24f && most <= 0x1p40f && size_of(t) <= 0x1p60f)) return Finding::unsure;
  const FloatNumbers numbers{6 * 8 * 0x1p-24f * extent[0] * extent[1] * extent[2]};
  return by_planes(triangles<FloatNumbers>(r.v, t), numbers);
}

}  // namespace detail
}  // namespace graze::exact
