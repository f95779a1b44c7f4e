// SPDX-License-Identifier: Apache-2.0
// Checks deciding comparisons by correcting them, and causes by removing them. False causes must not pass.
#include "analysis/audit.h"

#include <gtest/gtest.h>

#include <map>

#include "strata/strata.h"

namespace graze::analysis {
namespace {

std::vector<const Lane*> lanes_here() {
  std::vector<const Lane*> result;
  for (const Lane& lane : published_lanes()) {
    if (lane.explainable && (lane.is_cuda() ? cuda::twin_row(lane).decide != nullptr : runs_on_this_cpu(lane)))
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

// The rounding at line 49 comes first but is harmless. The comparison that decides has a NaN from an overflow.
TEST(Deciding, IsNotTheFirstWrongComparison) {
  const Pair pair = strata::generate(1, strata::Stratum::exact_contact, 10);
  const Lane* lane = find_lane("interval_overlap/f32/cpu");
  const std::vector<LaneExplanation> found = accounts(pair, Verdict::intersects, {&lane, 1});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].cause, Cause::overflow);
  EXPECT_EQ(found[0].settled, Settled::yes);
  ASSERT_NE(found[0].told(), nullptr);
  EXPECT_TRUE(found[0].told()->line.ends_with("interval_overlap.h:85")) << found[0].told()->line;
  EXPECT_TRUE(std::isnan(found[0].told()->difference.lane));
  const auto first_wrong =
      std::find_if(found[0].steps.begin(), found[0].steps.end(), [](const Step& step) { return step.wrong(); });
  EXPECT_TRUE(first_wrong->line.ends_with("interval_overlap.h:49")) << first_wrong->line;
}

// The lane is right once all deciding comparisons are corrected, and still wrong if the last one is not.
TEST(Deciding, CorrectedTheLaneIsRight) {
  std::size_t single = 0, sets = 0, none = 0;
  for (const Wrong& wrong : all_wrong()) {
    if (wrong.lane.cause == Cause::logic || wrong.lane.evidence == Evidence::none) continue;
    const std::vector<Decider>& deciding = wrong.lane.deciding;
    if (deciding.empty()) {
      EXPECT_EQ(wrong.lane.settled, Settled::not_by_few) << wrong.where;
      ++none;
      continue;
    }
    Path lead;
    for (const Decider& decider : deciding) {
      EXPECT_NE(run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, lead).verdict, wrong.truth);
      EXPECT_TRUE(std::equal(lead.begin(), lead.end(), decider.before.begin())) << wrong.where;
      lead = decider.corrected();
    }
    EXPECT_EQ(run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, lead).verdict, wrong.truth) << wrong.where;
    ++(deciding.size() == 1 ? single : sets);
  }
  EXPECT_GT(single, 500u);
  EXPECT_GT(sets, 10u);
  EXPECT_LT(none, single / 100);
}

// The path and the verdict of a run in which the comparisons at these indices are corrected.
struct Corrected {
  Path path;
  Verdict verdict;
};
Corrected corrected(const Wrong& wrong, const std::vector<std::size_t>& comparisons) {
  Path lead;
  for (const std::size_t comparison : comparisons) {
    const Path path = path_of(run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, lead));
    lead.assign(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(comparison) + 1);
    lead.back() = !lead.back();
  }
  const Trace<double> run = run_led(*wrong.lane.lane, wrong.pair, wrong.lane.rule, lead);
  return {path_of(run), run.verdict};
}

// Tries every smaller set, and every earlier set of the same size. The four pairs come from bug reports: a version that
// corrected values, not outcomes, named two comparisons where one is enough, or one that is not the first.
TEST(Deciding, IsTheSmallestSetAndOfEqualOnesTheFirst) {
  std::vector<Wrong> some;
  for (std::size_t i = 0; i < all_wrong().size(); i += 7) some.push_back(all_wrong()[i]);
  for (const auto& [stratum, index] : {std::pair{strata::Stratum::mixed_scale, 5496},
                                       {strata::Stratum::extreme_scale, 475},
                                       {strata::Stratum::exact_contact, 184},
                                       {strata::Stratum::extreme_scale, 2932}}) {
    const Pair pair = strata::generate(77, stratum, static_cast<std::uint64_t>(index));
    const Verdict truth = oracle::cgal_verdict(pair);
    for (LaneExplanation& lane : accounts(pair, truth, lanes_here()))
      some.push_back({pair, truth, std::move(lane), some.back().lane.lane->id + " on a reported pair"});
  }
  int smaller = 0, earlier = 0;
  for (const Wrong& wrong : some) {
    const std::vector<Decider>& deciding = wrong.lane.deciding;
    if (deciding.empty() || deciding.size() > 2) continue;
    const std::size_t first = deciding[0].before.size(), second = deciding.back().before.size();
    const auto exactly = [&](const Path& path) {
      return oracle::exact_outcomes(wrong.lane.lane->algorithm, in_doubles(wrong.pair), path);
    };
    const Path path = corrected(wrong, {}).path, exact = exactly(path);
    for (std::size_t i = 0; i < (deciding.size() == 1 ? first : path.size()); ++i) {
      if (path[i] == exact[i]) continue;
      const Corrected one = corrected(wrong, {i});
      EXPECT_NE(one.verdict, wrong.truth) << wrong.where << ": comparison " << i << " alone";
      ++smaller;
      if (deciding.size() == 1) continue;
      const Path exact_then = exactly(one.path);
      for (std::size_t j = i + 1; j < one.path.size() && std::pair{i, j} < std::pair{first, second}; ++j) {
        if (one.path[j] == exact_then[j]) continue;
        EXPECT_NE(corrected(wrong, {i, j}).verdict, wrong.truth) << wrong.where << ": comparisons " << i << ", " << j;
        ++earlier;
      }
    }
  }
  EXPECT_GT(smaller, 50);
  EXPECT_GT(earlier, 10);
}

// If the cause is overflow or underflow, the reported value must come from it, not from rounding alone.
TEST(Deciding, WhatIsToldOfARangeComesFromIt) {
  int told = 0;
  for (const Wrong& wrong : all_wrong()) {
    if ((wrong.lane.cause != Cause::overflow && wrong.lane.cause != Cause::underflow) || wrong.lane.deciding.empty() ||
        !wrong.lane.deciding.front().by_cause)
      continue;
    const Decider& first = wrong.lane.deciding.front();
    const Lane& lane = *wrong.lane.lane;
    const Trace<double> unlimited =
        oracle::run_limited(lane.algorithm, lane.scalar, in_doubles(wrong.pair), {}, wrong.lane.rule, first.before);
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

TEST(Audit, AFalseCauseDoesNotPass) {
  std::map<std::pair<Cause, Cause>, int> tried;
  for (const Wrong& wrong : all_wrong()) {
    if (wrong.lane.settled != Settled::yes) continue;
    for (const Cause other : {Cause::rounding, Cause::contraction, Cause::overflow, Cause::underflow, Cause::logic}) {
      if (other == wrong.lane.cause || other == Cause::rounding) continue;  // exact arithmetic removes range errors too
      LaneExplanation lied = wrong.lane;
      lied.cause = other;
      lied.contractions = {};
      ++tried[{wrong.lane.cause, other}];
      EXPECT_NE(audit(lied, wrong.pair, wrong.truth), Settled::yes) << wrong.where << ": " << name(other);
    }
  }
  EXPECT_GE(tried.size(), 12u);
}

// If the cause is rounding, the audit rejects every comparison other than the deciding one.
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
      if (before == wrong.lane.deciding.front().before) continue;
      LaneExplanation lied = wrong.lane;
      Decider& decider = lied.deciding.front();
      decider.before = before;
      decider.exact.held = seen.taken;  // the lane's own outcome
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
