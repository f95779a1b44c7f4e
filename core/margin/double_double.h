// SPDX-License-Identifier: Apache-2.0
// Numbers with twice a double's precision: the sum of two doubles that do not overlap.
// Reference: Joldes, Muller and Popescu 2017, "Tight and rigorous error bounds for basic building blocks of double-word
// arithmetic": algorithms 6, 12, 9 and 17, with relative errors 3 u^2 + 13 u^3, 5 u^2, 2 u^2 and 15 u^2 + 56 u^3, where
// u = 2^-53, as long as nothing over- or underflows.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

struct DoubleDouble {
  double hi, lo;

  DoubleDouble() = default;
  GRAZE_HD DoubleDouble(double x) : hi(x), lo(0) {}
  GRAZE_HD DoubleDouble(double x, double y) : hi(x), lo(y) {}
};

namespace double_double {

// A product that no compiler can fuse with a sum.
GRAZE_HD inline double product(double x, double y) {
#ifdef __CUDA_ARCH__
  return __dmul_rn(x, y);
#else
  return x * y;
#endif
}

// x + y and its error.   Requires: |x| >= |y|, or x is zero.
GRAZE_HD inline DoubleDouble ordered_sum(double x, double y) {
  const double sum = x + y;
  return {sum, y - (sum - x)};
}

// x + y and its error, for any two numbers.
GRAZE_HD inline DoubleDouble exact_sum(double x, double y) {
  const double sum = x + y, of_y = sum - x;
  return {sum, (x - (sum - of_y)) + (y - of_y)};
}

GRAZE_HD inline DoubleDouble times(const DoubleDouble& x, double y) {
  const double high = product(x.hi, y);
  return ordered_sum(high, fma(x.lo, y, fma(x.hi, y, -high)));
}

}  // namespace double_double

GRAZE_HD inline DoubleDouble operator+(const DoubleDouble& x, const DoubleDouble& y) {
  using namespace double_double;
  const DoubleDouble high = exact_sum(x.hi, y.hi), low = exact_sum(x.lo, y.lo);
  const DoubleDouble sum = ordered_sum(high.hi, high.lo + low.hi);
  return ordered_sum(sum.hi, low.lo + sum.lo);
}

GRAZE_HD inline DoubleDouble operator-(const DoubleDouble& x) { return {-x.hi, -x.lo}; }
GRAZE_HD inline DoubleDouble operator-(const DoubleDouble& x, const DoubleDouble& y) { return x + -y; }

GRAZE_HD inline DoubleDouble operator*(const DoubleDouble& x, const DoubleDouble& y) {
  using namespace double_double;
  const double high = product(x.hi, y.hi), error = fma(x.hi, y.hi, -high);
  return ordered_sum(high, error + fma(x.lo, y.hi, fma(x.hi, y.lo, product(x.lo, y.lo))));
}

GRAZE_HD inline DoubleDouble operator/(const DoubleDouble& x, const DoubleDouble& y) {
  using namespace double_double;
  const double high = x.hi / y.hi;
  const DoubleDouble back = times(y, high);
  return ordered_sum(high, ((x.hi - back.hi) + (x.lo - back.lo)) / y.hi);
}

GRAZE_HD inline bool operator==(const DoubleDouble& x, const DoubleDouble& y) { return x.hi == y.hi && x.lo == y.lo; }
GRAZE_HD inline bool operator<(const DoubleDouble& x, const DoubleDouble& y) {
  return x.hi < y.hi || (x.hi == y.hi && x.lo < y.lo);
}
GRAZE_HD inline bool operator>(const DoubleDouble& x, const DoubleDouble& y) { return y < x; }
GRAZE_HD inline bool operator<=(const DoubleDouble& x, const DoubleDouble& y) {
  return x.hi < y.hi || (x.hi == y.hi && x.lo <= y.lo);
}
GRAZE_HD inline bool operator>=(const DoubleDouble& x, const DoubleDouble& y) { return y <= x; }

}  // namespace GRAZE_FP
}  // namespace graze
