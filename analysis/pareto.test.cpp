// SPDX-License-Identifier: Apache-2.0
#include "analysis/pareto.h"

#include <gtest/gtest.h>

#include <cmath>

namespace graze::analysis {
namespace {

Offer offer(std::uint64_t wrong, double nanoseconds, std::uint64_t declined = 0) {
  Offer result;
  result.errors.pairs = 1000;
  result.errors.false_negative = wrong;
  result.errors.declined = declined;
  result.near = {nanoseconds, nanoseconds, nanoseconds};
  return result;
}

TEST(Pareto, TheFrontIsWhatNothingBeats) {
  std::vector<Offer> offers = {offer(0, 40), offer(5, 30),    offer(5, 35), offer(9, 10),
                               offer(0, 41), offer(0, 9, 10), offer(9, 10)};
  mark_dominated(offers);
  std::vector<bool> dominated;
  for (const Offer& one : offers) dominated.push_back(one.dominated);
  EXPECT_EQ(dominated, (std::vector<bool>{false, false, true, false, true, false, false}));
}

TEST(Pareto, CostsAreOfAllPairsInTurn) {
  const auto sources = strata::stratum_sources(1, 40, {"uniform", "lattice"});
  EXPECT_EQ(first_pairs(sources, 30).size(), 30u);
  EXPECT_EQ(first_pairs(sources, 100).size(), 40u);
  EXPECT_EQ(first_pairs(sources, 3)[1].a[0], sources[1].pair(0).a[0]);
  const std::vector<DecideBlock> lanes = {find_lane("exact/f32/cpu")->decide, find_lane("moller_1997/f32/cpu")->decide};
  for (const Cost& cost : costs_of(lanes, first_pairs(sources, 40), 9)) {
    EXPECT_GT(cost.low, 0);
    EXPECT_LE(cost.low, cost.middle);
    EXPECT_LE(cost.middle, cost.high);
  }
}

TEST(Extremes, AreWhatTheySay) {
  const auto sources = strata::stratum_sources(2, 50, {"uniform"});
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Pair pair = sources[0].pair(i);
    const auto at = [&](Extreme extreme, int k) { return made_extreme(sources, extreme, k)[0].pair(i); };
    EXPECT_EQ(at(Extreme::scale, -20).a[1].y, std::ldexp(pair.a[1].y, -20));
    EXPECT_EQ(at(Extreme::flatness, 6).b[2].z, std::ldexp(pair.b[2].z, -6));
    EXPECT_EQ(at(Extreme::flatness, 6).b[2].x, pair.b[2].x);
    EXPECT_EQ(at(Extreme::aspect, 6).b[2].x, std::ldexp(pair.b[2].x, -6));
    EXPECT_EQ(at(Extreme::aspect, 6).b[2].z, pair.b[2].z);
    EXPECT_GT(at(Extreme::offset, 10).a[0].x, 500);
    EXPECT_TRUE(is_finite(at(Extreme::scale, 120)));
  }
  for (const Extreme extreme : kExtremes) {
    const std::vector<int> at = exponents(extreme);
    EXPECT_EQ(std::count(at.begin(), at.end(), 0), 1) << name(extreme);
  }
}

TEST(Extremes, RightToIsTheLastOrdinaryShare) {
  ExtremeCurve curve{"lane", Extreme::scale, {}};
  for (const auto& [k, wrong] : {std::pair{-16, 300}, {-8, 15}, {0, 10}, {8, 20}, {16, 21}, {24, 0}}) {
    PolicyErrors errors;
    errors.pairs = 1000;
    errors.false_negative = static_cast<std::uint64_t>(wrong);
    curve.points.emplace_back(k, errors);
  }
  EXPECT_EQ(curve.right_to(1), 8);
  EXPECT_EQ(curve.right_to(-1), -8);
  curve.points[4].second.false_negative = 5;
  EXPECT_EQ(curve.right_to(1), std::nullopt);
}

// Moller's epsilon fits one scale only. Without it, only over- and underflow limit the algorithm's scale.
TEST(Extremes, FindTheScaleOfAnAbsoluteEpsilon) {
  const auto sources = strata::stratum_sources(4, 400, {"uniform"});
  const Lane& zero = *find_lane("moller_1997/f32/cpu");
  const Sweep sweep = host_sweep(zero);
  ExtremeCurve paper{"paper", Extreme::scale, {}}, none{"zero", Extreme::scale, {}};
  for (const int k : exponents(Extreme::scale)) {
    const auto found = sweep(std::vector<std::string>{"paper", ""}, made_extreme(sources, Extreme::scale, k));
    paper.points.emplace_back(k, found[0]);
    none.points.emplace_back(k, found[1]);
  }
  ASSERT_TRUE(paper.right_to(-1) && none.right_to(-1));
  EXPECT_GE(*paper.right_to(-1), -8);
  EXPECT_LE(*none.right_to(-1), -8);
}

}  // namespace
}  // namespace graze::analysis
