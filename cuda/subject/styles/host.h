// SPDX-License-Identifier: Apache-2.0
// The CUDA features that the styles use, for the host's compiler: qualifiers, and functions on the bits of integers.
#pragma once

#include <cfenv>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstring>

#define __device__
#define __constant__
#define __noinline__ __attribute__((noinline))

using std::isfinite;
using std::isnan;
using std::signbit;

inline unsigned __float_as_uint(float x) {
  unsigned bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline int __float_as_int(float x) { return (int)__float_as_uint(x); }
inline int __popc(unsigned x) { return __builtin_popcount(x); }
inline int __popcll(unsigned long long x) { return __builtin_popcountll(x); }
inline int __clz(int x) { return x ? __builtin_clz((unsigned)x) : 32; }
inline int __ffs(int x) { return __builtin_ffs(x); }
inline unsigned __brev(unsigned x) {
  unsigned result = 0;
  for (int i = 0; i < 32; ++i) result |= (x >> i & 1) << (31 - i);
  return result;
}
inline unsigned __funnelshift_l(unsigned low, unsigned high, unsigned by) {
  by %= 32;
  return by ? high << by | low >> (32 - by) : high;
}
inline unsigned __byte_perm(unsigned a, unsigned b, unsigned choice) {
  unsigned char bytes[8];
  std::memcpy(bytes, &a, 4);
  std::memcpy(bytes + 4, &b, 4);
  unsigned result = 0;
  for (int k = 0; k < 4; ++k) result |= (unsigned)bytes[choice >> (4 * k) & 7] << (8 * k);
  return result;
}
inline unsigned __usad(unsigned a, unsigned b, unsigned c) { return (a < b ? b - a : a - b) + c; }
inline unsigned __umulhi(unsigned a, unsigned b) { return (unsigned)((unsigned long long)a * b >> 32); }

// Runs an operation in another rounding mode of the processor.
template <class F>
auto in_rounding_mode(int mode, F f) {
  std::fesetround(mode);
  const volatile auto result = f();
  std::fesetround(FE_TONEAREST);
  return result;
}
#define GRAZE_ROUNDED(name, mode, expression)                           \
  inline float name(float a_, float b_) {                               \
    const volatile float a = a_, b = b_;                                \
    return in_rounding_mode(mode, [&] { return (float)(expression); }); \
  }
GRAZE_ROUNDED(__fadd_rd, FE_DOWNWARD, a + b)
GRAZE_ROUNDED(__fadd_ru, FE_UPWARD, a + b)
GRAZE_ROUNDED(__fsub_rd, FE_DOWNWARD, a - b)
GRAZE_ROUNDED(__fmul_rd, FE_DOWNWARD, a* b)
GRAZE_ROUNDED(__fmul_ru, FE_UPWARD, a* b)
GRAZE_ROUNDED(__fdiv_rd, FE_DOWNWARD, a / b)
inline float __fsqrt_ru(float x_) {
  const volatile float x = x_;
  return in_rounding_mode(FE_UPWARD, [&] { return __builtin_sqrtf(x); });
}
inline float __fmaf_ru(float x_, float y_, float z_) {
  const volatile float x = x_, y = y_, z = z_;
  return in_rounding_mode(FE_UPWARD, [&] { return __builtin_fmaf(x, y, z); });
}
inline double __dadd_rz(double x_, double y_) {
  const volatile double x = x_, y = y_;
  return in_rounding_mode(FE_TOWARDZERO, [&] { return x + y; });
}
inline float __double2float_rz(double x_) {
  const volatile double x = x_;
  return in_rounding_mode(FE_TOWARDZERO, [&] { return (float)x; });
}
inline float __int2float_rd(int x_) {
  const volatile int x = x_;
  return in_rounding_mode(FE_DOWNWARD, [&] { return (float)x; });
}
inline int __float2int_rn(float x) {  // the nearest int; 0 for NaN
  if (x != x) return 0;
  const double near = std::nearbyint((double)x);
  return near >= 2147483647.0 ? INT_MAX : near <= -2147483648.0 ? INT_MIN : (int)near;
}
