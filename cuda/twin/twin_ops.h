// SPDX-License-Identifier: Apache-2.0
// PTX operations on the CPU, one function per operation, which generated twins call. Numbers are IEEE 754 binary32 and
// binary64, rounded to nearest even. A NaN's bits are replayed only in bits_of. Requires: compilation with
// -ffp-contract=off, and a separate namespace GRAZE_FP for each instruction set. Reference: NVIDIA, PTX ISA 9.0,
// chapter 9.7.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/vec3.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {

using u8 = std::uint8_t;
using u16 = std::uint16_t;
using u32 = std::uint32_t;
using u64 = std::uint64_t;
using s8 = std::int8_t;
using s16 = std::int16_t;
using s32 = std::int32_t;
using s64 = std::int64_t;
using f32 = float;
using f64 = double;

template <class T>
using Bits = std::conditional_t<sizeof(T) == 1, u8,
                                std::conditional_t<sizeof(T) == 2, u16, std::conditional_t<sizeof(T) == 4, u32, u64>>>;

// The bits of a register. Float32 operations return different NaNs on a device and on x86, which matters if the bits
// are read. Float64 operations return the same NaN on a device and on x86.
constexpr u32 bits_of(f32 x) {
  const u32 bits = std::bit_cast<u32>(x);
  return bits == 0xffc00000u ? 0x7fffffffu : bits;
}
constexpr u64 bits_of(f64 x) { return std::bit_cast<u64>(x); }

// The register's bits as another type of the same size. Integers of a different size are extended or truncated.
template <class T, class From>
constexpr T as(From x) {
  if constexpr (std::is_integral_v<T> && std::is_integral_v<From>) {
    return static_cast<T>(x);
  } else if constexpr (std::is_integral_v<T>) {
    return std::bit_cast<T>(bits_of(x));
  } else {
    return std::bit_cast<T>(x);
  }
}

template <class T>
T load(u64 address) {
  T value;
  std::memcpy(&value, reinterpret_cast<const void*>(address), sizeof value);
  return value;
}

template <class T>
void store(u64 address, T value) {
  std::memcpy(reinterpret_cast<void*>(address), &value, sizeof value);
}

// ---- bits of floating-point numbers ----

template <class T>
constexpr Bits<T> kSign = Bits<T>{1} << (8 * sizeof(T) - 1);

template <class T>
T neg(T x) {
  if constexpr (std::is_integral_v<T>)
    return static_cast<T>(Bits<T>{0} - static_cast<Bits<T>>(x));
  else
    return std::bit_cast<T>(std::bit_cast<Bits<T>>(x) ^ kSign<T>);
}

template <class T>
T abs(T x) {
  if constexpr (std::is_integral_v<T>)
    return x < 0 ? neg(x) : x;
  else
    return std::bit_cast<T>(std::bit_cast<Bits<T>>(x) & ~kSign<T>);
}

// The magnitude of b with the sign of a, in PTX's operand order.
template <class T>
T copysign(T a, T b) {
  return std::bit_cast<T>((bits_of(a) & kSign<T>) | (std::bit_cast<Bits<T>>(b) & ~kSign<T>));
}

template <class T>
bool is_nan(T x) {
  return x != x;
}

template <class T>
bool is_subnormal(T x) {
  return x != 0 && abs(x) < std::numeric_limits<T>::min();
}

// .ftz: a subnormal number becomes a zero of the same sign.
inline f32 flushed(f32 x) { return is_subnormal(x) ? copysign(x, 0.0f) : x; }

// .sat: clamps to [0, 1]; NaN becomes +0.
template <class T>
T saturated(T x) {
  return x > 0 ? (x < 1 ? x : T{1}) : T{0};
}

// ---- arithmetic ----

template <class T>
T fma(T a, T b, T c) {
  if constexpr (sizeof(T) == 4)
    return __builtin_fmaf(a, b, c);
  else
    return __builtin_fma(a, b, c);
}

template <class T>
T add(T a, T b) {
  if constexpr (std::is_integral_v<T>)
    return static_cast<T>(static_cast<u64>(a) + static_cast<u64>(b));
  else
    return a + b;
}

template <class T>
T sub(T a, T b) {
  if constexpr (std::is_integral_v<T>)
    return static_cast<T>(static_cast<u64>(a) - static_cast<u64>(b));
  else
    return a - b;
}

template <class T>
T mul(T a, T b) {
  return a * b;
}

template <class T>
T div(T a, T b) {
  return a / b;
}

// .ftz depends on the result rounded to 24 bits with unlimited exponent range, as measured on an H100. IEEE arithmetic
// rounds results below the least normal number to fewer bits, so it would round the largest flushed results up to that
// number. Sums and differences near that number are exact, so only products and quotients are affected.
constexpr f64 kFlushBelow = 0x1p-126 - 0x1p-151;

inline f32 mul_ftz(f32 a, f32 b) {
  const f64 exact = f64{flushed(a)} * f64{flushed(b)};
  return abs(exact) < kFlushBelow ? static_cast<f32>(copysign(exact, 0.0)) : flushed(a) * flushed(b);
}

inline f32 fma_ftz(f32 a, f32 b, f32 c) {
  const f64 product = f64{flushed(a)} * f64{flushed(b)}, addend = flushed(c);
  const f64 sum = product + addend, part = sum - product;
  const f64 rest = (product - (sum - part)) + (addend - part);  // the sum is exactly sum + rest: Knuth's TwoSum
  const bool flushes = abs(sum) < kFlushBelow || (abs(sum) == kFlushBelow && rest != 0 && (rest < 0) == (sum > 0));
  return flushes ? static_cast<f32>(copysign(sum, 0.0)) : fma(flushed(a), flushed(b), flushed(c));
}

// Double precision cannot round a quotient of floats to the limit, because the two differ relatively by at least 2^-49.
inline f32 div_ftz(f32 a, f32 b) {
  const f64 quotient = f64{flushed(a)} / f64{flushed(b)};
  return abs(quotient) < kFlushBelow ? static_cast<f32>(copysign(quotient, 0.0)) : flushed(a) / flushed(b);
}

inline f32 narrow_ftz(f64 x) { return abs(x) < kFlushBelow ? static_cast<f32>(copysign(x, 0.0)) : static_cast<f32>(x); }

template <class T>
T sqrt(T x) {
  if constexpr (sizeof(T) == 4)
    return __builtin_sqrtf(x);
  else
    return __builtin_sqrt(x);
}

// If one operand is NaN, the result is the other operand. -0 is less than +0.
template <class T>
T min(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (is_nan(a)) return b;
    if (is_nan(b)) return a;
    if (a == b) return std::bit_cast<T>(std::bit_cast<Bits<T>>(a) | std::bit_cast<Bits<T>>(b));
  }
  return b < a ? b : a;
}

template <class T>
T max(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (is_nan(a)) return b;
    if (is_nan(b)) return a;
    if (a == b) return std::bit_cast<T>(std::bit_cast<Bits<T>>(a) & std::bit_cast<Bits<T>>(b));
  }
  return a < b ? b : a;
}

// .NaN: the result is NaN if either operand is NaN.
template <class T>
T min_nan(T a, T b) {
  return is_nan(a) || is_nan(b) ? std::numeric_limits<T>::quiet_NaN() : min(a, b);
}

template <class T>
T max_nan(T a, T b) {
  return is_nan(a) || is_nan(b) ? std::numeric_limits<T>::quiet_NaN() : max(a, b);
}

// ---- contractions ----

// Fuses every contraction site, as the kernel does.
struct AllFused {
  template <class T>
  T operator()(int, T a, T b, T c) const {
    return fma(a, b, c);
  }
  static f32 flushing(int, f32 a, f32 b, f32 c) { return fma_ftz(a, b, c); }

  // Every comparison of numbers passes through here, with its PTX line and its outcome.
  template <class T>
  static bool compared(int, T, T, bool outcome) {
    return outcome;
  }
};

// Rounds twice at the sites whose bit is not set.
struct SomeFused {
  const u64* bits;

  template <class T>
  T operator()(int site, T a, T b, T c) const {
    return fused(site) ? fma(a, b, c) : a * b + c;
  }
  f32 flushing(int site, f32 a, f32 b, f32 c) const {
    return fused(site) ? fma_ftz(a, b, c) : flushed(mul_ftz(a, b) + flushed(c));
  }
  bool fused(int site) const { return bits[site / 64] >> (site % 64) & 1; }

  template <class T>
  static bool compared(int, T, T, bool outcome) {
    return outcome;
  }
};

}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
