// SPDX-License-Identifier: Apache-2.0
// Tests every PTX operation that the generator replays, on special values. The generator translates
// cuda/twin/generator/semantics.ptx; its results are compared with the standard library or the text of the PTX ISA.
#include "cuda/twin/twin_ops_bits.h"
#include "cuda/twin/twin_ops_rounding.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "cuda/lanes/device.h"
#include "cuda/twin/ptx_testing.h"
#include "cuda/twin/twin.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#include "cuda/generated/semantics.inc"
#pragma GCC diagnostic pop

#include "cuda/twin/twin_ops_testing.inl"

template <class Real>
Real flush(Real x) {
  return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(Real(0), x) : x;
}

// A .ftz result: rounded once to 24 bits with unlimited exponent, then flushed. Only sums far from the limit need more
// bits than long double has.
f32 flushed_result(long double exact, f32 rounded) {
  return std::fabs(exact) < 0x1p-126L - 0x1p-151L ? std::copysign(0.0f, static_cast<f32>(exact)) : rounded;
}

template <class Real>
Real clamp(Real x) {
  return std::isnan(x) ? Real(0) : x <= 0 ? Real(0) : x > 1 ? Real(1) : x;
}

template <class Real>
Real least(Real a, Real b) {
  return a == 0 && b == 0 ? (std::signbit(a) ? a : b) : std::fmin(a, b);
}

template <class Real>
Real greatest(Real a, Real b) {
  return a == 0 && b == 0 ? (std::signbit(a) ? b : a) : std::fmax(a, b);
}

// The integer of this type nearest to an integral value. According to the PTX ISA (cvt), NaN becomes 0, or the integer
// with only the top bit set if either type has 64 bits.
template <class To, class Real>
To nearest_integer(Real x, To of_nan) {
  if (std::isnan(x)) return of_nan;
  const long double wide = x;
  return wide >= static_cast<long double>(Limits<To>::max())   ? Limits<To>::max()
         : wide <= static_cast<long double>(Limits<To>::min()) ? Limits<To>::min()
                                                               : static_cast<To>(wide);
}

template <class Real>
std::vector<Slot<Real>> arithmetic() {
  return {slot<Real>("add", [](Real a, Real b, Real) { return a + b; }),
          slot<Real>("sub", [](Real a, Real b, Real) { return a - b; }),
          slot<Real>("mul", [](Real a, Real b, Real) { return a * b; }),
          slot<Real>("fma", [](Real a, Real b, Real c) { return std::fma(a, b, c); }),
          slot<Real>("div", [](Real a, Real b, Real) { return a / b; }),
          slot<Real>("sqrt", [](Real a, Real, Real) { return std::sqrt(a); }),
          slot<Real>("min", [](Real a, Real b, Real) { return least(a, b); }),
          slot<Real>("max", [](Real a, Real b, Real) { return greatest(a, b); }),
          slot<Real>("neg", [](Real a, Real, Real) { return -a; }),
          slot<Real>("abs", [](Real a, Real, Real) { return std::fabs(a); }),
          slot<Real>("copysign", [](Real a, Real b, Real) { return std::copysign(b, a); })};
}

std::vector<Slot<f32>> flushing() {
  using F = f32;
  return {slot<F>("add.ftz", [](F a, F b, F) { return flush(flush(a) + flush(b)); }),
          slot<F>("sub.ftz", [](F a, F b, F) { return flush(flush(a) - flush(b)); }),
          slot<F>("mul.ftz",
                  [](F a, F b, F) {
                    return flushed_result(static_cast<long double>(flush(a)) * flush(b), flush(a) * flush(b));
                  }),
          slot<F>("fma.ftz",
                  [](F a, F b, F c) {
                    const long double exact = static_cast<long double>(flush(a)) * flush(b) + flush(c);
                    return flushed_result(exact, std::fma(flush(a), flush(b), flush(c)));
                  }),
          slot<F>("div.ftz",
                  [](F a, F b, F) {
                    return flushed_result(static_cast<long double>(flush(a)) / flush(b), flush(a) / flush(b));
                  }),
          slot<F>("sqrt.ftz", [](F a, F, F) { return std::sqrt(flush(a)); }),
          slot<F>("min.ftz", [](F a, F b, F) { return least(flush(a), flush(b)); }),
          slot<F>("max.ftz", [](F a, F b, F) { return greatest(flush(a), flush(b)); }),
          slot<F>("add.sat", [](F a, F b, F) { return clamp(a + b); }),
          slot<F>("fma.sat", [](F a, F b, F c) { return clamp(std::fma(a, b, c)); })};
}

template <class Real>
std::vector<Slot<Real>> comparisons() {
  using Test = bool (*)(Real, Real);
  const std::pair<const char*, Test> ordered[] = {
      {"eq", [](Real a, Real b) { return a == b; }}, {"ne", [](Real a, Real b) { return a != b; }},
      {"lt", [](Real a, Real b) { return a < b; }},  {"le", [](Real a, Real b) { return a <= b; }},
      {"gt", [](Real a, Real b) { return a > b; }},  {"ge", [](Real a, Real b) { return a >= b; }}};
  std::vector<Slot<Real>> slots;
  for (bool unordered : {false, true}) {
    for (const auto& [name, test] : ordered) {
      slots.push_back(
          slot<Real>(std::string(name) + (unordered ? "u" : ""), [test = test, unordered](Real a, Real b, Real) {
            return std::isunordered(a, b) ? u32{unordered} : u32{test(a, b)};
          }));
    }
  }
  slots.push_back(slot<Real>("num", [](Real a, Real b, Real) { return u32{!std::isunordered(a, b)}; }));
  slots.push_back(slot<Real>("nan", [](Real a, Real b, Real) { return u32{std::isunordered(a, b)}; }));
  // p = (a < b) OP !(a < c), q = !(a < b) OP !(a < c)
  slots.push_back(slot<Real>("lt.and p", [](Real a, Real b, Real c) { return u32{a < b && !(a < c)}; }));
  slots.push_back(slot<Real>("lt.and q", [](Real a, Real b, Real c) { return u32{!(a < b) && !(a < c)}; }));
  slots.push_back(slot<Real>("lt.or p", [](Real a, Real b, Real c) { return u32{a < b || !(a < c)}; }));
  slots.push_back(slot<Real>("lt.or q", [](Real a, Real b, Real c) { return u32{!(a < b) || !(a < c)}; }));
  slots.push_back(slot<Real>("lt.xor p", [](Real a, Real b, Real c) { return u32{(a < b) == (a < c)}; }));
  slots.push_back(slot<Real>("lt.xor q", [](Real a, Real b, Real c) { return u32{(a < b) != (a < c)}; }));
  slots.push_back(slot<Real>("testp.finite", [](Real a, Real, Real) { return u32{std::isfinite(a)}; }));
  slots.push_back(slot<Real>("testp.infinite", [](Real a, Real, Real) { return u32{std::isinf(a)}; }));
  slots.push_back(slot<Real>("testp.number", [](Real a, Real, Real) { return u32{!std::isnan(a)}; }));
  slots.push_back(slot<Real>("testp.notanumber", [](Real a, Real, Real) { return u32{std::isnan(a)}; }));
  slots.push_back(slot<Real>("testp.normal", [](Real a, Real, Real) { return u32{std::isnormal(a) || a == 0}; }));
  slots.push_back(
      slot<Real>("testp.subnormal", [](Real a, Real, Real) { return u32{std::fpclassify(a) == FP_SUBNORMAL}; }));
  slots.push_back(slot<Real>("selp", [](Real a, Real b, Real) { return a > b ? a : b; }));
  return slots;
}

template <class Real>
std::vector<Slot<Real>> conversions() {
  constexpr bool kDouble = sizeof(Real) == 8;
  return {
      slot<Real>("cvt.rni", [](Real a, Real, Real) { return std::rint(a); }),
      slot<Real>("cvt.rzi", [](Real a, Real, Real) { return std::trunc(a); }),
      slot<Real>("cvt.rmi", [](Real a, Real, Real) { return std::floor(a); }),
      slot<Real>("cvt.rpi", [](Real a, Real, Real) { return std::ceil(a); }),
      slot<Real>(
          "cvt.rzi.s32",
          [](Real a, Real, Real) { return nearest_integer<s32>(std::trunc(a), kDouble ? Limits<s32>::min() : 0); }),
      slot<Real>("cvt.rzi.u32",
                 [](Real a, Real, Real) { return nearest_integer<u32>(std::trunc(a), kDouble ? 0x80000000u : 0); }),
      slot<Real>("cvt.rni.s64",
                 [](Real a, Real, Real) { return nearest_integer<s64>(std::rint(a), Limits<s64>::min()); }),
      slot<Real>("cvt.rni.u64", [](Real a, Real, Real) { return nearest_integer<u64>(std::rint(a), u64{1} << 63); })};
}

std::vector<Slot<f32>> f32_slots() {
  using F = f32;
  return joined<F>(
      {arithmetic<F>(),
       flushing(),
       comparisons<F>(),
       conversions<F>(),
       {slot<F>("lt.ftz", [](F a, F b, F) { return u32{flush(a) < flush(b)}; }),
        slot<F>("cvt.f64", [](F a, F, F) { return f64{a}; }),
        slot<F>("cvt.ftz.f64", [](F a, F, F) { return f64{flush(a)}; }),
        slot<F>("cvt.sat", [](F a, F, F) { return clamp(a); }), slot<F>("cvt.ftz", [](F a, F, F) { return flush(a); }),
        slot<F>("cvt.rn.f32.s32", [](F a, F, F) { return static_cast<F>(std::bit_cast<s32>(a)); }),
        slot<F>("cvt.rn.f32.u32", [](F a, F, F) { return static_cast<F>(std::bit_cast<u32>(a)); }),
        slot<F>("one", [](F, F, F) { return F{1}; })}});
}

TEST(TwinOps, F32) { check<semantics_f32, f32>(f32_slots(), special_values<f32>()); }
TEST(TwinOps, F32OnADevice) {
  check_on_device<semantics_f32, f32>("semantics.ptx", f32_slots(), special_values<f32>());
}

std::vector<Slot<f64>> f64_slots() {
  using F = f64;
  return joined<F>({arithmetic<F>(),
                    comparisons<F>(),
                    conversions<F>(),
                    {slot<F>("cvt.rn.f32", [](F a, F, F) { return static_cast<f32>(a); }),
                     slot<F>("cvt.rn.ftz.f32", [](F a, F, F) { return flushed_result(a, static_cast<f32>(a)); }),
                     slot<F>("cvt.rn.f64.s64", [](F a, F, F) { return static_cast<F>(std::bit_cast<s64>(a)); }),
                     slot<F>("cvt.rn.f64.u64", [](F a, F, F) { return static_cast<F>(std::bit_cast<u64>(a)); }),
                     slot<F>("one", [](F, F, F) { return F{1}; })}});
}

TEST(TwinOps, F64) { check<semantics_f64, f64>(f64_slots(), special_values<f64>()); }
TEST(TwinOps, F64OnADevice) {
  check_on_device<semantics_f64, f64>("semantics.ptx", f64_slots(), special_values<f64>());
}

std::vector<Slot<u32>> integer_slots() {
  using I = u32;
  const auto sign = [](I x) { return static_cast<s32>(x); };
  const auto wide = [](I x) { return static_cast<s64>(static_cast<s32>(x)); };
  return {slot<I>("add", [](I a, I b, I) { return a + b; }),
          slot<I>("sub", [](I a, I b, I) { return a - b; }),
          slot<I>("mul.lo", [](I a, I b, I) { return a * b; }),
          slot<I>("mul.hi.s32", [=](I a, I b, I) { return static_cast<I>(wide(a) * wide(b) >> 32); }),
          slot<I>("mul.hi.u32", [](I a, I b, I) { return static_cast<I>(u64{a} * b >> 32); }),
          slot<I>("min.s32", [=](I a, I b, I) { return sign(a) < sign(b) ? a : b; }),
          slot<I>("max.u32", [](I a, I b, I) { return std::max(a, b); }),
          slot<I>("and", [](I a, I b, I) { return a & b; }),
          slot<I>("or", [](I a, I b, I) { return a | b; }),
          slot<I>("xor", [](I a, I b, I) { return a ^ b; }),
          slot<I>("shl", [](I a, I b, I) { return b > 31 ? 0 : a << b; }),
          slot<I>("shr.u32", [](I a, I b, I) { return b > 31 ? 0 : a >> b; }),
          slot<I>("shr.s32", [=](I a, I b, I) { return sign(a) >> std::min(b, 31u); }),
          slot<I>("mad.lo", [](I a, I b, I) { return a * b + a; }),
          slot<I>("mul.wide.s32", [=](I a, I b, I) { return wide(a) * wide(b); }),
          slot<I>("mul.wide.u32", [](I a, I b, I) { return u64{a} * b; }),
          slot<I>("not", [](I a, I, I) { return ~a; }),
          slot<I>("neg", [](I a, I, I) { return 0 - a; }),
          slot<I>("abs", [=](I a, I, I) { return sign(a) < 0 ? 0 - a : a; }),
          slot<I>("lt.s32", [=](I a, I b, I) { return u32{sign(a) < sign(b)}; }),
          slot<I>("lt.u32", [](I a, I b, I) { return u32{a < b}; }),
          slot<I>("hi.u32", [](I a, I b, I) { return u32{a > b}; }),
          slot<I>("ne", [](I a, I b, I) { return u32{a != b}; }),
          slot<I>("cvt.u16", [](I a, I, I) { return a & 0xffffu; }),
          slot<I>("cvt.s16", [](I a, I, I) { return static_cast<s32>(static_cast<s16>(a)); }),
          slot<I>("cvt.s64.s32", [=](I a, I, I) { return wide(a); }),
          slot<I>("pack", [](I a, I b, I) { return u64{b} << 32 | a; }),
          slot<I>("unpack", [](I a, I b, I) { return b - a; }),
          slot<I>("local", [](I a, I, I) { return a; }),
          slot<I>("ballot", [=](I a, I b, I) { return u32{sign(a) > sign(b)}; }),
          slot<I>("guards", [=](I a, I b, I) { return sign(a) > sign(b) ? 8u : 5u; }),
          slot<I>("loop", [](I, I, I) { return 5u; }),
          slot<I>("predicates", [](I, I, I) { return 1u; })};
}

const std::vector<u32> kIntegers = {0,      1,      2,          5,          31,         32,         40,       0x7fff,
                                    0x8000, 0xffff, 0x7fffffff, 0x80000000, 0x80000001, 0xffffffff, 123456789};

TEST(TwinOps, Integers) { check<semantics_integer, u32>(integer_slots(), kIntegers); }
TEST(TwinOps, IntegersOnADevice) {
  check_on_device<semantics_integer, u32>("semantics.ptx", integer_slots(), kIntegers);
}

TEST(TwinOps, FlushedProductKeepsItsSign) {
  EXPECT_EQ(std::bit_cast<u32>(flushed(-0x1p-130f)), 0x80000000u);
  EXPECT_EQ(flushed(0x1p-126f), 0x1p-126f);
}

// The exact result differs from the limit by only 2^-197, so double precision rounds it to the limit.
TEST(TwinOps, FmaFlushesByWhatRoundingToDoubleLeavesOut) {
  const f32 limit = 0x1p-126f, up = (1 + 0x1p-23f) * 0x1p-75f,
            down = (1 - 0x1p-23f) * 0x1p-76f;                       // product: 2^-151 - 2^-197
  const f32 large = 8384513 * 0x1p-98f, also = 8392705 * 0x1p-99f;  // product: 2^-151 + 2^-197
  ASSERT_EQ(f64{large} * f64{also}, 0x1p-151 + 0x1p-197);
  for (const f32 sign : {1.0f, -1.0f}) {
    EXPECT_EQ(fma_ftz(sign * up, -down, sign * limit), sign * limit);
    EXPECT_EQ(fma_ftz(sign * large, -also, sign * limit), 0);
  }
}

TEST(TwinOps, MinAndMaxThatKeepNan) {
  const f32 nan_value = Limits<f32>::quiet_NaN();
  EXPECT_TRUE(is_nan(min_nan(1.0f, nan_value)));
  EXPECT_TRUE(is_nan(max_nan(nan_value, 1.0f)));
  EXPECT_EQ(min_nan(1.0f, 2.0f), 1.0f);
}

TEST(TwinOps, SomeFusedRoundsTwiceWhereTheBitIsClear) {
  const f32 a = 1 + 0x1p-12f;
  const u64 bits[2] = {u64{1} << 3, 1};
  const SomeFused fuse{bits};
  EXPECT_NE(fuse(3, a, a, -1.0f), fuse(4, a, a, -1.0f));
  EXPECT_EQ(fuse(64, a, a, -1.0f), std::fma(a, a, -1.0f));
  EXPECT_EQ(fuse(65, a, a, -1.0f), a * a - 1.0f);
}

}  // namespace
}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
