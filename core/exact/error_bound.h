// SPDX-License-Identifier: Apache-2.0
// How far rounding to doubles can move a determinant of three differences of floats: a bound for each
// determinant, and one bound for all determinants of a pair. Each difference is rounded once, so a determinant
// is off by at most (7 + 56 e) e sum |products|, e = 2^-53 (Shewchuk 1997, orient3d stage A). Contraction only
// removes roundings. Nothing over- or underflows: differences of floats are zero or lie between 2^-149 and
// 2^129.
#pragma once

#ifdef __FAST_MATH__
#error "graze/exact.h: error bounds do not hold under -ffast-math"
#endif

#include "core/exact/vector.h"

namespace graze::exact::detail {

// Error bound relative to the sum of the products' magnitudes: (7 + 56 e) e < 8 e.
inline constexpr double kDeterminantError = 8 * 0x1p-53;

// A sum of products, and the sum of their magnitudes.
struct Bounded {
  double value, size;
  GRAZE_HD explicit Bounded(double x) : value(x), size(x < 0 ? -x : x) {}
  GRAZE_HD Bounded(double v, double s) : value(v), size(s) {}
  GRAZE_HD friend Bounded operator*(const Bounded& l, double r) { return {l.value * r, l.size * (r < 0 ? -r : r)}; }
  GRAZE_HD friend Bounded operator+(const Bounded& l, const Bounded& r) { return {l.value + r.value, l.size + r.size}; }
  GRAZE_HD friend Bounded operator-(const Bounded& l, const Bounded& r) { return {l.value - r.value, l.size + r.size}; }
};

// The extent of the pair along each axis, each with one rounding.
GRAZE_HD inline Vec<double> extent_of(const float* a, const float* b) {
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) {
    float low = a[axis], high = a[axis];
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

// Error bound of every determinant of the pair. A determinant is a sum of six products of a difference in x, one in y
// and one in z. No difference is larger than the pair's extent in that axis.
GRAZE_HD inline double determinant_error(const Vec<double>& extent) {
  return 6 * kDeterminantError * extent.x * extent.y * extent.z;
}

// Whether both are certainly proper: a normal's component is the difference of two products of differences.
GRAZE_HD inline bool both_proper(const float* a, const float* b) {
  const Vec<double> extent = extent_of(a, b);
  const double error_x = 2 * kDeterminantError * extent.y * extent.z,
               error_y = 2 * kDeterminantError * extent.z * extent.x,
               error_z = 2 * kDeterminantError * extent.x * extent.y;
  bool proper = true;
  const float* const triangles[2] = {a, b};
  for (const float* v : triangles) {
    const Vec<double> u{double(v[3]) - v[0], double(v[4]) - v[1], double(v[5]) - v[2]};
    const Vec<double> w{double(v[6]) - v[0], double(v[7]) - v[1], double(v[8]) - v[2]};
    const Vec<double> n = cross<double>(u, w);
    proper = proper &&
             (n.x > error_x || n.x < -error_x || n.y > error_y || n.y < -error_y || n.z > error_z || n.z < -error_z);
  }
  return proper;
}

}  // namespace graze::exact::detail
