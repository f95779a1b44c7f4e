// SPDX-License-Identifier: Apache-2.0
// Tests the oracle on pairs of doubles: the two decisions agree, and truths and margins are right at double's limits.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <limits>

#include "oracle/integer_pair.h"
#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::Kind;
using Source = oracle_test::BasicPairSource<double>;

constexpr std::uint64_t kSeed = 20261127;

TEST(DoubleVerdict, BothDecisionsAgreeAlsoOnIntegersOfAnySize) {
  for (const Kind kind : oracle_test::kKinds) {
    Source source(kind, kSeed);
    int intersecting = 0;
    const int pairs = kind == Kind::raw_bits || kind == Kind::wide ? 4'000 : 20'000;
    for (int n = 0; n < pairs; ++n) {
      const DoublePair pair = source.next();
      const Verdict verdict = cgal_verdict(pair);
      const Contact contact = gmp_contact(pair);
      ASSERT_EQ(verdict == Verdict::intersects, contact != Contact::none) << hex(pair);
      intersecting += contact != Contact::none;
      if (n % 4 != 0) continue;
      const LargePair large = large_integers(pair, grid_of(pair));
      ASSERT_EQ(cgal_verdict(large), verdict) << hex(pair);
      ASSERT_EQ(gmp_contact(large), contact) << hex(pair);
      ASSERT_EQ(hulls(large), hulls(pair)) << hex(pair);
    }
    EXPECT_GT(intersecting, pairs / 40) << "kind " << static_cast<int>(kind);
  }
}

TEST(DoubleTruth, IgnoresOrderAxesAndSigns) {
  for (const Kind kind : oracle_test::kKinds) {
    Source source(kind, kSeed + 1);
    for (int n = 0; n < 4; ++n) {
      const DoublePair pair = source.next();
      const Truth first = truth(pair);
      for (int order = 0; order < 72; ++order) {
        const DoublePair other = oracle_test::turned(oracle_test::reordered(pair, order), source.below(48));
        const Truth found = truth(other);
        ASSERT_EQ(found.verdict, first.verdict) << hex(other);
        ASSERT_EQ(found.contact, first.contact) << hex(other);
        ASSERT_EQ(found.margin, first.margin) << hex(other);
        ASSERT_EQ(found.margin_ulps, first.margin_ulps) << hex(other);
      }
    }
  }
}

// Scales pairs past the limits of each kernel: small integers, filtered doubles and rationals.
TEST(DoubleTruth, ScalesByPowersOfTwo) {
  for (const Kind kind : {Kind::near, Kind::coplanar, Kind::touching, Kind::degenerate}) {
    Source source(kind, kSeed + 2);
    for (int n = 0; n < 200; ++n) {
      const DoublePair pair = source.next();
      const Truth found = truth(pair);
      for (const int power : {-900, -250, 300, 1000}) {
        DoublePair scaled = pair;
        for (int i = 0; i < kCoordinates; ++i) coordinates(scaled)[i] = std::ldexp(coordinates(pair)[i], power);
        const Truth other = truth(scaled);
        ASSERT_EQ(static_cast<const Relation&>(other), static_cast<const Relation&>(found)) << hex(pair) << power;
        ASSERT_EQ(other.margin, std::ldexp(found.margin, power)) << hex(pair) << power;
        ASSERT_EQ(other.margin_ulps, found.margin_ulps) << hex(pair) << power;
      }
    }
  }
}

TEST(DoubleTruth, DeclinesWhatIsNotFinite) {
  for (const double bad : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    for (int i = 0; i < kCoordinates; ++i) {
      DoublePair pair{};
      coordinates(pair)[i] = bad;
      EXPECT_EQ(truth(pair).verdict, Verdict::declined);
      EXPECT_TRUE(std::isnan(truth(pair).margin));
    }
  }
}

// A margin that is not a double is rounded once, possibly to a subnormal, but never to zero or infinity.
TEST(DoubleTruth, MarginsAreRoundedOnceAtTheLimits) {
  constexpr double kLeast = 0x1p-1074;
  const auto point_above = [](double height) {  // the plane z = 4 x, and a point above its triangle
    const Vec3<double> at{4 * kLeast, 4 * kLeast, 16 * kLeast + height};
    return DoublePair{{{0, 0, 0}, {1, 0, 4}, {0, 1, 0}}, {at, at, at}};
  };
  for (const auto& [height, margin] :
       {std::pair{kLeast, kLeast}, {2 * kLeast, kLeast}, {3 * kLeast, kLeast}, {8 * kLeast, 2 * kLeast}}) {
    const Truth found = truth(point_above(height));  // at a distance of height / sqrt(17)
    EXPECT_EQ(found.verdict, Verdict::disjoint);
    EXPECT_EQ(found.margin_sign, 1);
    EXPECT_EQ(found.margin, margin);
    EXPECT_NEAR(std::ldexp(found.margin_ulps, log2_ulp(point_above(height)) + 1074), height / kLeast / std::sqrt(17.0),
                1e-9);
  }
  const double most = DBL_MAX;
  const DoublePair far{{{most, 0, 0}, {most, 1, 0}, {most, 0, 1}}, {{-most, 0, 0}, {-most, 1, 0}, {-most, 0, 1}}};
  EXPECT_EQ(truth(far).margin, most);  // the margin is not infinity
  EXPECT_EQ(truth(far).margin_sign, 1);
  EXPECT_EQ(truth(far).margin_ulps, std::ldexp(most, 1 - 971));
  const DoublePair half{{{most / 4, 0, 0}, {most / 4, 1, 0}, {most / 4, 0, 1}},
                        {{-most / 4, 0, 0}, {-most / 4, 1, 0}, {-most / 4, 0, 1}}};
  EXPECT_EQ(truth(half).margin, most / 2);
}

TEST(DoubleIntegers, ScaledBackGiveTheDoubles) {
  for (const Kind kind : {Kind::raw_bits, Kind::wide, Kind::uniform}) {
    Source source(kind, kSeed + 4);
    for (int n = 0; n < 500; ++n) {
      const DoublePair pair = source.next();
      const Grid grid = grid_of(pair);
      ASSERT_GE(grid.exponent, -1074);
      ASSERT_LE(grid.bits, 2098);
      const LargePair large = large_integers(pair, grid);
      for (int i = 0; i < kCoordinates; ++i) {
        const mpz_class& integer = component(i < 9 ? large.a[i / 3] : large.b[i / 3 - 3], i % 3);
        mpz_class shifted = integer;
        const int own = coordinates(pair)[i] == 0 ? 0 : std::ilogb(coordinates(pair)[i]) - 52;
        const int shift = std::max(own, -1074) - grid.exponent;
        const mpz_class mantissa(std::ldexp(coordinates(pair)[i], -std::max(own, -1074)));
        if (shift < 0) {
          shifted <<= static_cast<unsigned>(-shift);
          ASSERT_EQ(shifted, mantissa);
        } else if (coordinates(pair)[i] != 0) {
          mpz_class scaled = mantissa;
          scaled <<= static_cast<unsigned>(shift);
          ASSERT_EQ(integer, scaled);
        } else {
          ASSERT_EQ(integer, 0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace graze::oracle
