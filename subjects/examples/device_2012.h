// SPDX-License-Identifier: Apache-2.0
// The float arithmetic of CUDA devices in 2012, as a scalar type for the published algorithms. Multiply-adds follow the
// PTX ISA (mad.f32 and fma.f32). Division, square root and the choice of the fused product are only modelled, because
// no document defines their bits.
#pragma once

#include <bit>
#include <cfloat>
#include <cmath>
#include <compare>
#include <cstdint>

namespace graze::device_2012 {

enum class Mad {
  none,        // a product is rounded before it is added
  truncating,  // mad.f32 on devices of compute capability 1.x
  fused,       // fma.rn.f32, or mad.f32 on devices of compute capability 2.0 and later
};
enum class Fuses { left, right };  // which product of a * b + c * d is fused into the sum; the other is rounded
enum class Division {
  ieee,        // correctly rounded division and square root; keeps subnormal numbers, which the others flush
  reciprocal,  // x * (1 / y), and 1 / (1 / sqrt(x)), with each step rounded
  two_ulps,    // the rounded result moved by at most 2 ulps, the documented maximum of a division
};

struct Device {
  Mad mad;
  Fuses fuses;
  Division division;
};

// a * b + c with a truncated product. The product is cut to 24 significant bits, with an exponent of any size. The
// addition rounds once.
inline float truncating_mad(float a, float b, float c) {
  if (c == 0) return a * b + c;
  constexpr std::uint64_t kCut = (std::uint64_t{1} << (DBL_MANT_DIG - FLT_MANT_DIG)) - 1;
  const double product = std::bit_cast<double>(std::bit_cast<std::uint64_t>(double{a} * double{b}) & ~kCut);
  const float in_range = static_cast<float>(product);
  if (double{in_range} == product) return in_range + c;
  int exponent;  // the product may exceed float's range, so fma gets it as two factors
  const auto mantissa = static_cast<float>(std::frexp(product, &exponent));
  return std::fma(std::ldexp(mantissa, exponent / 2), std::ldexp(1.0f, exponent - exponent / 2), c);
}

// Moves x by -2 to 2 ulps; a hash of x selects the number.
inline float off_by_ulps(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::isnormal(x) ? std::bit_cast<float>(bits + (bits * 0x9e3779b9u >> 16) % 5 - 2) : x;
}

// A number on the device. A product keeps its factors, so that the next sum can fuse them: across statements, as nvcc
// does, and even if the product has other uses.
template <Device kDevice>
class Number {
 public:
  Number() = default;
  explicit Number(float x) : value(flushed(x)) {}

  friend Number operator-(Number x) {
    x.value = -x.value;
    x.factor = -x.factor;
    return x;
  }
  friend Number operator*(const Number& x, const Number& y) {
    Number product(x.value * y.value);
    product.is_product = true;
    product.factor = x.value;
    product.other_factor = y.value;
    return product;
  }
  friend Number operator+(const Number& x, const Number& y) {
    if (kDevice.mad == Mad::none || !(x.is_product || y.is_product)) return Number(x.value + y.value);
    const bool first = x.is_product && !(y.is_product && kDevice.fuses == Fuses::right);
    return first ? mad(x, y.value) : mad(y, x.value);
  }
  friend Number operator-(const Number& x, const Number& y) { return x + -y; }
  friend Number operator/(const Number& x, const Number& y) {
    if (kDevice.division == Division::reciprocal) return Number(x.value * flushed(1 / y.value));
    return approximated(x.value / y.value);
  }
  friend Number sqrt(const Number& x) {
    if (kDevice.division != Division::reciprocal) return approximated(std::sqrt(x.value));
    return Number(1 / static_cast<float>(1 / std::sqrt(double{x.value})));
  }
  friend auto operator<=>(const Number& x, const Number& y) { return x.value <=> y.value; }
  friend bool operator==(const Number& x, const Number& y) { return x.value == y.value; }

  explicit operator float() const { return value; }

 private:
  static float flushed(float x) {
    return kDevice.division != Division::ieee && std::abs(x) < FLT_MIN ? std::copysign(0.0f, x) : x;
  }

  static Number approximated(float x) { return Number(kDevice.division == Division::two_ulps ? off_by_ulps(x) : x); }

  static Number mad(const Number& product, float c) {
    return Number(kDevice.mad == Mad::fused ? std::fma(product.factor, product.other_factor, c)
                                            : truncating_mad(product.factor, product.other_factor, c));
  }

  float value = 0, factor = 0, other_factor = 0;
  bool is_product = false;
};

}  // namespace graze::device_2012
