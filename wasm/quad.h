// SPDX-License-Identifier: Apache-2.0
// The compiler's long double with an error bound, as a number type for the algorithms. For WebAssembly, long
// double is implemented in software, with 113 bits and exponents up to 16383. Two numbers count as equal if their error
// bounds overlap, as in oracle/multiprecision.h.
#pragma once

#include <cmath>
#include <compare>

namespace graze::wasm {

struct Quad {
  static constexpr long double kUnit = 0x1p-112L;  // twice the unit roundoff, because the bounds are rounded too

  long double value = 0, error = 0;

  Quad() = default;
  template <class Number>
  explicit Quad(Number x) : value(static_cast<long double>(x)) {}
  Quad(long double v, long double propagated) : value(v), error(propagated + kUnit * std::abs(v)) {}

  friend Quad operator+(const Quad& l, const Quad& r) { return {l.value + r.value, l.error + r.error}; }
  friend Quad operator-(const Quad& l, const Quad& r) { return {l.value - r.value, l.error + r.error}; }
  friend Quad operator*(const Quad& l, const Quad& r) {
    return {l.value * r.value, (std::abs(l.value) + l.error) * r.error + std::abs(r.value) * l.error};
  }
  friend Quad operator/(const Quad& l, const Quad& r) {
    const long double ratio = l.value / r.value, divisor = std::abs(r.value) - r.error;
    return {ratio, divisor > 0 ? (l.error + std::abs(ratio) * r.error) / divisor : INFINITY};
  }
  friend Quad operator-(const Quad& x) {
    Quad result = x;
    result.value = -x.value;
    return result;
  }
  friend Quad sqrt(const Quad& x) {
    const long double root = std::sqrt(x.value);
    return {root, x.error == 0 ? 0 : x.value > x.error ? x.error / root : std::sqrt(std::abs(x.value) + x.error)};
  }
  friend std::partial_ordering compare_numbers(const Quad& l, const Quad& r) {
    if (std::abs(l.value - r.value) <= l.error + r.error) return std::partial_ordering::equivalent;
    return l.value <=> r.value;
  }
};

}  // namespace graze::wasm
