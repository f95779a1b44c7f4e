// SPDX-License-Identifier: Apache-2.0
#include "oracle/precise.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/gmp.hpp>

#include "oracle/multiprecision.h"
#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using namespace oracle_test;

// Error bounds add up. If one of two numbers is exact, the other's error must not be lost.
TEST(Ball, ARadiusHoldsBothErrors) {
  constexpr long kExact = Ball::kExact, kUnknown = Ball::kUnknown;
  EXPECT_EQ(Ball::either(kExact, kExact), kExact);
  EXPECT_EQ(Ball::either(kExact, -7), -7);
  EXPECT_EQ(Ball::either(-7, kExact), -7);
  EXPECT_EQ(Ball::either(-7, -9), -6);
  EXPECT_EQ(Ball::either(-9, -7), -6);
  EXPECT_EQ(Ball::either(kUnknown, 3), kUnknown);
  EXPECT_EQ(Ball::scaled(kExact, 3), kExact);
  EXPECT_EQ(Ball::scaled(3, kExact), kExact);
  EXPECT_EQ(Ball::scaled(kUnknown, 3), kUnknown);
  EXPECT_EQ(Ball::scaled(-7, 3), -4);
}

// With exponent limits, a result that underflows is zero, and one that overflows is infinite; both zero and infinity
// count as exact, so that later sums of radii do not overflow their signed integer.
TEST(Ball, ZeroAndInfinityOfALimitedRangeAreExact) {
  const mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();
  mpfr_set_emin(-148);
  mpfr_set_emax(128);
  const Ball tiny = Ball(0x1p-100) * Ball(0x1p-100), huge = Ball(0x1p100) * Ball(0x1p100);
  const Ball of_tiny = tiny * tiny, of_huge = huge * huge;
  mpfr_set_emin(emin);
  mpfr_set_emax(emax);
  for (const Ball* ball : {&tiny, &huge, &of_tiny, &of_huge}) EXPECT_EQ(ball->radius, Ball::kExact);
  EXPECT_TRUE(tiny.can_be_zero());
  EXPECT_FALSE(huge.can_be_zero());
}

TEST(Multi, KnowsWhetherItWasRoundedWhereverItIsMovedTo) {
  EXPECT_TRUE(Multi(0.1).exact());  // it was not computed by an operation
  EXPECT_TRUE((Multi(1) / Multi(4)).exact());
  const Multi third = Multi(1) / Multi(3);
  EXPECT_FALSE(third.exact());
  Multi copy(third), assigned(1);
  EXPECT_FALSE(copy.exact());
  const Multi moved(std::move(copy));
  EXPECT_FALSE(moved.exact());
  assigned = moved;
  EXPECT_FALSE(assigned.exact());
}

// A result underflows if it is rounded and below the least normal number, 2^-126. Results of at least 2^-126 do not
// underflow.
TEST(Multi, UnderflowsBelowTheLeastNormalNumber) {
  const mpfr_exp_t emin = mpfr_get_emin();
  Multi::precision = 24;
  Multi::subnormals = true;
  mpfr_set_emin(-148);
  const auto event = [](double l, double r) {
    Multi::first_event = 0;
    Multi(l) * Multi(r);
    return Multi::first_event;
  };
  const double more = 1 + 0x1p-23;
  EXPECT_EQ(event(0x1p-126 * more, more), 0);  // rounded, and normal
  EXPECT_EQ(event(0x1p-126, 1), 0);
  EXPECT_EQ(event(0x1p-127 * more, more), -1);
  EXPECT_EQ(event(0x1p-126, 0.5), 0);  // subnormal, and exact
  EXPECT_EQ(event(0x1p-100, 0x1p-60), -1);
  mpfr_set_emin(emin);
  Multi::subnormals = false;
  Multi::first_event = 0;
  Multi::precision = 53;
}

// MPFR with a format's mantissa and exponents, subnormals included, computes like that format.
TEST(Precise, WithBothLimitsIsTheCpuLane) {
  int overflows = 0, underflows = 0;
  for (const Kind kind : kKinds) {
    PairSource source(kind, 11);
    for (int i = 0; i < 300; ++i) {
      const Pair pair = source.next();
      for (const Lane& lane : published_lanes()) {
        if (lane.variant != Variant::cpu) continue;
        const Limited limited = decide_limited(lane.algorithm, lane.scalar, in_doubles(pair), {true, true});
        const int bits = lane.scalar == Scalar::f32 ? 24 : 53;
        ASSERT_EQ(decide_with_bits(lane.algorithm, in_doubles(pair), bits, lane.scalar), limited.verdict) << lane.id;
        EXPECT_EQ(name(limited.verdict), name(decide_one(lane.decide, pair))) << lane.id << hex(pair);
        overflows += limited.first == RangeEvent::overflow;
        underflows += limited.first == RangeEvent::underflow;
      }
    }
  }
  EXPECT_GT(overflows, 100);
  EXPECT_GT(underflows, 100);
}

// Compares with GMP's rationals, which need no error bounds. Uses the three algorithms that neither divide nor take
// roots.
TEST(Precise, ExactlyIsWhatRationalsSay) {
  using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
  using Decide = Verdict (*)(const Pair&);
  const std::pair<int, Decide> algorithms[] = {{2, decide_widened<Moller1997, Rational>},
                                               {3, decide_widened<GuigueDevillers2003, Rational>},
                                               {4, decide_widened<SeparatingAxes, Rational>}};
  for (const Kind kind : kKinds) {
    PairSource source(kind, 12);
    for (int i = 0; i < 200; ++i) {
      const Pair pair = source.next();
      for (const auto& [algorithm, rational] : algorithms) {
        const Exactly exactly = decide_exactly(algorithm, in_doubles(pair));
        EXPECT_TRUE(exactly.settled) << algorithm << hex(pair);
        EXPECT_EQ(name(exactly.verdict), name(rational(pair))) << algorithm << hex(pair);
      }
    }
  }
}

// interval_overlap is right in exact arithmetic unless a triangle is degenerate. Because of its roots and quotients, no
// number of bits makes an exact contact come out exact. So this test shows how open comparisons are settled.
TEST(Precise, ExactlySettlesRootsAndQuotients) {
  int untold = 0;
  for (const Kind kind : {Kind::uniform, Kind::near, Kind::touching, Kind::coplanar}) {
    PairSource source(kind, 13);
    for (int i = 0; i < 300; ++i) {
      const Pair pair = source.next();
      if (hulls(pair).dimension_a < 2 || hulls(pair).dimension_b < 2) continue;
      const Exactly exactly = decide_exactly(1, in_doubles(pair));
      EXPECT_TRUE(exactly.settled) << hex(pair);
      EXPECT_EQ(name(exactly.verdict), name(cgal_verdict(pair))) << hex(pair);
      untold += !exactly.certain;
    }
  }
  EXPECT_GT(untold, 100);
}

// projected_sat adds terms of degree 3 to coordinates, so near 2^257 even 1,024 bits leave unequal numbers unseparated.
// The same holds for all algorithms if a pair has coordinates near 2^700 and 2^-700.
TEST(Precise, ExactlyIsTheSameWithMoreBits) {
  const auto expect_same = [](const DoublePair& pair) {
    for (int algorithm = 0; algorithm < kAlgorithmCount; ++algorithm) {
      const Exactly exactly = decide_exactly(algorithm, pair);
      EXPECT_TRUE(exactly.settled) << algorithm << hex(pair);
      EXPECT_EQ(exactly.verdict, decide_with_bits(algorithm, pair, 80'000)) << algorithm << hex(pair);
    }
  };
  const double unit[18] = {-2, -2, 1, -1, 0, 1, 0, 1, 2, 1, 0, 2, 2, 0, 2, -2, -1, 2};
  DoublePair pair;
  for (const int exponent : {0, 100, 254, 256, 300, 1000, -257, -300, -1000}) {
    for (int i = 0; i < 18; ++i) coordinates(pair)[i] = std::ldexp(unit[i], exponent);
    expect_same(pair);
  }
  const double s = 0x1p-700, t = 0x1p-699, l = 0x1p700, m = 0x1p701;
  // Each pair, with an algorithm that is right on it in exact arithmetic.
  const std::pair<int, DoublePair> mixed[] = {
      {3, {{{0, 0, t}, {-s, 0, 0}, {m, 0, m}}, {{0, s, l}, {0, 0, 0}, {0, s, 0}}}},
      {2, {{{t, 0, 0}, {0, -s, t}, {0, t, t}}, {{-s, l, l}, {0, t, 0}, {0, 0, 0}}}},
      {4, {{{0, 0, s}, {0, 0, m}, {0, 0, -s}}, {{l, 0, l}, {l, l, -l}, {0, -s, m}}}}};
  for (const auto& [algorithm, each] : mixed) {
    expect_same(each);
    EXPECT_EQ(decide_exactly(algorithm, each).verdict, Verdict::disjoint) << algorithm;
  }
}

TEST(Precise, BitsNeededIsTheLeastFromWhichAllAreRight) {
  PairSource source(Kind::near, 14);
  int more = 0;
  for (int i = 0; i < 60; ++i) {
    const Pair pair = source.next();
    const Verdict truth = cgal_verdict(pair);
    const int bits = bits_needed(4, in_doubles(pair), truth, 24);
    ASSERT_GE(bits, 24) << hex(pair);
    if (bits > 24) {
      ++more;
      EXPECT_NE(decide_with_bits(4, in_doubles(pair), bits - 1), truth);
    }
    for (int p = bits; p < bits + 40; ++p) EXPECT_EQ(decide_with_bits(4, in_doubles(pair), p), truth);
  }
  EXPECT_GT(more, 0);
}

// float32 rounds a distance of 2^-180 to 0, so the error is the whole distance, 2^23 ulps.
TEST(Precise, ErrorsAreInUlpsOfTheExactNumberWithoutLimits) {
  const Pair pair{{{0, 0, 0}, {0x1p-60f, 0, 0}, {0, 0x1p-60f, 0}}, {{0, 0, 0x1p-60f}, {1, 0, 1}, {0, 1, 2}}};
  const Trace<double> run = run_traced<float>(2, pair);
  const std::vector<ExactStep> steps = exact_steps(2, Scalar::f32, in_doubles(pair), run);
  ASSERT_EQ(steps.size(), run.seen.size());
  const Beside& distance = steps[0].left;  // from b[0] to the plane of a, times the normal's length
  EXPECT_EQ(distance.lane, 0);
  EXPECT_EQ(distance.exact, 0x1p-180);
  EXPECT_EQ(distance.ulps, 0x1p23);
}

}  // namespace
}  // namespace graze::oracle
