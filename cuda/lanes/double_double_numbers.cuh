// SPDX-License-Identifier: Apache-2.0
// Determinants in twice a double's precision, with a bound of their error: for pairs whose grid no machine number
// holds.
//
// Differences are exact: the sum of two floats and its error are doubles. Of each of a determinant's six products the
// relative error is that of two multiplications and three sums, 2 * 5 u^2 + 3 * 3 u^2 and terms of u^3, u = 2^-53; see
// core/margin/double_double.h. The size, of doubles, is too small by less than one part in 2^48. So 32 u^2 is a bound
// for both. Nothing over- or underflows: differences of floats lie between 2^-149 and 2^129, or are zero.
#pragma once

#include "core/exact/numbers.h"
#include "core/margin/double_double.h"

namespace graze {

// Found by its argument.
__device__ inline void convert(float x, double, DoubleDouble& out) { out = static_cast<double>(x); }

namespace cuda {

// A difference is one double and its error. A sum of products, and the sum of the products' magnitudes.
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
