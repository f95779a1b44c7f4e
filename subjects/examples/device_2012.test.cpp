// SPDX-License-Identifier: Apache-2.0
// Compares the arithmetic of devices in 2012 with exact arithmetic. A device without peculiarities must match float.
#include "subjects/examples/device_2012.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <random>

#include "core/algorithms/interval_overlap.h"
#include "core/algorithms/projected_sat.h"
#include "strata/strata.h"

namespace graze::device_2012 {
namespace {

constexpr int kTimes = 100'000;
constexpr Device kPlain{Mad::none, Fuses::left, Division::ieee};
constexpr Device kReciprocal{Mad::none, Fuses::left, Division::reciprocal};
constexpr Device kTwoUlps{Mad::none, Fuses::left, Division::two_ulps};
constexpr Device kLeft{Mad::fused, Fuses::left, Division::ieee};
constexpr Device kRight{Mad::fused, Fuses::right, Division::ieee};
constexpr Device kTruncating{Mad::truncating, Fuses::left, Division::reciprocal};

std::mt19937 bits(2012);

float any_float() {  // every exponent has the same probability, including those of subnormal numbers
  for (;;) {
    const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(bits()));
    if (std::isfinite(x)) return x;
  }
}

float ordinary_float() {
  return std::ldexp(1 + std::ldexp(static_cast<float>(bits() >> 9), -23), int(bits() % 40) - 20);
}

// Holds the exact sum of a float and a product of two floats with any exponents.
using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<1024, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;

Exact exact_mad(float a, float b, float c) {
  int exponent;
  const Exact mantissa = frexp(Exact(a) * Exact(b), &exponent);
  return ldexp(trunc(ldexp(mantissa, FLT_MANT_DIG)), exponent - FLT_MANT_DIG) + Exact(c);
}

// Whether x is the float nearest to `exact`; of two nearest floats, the one with an even mantissa.
bool is_rounded(float x, const Exact& exact) {
  const Exact most =
      ldexp(Exact(2) - ldexp(Exact(1), -FLT_MANT_DIG), FLT_MAX_EXP - 1);  // larger numbers round to infinity
  if (std::isinf(x) || abs(exact) >= most) return std::isinf(x) && abs(exact) >= most && (x > 0) == (exact > 0);
  const Exact error = abs(Exact(x) - exact);
  for (const float to : {-INFINITY, INFINITY}) {
    const float next = std::nextafter(x, to);
    if (std::isinf(next)) continue;
    const Exact other = abs(Exact(next) - exact);
    if (other < error || (other == error && std::bit_cast<std::uint32_t>(x) % 2 == 1)) return false;
  }
  return true;
}

template <Device kDevice>
float value(const Number<kDevice>& x) {
  return static_cast<float>(x);
}

TEST(Device2012, TruncatesProductsAsExactArithmeticDoes) {
  int beyond_floats = 0, not_fused = 0;
  for (int i = 0; i < kTimes; ++i) {
    const float a = any_float(), b = any_float();
    float c = any_float();
    if (i % 2 == 0) c = std::ldexp(-a * b, int(bits() % 7) - 3);  // about as large as the product
    if (c == 0 || !std::isfinite(c)) continue;
    beyond_floats += std::abs(a * b) < FLT_MIN || std::isinf(a * b);
    const float found = truncating_mad(a, b, c);
    not_fused += found != std::fma(a, b, c);
    ASSERT_TRUE(is_rounded(found, exact_mad(a, b, c)))
        << std::hexfloat << found << ": " << a << " * " << b << " + " << c;
  }
  EXPECT_GT(beyond_floats, kTimes / 10);
  EXPECT_GT(not_fused, kTimes / 10);
}

TEST(Device2012, RoundsAProductToWhichZeroIsAdded) {
  const float a = 0x1.000002p0f, b = 1.75f;  // the exact product is nearer to the next float above than below
  EXPECT_EQ(truncating_mad(a, b, 0), a * b);
  EXPECT_EQ(truncating_mad(a, b, -0.0f), a * b);
  EXPECT_LT(truncating_mad(a, b, 0x1p-149f), a * b);
}

TEST(Device2012, SumsTakeTheChosenProduct) {
  const float a = 0x1.000002p0f, b = 1.75f;
  const auto difference = []<Device kDevice>(Number<kDevice> x, Number<kDevice> y) { return value(x * y - y * x); };
  EXPECT_EQ(difference(Number<kPlain>(a), Number<kPlain>(b)), 0);
  EXPECT_EQ(difference(Number<kLeft>(a), Number<kLeft>(b)), std::fma(a, b, -(a * b)));
  EXPECT_EQ(difference(Number<kRight>(a), Number<kRight>(b)), std::fma(-a, b, a * b));
  EXPECT_EQ(difference(Number<kTruncating>(a), Number<kTruncating>(b)), truncating_mad(a, b, -(a * b)));
  const Number<kLeft> kept = Number<kLeft>(a) * Number<kLeft>(b);  // fused in a later statement
  EXPECT_EQ(value(Number<kLeft>(1) - kept), std::fma(-a, b, 1.0f));
  EXPECT_EQ(value(kept), a * b);
}

TEST(Device2012, FlushesSubnormalNumbersUnlessIeee) {
  EXPECT_EQ(value(Number<kTruncating>(FLT_MIN / 2)), 0);
  EXPECT_TRUE(std::signbit(value(Number<kTruncating>(-FLT_MIN) * Number<kTruncating>(0.5f))));
  EXPECT_EQ(value(Number<kPlain>(FLT_MIN) * Number<kPlain>(0.5f)), FLT_MIN / 2);
}

template <Device kDevice>
void expect_at_most_two_ulps() {
  int inexact = 0;
  for (int i = 0; i < kTimes; ++i) {
    const float x = ordinary_float(), y = ordinary_float();
    const float quotient = value(Number<kDevice>(x) / Number<kDevice>(y)), root = value(sqrt(Number<kDevice>(x)));
    const double exact = double{x} / y, exact_root = std::sqrt(double{x});
    inexact += quotient != x / y;
    ASSERT_LE(std::abs(quotient - exact), 2.5 * (std::nextafter(x / y, INFINITY) - x / y)) << x << " / " << y;
    ASSERT_LE(std::abs(root - exact_root), 2.5 * (std::nextafter(std::sqrt(x), INFINITY) - std::sqrt(x))) << x;
  }
  EXPECT_GT(inexact, kTimes / 10);
}

TEST(Device2012, DividesAndTakesRootsWithinTheDocumentedError) {
  expect_at_most_two_ulps<kReciprocal>();
  expect_at_most_two_ulps<kTwoUlps>();
}

template <class Algorithm, class Real>
Verdict decided(const Pair& pair) {
  const auto triangle = [](const Vec3<float>(&v)[3], Vec3<Real>(&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = {Real(v[i].x), Real(v[i].y), Real(v[i].z)};
  };
  Vec3<Real> a[3], b[3];
  triangle(pair.a, a);
  triangle(pair.b, b);
  return Algorithm::decide(a, b);
}

TEST(Device2012, WithoutItsPeculiaritiesIsFloat) {
  int apart = 0;
  for (std::uint64_t i = 0; i < kTimes; ++i) {
    for (const strata::Stratum stratum : {strata::Stratum::thesis, strata::Stratum::thesis_special}) {
      const Pair pair = strata::generate(2012, stratum, i);
      const Verdict verdict = decided<IntervalOverlap, float>(pair);
      ASSERT_EQ((decided<IntervalOverlap, Number<kPlain>>(pair)), verdict) << i;
      ASSERT_EQ((decided<ProjectedSat, Number<kPlain>>(pair)), (decided<ProjectedSat, float>(pair))) << i;
      apart += decided<IntervalOverlap, Number<kTruncating>>(pair) != verdict;
    }
  }
  EXPECT_GT(apart, 0);
}

}  // namespace
}  // namespace graze::device_2012
