// SPDX-License-Identifier: Apache-2.0
// Bounds on the error of a determinant of three differences of floats or doubles, computed in doubles: a bound for each
// determinant, and one bound for all determinants of a pair. Each difference is rounded once, so a determinant
// is off by at most (7 + 56 e) e sum |products|, e = 2^-53 (Shewchuk 1997, orient3d stage A). Contraction only
// removes roundings. With floats nothing over- or underflows: their differences are zero or lie between 2^-149 and
// 2^129. For doubles, see kMostExtent.
#pragma once

#ifdef __FAST_MATH__
#error "graze/exact.h: error bounds do not hold under -ffast-math"
#endif

#include "core/exact/grid.h"
#include "core/exact/vector.h"

namespace graze::exact::detail {

// Error bound relative to the sum of the products' magnitudes: (7 + 56 e) e < 8 e.
inline constexpr double kDeterminantError = 8 * 0x1p-53;

// Bounds for pairs of doubles hold up to this extent, because nothing overflows there. If a product of two differences
// underflows, it is off by at most 2^-1075, which adds less than 6 * 2^-1075 * (2^300 + 1) < 2^-771 to the error of a
// determinant, and less than 2^-1073 to that of a minor. Underflow in computing the bounds themselves adds less.
inline constexpr double kMostExtent = 0x1p300, kDeterminantUnderflow = 0x1p-700, kMinorUnderflow = 0x1p-1000;

// Whether nothing over- or underflows in determinants of coordinates on this grid: differences are zero or lie between
// 2^-300 and 2^301.
GRAZE_HD constexpr bool is_moderate(const Grid& grid) {
  return grid.exponent >= -300 && grid.exponent + grid.bits <= 300;
}

// A sum of products, and the sum of their magnitudes.
struct Bounded {
  double value, size;
  GRAZE_HD explicit Bounded(double x) : value(x), size(x < 0 ? -x : x) {}
  GRAZE_HD Bounded(double v, double s) : value(v), size(s) {}
  GRAZE_HD friend Bounded operator*(const Bounded& l, double r) { return {l.value * r, l.size * (r < 0 ? -r : r)}; }
  GRAZE_HD friend Bounded operator+(const Bounded& l, const Bounded& r) { return {l.value + r.value, l.size + r.size}; }
  GRAZE_HD friend Bounded operator-(const Bounded& l, const Bounded& r) { return {l.value - r.value, l.size + r.size}; }
};

// The pair's extent along each axis, rounded once.
template <class Real>
GRAZE_HD Vec<double> extent_of(const Real* a, const Real* b) {
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) {
    Real low = a[axis], high = a[axis];
    for (int i = axis; i < 9; i += 3) {
      low = a[i] < low ? a[i] : low;
      high = a[i] > high ? a[i] : high;
      low = b[i] < low ? b[i] : low;
      high = b[i] > high ? b[i] : high;
    }
    extent[axis] = static_cast<double>(high) - static_cast<double>(low);
  }
  return {extent[0], extent[1], extent[2]};
}

// Error bound for every determinant of the pair, whose coordinates are of type Real. A determinant is a sum of six
// products of a difference in x, one in y and one in z. No difference is larger than the pair's extent along that axis.
// Returns: infinity where no bound holds.
template <class Real>
GRAZE_HD double determinant_error(const Vec<double>& extent) {
  const double error = 6 * kDeterminantError * extent.x * extent.y * extent.z;
  if constexpr (sizeof(Real) == sizeof(float)) return error;
  const bool holds = extent.x <= kMostExtent && extent.y <= kMostExtent && extent.z <= kMostExtent;
  return holds ? error + kDeterminantUnderflow : __builtin_inf();
}

// Whether both triangles are certainly proper: some component of each normal exceeds its error bound. If differences of
// doubles overflow, the results may be infinite or NaN, which proves nothing.
template <class Real>
GRAZE_HD bool both_proper(const Real* a, const Real* b) {
  const Vec<double> extent = extent_of(a, b);
  const double underflow = sizeof(Real) == sizeof(float) ? 0 : kMinorUnderflow;
  const double error_x = 2 * kDeterminantError * extent.y * extent.z + underflow,
               error_y = 2 * kDeterminantError * extent.z * extent.x + underflow,
               error_z = 2 * kDeterminantError * extent.x * extent.y + underflow;
  bool proper = true;
  const Real* const triangles[2] = {a, b};
  for (const Real* v : triangles) {
    const Vec<double> u{double(v[3]) - v[0], double(v[4]) - v[1], double(v[5]) - v[2]};
    const Vec<double> w{double(v[6]) - v[0], double(v[7]) - v[1], double(v[8]) - v[2]};
    const Vec<double> n = cross<double>(u, w);
    proper = proper &&
             (n.x > error_x || n.x < -error_x || n.y > error_y || n.y < -error_y || n.z > error_z || n.z < -error_z);
  }
  return proper;
}

}  // namespace graze::exact::detail
