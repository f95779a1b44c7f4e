// SPDX-License-Identifier: Apache-2.0
// Tests reciprocals, and operations that round toward zero, down and up (generator/semantics_rounding.ptx). Expected
// results come from quadruple precision and the signs of its errors.
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
#include "cuda/twin/twin_ops_bits.h"

namespace graze::cuda {
inline namespace GRAZE_FP {
namespace ptx {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#include "cuda/generated/semantics_rounding.inc"
#pragma GCC diagnostic pop

#include "cuda/twin/twin_ops_testing.inl"

__extension__ typedef __float128 Quad;

bool finite(Quad x) { return x - x == 0; }
int sign_of_quad(Quad x) { return (x > 0) - (x < 0); }

// A result rounded to nearest, and on which side of it the exact result lies.
template <class Real>
struct Nearest {
  Real value;
  int side;
};

// The sign of a sum's rounding error.
int rest_of_sum(Quad a, Quad b) {
  const Quad sum = a + b, part = sum - a;
  return sign_of_quad((a - (sum - part)) + (b - part));
}

// The sum of two numbers that are exact in quadruple precision.
template <class Real>
Nearest<Real> sum_of(Quad a, Quad b, Real nearest) {
  const Quad sum = a + b;
  return {nearest, sum != Quad(nearest) ? sign_of_quad(sum - Quad(nearest)) : rest_of_sum(a, b)};
}

template <class Real>
Real directed(const std::string& mode, Nearest<Real> x) {
  if (std::isnan(x.value)) return x.value;
  const Real up = Limits<Real>::infinity();
  if (x.side > 0 && (mode == "rp" || (mode == "rz" && x.value < 0))) return std::nextafter(x.value, up);
  if (x.side < 0 && (mode == "rm" || (mode == "rz" && x.value > 0))) return std::nextafter(x.value, -up);
  return x.value;
}

// When rounding down, an exact sum of zero is -0 unless both operands are positive.
template <class Real>
Real directed_sum(const std::string& mode, Quad a, Quad b, Real nearest) {
  if (nearest == 0 && a + b == 0) {
    const bool both = std::signbit(static_cast<Real>(a)) && std::signbit(static_cast<Real>(b));
    const bool any = std::signbit(static_cast<Real>(a)) || std::signbit(static_cast<Real>(b));
    return both || (mode == "rm" && any) ? -Real(0) : Real(0);
  }
  if (!finite(a) || !finite(b)) return nearest;
  return directed(mode, sum_of(a, b, nearest));
}

template <class Real>
Real directed_quotient(const std::string& mode, Real a, Real b) {
  const Real nearest = a / b;
  if (b == 0 || !finite(a) || !finite(b)) return nearest;
  // If the quotient overflows, the nearest result is infinite, and the exact quotient is closer to zero.
  const int left =
      std::isinf(nearest) ? (nearest > 0 ? -1 : 1) : sign_of_quad(Quad(a) - Quad(nearest) * Quad(b)) * (b < 0 ? -1 : 1);
  return directed<Real>(mode, {nearest, left});
}

template <class Real>
Real directed_product(const std::string& mode, Real a, Real b) {
  const Real nearest = a * b;
  const Quad exact = Quad(a) * Quad(b);
  if (!finite(exact)) return nearest;
  return directed<Real>(mode, {nearest, sign_of_quad(exact - Quad(nearest))});
}

template <class Real>
Real directed_root(const std::string& mode, Real a) {
  const Real nearest = std::sqrt(a);
  if (!(a > 0) || !finite(a)) return nearest;
  return directed<Real>(mode, {nearest, sign_of_quad(Quad(a) - Quad(nearest) * Quad(nearest))});
}

f32 flush_subnormal(f32 x) { return std::fpclassify(x) == FP_SUBNORMAL ? std::copysign(0.0f, x) : x; }

// The result with .ftz: the exact result rounded to 24 bits with unlimited exponent range, or zero if the rounded
// result is below 2^-126.
f32 flushed_to_zero(const std::string& mode, Quad exact, int rest, f32 otherwise) {
  const Quad size = exact < 0 ? -exact : exact;
  const bool below = size < Quad(0x1p-126) || (size == Quad(0x1p-126) && (exact < 0 ? rest > 0 : rest < 0));
  if (exact == 0 || !below) return otherwise;
  const Quad scaled = exact * Quad(0x1p+60);
  const f32 nearest = static_cast<f32>(scaled);
  const int side = scaled != Quad(nearest) ? sign_of_quad(scaled - Quad(nearest)) : rest;
  return std::fabs(directed<f32>(mode, {nearest, side})) < 0x1p-66f ? (exact < 0 ? -0.0f : 0.0f) : otherwise;
}

template <class Real>
std::vector<Slot<Real>> directed_slots(const std::string& mode, bool ftz) {
  using R = Real;
  const auto in = [ftz](R x) {
    if constexpr (sizeof(R) == 4) return ftz ? flush_subnormal(x) : x;
    return x;
  };
  const auto out = [mode, ftz](Quad exact, int rest, R otherwise) {
    if constexpr (sizeof(R) == 4)
      return ftz && finite(exact) ? flushed_to_zero(mode, exact, rest, otherwise) : otherwise;
    static_cast<void>(exact), static_cast<void>(rest);
    return otherwise;
  };
  const auto sum = [=](Quad a, Quad b, R nearest) {
    return out(a + b, rest_of_sum(a, b), directed_sum<R>(mode, a, b, nearest));
  };
  const auto quotient = [=](R a, R b) {
    const Quad near = Quad(a) / Quad(b);
    const int rest = b == 0 || !finite(near) ? 0 : sign_of_quad(Quad(a) - near * Quad(b)) * (b < 0 ? -1 : 1);
    return out(near, rest, directed_quotient<R>(mode, a, b));
  };
  const std::string tail = "." + mode + (ftz ? ".ftz" : "");
  return {
      slot<R>("add" + tail, [=](R a, R b, R) { return sum(in(a), in(b), in(a) + in(b)); }),
      slot<R>("sub" + tail, [=](R a, R b, R) { return sum(in(a), -in(b), in(a)-in(b)); }),
      slot<R>("mul" + tail,
              [=](R a, R b, R) { return out(Quad(in(a)) * Quad(in(b)), 0, directed_product<R>(mode, in(a), in(b))); }),
      slot<R>("fma" + tail,
              [=](R a, R b, R c) {
                const R nearest = std::fma(in(a), in(b), in(c));
                return sum(Quad(in(a)) * Quad(in(b)), in(c), nearest);
              }),
      slot<R>("div" + tail, [=](R a, R b, R) { return quotient(in(a), in(b)); }),
      slot<R>("sqrt" + tail, [=](R a, R, R) { return directed_root<R>(mode, in(a)); }),
      slot<R>("rcp" + tail, [=](R a, R, R) { return quotient(R(1), in(a)); })};
}

template <class To, class From>
To directed_integer(const std::string& mode, From x) {
  const To nearest = static_cast<To>(x);
  return directed<To>(mode, {nearest, sign_of_quad(Quad(x) - Quad(nearest))});
}

std::vector<Slot<f32>> f32_slots() {
  std::vector<std::vector<Slot<f32>>> parts;
  for (const bool ftz : {false, true}) {
    parts.push_back({slot<f32>(ftz ? "rcp.rn.ftz" : "rcp.rn", [ftz](f32 a, f32, f32) {
      const f32 x = ftz ? flush_subnormal(a) : a;
      return ftz && std::fabs(1.0 / x) < 0x1p-126 - 0x1p-151 ? std::copysign(0.0f, x) : 1 / x;
    })});
    for (const char* mode : {"rz", "rm", "rp"}) parts.push_back(directed_slots<f32>(mode, ftz));
  }
  for (const std::string mode : {"rz", "rm", "rp"}) {
    parts.push_back({slot<f32>("cvt.f32.s32 " + mode,
                               [=](f32 a, f32, f32) { return directed_integer<f32>(mode, std::bit_cast<s32>(a)); }),
                     slot<f32>("cvt.f32.u32 " + mode,
                               [=](f32 a, f32, f32) { return directed_integer<f32>(mode, std::bit_cast<u32>(a)); })});
  }
  return joined<f32>(parts);
}

std::vector<Slot<f64>> f64_slots() {
  std::vector<std::vector<Slot<f64>>> parts = {{slot<f64>("rcp.rn", [](f64 a, f64, f64) { return 1 / a; })}};
  for (const std::string mode : {"rz", "rm", "rp"}) parts.push_back(directed_slots<f64>(mode, false));
  for (const std::string mode : {"rz", "rm", "rp"}) {
    const auto narrow = [=](f64 a) {
      const f32 nearest = static_cast<f32>(a);
      return std::isfinite(a) ? directed<f32>(mode, {nearest, sign_of_quad(Quad(a) - Quad(nearest))}) : nearest;
    };
    parts.push_back({slot<f64>("cvt.f32.f64 " + mode, [=](f64 a, f64, f64) { return narrow(a); }),
                     slot<f64>("cvt.ftz.f32.f64 " + mode,
                               [=](f64 a, f64, f64) {
                                 return std::isfinite(a) ? flushed_to_zero(mode, a, 0, narrow(a)) : narrow(a);
                               }),
                     slot<f64>("cvt.f64.s64 " + mode,
                               [=](f64 a, f64, f64) { return directed_integer<f64>(mode, std::bit_cast<s64>(a)); }),
                     slot<f64>("cvt.f32.u64 " + mode,
                               [=](f64 a, f64, f64) { return directed_integer<f32>(mode, std::bit_cast<u64>(a)); })});
  }
  return joined<f64>(parts);
}

// The operands are normal numbers, so that only the result is flushed.
TEST(TwinOps, SumsBelowTheLeastNormalNumberAreFlushed) {
  EXPECT_EQ((rounded_add<Rounding::rz, true, f32>(0x1.8p-126f, -0x1p-126f)), 0);
  EXPECT_EQ((rounded_sub<Rounding::rp, true, f32>(-0x1.8p-126f, -0x1p-126f)), 0);
  EXPECT_EQ((rounded_add<Rounding::rz, false, f32>(0x1.8p-126f, -0x1p-126f)), 0x1p-127f);
}

TEST(TwinOps, RoundingF32) { check<semantics_rounding_f32, f32>(f32_slots(), special_values<f32>()); }
TEST(TwinOps, RoundingF64) { check<semantics_rounding_f64, f64>(f64_slots(), special_values<f64>()); }
TEST(TwinOps, RoundingF32OnADevice) {
  check_on_device<semantics_rounding_f32, f32>("semantics_rounding.ptx", f32_slots(), special_values<f32>());
}
TEST(TwinOps, RoundingF64OnADevice) {
  check_on_device<semantics_rounding_f64, f64>("semantics_rounding.ptx", f64_slots(), special_values<f64>());
}

}  // namespace
}  // namespace ptx
}  // namespace GRAZE_FP
}  // namespace graze::cuda
