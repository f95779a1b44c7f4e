// SPDX-License-Identifier: Apache-2.0
// Tests a league of planted subjects. The test recomputes every number of the league, using only the oracle.
#include "fuzz/league/league.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "analysis/invariants.h"
#include "analysis/neighbours.h"
#include "core/simplify/simplicity.h"
#include "fuzz/minimise/kinds.h"
#include "strata/strata.h"
#include "subjects/subjects.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// Each of these functions has one defect, which its name describes.
constexpr const char* kPlanted = R"(
#include <cstdlib>
#include <graze/subject.h>
#include "core/exact/exact.h"
using graze::exact::relation;
template <class T> int truth(const T a[9], const T b[9]) { return relation(a, b).intersects(); }
template <class T> int blind(const T a[9], const T b[9]) { return !relation(a, b).hulls.coplanar && truth(a, b); }
template <class T> int dies(const T a[9], const T b[9]) { if (a[0] == 1) abort(); return truth(a, b); }
template <class T> int narrow(const T a[9], const T b[9]) {
  return relation(a, b).hulls.dimension_a == 2 && relation(a, b).hulls.dimension_b == 2 && truth(a, b);
}
template <class T> int one_sided(const T a[9], const T b[9]) { return a[0] > b[0] || truth(a, b); }
#define PLANT(name, outside) \
  GRAZE_SUBJECT(name##_one) = {GRAZE_SUBJECT_ABI, outside, "3", nullptr, nullptr, name<float>, name<double>, nullptr, nullptr}
PLANT(truth, 0);
PLANT(blind, 0);
PLANT(dies, 0);
PLANT(narrow, GRAZE_OUTSIDE_DEGENERATE);
PLANT(one_sided, 0);
)";

constexpr std::uint64_t kSeed = 3, kPairs = 3000, kOrders = 50;  // kOrders: 1 in 20 of each source
constexpr const char* kNames[] = {"truth", "blind", "dies", "narrow", "one_sided"};

std::vector<strata::PairSource> sources(PairTypes types = PairTypes::f32) {
  return strata::stratum_sources(kSeed, kPairs, {"uniform", "lattice", "coplanar_wide"}, types);
}

struct Planted : testing::Test {
  static inline League league, of_doubles;
  static inline SelectedLanes lanes;

  static void SetUpTestSuite() {
    const fs::path folder = fs::path(testing::TempDir()) / ("league-" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "planted.cpp") << kPlanted;
    const std::string build = "c++ -std=c++20 -O2 -ffp-contract=off -shared -fPIC -I" GRAZE_SOURCE_DIR
                              " -I" GRAZE_SOURCE_DIR "/subjects/include ";
    const fs::path library = folder / "planted.so";
    ASSERT_EQ(std::system((build + (folder / "planted.cpp").string() + " -o " + library.string()).c_str()), 0);
    for (const std::string name : kNames)
      subjects::open(subjects::parse_subject(name + '=' + library.string() + ':' + name + "_one"));
    std::vector<std::string> all{"moller_1997/*", "exact/*"}, in_doubles{"moller_1997/f64/*", "exact/f64/*"};
    for (const std::string name : kNames) {
      all.push_back(name + "/f32/*");
      in_doubles.push_back(name + "/f64/*");
    }
    lanes = league_lanes(all);
    league = run_league(lanes, sources(), kSeed);
    SelectedLanes of_f64 = league_lanes(in_doubles);
    select_for_doubles(of_f64);
    of_doubles = run_league(of_f64, sources(PairTypes::f64), kSeed);
  }

  static const LeagueRow& row(const std::string& lane, const League& of = league) {
    for (const LeagueRow& r : of.rows) {
      if (r.lane->id == lane) return r;
    }
    throw std::logic_error(lane);
  }

  template <class Real>
  static void expect_independent_counts(const League& found, PairTypes types);
};

// The verdict that a planted subject must give, according to the oracle.
template <class Real>
Verdict planted(std::string_view name, const BasicPair<Real>& pair) {
  const Hulls hulls = oracle::hulls(pair);
  const Verdict truth = oracle::truth(pair).verdict;
  const bool degenerate = hulls.dimension_a < 2 || hulls.dimension_b < 2;
  if (name == "blind" && hulls.coplanar) return Verdict::disjoint;
  if (name == "dies" && pair.a[0].x == 1) return Verdict::crashed;
  if (name == "narrow" && degenerate) return Verdict::disjoint;
  if (name == "one_sided" && pair.a[0].x > pair.b[0].x) return Verdict::intersects;
  return truth;
}

template <class Real>
BasicPair<Real> pair_of(const strata::PairSource& source, std::uint64_t i) {
  if constexpr (sizeof(Real) == sizeof(float))
    return source.pair(i);
  else
    return source.double_pair(i);
}

template <class Real>
void Planted::expect_independent_counts(const League& of, PairTypes types) {
  const std::string suffix = types == PairTypes::f64 ? "/f64/cpu" : "/f32/cpu";
  for (const std::string name : kNames) {
    const LeagueRow& found = row(name + suffix, of);
    std::array<LeagueCounts, kLeagueGroupCount> groups;
    std::uint64_t order_dependent = 0, breaks_invariant = 0, sample = 0;
    for (const strata::PairSource& source : sources(types)) {
      ASSERT_EQ(source.pairs, 1000u);
      LeagueCounts& counts = groups[source.id.starts_with("uniform")         ? 0
                                    : source.id.starts_with("coplanar_wide") ? 2
                                                                             : 3];
      for (std::uint64_t i = 0; i < source.pairs; ++i) {
        const BasicPair<Real> pair = pair_of<Real>(source, i);
        const oracle::Truth truth = oracle::truth(pair);
        const Hulls hulls = oracle::hulls(pair);
        const bool degenerate = hulls.dimension_a < 2 || hulls.dimension_b < 2;
        const bool outside = name == "narrow" && degenerate;
        const Verdict says = planted(name, pair);
        ++(outside ? counts.outside : counts.pairs);
        counts.by_convention += outside && says != truth.verdict;
        if (!outside && says != truth.verdict) {
          ++counts.of(says);
          counts.clear += !hulls.coplanar && !degenerate && std::fabs(truth.margin_ulps) >= 4096;
        }
        if (i >= kOrders || outside) continue;
        ++sample;
        const std::vector<BasicPair<Real>> orders = analysis::orders(pair);
        breaks_invariant += std::any_of(
            std::begin(analysis::kInvariants) + 2, std::end(analysis::kInvariants), [&](const auto& invariant) {
              const std::vector<BasicPair<Real>> images = analysis::images(invariant.invariant, pair);
              return std::any_of(images.begin(), images.end(), [&](const BasicPair<Real>& other) {
                const bool open =
                    name == "narrow" && (oracle::hulls(other).dimension_a < 2 || oracle::hulls(other).dimension_b < 2);
                return !open && analysis::breaks(invariant.invariant, says, planted(name, other));
              });
            });
        order_dependent += std::any_of(orders.begin(), orders.end(),
                                       [&](const BasicPair<Real>& other) { return planted(name, other) != says; });
      }
    }
    for (std::size_t g = 0; g < kLeagueGroupCount; ++g) {
      SCOPED_TRACE(name + " " + std::string(kLeagueGroups[g]));
      EXPECT_EQ(found.groups[g].pairs, groups[g].pairs);
      EXPECT_EQ(static_cast<const Counts&>(found.groups[g]), groups[g]);
      EXPECT_EQ(found.groups[g].clear, groups[g].clear);
      EXPECT_EQ(found.groups[g].outside, groups[g].outside);
      EXPECT_EQ(found.groups[g].not_repeated, 0u);
    }
    EXPECT_EQ(found.order_dependent, order_dependent) << name;
    EXPECT_EQ(found.breaks_invariant, breaks_invariant) << name;
    EXPECT_EQ(found.order_sample, sample) << name;
    EXPECT_FALSE(found.flips) << name;
  }
  // Each planted defect occurs often enough to be tested.
  EXPECT_GT(row("blind" + suffix, of).groups[2].false_negative, 100u);
  EXPECT_GT(row("dies" + suffix, of).groups[3].crashed, 100u);
  EXPECT_GT(row("narrow" + suffix, of).groups[3].by_convention, 50u);
  EXPECT_GT(row("one_sided" + suffix, of).groups[0].clear, 100u);
  EXPECT_GT(row("one_sided" + suffix, of).order_dependent, 10u);
  EXPECT_EQ(row("truth" + suffix, of).order_dependent, 0u);
  EXPECT_GT(row("one_sided" + suffix, of).breaks_invariant, 10u);
  EXPECT_GT(row("moller_1997" + suffix, of).breaks_invariant, 10u);
  EXPECT_EQ(row("truth" + suffix, of).breaks_invariant, 0u);
  EXPECT_EQ(row("exact" + suffix, of).breaks_invariant, 0u);
}

TEST_F(Planted, EveryNumberIsThatOfAnIndependentCount) { expect_independent_counts<float>(league, PairTypes::f32); }

TEST_F(Planted, OnDoublesToo) {
  EXPECT_TRUE(of_doubles.in_doubles);
  expect_independent_counts<double>(of_doubles, PairTypes::f64);
  EXPECT_GT(of_doubles.failures.size(), 4u);
  for (const LeagueFailure& failure : of_doubles.failures) {
    EXPECT_EQ(failure.lane->scalar, Scalar::f64);
    EXPECT_NE(failure.verdict, oracle::truth(failure.pair).verdict);
  }
}

TEST_F(Planted, FlipsAreThePairsOnWhichContractionChangesTheVerdict) {
  const Lane *cpu = find_lane("moller_1997/f32/cpu"), *fused = find_lane("moller_1997/f32/cpu-fma");
  if (!runs_on_this_cpu(*fused)) GTEST_SKIP() << "this processor has no FMA instructions";
  std::uint64_t flips = 0;
  for (const strata::PairSource& source : sources()) {
    for (std::uint64_t i = 0; i < source.pairs; ++i)
      flips += decide_one(cpu->decide, source.pair(i)) != decide_one(fused->decide, source.pair(i));
  }
  EXPECT_GT(flips, 0u);
  EXPECT_EQ(row("moller_1997/f32/cpu").flips, flips);
}

TEST_F(Planted, TheSmallestFailureOfEachKindIsOneAndIsSmall) {
  std::map<std::string, int> kinds;
  for (const LeagueFailure& failure : league.failures) {
    const std::string subject(failure.lane->info->id);
    const Pair& pair = failure.pair.floats.value();
    ++kinds[subject + ", " + failure.shape + ", " + std::string(name(failure.verdict))];
    EXPECT_EQ(oracle::truth(pair).verdict, failure.truth.verdict);
    EXPECT_NE(failure.verdict, failure.truth.verdict);
    EXPECT_EQ(shape_name(oracle::hulls(pair)), failure.shape == kClear ? "general" : failure.shape);
    EXPECT_TRUE(failure.shape != kClear || std::fabs(failure.truth.margin_ulps) >= 4096);
    if (!failure.lane->foreign) continue;
    EXPECT_EQ(planted(subject, pair), failure.verdict) << subject;
    EXPECT_TRUE(failure.minimised);
    EXPECT_LE(nontrivial_magnitudes(pair), 1) << subject << ' ' << pair_text(pair);
  }
  for (const char* kind :
       {"blind, coplanar, disjoint", "blind, degenerate, disjoint", "one_sided, clear, intersects",
        "dies, clear, crashed", "dies, general, crashed", "dies, coplanar, crashed", "dies, degenerate, crashed",
        "one_sided, general, intersects", "one_sided, coplanar, intersects", "one_sided, degenerate, intersects"}) {
    EXPECT_EQ(kinds[kind], 1) << kind;
    kinds.erase(kind);
  }
  for (const auto& [kind, count] : kinds) EXPECT_TRUE(kind.starts_with("moller")) << kind;
  EXPECT_EQ(league.failures_not_repeated, 0u);
}

TEST_F(Planted, SameAgainAndOfASlowSubjectTheFirstPairs) {
  const League again = run_league(lanes, sources(), kSeed, {{"blind", 300}});
  ASSERT_EQ(again.failures.size(), league.failures.size());
  for (std::size_t r = 0; r < league.rows.size(); ++r) {
    for (std::size_t g = 0; g < kLeagueGroupCount; ++g) {
      const LeagueCounts &now = again.rows[r].groups[g], &then = league.rows[r].groups[g];
      if (league.rows[r].lane->info->id == "blind") {
        EXPECT_EQ(now.pairs * 10, then.pairs);
        EXPECT_LE(now.wrong(), then.wrong());
      } else {
        EXPECT_EQ(now.pairs, then.pairs);
        EXPECT_EQ(static_cast<const Counts&>(now), then);
        EXPECT_EQ(now.clear, then.clear);
      }
    }
  }
  for (std::size_t f = 0; f < league.failures.size(); ++f) {
    if (league.failures[f].lane->info->id == "blind") continue;
    EXPECT_EQ(pair_text(again.failures[f].pair), pair_text(league.failures[f].pair));
  }
}

TEST_F(Planted, CostsAreThoseOfTheCodeItself) {
  const std::vector<std::optional<double>> costs = league_costs(league);
  ASSERT_EQ(costs.size(), league.rows.size());
  for (std::size_t r = 0; r < costs.size(); ++r) {
    ASSERT_TRUE(costs[r]) << league.rows[r].lane->id;
    EXPECT_GT(*costs[r], 1) << league.rows[r].lane->id;
    EXPECT_LT(*costs[r], 100'000) << league.rows[r].lane->id;
  }
}

TEST(LeagueGroups, NearAndExactContactsStandApart) {
  EXPECT_EQ(league_group("near_edge_edge"), LeagueGroup::near);
  EXPECT_EQ(league_group("exact_contact"), LeagueGroup::near);
  EXPECT_EQ(league_group("uniform"), LeagueGroup::general);
  EXPECT_EQ(league_group("shared_edge"), LeagueGroup::general);
  EXPECT_EQ(league_group("coplanar_rounded"), LeagueGroup::coplanar);
  EXPECT_EQ(league_group("lattice"), LeagueGroup::degenerate);
  EXPECT_EQ(league_group("extreme_scale"), LeagueGroup::extreme);
}

}  // namespace
}  // namespace graze::fuzz
