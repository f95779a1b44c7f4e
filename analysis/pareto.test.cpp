// SPDX-License-Identifier: Apache-2.0
#include "analysis/pareto.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

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

TEST(Pareto, AVerdictThatAConventionAllowsIsNoCorrectOne) {
  std::vector<Offer> offers = {offer(0, 40), offer(0, 9)};
  offers[1].errors.by_convention = 1;
  mark_dominated(offers);
  EXPECT_FALSE(offers[0].dominated || offers[1].dominated);
}

TEST(Pareto, ADifferenceWithinTheSpreadsDominatesNothing) {
  std::vector<Offer> offers = {offer(0, 18), offer(0, 17.9), offer(0, 15)};
  offers[1].near = Cost{17, 17.9, 18.5};
  mark_dominated(offers);
  EXPECT_TRUE(offers[0].dominated && offers[1].dominated);  // by the third
  offers.pop_back();
  mark_dominated(offers);
  EXPECT_FALSE(offers[0].dominated || offers[1].dominated);
  offers[0].errors.false_negative = 1;
  mark_dominated(offers);
  EXPECT_TRUE(offers[0].dominated);
}

TEST(Pareto, CostsAreOfAllPairsInTurn) {
  const auto sources = strata::stratum_sources(1, 40, {"uniform", "lattice"});
  EXPECT_EQ(first_pairs(sources, 30).size(), 30u);
  EXPECT_EQ(first_pairs(sources, 100).size(), 40u);
  EXPECT_EQ(first_pairs(sources, 3).floats[1].a[0], sources[1].pair(0).a[0]);
  EXPECT_FALSE(first_pairs(sources, 3).in_doubles());
  const auto in_doubles = strata::stratum_sources(1, 40, {"uniform", "stored"}, PairTypes::both);
  const strata::PairBlock both = first_pairs(in_doubles, 9);
  ASSERT_EQ(both.doubles.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) {
    const AnyPair pair = in_doubles[i % 3].any_pair(i / 3);
    EXPECT_TRUE(both.doubles[i].a[0] == pair.doubles.a[0]) << i;
    EXPECT_TRUE(both.floats[i].a[0] == stored_in_float32(pair.doubles).a[0]) << i;
  }
  const std::vector<const Lane*> lanes = {find_lane("exact/f32/cpu"), find_lane("moller_1997/f32/cpu")};
  for (const std::optional<Cost>& cost : costs_of(lanes, first_pairs(sources, 40), 9)) {
    ASSERT_TRUE(cost);
    EXPECT_GT(cost->low, 0);
    EXPECT_LE(cost->low, cost->middle);
    EXPECT_LE(cost->middle, cost->high);
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

// Moller's epsilon fits one scale only; without the epsilon, only overflow and underflow limit the scale.
TEST(Extremes, FindTheScaleOfAnAbsoluteEpsilon) {
  const auto sources = strata::stratum_sources(4, 4'000, {"uniform"});
  const Lane& zero = *find_lane("moller_1997/f32/cpu");
  const Sweep sweep = host_sweep(zero);
  ExtremeCurve paper{"paper", Extreme::scale, {}}, none{"zero", Extreme::scale, {}};
  for (const int k : exponents(Extreme::scale)) {
    const auto found = sweep(std::vector<std::string>{"paper", ""}, made_extreme(sources, Extreme::scale, k));
    paper.points.emplace_back(k, found[0]);
    none.points.emplace_back(k, found[1]);
  }
  const auto of_paper = right_range(paper.errors()), of_none = right_range(none.errors());
  ASSERT_TRUE(of_paper && of_none && of_paper->settled && of_none->settled);
  EXPECT_EQ(of_paper->down.right, 0);
  EXPECT_EQ(of_paper->down.worse, -8);
  EXPECT_LE(of_none->down.right, -8);
  ASSERT_TRUE(of_none->down.worse);
  EXPECT_LT(*of_none->down.worse, -8);
}

// A range found on some pairs also holds on five times as many fresh pairs: at its ends the lane is as right as at 2^0.
// Where the lane is shown to be less right, it is less right on the fresh pairs too.
TEST(Extremes, AreTrueOfFreshPairs) {
  const std::vector<std::string> lanes = {"moller_1997/f32/cpu", "interval_overlap/f32/cpu", "separating_axes/f64/cpu"};
  const std::vector<std::string> strata = {"near_edge_edge", "near_vertex_face", "uniform"};
  const Sweep sweep =
      host_sweep([](const std::string& id) { return find_lane(id.empty() ? "exact/f32/cpu" : id)->decide; });
  const auto measured = [&](std::uint64_t seed, std::uint64_t pairs, Extreme extreme, int k) {
    return sweep(lanes, made_extreme(strata::stratum_sources(seed, pairs, strata), extreme, k));
  };
  int ends = 0, beyond = 0;
  for (const Extreme extreme : kExtremes) {
    std::vector<ExtremeCurve> curves;
    for (const std::string& lane : lanes) curves.push_back({lane, extreme, {}});
    for (const int k : exponents(extreme)) {
      const auto found = measured(1, 4'000, extreme, k);
      for (std::size_t l = 0; l < lanes.size(); ++l) curves[l].points.emplace_back(k, found[l]);
    }
    std::map<int, std::vector<PolicyErrors>> fresh;
    const auto share = [&](int k, std::size_t lane) {
      if (!fresh.contains(k)) fresh[k] = measured(2, 20'000, extreme, k);
      return fresh[k][lane].share_not_true();
    };
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      const auto range = right_range(curves[l].errors());
      ASSERT_TRUE(range && range->settled) << lanes[l] << ' ' << name(extreme);
      const double most = std::max(kAsRight * share(0, l), kRightShare);
      for (const RightSide& side : {range->down, range->up}) {
        EXPECT_LE(share(side.right, l), most) << lanes[l] << ' ' << name(extreme) << ' ' << side.right;
        ++ends;
        if (!side.worse) continue;
        EXPECT_GT(share(*side.worse, l), most) << lanes[l] << ' ' << name(extreme) << ' ' << *side.worse;
        ++beyond;
      }
    }
  }
  EXPECT_EQ(ends, 24);
  EXPECT_GE(beyond, 6);
}

}  // namespace
}  // namespace graze::analysis
