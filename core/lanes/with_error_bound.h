// SPDX-License-Identifier: Apache-2.0
// Numbers that certify comparisons, for the policy `bound`: a value, computed as usual, and a bound on its forward
// error. A comparison that the bounds do not settle raises a doubt. If no doubt is raised, every comparison has the
// same outcome as in exact arithmetic, and the algorithm's verdict is the same too.
// Derivation: running error analysis, N. J. Higham, Accuracy and Stability of Numerical Algorithms, second edition
// (2002), section 3.3. With u the unit roundoff and t half the least subnormal, fl(x op y) = (x op y)(1 + d) + e, where
// |d| <= u, and |e| <= t for products and quotients, 0 for sums. Let X, Y be the exact quantities that x, y stand for,
// with |X - x| <= ex and |Y - y| <= ey. Then
//   |X + Y - fl(x + y)|  <= ex + ey + u |fl(x + y)|
//   |X Y   - fl(x y)|    <= |x| ey + |y| ex + ex ey + u |fl(x y)| + t
//   |X / Y - fl(x / y)|  <= (ex + (|q| + u |q| + t) ey) / (|y| - ey) + u |q| + t   for q = fl(x / y), |y| > ey
//   |sqrt X - fl(sqrt x)|  <= ex / sqrt x + u |fl(sqrt x)|   for x > ex
// The bounds themselves are rounded: at most eight roundings in a row, each of at most u. A factor of 1 + 32 u covers
// these roundings of normal numbers; adding the smallest normal number covers the loss of subnormal steps. Contraction
// rounds once where these formulas count two roundings, in values and in bounds, so both still hold. Overflow makes a
// bound infinite or NaN; then every comparison is in doubt.
#pragma once

#include <cmath>

#include "core/algorithms/range.h"
#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct WithErrorBound {
  static constexpr bool kIsFloat = sizeof(Real) == sizeof(float);
  static constexpr Real kUnit = kIsFloat ? Real(0x1p-24) : Real(0x1p-53);
  static constexpr Real kTiny = kIsFloat ? Real(0x1p-126f) : Real(0x1p-1022);  // normal, because subnormals are slow
  static constexpr Real kSlack = Real(1) + 32 * kUnit;

  Real value = 0;
  Real error = 0;
  bool* doubt = nullptr;  // null for constants

  WithErrorBound() = default;
  GRAZE_IN_PLACE GRAZE_HD explicit WithErrorBound(Real exact) : value(exact) {}
  GRAZE_IN_PLACE GRAZE_HD WithErrorBound(Real exact, bool* in_doubt) : value(exact), doubt(in_doubt) {}

  GRAZE_IN_PLACE GRAZE_HD bool is_exact() const { return error == Real(0); }
  GRAZE_IN_PLACE GRAZE_HD bool is_exact_zero() const { return value == Real(0) && is_exact(); }
  // Whether the exact quantity is certainly less than the other's.
  GRAZE_IN_PLACE GRAZE_HD bool is_below(const WithErrorBound& y) const {
    return value < y.value && is_settled(*this, y);
  }
  // Whether the exact quantity is certainly not zero.
  GRAZE_IN_PLACE GRAZE_HD bool is_nonzero() const { return magnitude(value) > error; }

  GRAZE_IN_PLACE GRAZE_HD WithErrorBound operator-() const {
    WithErrorBound result = *this;
    result.value = -value;
    return result;
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithErrorBound operator+(const WithErrorBound& x, const WithErrorBound& y) {
    return sum(x, y, x.value + y.value);
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithErrorBound operator-(const WithErrorBound& x, const WithErrorBound& y) {
    return sum(x, y, x.value - y.value);
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithErrorBound operator*(const WithErrorBound& x, const WithErrorBound& y) {
    WithErrorBound result = either(x, y);
    result.value = x.value * y.value;
    if (!x.is_exact_zero() && !y.is_exact_zero())
      result.error =
          ((magnitude(x.value) + x.error) * y.error + magnitude(y.value) * x.error + kUnit * magnitude(result.value)) *
              kSlack +
          kTiny;
    return result;
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithErrorBound operator/(const WithErrorBound& x, const WithErrorBound& y) {
    WithErrorBound result = either(x, y);
    const Real q = result.value = x.value / y.value;
    const Real size = magnitude(q) * kSlack + kTiny, divisor = (magnitude(y.value) - y.error) / kSlack;
    if (divisor > Real(0)) {
      if (!x.is_exact_zero())
        result.error = ((x.error + size * y.error + kTiny) / divisor + kUnit * size) * kSlack + kTiny;
    } else {
      result.error = HUGE_VAL;  // unused where an algorithm guards the division
    }
    return result;
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithErrorBound sqrt(const WithErrorBound& x) {
    using std::sqrt;
    WithErrorBound result = x;
    result.value = sqrt(x.value);
    if (!x.is_exact_zero())
      result.error = x.value > x.error ? ((x.error / result.value) * kSlack + kUnit * result.value) * kSlack + kTiny
                                       : Real(HUGE_VAL);
    return result;
  }

  GRAZE_IN_PLACE GRAZE_HD friend bool operator<(const WithErrorBound& x, const WithErrorBound& y) {
    return settled(x, y), x.value < y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator>(const WithErrorBound& x, const WithErrorBound& y) {
    return settled(x, y), x.value > y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator<=(const WithErrorBound& x, const WithErrorBound& y) {
    return settled(x, y), x.value <= y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator>=(const WithErrorBound& x, const WithErrorBound& y) {
    return settled(x, y), x.value >= y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator==(const WithErrorBound& x, const WithErrorBound& y) {
    return settled(x, y), x.value == y.value;
  }

 private:
  GRAZE_IN_PLACE GRAZE_HD static WithErrorBound either(const WithErrorBound& x, const WithErrorBound& y) {
    WithErrorBound result;
    result.doubt = x.doubt ? x.doubt : y.doubt;
    return result;
  }

  GRAZE_IN_PLACE GRAZE_HD static WithErrorBound sum(const WithErrorBound& x, const WithErrorBound& y, Real computed) {
    WithErrorBound result = either(x, y);
    result.value = computed;
    // A zero sum of exact numbers is exact: two different numbers never have a difference that rounds to zero.
    if (!(computed == Real(0) && x.is_exact() && y.is_exact()))
      result.error = (x.error + y.error + kUnit * magnitude(computed)) * kSlack + kTiny;
    return result;
  }

  // Whether the exact quantities certainly have the same order as their values: both values are exact, or they differ
  // by more than their bounds and the rounding in this function.
  GRAZE_IN_PLACE GRAZE_HD static bool is_settled(const WithErrorBound& x, const WithErrorBound& y) {
    const Real gap = magnitude(x.value - y.value), errors = (x.error + y.error) * kSlack;
    return (gap * (Real(1) - 4 * kUnit) > errors + kTiny && gap <= kLargest) ||
           (x.is_exact() && y.is_exact() && x.value == x.value && y.value == y.value);
  }

  GRAZE_IN_PLACE GRAZE_HD static void settled(const WithErrorBound& x, const WithErrorBound& y) {
    if (is_settled(x, y)) return;
    if (bool* const doubt = x.doubt ? x.doubt : y.doubt) *doubt = true;
  }

  static constexpr Real kLargest = kIsFloat ? Real(0x1.fffffep127) : Real(0x1.fffffffffffffp1023);
};

// Any component that is certainly nonzero will do. A doubt is raised only if the chosen component may be zero.
template <class Real>
GRAZE_HD int dominant_axis(const Vec3<WithErrorBound<Real>>& v) {
  const int axis = dominant_axis(Vec3<Real>{v.x.value, v.y.value, v.z.value});
  const WithErrorBound<Real>& chosen = component(v, axis);
  if (!chosen.is_nonzero() && chosen.doubt) *chosen.doubt = true;
  return axis;
}

// The least of three exact quantities differs from the least of their values by at most the largest of the bounds, even
// if the least quantity and the least value belong to different vertices. The same holds for the greatest.
template <class Real>
GRAZE_HD Range<WithErrorBound<Real>> project(const Vec3<WithErrorBound<Real>>& direction,
                                             const Vec3<WithErrorBound<Real>> (&v)[3]) {
  const WithErrorBound<Real> first = dot(direction, v[0]);
  Range<WithErrorBound<Real>> range{first, first};
  Real error = first.error;
  for (int i = 1; i < 3; ++i) {
    const WithErrorBound<Real> t = dot(direction, v[i]);
    range.lo.value = t.value < range.lo.value ? t.value : range.lo.value;
    range.hi.value = t.value > range.hi.value ? t.value : range.hi.value;
    if (error == error && !(t.error <= error)) error = t.error;  // NaN stays
  }
  range.lo.error = range.hi.error = error;
  return range;
}

// False only if the ranges are certainly disjoint. If neither answer is certain, returns true and raises a doubt.
template <class Real>
GRAZE_HD bool overlap(const Range<WithErrorBound<Real>>& s, const Range<WithErrorBound<Real>>& t, const ExactZero&,
                      int /*question*/) {
  if (s.hi.is_below(t.lo) || t.hi.is_below(s.lo)) return false;
  static_cast<void>(s.hi < t.lo || t.hi < s.lo);  // raises the doubt
  return true;
}

}  // namespace GRAZE_FP
}  // namespace graze
