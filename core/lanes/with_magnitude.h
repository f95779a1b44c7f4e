// SPDX-License-Identifier: Apache-2.0
// A value, computed as usual, together with the size of the quantities that it was computed from. The size times half
// the machine epsilon bounds the value's rounding error to first order: running error analysis, N. J. Higham, Accuracy
// and Stability of Numerical Algorithms, second edition (2002), section 3.3. The size has the value's unit, so a
// tolerance relative to the size does not change with the scene's scale.
#pragma once

#include <cmath>

#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct WithMagnitude {
  Real value = 0;
  Real size = 0;  // zero for a given number, because it is not rounded

  WithMagnitude() = default;
  GRAZE_IN_PLACE GRAZE_HD explicit WithMagnitude(Real given) : value(given) {}
  GRAZE_IN_PLACE GRAZE_HD WithMagnitude(Real computed, Real of_operands)
      : value(computed), size(of_operands + magnitude(computed)) {}

  GRAZE_IN_PLACE GRAZE_HD WithMagnitude operator-() const {
    WithMagnitude result = *this;
    result.value = -value;
    return result;
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithMagnitude operator+(const WithMagnitude& x, const WithMagnitude& y) {
    return {x.value + y.value, x.size + y.size};
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithMagnitude operator-(const WithMagnitude& x, const WithMagnitude& y) {
    return {x.value - y.value, x.size + y.size};
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithMagnitude operator*(const WithMagnitude& x, const WithMagnitude& y) {
    return {x.value * y.value, magnitude(x.value) * y.size + magnitude(y.value) * x.size};
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithMagnitude operator/(const WithMagnitude& x, const WithMagnitude& y) {
    const Real quotient = x.value / y.value;
    return {quotient, (x.size + magnitude(quotient) * y.size) / magnitude(y.value)};
  }
  GRAZE_IN_PLACE GRAZE_HD friend WithMagnitude sqrt(const WithMagnitude& x) {
    using std::sqrt;
    const Real root = sqrt(x.value);
    return {root, x.size == Real(0) ? Real(0) : x.size / (root + root)};
  }

  GRAZE_IN_PLACE GRAZE_HD friend bool operator<(const WithMagnitude& x, const WithMagnitude& y) {
    return x.value < y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator>(const WithMagnitude& x, const WithMagnitude& y) {
    return x.value > y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator<=(const WithMagnitude& x, const WithMagnitude& y) {
    return x.value <= y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator>=(const WithMagnitude& x, const WithMagnitude& y) {
    return x.value >= y.value;
  }
  GRAZE_IN_PLACE GRAZE_HD friend bool operator==(const WithMagnitude& x, const WithMagnitude& y) {
    return x.value == y.value;
  }
};

}  // namespace GRAZE_FP
}  // namespace graze
