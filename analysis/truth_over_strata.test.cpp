// SPDX-License-Identifier: Apache-2.0
// Tests the oracle and the lanes over the strata. The two exact decisions must always agree, and subjects must fail
// where they are known to fail.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "analysis/tally.h"
#include "core/exact/exact.h"
#include "core/exact_blocks/decide.h"
#include "core/margin/single_precision.h"
#include "core/margin/tie_proof.h"
#include "core/margin_blocks/buckets.h"
#include "core/relation_of.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kSeed = 20120727;

bool wrong(const Lane& lane, const Pair& pair, Verdict truth) {
  std::uint64_t intersects = 0, declined = 0;
  lane.decide(&pair, 1, &intersects, &declined);
  return declined || (intersects != 0) != (truth == Verdict::intersects);
}

const Lane& lane(std::string_view id) {
  for (const Lane& row : lanes()) {
    if (row.id == id) return row;
  }
  throw std::out_of_range(std::string(id));
}

class EveryStratum : public testing::TestWithParam<strata::StratumInfo> {};

TEST_P(EveryStratum, TheOraclesTwoDecisionsAgree) {
  std::uint64_t intersecting = 0;
  for (std::uint64_t index = 0; index < 100'000; ++index) {
    const Pair pair = strata::generate(kSeed, GetParam().stratum, index);
    const bool intersects = oracle::cgal_verdict(pair) == Verdict::intersects;
    ASSERT_EQ(intersects, oracle::gmp_contact(pair) != Contact::none) << GetParam().id << ":" << kSeed << ":" << index;
    intersecting += intersects;
  }
  EXPECT_GT(intersecting, 0u);
  // Neighbours in a mesh always share a point. In all other strata, both verdicts must occur.
  const bool shared =
      GetParam().stratum == strata::Stratum::shared_vertex || GetParam().stratum == strata::Stratum::shared_edge;
  EXPECT_EQ(intersecting == 100'000u, shared);
}

struct Decided {
  std::vector<Pair> pairs;
  std::vector<std::uint64_t> intersects, declined;  // a bit for each pair
};

// Runs the exact decision on a block of pairs.
Decided drawn_and_decided(std::uint64_t seed, strata::Stratum stratum, std::size_t count) {
  const std::vector<std::uint64_t> none((count + 63) / 64);
  Decided all{std::vector<Pair>(count), none, none};
  for (std::size_t i = 0; i < count; ++i) all.pairs[i] = strata::generate(seed, stratum, i);
  exact::decide(coordinates(all.pairs[0]), count, all.intersects.data(), all.declined.data());
  return all;
}

// The exact decision on machine numbers gives the oracle's verdict, contact, shape and sign of the margin.
TEST_P(EveryStratum, TheExactLaneAgreesWithTheOracle) {
  constexpr std::size_t kPairs = 100'000;
  const auto [pairs, side_by_side, declined] = drawn_and_decided(kSeed + 1, GetParam().stratum, kPairs);
  for (std::size_t index = 0; index < kPairs; ++index) {
    const Pair& pair = pairs[index];
    const float *a = &pair.a[0].x, *b = &pair.b[0].x;
    const Verdict verdict = oracle::cgal_verdict(pair);
    const Contact contact = oracle::gmp_contact(pair);
    ASSERT_EQ(exact::intersects(a, b), verdict == Verdict::intersects) << index;
    ASSERT_EQ(side_by_side[index / 64] >> index % 64 & 1, verdict == Verdict::intersects) << index;
    ASSERT_EQ(declined[index / 64] >> index % 64 & 1, 0u) << index;
    const Relation r = relation_of(pair);
    ASSERT_EQ(r.verdict, verdict) << index;
    ASSERT_EQ(r.contact, contact) << index;
    ASSERT_EQ(r.hulls, oracle::hulls(pair)) << index;
    const Bucket bucket = oracle::margin_bucket(pair, verdict);
    ASSERT_EQ(r.margin_sign, sign_of(bucket)) << index;
  }
}

// For 20,000 pairs of each stratum: how many the shortcuts decide in single and in double precision, and how many
// distances are proven in integers.
constexpr std::array<int, 3> kDecided[strata::kStrataCount] = {
    {20000, 20000, 0},   {19934, 19942, 9},  {19963, 19999, 0},  {19999, 19999, 0},    {11842, 19999, 0},
    {6504, 16511, 775},  {5584, 5590, 855},  {0, 6310, 0},       {0, 9936, 0},         {6985, 16380, 1},
    {7256, 15705, 2940}, {9837, 18445, 313}, {5654, 8250, 1574}, {348, 1912, 0},       {0, 0, 0},
    {17476, 17519, 193}, {1214, 14371, 169}, {5956, 15003, 56},  {10801, 10842, 1539}, {19075, 19085, 439},
    {4408, 10484, 749},
};

// The engine's shortcuts to a bucket are quick bounds in two precisions, and a proof of the distance in integers.
TEST_P(EveryStratum, ShortcutsToTheBucketAreRightWhereTheyDecide) {
  int by_single = 0, by_double = 0, proven = 0, undecided = 0, left = 0;
  for (std::uint64_t index = 0; index < 20'000; ++index) {
    const Pair pair = strata::generate(kSeed + 2, GetParam().stratum, index);
    const float *a = &pair.a[0].x, *b = &pair.b[0].x;
    const Verdict verdict = exact::intersects(a, b) ? Verdict::intersects : Verdict::disjoint;
    const Bucket expected = oracle::margin_bucket(pair, verdict);
    Bucket bucket;
    if (bucket_by_single(pair, verdict, bucket)) {
      ++by_single;
      ASSERT_EQ(bucket, expected) << index;
    }
    if (bucket_by_double(pair, verdict, bucket)) {
      ++by_double;
      ASSERT_EQ(bucket, expected) << index;
    }
    const MarginBounds bounds = margin_bounds(pair, verdict);
    const int ulp = log2_ulp(pair), upper = floor_log2(bounds.hi);
    if (bucket_from_bounds(bounds, verdict, ulp, bucket)) continue;
    const MarginBounds close = margin_bounds<DoubleDouble>(pair, verdict);
    ASSERT_TRUE(close.lo <= bounds.hi && bounds.lo <= close.hi) << index;
    const bool is_close = bucket_from_bounds(close, verdict, ulp, bucket);
    ASSERT_TRUE(!is_close || bucket == expected) << index;
    if (verdict == Verdict::intersects) continue;
    left += !is_close && !are_apart_by(a, b, close.direction, floor_log2(close.hi));
    const bool is_proven = are_apart_by(a, b, bounds.direction, upper);
    undecided += !is_proven;
    proven += is_proven;
    ASSERT_TRUE(!is_proven || make_bucket(1, upper - ulp) == expected) << index;
    EXPECT_FALSE(are_apart_by(a, b, bounds.direction, upper + 1)) << index;
  }
  const bool touching =
      GetParam().stratum == strata::Stratum::shared_vertex || GetParam().stratum == strata::Stratum::shared_edge;
  EXPECT_TRUE(touching || by_double > 3'000) << by_double;
  EXPECT_TRUE(!GetParam().id.starts_with("near_") || by_single > 5'000) << by_single;
  // Nothing is contracted here, so the counts are the same on every host. Smaller counts mean worse estimates and
  // slower code; no other test would show that.
  EXPECT_EQ((std::array{by_single, by_double, proven}), kDecided[static_cast<int>(GetParam().stratum)]);
  const bool mixed = GetParam().stratum == strata::Stratum::mixed_scale;
  EXPECT_TRUE(mixed ? undecided > 1'000 : undecided < 20) << undecided;
  EXPECT_LT(left, mixed ? 150 : 1) << left;
}

// How many of 100,003 pairs of each stratum the vector code leaves undecided.
constexpr std::size_t kOpen[strata::kStrataCount] = {
    0, 91, 1, 1, 1, 3830, 4121, 1, 0, 94, 14811, 1640, 7856, 183, 116, 988, 917, 28142, 7605, 2978, 4572,
};

// Runs the code for every instruction set of this processor. With an instruction set without fused multiply-adds, the
// code decides no pairs; with all others it decides the same pairs.
TEST_P(EveryStratum, BucketsSideBySideAreRightWhereTheyAreSettled) {
  constexpr std::size_t kPairs = 100'003;
  const auto [pairs, truth, declined] = drawn_and_decided(kSeed + 3, GetParam().stratum, kPairs);
  std::vector<Bucket> expected(kPairs);
  for (std::size_t i = 0; i < kPairs; ++i)
    expected[i] = oracle::margin_bucket(pairs[i], test_bit(truth, i) ? Verdict::intersects : Verdict::disjoint);
  const auto take = [](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  const std::size_t least = kOpen[static_cast<int>(GetParam().stratum)];
  std::size_t fewest = kPairs;
  for (std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS; all != 0; all &= all - 1) {
    take(all & -all);
    std::vector<Bucket> buckets(kPairs + 1, 100);
    margin_buckets(coordinates(pairs[0]), kPairs, truth.data(), buckets.data());
    std::size_t open = 0;
    for (std::size_t i = 0; i < kPairs; ++i) {
      open += buckets[i] == kOpenBucket;
      if (buckets[i] == kOpenBucket) continue;
      ASSERT_EQ(buckets[i], expected[i]) << i << " by " << hwy::TargetName(all & -all);
    }
    EXPECT_EQ(buckets[kPairs], 100) << "written past the end";
    EXPECT_TRUE(open == kPairs || open == least) << open << " by " << hwy::TargetName(all & -all);
    fewest = std::min(fewest, open);
  }
  take(0);
  EXPECT_EQ(fewest, least);
}

// A block gives each pair the same verdict as a call with that pair alone, even if the block's code works on several
// pairs at once.
TEST_P(EveryStratum, BlocksOfHostLanesAreDecidedAsEachPairAlone) {
  constexpr std::size_t kPairs = 20'003;
  const std::vector<Pair> pairs = drawn_and_decided(kSeed + 4, GetParam().stratum, kPairs).pairs;
  std::vector<std::uint64_t> intersects(kPairs / 64 + 1), declined(intersects);
  for (const Lane& row : lanes()) {
    if (row.is_cuda() || row.exact || !runs_on_this_cpu(row)) continue;
    row.decide(pairs.data(), kPairs, intersects.data(), declined.data());
    for (std::size_t i = 0; i < kPairs; ++i) {
      const Verdict in_block = row.decide.verdict_of(test_bit(intersects, i), test_bit(declined, i), pairs[i]);
      ASSERT_EQ(in_block, decide_one(row.decide, pairs[i])) << row.id << ", pair " << i;
    }
  }
}

// Compares the certified bucket, including its sign, with the exact margin.
TEST_P(EveryStratum, BucketsHoldTheExactMargin) {
  for (std::uint64_t index = 0; index < 400; ++index) {
    const Pair pair = strata::generate(kSeed, GetParam().stratum, index);
    const oracle::Truth t = oracle::truth(pair);
    const Bucket bucket = oracle::margin_bucket(pair, t.verdict);
    ASSERT_EQ(bucket > 0, t.verdict == Verdict::disjoint) << index;
    ASSERT_EQ(bucket == 0, t.margin == 0 && t.verdict == Verdict::intersects) << index;
    if (bucket != 0 && t.margin_ulps != 0 && std::isfinite(t.margin_ulps)) {
      // If the rounded margin is on the border of two buckets, the bucket may be the lower one.
      const int log2_ulps = std::ilogb(t.margin_ulps);
      EXPECT_TRUE(bucket == make_bucket(bucket > 0 ? 1 : -1, log2_ulps) ||
                  std::abs(t.margin_ulps) == std::ldexp(1.0, log2_ulps))
          << index;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Strata, EveryStratum, testing::ValuesIn(strata::kStrata),
                         [](const auto& row) { return std::string(row.param.id); });

// Every near, coplanar, degenerate and extreme stratum must make some lane fail; otherwise it is useless.
TEST(Lanes, FailInEveryHardStratum) {
  for (const strata::StratumInfo& row : strata::kStrata) {
    if (row.stratum == strata::Stratum::uniform || row.stratum == strata::Stratum::thesis) continue;
    std::uint64_t failures = 0;
    for (std::uint64_t index = 0; index < 3000; ++index) {
      const Pair pair = strata::generate(kSeed, row.stratum, index);
      failures += wrong(lane("moller_1997/f32/cpu"), pair, oracle::cgal_verdict(pair)) ||
                  wrong(lane("guigue_devillers_2003/f32/cpu"), pair, oracle::cgal_verdict(pair));
    }
    EXPECT_GT(failures, 0u) << row.id;
  }
}

// On coordinates in {-1,0,1}, algorithms that neither divide nor take roots do not round. So every error is a logic
// error; none occurs on proper triangles.
TEST(Lanes, OnTheLatticeDivisionFreeAlgorithmsFailOnDegeneratePairsOnly) {
  std::uint64_t proper = 0, wrong_on_degenerate = 0;
  for (std::uint64_t index = 0; index < 200'000; ++index) {
    const Pair pair = strata::generate(kSeed, strata::Stratum::lattice, index);
    const Verdict verdict = oracle::cgal_verdict(pair);
    const Hulls hulls = oracle::hulls(pair);
    const bool degenerate = hulls.dimension_a < 2 || hulls.dimension_b < 2;
    proper += !degenerate;
    for (const Lane& row : lanes()) {
      if (!row.info->rounding_free_on_lattice || row.is_cuda() || !runs_on_this_cpu(row)) continue;
      const bool failed = wrong(row, pair, verdict);
      wrong_on_degenerate += degenerate && failed;
      ASSERT_FALSE(!degenerate && failed) << row.id << " on lattice:" << kSeed << ":" << index;
    }
  }
  EXPECT_GT(proper, 100'000u);
  EXPECT_GT(wrong_on_degenerate, 0u);
}

// Wide exact contacts defeat double precision as well.
TEST(Lanes, WideExactContactsDefeatDoublePrecision) {
  for (const strata::Stratum stratum : {strata::Stratum::coplanar_wide, strata::Stratum::exact_contact}) {
    std::uint64_t failures = 0;
    for (std::uint64_t index = 0; index < 3000; ++index) {
      const Pair pair = strata::generate(kSeed, stratum, index);
      failures += wrong(lane("guigue_devillers_2003/f64/cpu"), pair, oracle::cgal_verdict(pair));
    }
    EXPECT_GT(failures, 30u) << strata::kStrata[static_cast<int>(stratum)].id;
  }
}

// If this canary finds no effect of contraction, the fused lanes were compiled like the strict ones (see GRAZE_FP).
TEST(Canary, EveryHostVariantShowsInEveryAlgorithmAndScalar) {
  for (const Lane& fused : lanes()) {
    if (fused.exact || fused.variant == Variant::cpu || fused.is_cuda() || !runs_on_this_cpu(fused)) continue;
    const Lane& strict = *counterpart(fused, Variant::cpu);
    std::uint64_t differences = 0;
    for (std::uint64_t index = 0; index < 2000; ++index) {
      const Pair pair = strata::generate(kSeed, strata::Stratum::exact_contact, index);
      differences += wrong(fused, pair, Verdict::intersects) != wrong(strict, pair, Verdict::intersects);
    }
    EXPECT_GT(differences, 0u) << fused.id;
  }
}

}  // namespace
}  // namespace graze::analysis
