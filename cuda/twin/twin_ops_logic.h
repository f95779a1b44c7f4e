// SPDX-License-Identifier: Apache-2.0
// More PTX operations on the CPU: integers, comparisons, conversions.
#pragma once

#include "cuda/twin/twin_ops.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {

// ---- integers ----

template <class T>
T mul_lo(T a, T b) {
  return static_cast<T>(static_cast<u64>(a) * static_cast<u64>(b));
}

template <class T>
using Wide = std::conditional_t<std::is_signed_v<T>, std::conditional_t<sizeof(T) == 2, s32, s64>,
                                std::conditional_t<sizeof(T) == 2, u32, u64>>;

template <class T>
Wide<T> mul_wide(T a, T b) {
  return static_cast<Wide<T>>(static_cast<Wide<T>>(a) * static_cast<Wide<T>>(b));
}

template <class T>
T mul_hi(T a, T b) {
  if constexpr (sizeof(T) == 8) {
    const u64 x = static_cast<u64>(a), y = static_cast<u64>(b);
    const u64 low = (x & 0xffffffffu) * (y & 0xffffffffu), one = (x >> 32) * (y & 0xffffffffu) + (low >> 32),
              two = (x & 0xffffffffu) * (y >> 32) + (one & 0xffffffffu);
    u64 high = (x >> 32) * (y >> 32) + (one >> 32) + (two >> 32);
    if constexpr (std::is_signed_v<T>) high -= (a < 0 ? y : 0) + (b < 0 ? x : 0);
    return static_cast<T>(high);
  } else {
    return static_cast<T>(mul_wide(a, b) >> (8 * sizeof(T)));
  }
}

// PTX does not define division by zero. Devices return a quotient of all ones, and the dividend as the remainder.
template <class T>
T quotient(T a, T b) {
  if (b == 0) return static_cast<T>(-1);
  if (std::is_signed_v<T> && b == static_cast<T>(-1)) return neg(a);
  return static_cast<T>(a / b);
}

template <class T>
T remainder(T a, T b) {
  if (b == 0) return a;
  if (std::is_signed_v<T> && b == static_cast<T>(-1)) return 0;
  return static_cast<T>(a % b);
}

// |a - b|
template <class T>
T sad(T a, T b) {
  return a < b ? sub(b, a) : sub(a, b);
}

// Shifts by at least the type's width give zero, or copies of the sign.
template <class T>
T shl(T x, u32 by) {
  return by < 8 * sizeof(T) ? static_cast<T>(static_cast<u64>(x) << by) : T{0};
}

template <class T>
T shr(T x, u32 by) {
  return by < 8 * sizeof(T) ? static_cast<T>(x >> by) : x < 0 ? static_cast<T>(-1) : T{0};
}

// ---- comparisons; with a NaN, comparisons with u are true and all others are false ----

template <class T>
bool eq(T a, T b) {
  return a == b;
}
template <class T>
bool ne(T a, T b) {
  if constexpr (std::is_integral_v<T>)
    return a != b;
  else
    return a < b || a > b;
}
template <class T>
bool lt(T a, T b) {
  return a < b;
}
template <class T>
bool le(T a, T b) {
  return a <= b;
}
template <class T>
bool gt(T a, T b) {
  return a > b;
}
template <class T>
bool ge(T a, T b) {
  return a >= b;
}
template <class T>
bool equ(T a, T b) {
  return !ne(a, b);
}
template <class T>
bool neu(T a, T b) {
  return !(a == b);
}
template <class T>
bool ltu(T a, T b) {
  return !(a >= b);
}
template <class T>
bool leu(T a, T b) {
  return !(a > b);
}
template <class T>
bool gtu(T a, T b) {
  return !(a <= b);
}
template <class T>
bool geu(T a, T b) {
  return !(a < b);
}
template <class T>
bool num(T a, T b) {
  return !is_nan(a) && !is_nan(b);
}
template <class T>
bool nan(T a, T b) {
  return is_nan(a) || is_nan(b);
}

template <class T>
bool test_finite(T x) {
  return abs(x) <= std::numeric_limits<T>::max();
}
template <class T>
bool test_infinite(T x) {
  return abs(x) == std::numeric_limits<T>::infinity();
}
template <class T>
bool test_number(T x) {
  return !is_nan(x);
}
template <class T>
bool test_notanumber(T x) {
  return is_nan(x);
}
template <class T>
bool test_normal(T x) {  // zero counts as normal
  return test_finite(x) && !is_subnormal(x);
}
template <class T>
bool test_subnormal(T x) {
  return is_subnormal(x);
}

// ---- conversions ----

// rni, rzi, rmi and rpi round to an integral number: to nearest even, toward zero, down, up. A zero keeps its sign.
template <class T>
T rni(T x) {
  return std::nearbyint(x);
}
template <class T>
T rzi(T x) {
  return std::trunc(x);
}
template <class T>
T rmi(T x) {
  return std::floor(x);
}
template <class T>
T rpi(T x) {
  return std::ceil(x);
}

// Converts an integral floating-point number to the nearest integer of the type. NaN becomes 0, or the integer with
// only the top bit set if either type has 64 bits.
template <class To, class From>
To to_integer(From x) {
  if (is_nan(x))
    return sizeof(From) == 8 || sizeof(To) == 8 ? static_cast<To>(Bits<To>{1} << (8 * sizeof(To) - 1)) : To{0};
  const From above = static_cast<From>(std::numeric_limits<To>::max() / 2 + 1) * 2;  // 2^bits, or 2^(bits - 1): exact
  if (x >= above) return std::numeric_limits<To>::max();
  if (x <= static_cast<From>(std::numeric_limits<To>::min())) return std::numeric_limits<To>::min();
  return static_cast<To>(x);
}

// cvt.sat between integers: clamps to the range of the type.
template <class To, class From>
To clamped(From x) {
  if constexpr (std::is_signed_v<From>) {
    const s64 wide = x;
    if (std::is_unsigned_v<To> && wide < 0) return 0;
    if (std::is_signed_v<To> && wide < static_cast<s64>(std::numeric_limits<To>::min()))
      return std::numeric_limits<To>::min();
    if (wide < 0) return static_cast<To>(wide);
  }
  const u64 most = static_cast<u64>(std::numeric_limits<To>::max());
  return static_cast<u64>(x) > most ? std::numeric_limits<To>::max() : static_cast<To>(x);
}

}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
