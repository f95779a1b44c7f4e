// SPDX-License-Identifier: Apache-2.0
// A pair's triangles in one kind of numbers.
#pragma once

#include <type_traits>

#include "core/exact/grid.h"
#include "core/exact/numbers.h"
#include "core/exact/vector.h"

namespace graze::exact::detail {

template <class Numbers>
using VecOf = Vec<typename Numbers::D>;

template <class Numbers>
using NormalOf = Vec<typename Numbers::M>;

template <class Numbers>
struct Triangles {
  VecOf<Numbers> a[3], b[3];
};

// Puts a float on its grid. Integers are multiples of 1 / scale, and the widest integers are multiples of 2^-149.
// Floating-point numbers are not scaled.
GRAZE_HD inline void convert(float x, double, float& out) { out = x; }
GRAZE_HD inline void convert(float x, double, double& out) { out = static_cast<double>(x); }
GRAZE_HD inline void convert(float x, double scale, std::int64_t& out) { out = static_cast<std::int64_t>(x * scale); }
GRAZE_HD inline void convert(float x, double scale, Whole& out) { out.value = x * scale; }
GRAZE_HD inline void convert(float x, double scale, Wide<2>& out) {
  const double integer = x < 0 ? x * -scale : x * scale;
  const auto high = static_cast<std::uint64_t>(integer * 0x1p-64);
  out.limb[0] = static_cast<std::uint64_t>(integer - static_cast<double>(high) * 0x1p64);
  out.limb[1] = high;
  if (x < 0) out = -out;
}

// Puts a double on the grid of this exponent. The scale may not fit in a double, so the bits are shifted.
// Requires: x is a multiple of 2^exponent.
GRAZE_HD inline void convert(double x, int, double& out) { out = x; }
GRAZE_HD inline void convert(double x, int exponent, std::int64_t& out) {
  int own;
  const std::uint64_t mantissa = mantissa_of(x, own);
  const int shift = own - exponent;  // arbitrary if x is zero
  const auto size = static_cast<std::int64_t>(mantissa == 0 ? 0 : shift < 0 ? mantissa >> -shift : mantissa << shift);
  out = x < 0 ? -size : size;
}
template <int N>
GRAZE_HD void convert(double x, int exponent, Wide<N>& out) {
  int own;
  std::uint64_t mantissa = mantissa_of(x, own);
  int shift = mantissa == 0 ? 0 : own - exponent;
  if (shift < 0) {
    mantissa >>= -shift;
    shift = 0;
  }
  out = Wide<N>(0);
  for (int i = 0; i < N; ++i) {
    if (i == shift / 64) out.limb[i] = mantissa << shift % 64;
    if (i == shift / 64 + 1 && shift % 64 != 0) out.limb[i] = mantissa >> (64 - shift % 64);
  }
  if (x < 0) out = -out;
}
GRAZE_HD inline void convert(float x, double, Wide<5>& out) { convert(double{x}, -149, out); }

// The second argument of `convert`, which puts coordinates on a grid: a factor for floats, an exponent for doubles.
template <class Real>
using PlaceOf = std::conditional_t<sizeof(Real) == sizeof(float), double, int>;

template <class Real>
GRAZE_HD PlaceOf<Real> place_of(int exponent) {
  if constexpr (sizeof(Real) == sizeof(float)) {
    return power_of_two(-exponent);
  } else {
    return exponent;
  }
}

template <class Numbers, class Real>
GRAZE_HD VecOf<Numbers> on_grid(const Vec<Real>& v, PlaceOf<Real> place) {
  VecOf<Numbers> out;
  convert(v.x, place, out.x);
  convert(v.y, place, out.y);
  convert(v.z, place, out.z);
  return out;
}

template <class Numbers, class Real>
GRAZE_HD Triangles<Numbers> triangles(const Real* a, const Real* b, int exponent = 0) {
  const PlaceOf<Real> place = place_of<Real>(exponent);
  Triangles<Numbers> t;
  for (int i = 0; i < 3; ++i) {
    t.a[i] = on_grid<Numbers>(Vec<Real>{a[3 * i], a[3 * i + 1], a[3 * i + 2]}, place);
    t.b[i] = on_grid<Numbers>(Vec<Real>{b[3 * i], b[3 * i + 1], b[3 * i + 2]}, place);
  }
  return t;
}

template <class Numbers>
GRAZE_HD NormalOf<Numbers> normal(const VecOf<Numbers> (&v)[3]) {
  return cross<typename Numbers::M>(v[1] - v[0], v[2] - v[0]);
}

// The sign of p q - r s; all four are differences.
template <class Numbers>
GRAZE_HD int sign_of_minor(const typename Numbers::D& p, const typename Numbers::D& q, const typename Numbers::D& r,
                           const typename Numbers::D& s) {
  using M = typename Numbers::M;
  if constexpr (std::is_same_v<M, Residue>) {
    return sign_of_difference(p, q, r, s);
  } else {
    const M minor = M(p) * q - M(r) * s;
    return int{minor > M(0)} - int{minor < M(0)};
  }
}

}  // namespace graze::exact::detail
