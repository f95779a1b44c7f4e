// SPDX-License-Identifier: Apache-2.0
// More PTX operations on the CPU, which round toward zero, down and up. f32 operations round the exact result, held as
// a double and the sign of the remainder. f64 operations set the processor's rounding mode.
#pragma once

#include <cfenv>

#include "cuda/twin/twin_ops_logic.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {

enum class Rounding { rz, rm, rp };

// An exact number: a nearby double, and the sign of the remainder, which is below half of the double's last place.
struct Exact {
  f64 near;
  int rest;
};

inline int sign_of(f64 x) { return (x > 0) - (x < 0); }

inline Exact exact_sum(f64 a, f64 b) {  // Knuth's TwoSum
  const f64 sum = a + b, part = sum - a;
  return {sum, sign_of((a - (sum - part)) + (b - part))};
}

inline f32 next_to(f32 x, bool up) {
  return std::nextafter(x, up ? std::numeric_limits<f32>::infinity() : -std::numeric_limits<f32>::infinity());
}

// With Flush, a result becomes zero if it is below the least normal number after rounding to 24 bits, as in
// twin_ops.h.
template <Rounding R, bool Flush>
f32 narrowed(Exact x) {
  if (is_nan(x.near) || abs(x.near) == std::numeric_limits<f64>::infinity()) return static_cast<f32>(x.near);
  const bool negative = x.near < 0 || (x.near == 0 && std::signbit(x.near));
  if (Flush && x.near != 0) {
    const bool away = R == Rounding::rp ? !negative : R == Rounding::rm && negative;
    const f64 limit = away ? 0x1p-126 - 0x1p-150 : 0x1p-126;  // larger results become the least normal number
    const int above = abs(x.near) > limit ? 1 : abs(x.near) < limit ? -1 : negative ? -x.rest : x.rest;
    if (above < 0 || (away && above == 0)) return negative ? -0.0f : 0.0f;
  }
  const f32 result = static_cast<f32>(x.near);
  const int side = result < x.near ? 1 : result > x.near ? -1 : x.rest;  // the side on which the exact number lies
  if (side < 0 && (R == Rounding::rm || (R == Rounding::rz && !negative))) return next_to(result, false);
  if (side > 0 && (R == Rounding::rp || (R == Rounding::rz && negative))) return next_to(result, true);
  return result;
}

// Runs an f64 operation in a rounding mode. The result is volatile, because compilers assume the default rounding mode.
template <Rounding R, class Operation>
auto in_mode(Operation operation) {
  std::fesetround(R == Rounding::rz ? FE_TOWARDZERO : R == Rounding::rm ? FE_DOWNWARD : FE_UPWARD);
  const volatile auto result = operation();
  std::fesetround(FE_TONEAREST);
  return result;
}

template <Rounding R, bool Flush, class T>
T rounded_add(T a, T b) {
  if constexpr (sizeof(T) == 4) {
    const Exact sum = exact_sum(a, b);
    if (sum.near != 0) return narrowed<R, Flush>(sum);
    return R == Rounding::rm && (std::signbit(a) || std::signbit(b)) ? -0.0f : a + b;
  } else {
    const volatile T x = a, y = b;
    return in_mode<R>([&] { return x + y; });
  }
}

template <Rounding R, bool Flush, class T>
T rounded_sub(T a, T b) {
  return rounded_add<R, Flush>(a, neg(b));
}

template <Rounding R, bool Flush, class T>
T rounded_mul(T a, T b) {
  if constexpr (sizeof(T) == 4) {
    return narrowed<R, Flush>({f64{a} * f64{b}, 0});
  } else {
    const volatile T x = a, y = b;
    return in_mode<R>([&] { return x * y; });
  }
}

template <Rounding R, bool Flush, class T>
T rounded_fma(T a, T b, T c) {
  if constexpr (sizeof(T) == 4) {
    const f64 product = f64{a} * f64{b};
    const Exact sum = exact_sum(product, c);
    if (sum.near != 0) return narrowed<R, Flush>(sum);
    return R == Rounding::rm && (std::signbit(product) || std::signbit(c)) ? -0.0f : static_cast<f32>(sum.near);
  } else {
    const volatile T x = a, y = b, z = c;
    return in_mode<R>([&] { return __builtin_fma(x, y, z); });
  }
}

template <Rounding R, bool Flush, class T>
T rounded_div(T a, T b) {
  if constexpr (sizeof(T) == 4) {
    const f64 near = f64{a} / f64{b};
    if (near == 0 || is_nan(near) || abs(near) == std::numeric_limits<f64>::infinity()) return static_cast<f32>(near);
    const int left = sign_of(__builtin_fma(-near, f64{b}, f64{a}));
    return narrowed<R, Flush>({near, b < 0 ? -left : left});
  } else {
    const volatile T x = a, y = b;
    return in_mode<R>([&] { return x / y; });
  }
}

template <Rounding R, bool Flush, class T>
T rounded_rcp(T x) {
  return rounded_div<R, Flush>(T{1}, x);
}

template <Rounding R, bool Flush, class T>
T rounded_sqrt(T a) {
  if constexpr (sizeof(T) == 4) {
    const f64 near = sqrt(f64{a});
    if (!(near > 0 && near <= std::numeric_limits<f64>::max())) return static_cast<f32>(near);
    return narrowed<R, Flush>({near, sign_of(__builtin_fma(-near, near, f64{a}))});
  } else {
    const volatile T x = a;
    return in_mode<R>([&] { return __builtin_sqrt(x); });
  }
}

// Converts a double to a float (cvt.f32.f64).
template <Rounding R, bool Flush>
f32 rounded_narrow(f64 x) {
  if (x == 0) return static_cast<f32>(x);
  return narrowed<R, Flush>({x, 0});
}

// Converts an integer to a floating-point number (cvt).
template <Rounding R, class To, class From>
To rounded_integer(From x) {
  const volatile From integer = x;
  return in_mode<R>([&] { return static_cast<To>(integer); });
}

}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
