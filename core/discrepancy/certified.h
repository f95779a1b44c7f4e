// SPDX-License-Identifier: Apache-2.0
// Numbers with twice a double's precision and a certified error bound, on host and device alike. A sum's rounding error
// is computed, not estimated, so an exact result has a bound of zero.
// References: T. J. Dekker, A floating-point technique for extending the available precision, Numerische Mathematik 18
// (1971): errors of sums and products.
// Requires: compiled without contraction, so that host and device give the same bits.
#pragma once

#include <cmath>

#include "core/exact/host_device.h"
#include "core/margin/double_double.h"

namespace graze {
inline namespace GRAZE_FP {

// The true value lies in [hi + lo - bound, hi + lo + bound]. An infinite or NaN bound says nothing about the value.
struct Certified {
  double hi = 0, lo = 0, bound = 0;

  Certified() = default;
  GRAZE_HD explicit Certified(double given) : hi(given) {}
  GRAZE_HD Certified(const DoubleDouble& value, double error) : hi(value.hi), lo(value.lo), bound(error) {
    // From 2^1000 on, the computed error of a sum or a quotient may overflow.
    if (!(fabs(hi) < 0x1p+1000)) bound = HUGE_VAL;
  }

  GRAZE_HD bool settled() const { return bound < HUGE_VAL; }
  GRAZE_HD bool is_exactly_zero() const { return hi == 0 && lo == 0 && bound == 0; }

  GRAZE_HD friend Certified sqrt(const Certified& x) { return x.root(); }

 private:
  GRAZE_HD Certified root() const;
};

namespace certified {

// Rounds up a sum of a few nonnegative terms.
GRAZE_HD inline double up(double bound) { return bound * (1 + 0x1p-48); }

// Bound on the part of a product's error that underflows; zero if a factor is zero.
GRAZE_HD inline double lost_below(double product, double x, double y) {
  return x != 0 && y != 0 && !(fabs(product) >= 0x1p-900) ? 0x1p-1060 : 0;
}

// |hi| + |lo|, rounded up.
GRAZE_HD inline double above(const Certified& x) { return up(fabs(x.hi) + fabs(x.lo)); }

// A lower bound on the number's magnitude; it may be negative.
GRAZE_HD inline double least_size(const Certified& x) { return (fabs(x.hi) - fabs(x.lo)) * (1 - 0x1p-48) - x.bound; }

}  // namespace certified

GRAZE_HD inline Certified operator-(const Certified& x) {
  Certified result = x;
  result.hi = -x.hi;
  result.lo = -x.lo;
  return result;
}

GRAZE_HD GRAZE_CALLED inline Certified operator+(const Certified& x, const Certified& y) {
  using namespace double_double;
  const DoubleDouble high = exact_sum(x.hi, y.hi), low = exact_sum(x.lo, y.lo);
  const DoubleDouble middle = exact_sum(high.lo, low.hi), top = exact_sum(high.hi, middle.hi);
  const DoubleDouble rest = exact_sum(middle.lo, low.lo), below = exact_sum(top.lo, rest.hi);
  const DoubleDouble sum = exact_sum(top.hi, below.hi);
  return {sum, certified::up(x.bound + y.bound + fabs(below.lo) + fabs(rest.lo))};
}
GRAZE_HD inline Certified operator-(const Certified& x, const Certified& y) { return x + -y; }

GRAZE_HD GRAZE_CALLED inline Certified operator*(const Certified& x, const Certified& y) {
  using namespace double_double;
  using namespace certified;
  const double high = x.hi * y.hi, error = fma(x.hi, y.hi, -high);
  const double left = x.hi * y.lo, left_error = fma(x.hi, y.lo, -left);
  const double right = x.lo * y.hi, right_error = fma(x.lo, y.hi, -right);
  const DoubleDouble cross = exact_sum(left, right), below = exact_sum(error, cross.hi);
  const DoubleDouble top = exact_sum(high, below.hi);
  const double rest = fabs(left_error) + fabs(right_error) + fabs(x.lo * y.lo) + fabs(cross.lo) + fabs(below.lo);
  const double lost = lost_below(high, x.hi, y.hi) + lost_below(left, x.hi, y.lo) + lost_below(right, x.lo, y.hi) +
                      lost_below(0, x.lo, y.lo);
  const double of_bounds =
      x.bound == 0 && y.bound == 0 ? 0 : above(x) * y.bound + above(y) * x.bound + x.bound * y.bound + 0x1p-1060;
  return {top, up(rest + lost + of_bounds)};
}

// The error is computed from the remainder: the dividend minus the quotient times the divisor.
GRAZE_HD GRAZE_CALLED inline Certified operator/(const Certified& x, const Certified& y) {
  using namespace certified;
  Certified quotient(x.hi / y.hi);
  const Certified first = x - quotient * y;
  const DoubleDouble better = double_double::exact_sum(quotient.hi, first.hi / y.hi);
  quotient.hi = better.hi;
  quotient.lo = better.lo;
  const Certified left = x - quotient * y;
  const double least = least_size(y);
  const double missing = above(left) + left.bound;
  const double bound = least > 0 ? missing == 0 ? 0 : up(missing / least) + 0x1p-1060 : HUGE_VAL;
  return {better, bound};
}

GRAZE_HD GRAZE_CALLED inline Certified Certified::root() const {
  using namespace certified;
  if (is_exactly_zero()) return *this;
  Certified result(std::sqrt(hi));
  const Certified first = *this - result * result;
  const DoubleDouble better = double_double::exact_sum(result.hi, first.hi / (result.hi + result.hi));
  result.hi = better.hi;
  result.lo = better.lo;
  const Certified left = *this - result * result;
  const double missing = above(left) + left.bound;
  // |sqrt(x) - r| = |x - r r| / (sqrt(x) + r), and sqrt(x) > 0.
  const bool positive = hi - fabs(lo) - bound > 0;
  const double error = !positive ? HUGE_VAL : missing == 0 ? 0 : up(missing / (better.hi * (1 - 0x1p-48))) + 0x1p-1060;
  return {better, error};
}

}  // namespace GRAZE_FP
}  // namespace graze
