// SPDX-License-Identifier: Apache-2.0
#include "analysis/tuning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <random>
#include <set>

#include "analysis/foreign_testing.h"
#include "core/exact/exact.h"

namespace graze::analysis {
namespace {

using strata::stratum_sources;

const Lane& moller() { return *find_lane("moller_1997/f32/cpu"); }

TEST(UpperBound, IsClopperAndPearsons) {
  EXPECT_NEAR(upper_bound(0, 1'000'000), 2.9957e-6, 1e-9);
  EXPECT_NEAR(upper_bound(0, 59), 0.0495, 1e-4);
  // R: binom.test(3, 100, alternative = "less")
  EXPECT_NEAR(upper_bound(3, 100), 0.07571, 1e-5);
  EXPECT_EQ(upper_bound(5, 5), 1);
}

// At the bound, the probability of at most `count` cases is at most 5 %. The reference value has 50 digits.
TEST(UpperBound, IsRoundedOutward) {
  using Precise = boost::multiprecision::cpp_bin_float_50;
  std::mt19937_64 random(11);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t of = 1 + random() % (i % 2 ? 4000 : 1'000'000),
                        count = i % 3 ? 0 : random() % std::min<std::uint64_t>(of, 40);
    const Precise p = upper_bound(count, of), q = 1 - p;
    Precise term = pow(q, Precise(of)), chance = term;
    for (std::uint64_t k = 1; k <= count; ++k) chance += term *= Precise(of - k + 1) / k * p / q;
    EXPECT_LE(chance, Precise("0.05")) << count << " of " << of;
    EXPECT_GE(chance, Precise("0.0499999")) << count << " of " << of;
  }
}

// At the lower bound, the probability of at least `count` cases is at most 5 %. Mirrors the test of the upper bound.
TEST(LowerBound, IsRoundedOutward) {
  using Precise = boost::multiprecision::cpp_bin_float_50;
  EXPECT_EQ(lower_bound(0, 100), 0);
  EXPECT_NEAR(lower_bound(3, 100), 0.00823, 1e-5);  // R: binom.test(3, 100, alternative = "greater")
  std::mt19937_64 random(12);
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t of = 40 + random() % (i % 2 ? 4000 : 1'000'000), count = 1 + random() % 40;
    const Precise p = lower_bound(count, of), q = 1 - p;
    Precise term = pow(q, Precise(of)), fewer = term;
    for (std::uint64_t k = 1; k < count; ++k) fewer += term *= Precise(of - k + 1) / k * p / q;
    EXPECT_LE(1 - fewer, Precise("0.05")) << count << " of " << of;
    EXPECT_GE(1 - fewer, Precise("0.0499999")) << count << " of " << of;
  }
}

TEST(Scaled, IsExactOrLeftAlone) {
  const auto sources = stratum_sources(1, 200, {"extreme_scale"});
  const auto moved = scaled(sources, 3);
  int changed = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Pair was = sources[0].pair(i), is = moved[0].pair(i);
    const bool same = is.a[0] == was.a[0] && is.b[2] == was.b[2];
    changed += !same;
    for (int c = 0; c < kCoordinates && !same; ++c) EXPECT_EQ(coordinates(is)[c], coordinates(was)[c] * 8);
  }
  EXPECT_GT(changed, 100);
  EXPECT_LT(changed, 200);
}

// The rate of forbidden errors and that of other errors are called low enough only at 95 % confidence.
TEST(Tune, BothRatesNeedABound) {
  const auto with = [](std::uint64_t negative, std::uint64_t positive, std::uint64_t pairs) {
    PolicyErrors errors;
    errors.false_negative = negative;
    errors.false_positive = positive;
    errors.pairs = pairs;
    return errors;
  };
  const auto result = [&](const PolicyErrors& chosen_on, const PolicyErrors& confirmed) {
    return result_of(chosen_on, confirmed, Forbid::false_negative, 1e-3, 0.1);
  };
  EXPECT_EQ(result(with(0, 9, 100), with(0, 200, 2995)), TuneResult::satisfied);
  EXPECT_EQ(result(with(0, 9, 100), with(0, 200, 2994)), TuneResult::too_few_pairs);  // to bound the forbidden errors
  EXPECT_EQ(result(with(0, 9, 100), with(0, 299, 2995)), TuneResult::too_few_pairs);  // to bound the others
  EXPECT_EQ(result(with(0, 40, 100), with(0, 1198, 2995)), TuneResult::not_useful);   // 40 %
  EXPECT_EQ(result(with(0, 9, 100), with(4, 200, 2995)), TuneResult::not_confirmed);
  EXPECT_EQ(result(with(1, 9, 100), with(4, 1198, 2995)), TuneResult::not_satisfiable);
  EXPECT_EQ(result_of(with(0, 0, 100), with(0, 0, 2995), Forbid::any, 1e-3, 0), TuneResult::satisfied);
}

TEST(Tune, ChoosesForWhatIsForbidden) {
  TuneSpec spec;
  spec.sweep = host_sweep(moller());
  spec.sources = stratum_sources(5, 6000, {"near_*"});
  spec.others = stratum_sources(6, 20'000, {"near_*"});
  spec.sites = sites_asked(moller(), spec.sources);
  EXPECT_EQ(spec.sites, (std::vector<std::string>{"plane_distance", "separation"}));
  spec.max_rate = 1e-3;
  spec.max_other = 0.75;
  spec.forbid = Forbid::false_negative;
  const Tuned no_negative = tune(spec);
  EXPECT_EQ(no_negative.result, TuneResult::satisfied) << no_negative.chosen << " " << no_negative.bound;
  EXPECT_GT(no_negative.zero_confirmed.false_negative, 100u);
  EXPECT_LE(no_negative.bound, 1e-3);
  EXPECT_LT(no_negative.confirmed.false_positive, 20'000u * 3 / 4);  // the policy does not simply answer intersects
  spec.forbid = Forbid::false_positive;
  const Tuned no_positive = tune(spec);
  EXPECT_EQ(no_positive.result, TuneResult::not_satisfiable);  // no tolerance removes false positives
  spec.forbid = Forbid::any;
  spec.max_rate = 1e-6;
  const Tuned neither = tune(spec);  // no epsilon can satisfy this limit
  EXPECT_EQ(neither.result, TuneResult::not_satisfiable);
  EXPECT_LE(neither.confirmed.wrong(), neither.zero_confirmed.wrong());
  EXPECT_EQ(tune(spec).chosen, neither.chosen);
}

// The claim about the chosen policy holds on the curves: if no policy is good enough, none has fewer forbidden errors.
TEST(Tune, NoPolicyIsGoodEnoughOnlyWhereNoneOfTheCurvesIs) {
  std::set<TuneResult> results;
  for (const std::uint64_t pairs : {300u, 3000u}) {
    for (const double rate : {1e-3, 0.05}) {
      for (const std::uint64_t seed : {1u, 2u, 3u}) {
        TuneSpec spec;
        spec.sweep = host_sweep(moller());
        spec.sources = stratum_sources(seed, pairs, {"near_*"});
        spec.others = stratum_sources(seed + 100, pairs * 10, {"near_*"});
        spec.sites = {"plane_distance"};
        spec.forbid = seed == 3 ? Forbid::any : Forbid::false_negative;
        spec.max_rate = rate;
        const Tuned tuned = tune(spec);
        results.insert(tuned.result);
        const auto is_low = [&](const PolicyErrors& e) {
          return static_cast<double>(forbidden(e, spec.forbid)) <= rate * static_cast<double>(e.pairs);
        };
        std::uint64_t fewest = forbidden(tuned.zero, spec.forbid);
        bool any_low = is_low(tuned.zero);
        for (const Curve& curve : tuned.curves) {
          for (const PolicyErrors& point : curve.points) {
            fewest = std::min(fewest, forbidden(point, spec.forbid));
            any_low = any_low || is_low(point);
          }
        }
        const std::uint64_t of_chosen =
            forbidden(spec.sweep(std::vector<std::string>{tuned.chosen}, spec.sources).front(), spec.forbid);
        EXPECT_TRUE(tuned.result != TuneResult::not_satisfiable || of_chosen == fewest) << tuned.chosen;
        EXPECT_EQ(tuned.result == TuneResult::not_satisfiable, !any_low && !is_low(tuned.confirmed)) << tuned.chosen;
        EXPECT_EQ(tuned.result == TuneResult::not_confirmed, any_low && !is_low(tuned.confirmed)) << tuned.chosen;
      }
    }
  }
  EXPECT_TRUE(results.contains(TuneResult::not_confirmed));
  EXPECT_TRUE(results.contains(TuneResult::not_satisfiable));
}

TEST(Tune, SaysWhenPairsAreTooFew) {
  TuneSpec spec;
  spec.sweep = host_sweep(*find_lane("guigue_devillers_2003/f64/cpu"));
  spec.sources = stratum_sources(5, 500, {"uniform"});
  spec.others = stratum_sources(6, 2000, {"uniform"});
  spec.max_rate = 1e-4;
  const Tuned tuned = tune(spec);
  EXPECT_EQ(tuned.result, TuneResult::too_few_pairs);
  EXPECT_EQ(tuned.chosen, "");
  EXPECT_NEAR(tuned.bound, 1.5e-3, 1e-4);
}

// A site whose tolerance has no effect is reported as dead; a site that decides is not.
TEST(Tune, FindsDeadKnobs) {
  TuneSpec spec;
  const auto real = [](const std::string& policy) {
    return policy.empty() ? moller().decide : lane_under(moller(), policy).decide;
  };
  spec.sweep = host_sweep([&](const std::string& policy) {
    return policy.starts_with("orientation=")            ? real("")
           : policy.find(",orientation=") != policy.npos ? real(policy.substr(0, policy.find(',')))
                                                         : real(policy);
  });
  spec.sources = stratum_sources(5, 3000, {"near_vertex_face"});
  spec.others = stratum_sources(6, 3000, {"near_vertex_face"});
  spec.sites = {"plane_distance", "orientation"};
  EXPECT_EQ(tune(spec).dead, std::vector<std::string>{"orientation"});
}

// This code is exact, except that it answers "intersects" for all pairs whose coordinates are all smaller than 1/1000.
// misses: it also answers "disjoint" for pairs whose first coordinate is above 0.
Stranger wrong_when_small(bool misses) {
  return Stranger([misses](const Pair& pair) {
    float largest = 0;
    for (int c = 0; c < kCoordinates; ++c) largest = std::max(largest, std::fabs(coordinates(pair)[c]));
    const bool missed = misses && pair.a[0].x > 0;
    const bool yes = largest < 1e-3f || (!missed && exact::intersects(&pair.a[0].x, &pair.b[0].x));
    return yes ? Verdict::intersects : Verdict::disjoint;
  });
}

// Only the false positives double. There are so many other errors that the sum of all errors does not double.
TEST(Tune, FindsWhereTheForbiddenErrorsDouble) {
  TuneSpec spec;
  Stranger small = wrong_when_small(true);
  const DecideBlock policy(small);
  spec.sweep = host_sweep([&](const std::string& of) { return of.empty() ? moller().decide : policy; });
  spec.forbid = Forbid::false_positive;
  spec.sources = stratum_sources(5, 4000, {"near_vertex_face"});
  spec.others = stratum_sources(6, 4000, {"near_vertex_face"});
  const Tuned tuned = tune(spec);
  ASSERT_NE(tuned.chosen, "");
  EXPECT_EQ(tuned.confirmed.false_positive, 0u);
  EXPECT_GT(tuned.confirmed.false_negative, 100u);
  EXPECT_GE(tuned.scale.down, -12);
  EXPECT_LE(tuned.scale.down, -9);
  EXPECT_GT(tuned.scale.at_down.false_positive, 10u);
  EXPECT_LT(tuned.scale.at_down.wrong(), 2 * tuned.confirmed.wrong());
}

TEST(Tune, FindsWhereTheScaleBreaksAPolicy) {
  TuneSpec spec;
  Stranger small = wrong_when_small(false);
  const DecideBlock policy(small);
  spec.sweep = host_sweep([&](const std::string& of) { return of.empty() ? moller().decide : policy; });
  spec.sources = stratum_sources(5, 4000, {"near_vertex_face"});  // coordinates of about 1
  spec.others = stratum_sources(6, 4000, {"near_vertex_face"});
  const Tuned tuned = tune(spec);
  ASSERT_NE(tuned.chosen, "");
  EXPECT_EQ(tuned.confirmed.wrong(), 0u);
  EXPECT_EQ(tuned.scale.up, 0);
  EXPECT_GE(tuned.scale.down, -12);
  EXPECT_LE(tuned.scale.down, -9);
  EXPECT_GT(tuned.scale.at_down.false_positive, 10u);
  EXPECT_EQ(tuned.scale.at_down.false_negative, 0u);
}

}  // namespace
}  // namespace graze::analysis
