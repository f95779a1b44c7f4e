// SPDX-License-Identifier: Apache-2.0
// Tests lanes under policies over the strata: certified verdicts equal the truth, and explanations that name a policy
// are right.
#include <gtest/gtest.h>

#include <array>

#include "analysis/explain.h"
#include "core/exact/exact.h"
#include "cuda/twin/twin.h"
#include "oracle/precise.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kSeed = 77;

const Lane& lane(const std::string& id) {
  add_policy_lanes(id);
  const Lane* found = find_lane(id);
  if (!found) throw std::out_of_range(id);
  return *found;
}

std::vector<Pair> drawn(strata::Stratum stratum, std::uint64_t count) {
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < count; ++i) pairs.push_back(strata::generate(kSeed, stratum, i));
  return pairs;
}

class PolicyOverStratum : public testing::TestWithParam<strata::StratumInfo> {};

// Runs 10,000 pairs of each stratum through every algorithm, scalar and host variant that has the policy.
TEST_P(PolicyOverStratum, WhatABoundDecidesIsTheTruth) {
  const std::vector<Pair> pairs = drawn(GetParam().stratum, 10'000);
  std::vector<bool> truth;
  for (const Pair& pair : pairs) truth.push_back(exact::intersects(&pair.a[0].x, &pair.b[0].x));
  std::vector<std::uint64_t> yes(pairs.size() / 64 + 1), none(yes.size());
  int lanes_asked = 0;
  std::uint64_t decided = 0;
  for (const char* of : {"*/f32/cpu", "*/f64/cpu", "*/f32/cpu-fma", "*/f64/cpu-fma"}) {
    for (const char* policy : {"/bound", "/filtered"}) add_policy_lanes(std::string(of) + policy);
  }
  for (const Lane& row : lanes()) {
    if ((row.policy != "bound" && row.policy != "filtered") || !row.decide || !runs_on_this_cpu(row)) continue;
    ++lanes_asked;
    row.decide(pairs.data(), pairs.size(), yes.data(), none.data());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const bool says = yes[i / 64] >> i % 64 & 1, declines = none[i / 64] >> i % 64 & 1;
      ASSERT_FALSE(says && declines) << row.id << " " << i;
      ASSERT_TRUE(declines || says == truth[i]) << row.id << " on " << GetParam().id << ":" << kSeed << ":" << i;
      ASSERT_FALSE(declines && row.policy == "filtered") << row.id << " " << i;
      decided += !declines && row.policy == "bound";
    }
  }
  EXPECT_GE(lanes_asked, 16);
  const bool open = GetParam().id.starts_with("coplanar_w") || GetParam().id.starts_with("shared_") ||
                    GetParam().stratum == strata::Stratum::degenerate;
  EXPECT_TRUE(open || decided > 10'000u) << decided;  // a filter must decide most pairs
}

// Checks each algorithm's claim to be right_without_rounding, on proper triangles.
TEST_P(PolicyOverStratum, AlgorithmsAreRightWithoutRoundingWhereTheySaySo) {
  int asked = 0;
  for (const Pair& pair : drawn(GetParam().stratum, 300)) {
    const Hulls hulls = oracle::hulls(pair);
    if (hulls.dimension_a < 2 || hulls.dimension_b < 2) continue;
    const Verdict truth = oracle::cgal_verdict(pair);
    for (const Lane& row : published_lanes()) {
      if (row.scalar != Scalar::f32 || row.variant != Variant::cpu || !row.info->right_without_rounding) continue;
      const oracle::Exactly found = oracle::decide_exactly(row.algorithm, in_doubles(pair));
      ++asked;
      ASSERT_TRUE(found.verdict == truth || !found.certain) << row.id;
    }
  }
  EXPECT_TRUE(asked > 0 || GetParam().stratum == strata::Stratum::degenerate);
}

INSTANTIATE_TEST_SUITE_P(Strata, PolicyOverStratum, testing::ValuesIn(strata::kStrata),
                         [](const auto& row) { return std::string(row.param.id); });

// projected_sat does not claim right_without_rounding; this test confirms that such a claim would be false.
TEST(PolicyLanes, AnAlgorithmThatIsWrongWithoutRoundingIsFound) {
  int wrong = 0;
  for (const Pair& pair : drawn(strata::Stratum::uniform, 300)) {
    const Lane& row = *find_lane("projected_sat/f32/cpu");
    const oracle::Exactly found = oracle::decide_exactly(row.algorithm, in_doubles(pair));
    wrong += found.verdict != oracle::cgal_verdict(pair);
  }
  EXPECT_GT(wrong, 5);
}

TEST(PolicyLanes, AreExplainedByTheLaneWithoutPolicy) {
  const Lane *paper = &lane("moller_1997/f32/cpu/paper"), *bound = &lane("moller_1997/f32/cpu/bound");
  int by_policy = 0, otherwise = 0, declined = 0;
  for (const strata::Stratum stratum : {strata::Stratum::extreme_scale, strata::Stratum::near_vertex_face}) {
    for (const Pair& pair : drawn(stratum, 120)) {
      const Verdict truth = oracle::cgal_verdict(pair);
      const bool zero_is_right = decide_one(find_lane("moller_1997/f32/cpu")->decide, pair) == truth;
      for (const LaneExplanation& account : explain(pair, std::vector{paper, bound}).lanes) {
        EXPECT_EQ(cause_of(*account.lane, pair, truth), account.cause);
        if (account.lane == bound) {
          EXPECT_EQ(account.verdict, Verdict::declined);
          EXPECT_EQ(account.cause, Cause::policy);
          ++declined;
        } else {
          EXPECT_EQ(account.cause == Cause::policy, zero_is_right);
          EXPECT_EQ(account.settled == Settled::yes, zero_is_right);
          ++(zero_is_right ? by_policy : otherwise);
        }
      }
    }
  }
  EXPECT_GT(by_policy, 10);
  EXPECT_GT(otherwise, 2);
  EXPECT_GT(declined, 10);
  Pair pair{{{0, 0, 0}, {0.01f, 0, 0}, {0, 0.01f, 0}}, {{0, 0, 0.005f}, {0.01f, 0, 0.005f}, {0, 0.01f, 0.005f}}};
  EXPECT_EQ(sentences(explain(pair, std::vector{paper})).at(0),
            "moller_1997/f32 (cpu/paper) says intersects, but the triangles are 0.005 apart (5.37e+06 ulps of the "
            "largest coordinate): the policy (without paper it is right).");
}

// Under tolerances, twins without contraction equal the CPU lanes, and twins with contraction differ from them.
TEST(PolicyLanes, TwinsWithoutContractionAreTheCpuLanes) {
  std::uint64_t contracted_apart = 0;
  for (const Lane& zero : published_lanes()) {
    if (zero.variant != Variant::cpu) continue;
    for (const char* policy : {"abs:1e-6", "rel:16", "plane_distance=rel:3,separation=abs:1e-9"}) {
      const Lane on_cpu = lane_under(zero, policy),
                 without = lane_under(*counterpart(zero, Variant::cuda_nofma), policy),
                 with = lane_under(*counterpart(zero, Variant::cuda_fma), policy);
      const DecideBlock contracted = cuda::block_on_host(with);
      EXPECT_EQ(!contracted, zero.id == "interval_overlap/f32/cpu" && with.under->epsilons.any_relative()) << with.id;
      for (const strata::StratumInfo& row : strata::kStrata) {
        const std::vector<Pair> pairs = drawn(row.stratum, 192);
        std::array<std::uint64_t, 3> expected, yes, none;
        on_cpu.decide(pairs.data(), pairs.size(), expected.data(), none.data());
        cuda::block_on_host(without)(pairs.data(), pairs.size(), yes.data(), none.data());
        ASSERT_EQ(yes, expected) << without.id << " on " << row.id;
        if (!contracted) continue;
        contracted(pairs.data(), pairs.size(), yes.data(), none.data());
        contracted_apart += yes != expected;
      }
    }
  }
  EXPECT_GT(contracted_apart, 50u);
}

}  // namespace
}  // namespace graze::analysis
