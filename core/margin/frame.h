// SPDX-License-Identifier: Apache-2.0
// A pair in doubles or in double-double numbers, and the arithmetic for certified bounds on its margin.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/exact/grid.h"
#include "core/margin/directions.h"
#include "core/margin/double_double.h"
#include "core/pair.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

// Unit roundoff of double. Contraction only removes roundings, so bounds hold with and without it.
inline constexpr double kHalfUlp = 0x1p-53;

// Unit roundoff of a number type: no operation has a larger relative error.
template <class Real>
inline constexpr double kRoundoff = kHalfUlp;
template <>
inline constexpr double kRoundoff<DoubleDouble> = 0x1p-102;

// Vertices and edges. Each difference of coordinates has a relative error of at most kRoundoff, or none if `exact`. No
// product of up to six differences over- or underflows (2^-894 to 2^780), nor does the error of such a product.
template <class Real>
struct MarginFrame {
  Vec3<Real> a[3], b[3], edge_a[3], edge_b[3];
  bool exact;  // no difference is rounded
};

GRAZE_HD inline double absolute(double x) { return fabs(x); }
GRAZE_HD inline DoubleDouble absolute(const DoubleDouble& x) { return x.hi < 0 ? -x : x; }
GRAZE_HD inline double as_double(double x) { return x; }
GRAZE_HD inline double as_double(const DoubleDouble& x) { return x.hi; }

template <class Real>
GRAZE_HD Vec3<Real> magnitudes(const Vec3<Real>& v) {
  return {absolute(v.x), absolute(v.y), absolute(v.z)};
}

// lesser and greater are one instruction each. fmin and fmax take more, because they handle NaN.
template <class Real>
GRAZE_HD Real lesser(const Real& x, const Real& y) {
  return x < y ? x : y;
}
template <class Real>
GRAZE_HD Real greater(const Real& x, const Real& y) {
  return x > y ? x : y;
}

GRAZE_HD inline Vec3<double> widen(const Vec3<float>& v) { return {double(v.x), double(v.y), double(v.z)}; }

// Whether the difference of any two coordinates is exact in double. Coordinates are multiples of 2^(low - 150) below
// 2^(high - 126), so differences are integers of high - low + 25 bits, and a double holds 53 bits.
GRAZE_HD inline bool differences_are_exact(const Pair& pair) {
  std::uint32_t low = 255, high = 0;
  const float* c = &pair.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    std::uint32_t bits;
    memcpy(&bits, &c[i], sizeof bits);
    bits &= 0x7fffffffu;
    if (bits == 0) continue;
    const std::uint32_t exponent = bits < 0x800000u ? 1u : bits >> 23;
    low = exponent < low ? exponent : low;
    high = exponent > high ? exponent : high;
  }
  return high <= low + 28;
}
GRAZE_HD inline bool differences_are_exact(const DoublePair& pair) {
  return exact::detail::grid_of(&pair.a[0].x, &pair.b[0].x).bits <= 52;
}

// Whether the coordinates are multiples of 2^-149 below 2^128, as floats are.
GRAZE_HD inline bool on_grid_of_floats(const DoublePair& pair) {
  const exact::detail::Grid grid = exact::detail::grid_of(&pair.a[0].x, &pair.b[0].x);
  return grid.exponent >= -149 && grid.exponent + grid.bits <= 128;
}

// Requires: floats, or doubles on the grid of floats.
template <class Real = double, class Coordinate>
GRAZE_HD MarginFrame<Real> make_margin_frame(const BasicPair<Coordinate>& pair) {
  MarginFrame<Real> f;
  f.exact = differences_are_exact(pair);
  for (int i = 0; i < 3; ++i) {
    f.a[i] = {Real(pair.a[i].x), Real(pair.a[i].y), Real(pair.a[i].z)};
    f.b[i] = {Real(pair.b[i].x), Real(pair.b[i].y), Real(pair.b[i].z)};
  }
  for (int i = 0; i < 3; ++i) {
    f.edge_a[i] = f.a[(i + 1) % 3] - f.a[i];
    f.edge_b[i] = f.b[(i + 1) % 3] - f.b[i];
  }
  return f;
}

// a*b - c*d by Kahan: relative error at most 2 kHalfUlp, and zero exactly when the products are equal.
// Reference: Jeannerod, Louvet and Muller 2013, theorem 1.1.
GRAZE_HD inline double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  const double error = fma(-c, d, cd);
  return fma(a, b, -cd) + error;
}

// Each product has an error of kRoundoff (none if its factors are doubles), and so has the difference.
GRAZE_HD inline DoubleDouble difference_of_products(const DoubleDouble& a, const DoubleDouble& b, const DoubleDouble& c,
                                                    const DoubleDouble& d) {
  return a * b - c * d;
}

template <class Real>
GRAZE_HD Vec3<Real> accurate_cross(const Vec3<Real>& u, const Vec3<Real>& v) {
  return {difference_of_products(u.y, v.z, u.z, v.y), difference_of_products(u.z, v.x, u.x, v.z),
          difference_of_products(u.x, v.y, u.y, v.x)};
}

// Direction number d of core/margin/directions.h. Its length is arbitrary.
template <class Real>
GRAZE_HD Vec3<Real> direction(const MarginFrame<Real>& f, int d) {
  if (d == kNormalA) return accurate_cross(f.edge_a[0], f.edge_a[1]);
  if (d == kNormalB) return accurate_cross(f.edge_b[0], f.edge_b[1]);
  if (d < kSeparatingAxes) return accurate_cross(f.edge_a[d / 3], f.edge_b[d % 3]);
  const int first = d < kFromEdgeB ? kFromEdgeA : d < kFromVertex ? kFromEdgeB : kFromVertex;
  const int i = (d - first) / 3, j = (d - first) % 3;
  const Vec3<Real> between = f.b[j] - f.a[i];
  if (first == kFromVertex) return between;
  const Vec3<Real>& edge = first == kFromEdgeA ? f.edge_a[i] : f.edge_b[j];
  return accurate_cross(accurate_cross(edge, between), edge);
}

template <class Real>
struct Interval {
  Real lo, hi;
};

// Widens the bounds on the least and the greatest value to include a value `at` that is known up to `error`.
template <class Real>
GRAZE_HD void include(Interval<Real>& least, Interval<Real>& most, const Real& at, const Real& error) {
  least = {lesser(least.lo, at - error), lesser(least.hi, at + error)};
  most = {greater(most.lo, at - error), greater(most.hi, at + error)};
}

}  // namespace GRAZE_FP
}  // namespace graze
