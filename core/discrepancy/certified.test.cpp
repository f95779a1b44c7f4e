// SPDX-License-Identifier: Apache-2.0
// Compares certified numbers with rational numbers.
#include "core/discrepancy/certified.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <random>

namespace graze {
namespace {

using Rational = boost::multiprecision::cpp_rational;

Rational exactly(const Certified& x) { return Rational(x.hi) + Rational(x.lo); }

// A certified number, and the rational number that it approximates.
struct Both {
  Certified number;
  Rational truth;
};

void expect_within_bound(const Both& x) {
  if (!x.number.settled()) return;
  EXPECT_LE(abs(x.truth - exactly(x.number)), Rational(x.number.bound)) << x.number.hi << ' ' << x.number.lo;
}

class RandomNumbers {
 public:
  double operator()(int exponents) {
    const int bits = kBits[random_() % 4];
    const double mantissa = static_cast<double>(static_cast<std::int64_t>(random_() >> (64 - bits)));
    const int exponent = static_cast<int>(random_() % static_cast<unsigned>(2 * exponents + 1)) - exponents;
    return std::ldexp(random_() % 2 ? mantissa : -mantissa, exponent);
  }
  std::uint64_t word() { return random_(); }

 private:
  static constexpr int kBits[] = {2, 8, 24, 53};
  std::mt19937_64 random_{2012};
};

// Evaluates a random expression tree, whose leaves are doubles, in both kinds of numbers.
Both tree(RandomNumbers& random, int depth, int exponents) {
  if (depth == 0) {
    const double x = random(exponents);
    return {Certified(x), Rational(x)};
  }
  const Both l = tree(random, depth - 1, exponents), r = tree(random, depth - 1, exponents);
  switch (random.word() % 4) {
    case 0:
      return {l.number + r.number, l.truth + r.truth};
    case 1:
      return {l.number - r.number, l.truth - r.truth};
    case 2:
      return {l.number * r.number, l.truth * r.truth};
    default:
      if (r.truth == 0) return l;
      return {l.number / r.number, l.truth / r.truth};
  }
}

TEST(Certified, BoundsHoldForEveryTreeOfOperations) {
  RandomNumbers random;
  int settled = 0, close = 0;
  for (int i = 0; i < 40'000; ++i) {
    const Both x = tree(random, 1 + i % 4, i % 3 == 0 ? 300 : 20);
    expect_within_bound(x);
    settled += x.number.settled();
    close += x.number.bound <= std::fabs(x.number.hi) * 0x1p-90;
  }
  EXPECT_GT(settled, 34'000);
  EXPECT_GT(close, 30'000);
}

TEST(Certified, BoundsOfRootsHold) {
  RandomNumbers random;
  int settled = 0;
  for (int i = 0; i < 20'000; ++i) {
    Both x = tree(random, 1 + i % 3, 20);
    if (x.truth < 0) x = {-x.number, -x.truth};
    const Certified root = sqrt(x.number);
    if (!root.settled()) continue;
    ++settled;
    const Rational low = exactly(root) - Rational(root.bound), high = exactly(root) + Rational(root.bound);
    EXPECT_LE(low > 0 ? low * low : Rational(0), x.truth);
    EXPECT_GE(high * high, x.truth);
  }
  EXPECT_GT(settled, 15'000);
}

TEST(Certified, ResultsThatFitAreExact) {
  const Certified a(3), b(4), c(0x1p-40);
  EXPECT_EQ((a * b + c).bound, 0);
  EXPECT_EQ(((a + c) * (b - c)).bound, 0);
  EXPECT_TRUE((a * b - b * a).is_exactly_zero());
  EXPECT_EQ((b / a * a - b).settled(), true);
  EXPECT_EQ(sqrt(b).hi, 2);
  EXPECT_EQ(sqrt(b).bound, 0);
  EXPECT_FALSE((a / Certified(0.0)).settled());
  EXPECT_FALSE(sqrt(-a).settled());
  EXPECT_FALSE((Certified(1e308) * Certified(1e308)).settled());
}

}  // namespace
}  // namespace graze
