// SPDX-License-Identifier: Apache-2.0
#include "analysis/sweep.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/lane_trace.h"
#include "core/exact/exact.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

using strata::stratum_sources;

const Lane& moller() { return *find_lane("moller_1997/f32/cpu"); }

// Adds a pair's verdicts under a policy and without a policy.
void count(PolicyErrors& to, Verdict truth, Verdict with, Verdict without, const PairPlace& place) {
  ++to.pairs;
  to.declined += with == Verdict::declined;
  to.false_negative += with == Verdict::disjoint && truth == Verdict::intersects;
  to.false_positive += with == Verdict::intersects && truth == Verdict::disjoint;
  if (with == truth && without != truth && to.fixed++ == 0) to.first_fixed = place;
  if (with != truth && without == truth && to.broken++ == 0) to.first_broken = place;
}

TEST(Sweep, CountsWhatEachPolicyGetsWrong) {
  const auto sources = stratum_sources(3, 3001, {"near_vertex_face", "shared_edge", "extreme_scale"});
  const std::vector<std::string> policies = {"", "abs:1e-6", "rel:100", "bound"};
  const std::vector<PolicyErrors> found = host_sweep(moller())(policies, sources);
  for (std::size_t p = 0; p < policies.size(); ++p) {
    PolicyErrors expected;
    const DecideBlock zero = moller().decide, under = p == 0 ? zero : lane_under(moller(), policies[p]).decide;
    for (std::size_t s = 0; s < sources.size(); ++s) {
      for (std::uint64_t i = 0; i < sources[s].pairs; ++i) {
        const Pair pair = sources[s].pair(i);
        const Verdict truth = exact::intersects(&pair.a[0].x, &pair.b[0].x) ? Verdict::intersects : Verdict::disjoint;
        const Verdict with = decide_one(under, pair), without = decide_one(zero, pair);
        count(expected, truth, with, without, {static_cast<int>(s), i});
      }
    }
    EXPECT_EQ(found[p].policy, policies[p]);
    EXPECT_EQ(found[p].pairs, expected.pairs);
    EXPECT_EQ(found[p].false_negative, expected.false_negative) << policies[p];
    EXPECT_EQ(found[p].false_positive, expected.false_positive) << policies[p];
    EXPECT_EQ(found[p].declined, expected.declined) << policies[p];
    EXPECT_EQ(found[p].fixed, expected.fixed) << policies[p];
    EXPECT_EQ(found[p].broken, expected.broken) << policies[p];
    EXPECT_EQ(found[p].first_fixed, expected.first_fixed) << policies[p];
    EXPECT_EQ(found[p].first_broken, expected.first_broken) << policies[p];
  }
  EXPECT_TRUE(found[0].changes_nothing());
  EXPECT_GT(found[1].fixed, 0u);  // an epsilon fixes some pairs and breaks others
  EXPECT_GT(found[1].broken, 0u);
  EXPECT_EQ(found[3].wrong(), 0u);
  EXPECT_GT(found[3].declined, 0u);
  for (const int threads : {1, 3}) {
    const std::vector<PolicyErrors> again = host_sweep(moller(), threads)(policies, sources);
    for (std::size_t p = 0; p < policies.size(); ++p) {
      EXPECT_EQ(again[p].false_positive, found[p].false_positive);
      EXPECT_EQ(again[p].first_broken, found[p].first_broken);
    }
  }
}

// For doubles, CGAL gives the truth, and lanes in float decide the pairs as float32 stores them.
TEST(Sweep, CountsPairsOfDoublesByTheirOwnTruth) {
  const auto sources = stratum_sources(3, 400, {"near_vertex_face", "stored"}, PairTypes::f64);
  const std::vector<std::string> policies = {"abs:1e-6", "rel:100", "bound"};
  for (const char* id : {"moller_1997/f32/cpu", "moller_1997/f64/cpu", "moller_1997/f32/cpu-fma"}) {
    const Lane& lane = *find_lane(id);
    const std::vector<PolicyErrors> found = host_sweep(lane)(policies, sources);
    for (std::size_t p = 0; p < policies.size(); ++p) {
      PolicyErrors expected;
      for (std::size_t s = 0; s < sources.size(); ++s) {
        for (std::uint64_t i = 0; i < sources[s].pairs; ++i) {
          const DoublePair pair = sources[s].double_pair(i);
          const Verdict truth = oracle::cgal_verdict(pair);
          const Verdict with = decide_lane(lane_under(lane, policies[p]), pair), without = decide_lane(lane, pair);
          count(expected, truth, with, without, {static_cast<int>(s), i});
        }
      }
      expected.policy = policies[p];
      EXPECT_EQ(found[p], expected) << id << ' ' << policies[p];
    }
    EXPECT_GT(found[0].wrong(), 50u) << id;
  }
}

TEST(Sweep, ListsEachPairOnWhichSomePolicyIsNotRight) {
  const auto sources = stratum_sources(3, 3001, {"near_vertex_face", "extreme_scale"});
  const std::vector<std::string> policies = {"", "abs:1e-6", "rel:100", "bound"};
  std::vector<DecideBlock> lanes = {moller().decide};
  for (std::size_t p = 1; p < policies.size(); ++p) lanes.push_back(lane_under(moller(), policies[p]).decide);
  for (const int threads : {1, 3}) {
    const NotRightPairs found = not_right_pairs(moller(), policies, sources, threads);
    std::size_t at = 0;
    for (std::size_t s = 0; s < sources.size(); ++s) {
      for (std::uint64_t i = 0; i < sources[s].pairs; ++i) {
        const Pair pair = sources[s].pair(i);
        const bool intersects = exact::intersects(&pair.a[0].x, &pair.b[0].x);
        std::vector<Verdict> verdicts;
        for (const DecideBlock& lane : lanes) verdicts.push_back(decide_one(lane, pair));
        if (std::all_of(verdicts.begin(), verdicts.end(), [&](Verdict verdict) {
              return verdict == (intersects ? Verdict::intersects : Verdict::disjoint);
            }))
          continue;
        ASSERT_LT(at, found.first.size());
        EXPECT_EQ(found.first[at].place, (PairPlace{static_cast<int>(s), i}));
        EXPECT_EQ(found.first[at].intersects, intersects);
        EXPECT_EQ(found.first[at].verdicts, verdicts);
        ++at;
      }
    }
    EXPECT_EQ(at, found.first.size());
    EXPECT_EQ(at, found.count);
    EXPECT_GT(at, 100u);
  }
}

// One sweep over many tolerances gives the same counts as a separate sweep for each. The tolerances are absolute and
// relative, at all sites and at one site.
TEST(Sweep, ManyTolerancesAtOnceAreEachAlone) {
  const auto sources = stratum_sources(8, 2 * strata::kStrataCount * 300, {}, PairTypes::both);
  std::vector<std::string> policies;
  for (const std::string_view form : {"abs", "rel", "plane_distance=abs", "separation=rel"}) {
    for (int k = -60; k <= 20; k += 5) policies.push_back(fmt::format("{}:{}", form, std::exp2(k)));
  }
  std::size_t lanes_of_cpu = 0;
  for (const Lane& lane : published_lanes()) {
    if (lane.variant != Variant::cpu) continue;
    ++lanes_of_cpu;
    const std::vector<PolicyErrors> together = host_sweep(lane)(policies, sources);
    const std::vector<PolicyErrors> alone = host_sweep([&](const std::string& policy) {
      return policy.empty() ? lane.decide : lane_under(lane, policy).decide;
    })(policies, sources);
    std::uint64_t changed = 0;
    for (std::size_t p = 0; p < policies.size(); ++p) {
      EXPECT_EQ(together[p], alone[p]) << lane.id << " " << policies[p];
      changed += alone[p].fixed + alone[p].broken;
    }
    EXPECT_GT(changed, 1000u) << lane.id;
  }
  EXPECT_EQ(lanes_of_cpu, 10u);
}

}  // namespace
}  // namespace graze::analysis
