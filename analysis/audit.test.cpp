// SPDX-License-Identifier: Apache-2.0
// The deciding comparison and the cause, checked by taking them away; and false causes, which must not pass.
#include "analysis/audit.h"

#include <gtest/gtest.h>

#include <map>

#include "strata/strata.h"

namespace graze::analysis {
namespace {

std::vector<const Lane*> lanes_here() {
  std::vector<const Lane*> result;
  for (const Lane& lane : published_lanes()) {
    if (lane.explainable && (lane.is_cuda() ? cuda::twin_block(lane) != nullptr : runs_on_this_cpu(lane)))
      result.push_back(&lane);
  }
  return result;
}

struct Wrong {
  Pair pair;
  Verdict truth;
  LaneExplanation lane;
  std::string where;
};

// Every wrong lane on the first pairs of every stratum.
const std::vector<Wrong>& all_wrong() {
  static const std::vector<Wrong> kAll = [] {
    std::vector<Wrong> all;
    for (const strata::StratumInfo& stratum : strata::kStrata) {
      for (std::uint64_t i = 0; i < 25; ++i) {
        const Pair pair = strata::generate(21, stratum.stratum, i);
        const Verdict truth = oracle::cgal_verdict(pair);
        for (LaneExplanation& lane : accounts(pair, truth, lanes_here())) {
          std::string where = lane.lane->id + " " + std::string(stratum.id) + ":21:" + std::to_string(i);
          all.push_back({pair, truth, std::move(lane), std::move(where)});
        }
      }
    }
    return all;
  }();
  return kAll;
}

// The harmless rounding at line 48 comes first; what decides is the NaN that an overflow left.
TEST(Deciding, IsNotTheFirstWrongComparison) {
  const Pair pair = strata::generate(1, strata::Stratum::exact_contact, 10);
  const Lane* lane = find_lane("interval_overlap/f32/cpu");
  const std::vector<LaneExplanation> found = accounts(pair, Verdict::intersects, {&lane, 1});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].cause, Cause::overflow);
  EXPECT_EQ(found[0].settled, Settled::yes);
  ASSERT_NE(found[0].told(), nullptr);
  EXPECT_TRUE(found[0].told()->line.ends_with("interval_overlap.h:83")) << found[0].told()->line;
  EXPECT_TRUE(std::isnan(found[0].told()->difference.lane));
  const auto first_wrong =
      std::find_if(found[0].steps.begin(), found[0].steps.end(), [](const Step& step) { return step.wrong(); });
  EXPECT_TRUE(first_wrong->line.ends_with("interval_overlap.h:48")) << first_wrong->line;
}

// With the exact values of the deciding comparisons alone the lane is right; with only the first ones it is not.
TEST(Deciding, CorrectedTheLaneIsRight) {
  std::size_t single = 0, sets = 0;
  for (const Wrong& wrong : all_wrong()) {
    if (wrong.lane.cause == Cause::logic || wrong.lane.evidence == Evidence::none) continue;
    const std::vector<Decider>& deciding = wrong.lane.deciding.comparisons;
    ASSERT_FALSE(deciding.empty()) << wrong.where;
    std::vector<Correction<double>> corrections;
    for (const Decider& decider : deciding) {
      EXPECT_NE(run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, {}, corrections).verdict, wrong.truth);
      corrections.push_back(decider.to_exact);
    }
    EXPECT_EQ(run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, {}, corrections).verdict, wrong.truth)
        << wrong.where;
    ++(deciding.size() == 1 ? single : sets);
  }
  EXPECT_GT(single, 500u);
  EXPECT_GT(sets, 10u);
}

// Of an overflow the value told is one that the overflow made; a value that rounding alone gives is not told as one.
TEST(Deciding, WhatIsToldOfARangeComesFromIt) {
  int told = 0;
  for (const Wrong& wrong : all_wrong()) {
    if ((wrong.lane.cause != Cause::overflow && wrong.lane.cause != Cause::underflow) ||
        wrong.lane.deciding.comparisons.empty() || !wrong.lane.deciding.by_cause)
      continue;
    const Decider& first = wrong.lane.deciding.comparisons.front();
    const Lane& lane = *wrong.lane.lane;
    const Trace<double> unlimited =
        oracle::run_limited(lane.algorithm, lane.scalar, wrong.pair, {}, wrong.lane.rule, first.before);
    const Seen<double>& seen = unlimited.seen[first.place];
    const oracle::Beside& difference = first.exact.difference;
    const bool lost = !std::isfinite(difference.lane) || (difference.lane == 0 && difference.decimal != "0");
    EXPECT_TRUE(lost || seen.held == first.exact.held) << wrong.where;
    ++told;
  }
  EXPECT_GT(told, 20);
}

TEST(Audit, MostCausesStandUpToIt) {
  std::map<Cause, std::array<int, 2>> count;  // settled, not settled
  for (const Wrong& wrong : all_wrong()) {
    ++count[wrong.lane.cause][wrong.lane.settled != Settled::yes];
    EXPECT_EQ(audit(wrong.lane, wrong.pair, wrong.truth), wrong.lane.settled);
  }
  for (const auto& [cause, settled] : count) {
    EXPECT_GT(settled[0], settled[1]) << name(cause);
  }
  EXPECT_EQ(count.size(), 5u);
  EXPECT_GT(count[Cause::rounding][0], 100 * count[Cause::rounding][1]);
  EXPECT_GT(count[Cause::contraction][0], 20 * count[Cause::contraction][1]);
  EXPECT_EQ(count[Cause::logic][1], 0);
}

// A cause put in place of the true one does not pass.
TEST(Audit, AFalseCauseDoesNotPass) {
  std::map<std::pair<Cause, Cause>, int> tried;
  for (const Wrong& wrong : all_wrong()) {
    if (wrong.lane.settled != Settled::yes) continue;
    for (const Cause other : {Cause::rounding, Cause::contraction, Cause::overflow, Cause::underflow, Cause::logic}) {
      if (other == wrong.lane.cause || other == Cause::rounding) continue;  // a range's value, made exact, is right too
      LaneExplanation lied = wrong.lane;
      lied.cause = other;
      lied.contractions = {};
      ++tried[{wrong.lane.cause, other}];
      EXPECT_NE(audit(lied, wrong.pair, wrong.truth), Settled::yes) << wrong.where << ": " << name(other);
    }
  }
  EXPECT_GE(tried.size(), 12u);
}

// Of a rounding, another comparison of the same run than the deciding one does not pass.
TEST(Audit, AnotherComparisonDoesNotPass) {
  int tried = 0, passed = 0;
  for (const Wrong& wrong : all_wrong()) {
    if (wrong.lane.cause != Cause::rounding || wrong.lane.settled != Settled::yes || !wrong.lane.then.empty()) continue;
    const Replay run = replay(*wrong.lane.lane, wrong.pair);
    const Path path = path_of(run.run);
    std::size_t comparison = 0;
    for (const Seen<double>& seen : run.run.seen) {
      if (!seen.compared) continue;
      const Path before(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(comparison++));
      if (seen.left_result == wrong.lane.deciding.comparisons.front().seen.left_result) continue;
      LaneExplanation lied = wrong.lane;
      Decider& decider = lied.deciding.comparisons.front();
      decider.before = before;
      decider.to_lane = {seen.left_result, seen.right_result, seen.left, seen.right, seen.relation, seen.taken};
      decider.to_exact = decider.to_lane;  // the value as it is
      ++tried;
      passed += audit(lied, wrong.pair, wrong.truth) == Settled::yes;
      break;
    }
  }
  EXPECT_GT(tried, 100);
  EXPECT_EQ(passed, 0);
}

}  // namespace
}  // namespace graze::analysis
