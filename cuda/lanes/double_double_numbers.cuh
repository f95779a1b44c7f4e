// SPDX-License-Identifier: Apache-2.0
// Determinants in double-double precision with error bounds, for pairs whose grid fits no built-in number type.
//
// Differences are exact: the sum of two doubles and its error are both doubles. Each of a determinant's six products
// has two multiplications and three sums, so its relative error is 2 * 5 u^2 + 3 * 3 u^2 plus terms of u^3, with u =
// 2^-53; see core/margin/double_double.h. The size is a double, too small by less than one part in 2^48. So 32 u^2
// bounds both errors. Nothing overflows or underflows. A difference of floats is zero or lies between 2^-149 and 2^129.
// Doubles must be on a moderate grid (core/exact/error_bound.h), so all numbers are multiples of 2^-900.
#pragma once

#include "core/exact/numbers.h"
#include "core/margin/double_double.h"

namespace graze {

// Argument-dependent lookup finds these functions.
__device__ inline void convert(float x, double, DoubleDouble& out) { out = static_cast<double>(x); }
__device__ inline void convert(double x, int, DoubleDouble& out) { out = x; }

namespace cuda {

// A difference, or a sum of products. size: the magnitude of the difference, or the sum of the products' magnitudes.
struct DoubleDoubleSum {
  DoubleDouble value;
  double size;

  __device__ explicit DoubleDoubleSum(const DoubleDouble& x) : value(x), size(fabs(x.hi)) {}
  __device__ DoubleDoubleSum(const DoubleDouble& v, double s) : value(v), size(s) {}
  __device__ friend DoubleDoubleSum operator*(const DoubleDoubleSum& l, const DoubleDouble& r) {
    return {l.value * r, l.size * fabs(r.hi)};
  }
  __device__ friend DoubleDoubleSum operator+(const DoubleDoubleSum& l, const DoubleDoubleSum& r) {
    return {l.value + r.value, l.size + r.size};
  }
  __device__ friend DoubleDoubleSum operator-(const DoubleDoubleSum& l, const DoubleDoubleSum& r) {
    return {l.value - r.value, l.size + r.size};
  }
};

struct DoubleDoubleNumbers {
  using D = DoubleDouble;
  using M = DoubleDoubleSum;
  using T = DoubleDoubleSum;
  static constexpr double kError = 0x1p-101;
  __device__ bool positive(const T& x) const { return x.value.hi > kError * x.size; }
  __device__ bool negative(const T& x) const { return x.value.hi < -kError * x.size; }
  __device__ bool zero(const T& x) const { return x.size == 0; }
  __device__ bool is_proper(const exact::detail::Vec<M>&) const { return false; }
};

}  // namespace cuda
}  // namespace graze
