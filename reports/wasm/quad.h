// SPDX-License-Identifier: Apache-2.0
// The compiler's long double as a number for the algorithms. In WebAssembly it has 113 bits and exponents to 2^16383,
// in software: most determinants of float32 numbers are exact in it.
#pragma once

#include <cmath>
#include <compare>

namespace graze::reports::wasm {

struct Quad {
  long double value = 0;

  Quad() = default;
  template <class Number>
  explicit Quad(Number x) : value(static_cast<long double>(x)) {}

  friend Quad operator+(Quad l, Quad r) { return Quad(l.value + r.value); }
  friend Quad operator-(Quad l, Quad r) { return Quad(l.value - r.value); }
  friend Quad operator*(Quad l, Quad r) { return Quad(l.value * r.value); }
  friend Quad operator/(Quad l, Quad r) { return Quad(l.value / r.value); }
  friend Quad operator-(Quad x) { return Quad(-x.value); }
  friend Quad sqrt(Quad x) { return Quad(std::sqrt(x.value)); }
  friend std::partial_ordering compare_numbers(Quad l, Quad r) { return l.value <=> r.value; }
};

}  // namespace graze::reports::wasm
