// SPDX-License-Identifier: Apache-2.0
// Tests a user's source with different values of its epsilon.
#include "analysis/epsilon_sweep.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "analysis/tuning.h"
#include "core/error.h"
#include "subjects/subjects.h"

namespace graze::analysis {
namespace {

namespace fs = std::filesystem;

// Finds boxes that overlap by more than kEps. It finds too many boxes if kEps is negative, too few if it is large.
constexpr const char* kBoxes = R"(#include "own.h"
const float kEps = 0.75f;
int intersects(const float a[9], const float b[9]) {
  for (int k = 0; k < 3; ++k) {
    const float low = least(b[k], b[k + 3], b[k + 6]), high = -least(-a[k], -a[k + 3], -a[k + 6]);
    const float low_a = least(a[k], a[k + 3], a[k + 6]), high_b = -least(-b[k], -b[k + 3], -b[k + 6]);
    if (low > high - kEps || low_a > high_b - kEps) return 0;
  }
  return 1;
})";

class EpsilonSweep : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("graze-epsilon-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
    std::ofstream(folder_ / "own.h")
        << "static float least(float x, float y, float z) { x = x < y ? x : y; return x < z ? x : z; }\n";
    std::ofstream(folder_ / "boxes.c") << kBoxes;
    subjects::open({"boxes", folder_ / "boxes.c", {}});
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  static inline fs::path folder_;
  const Lane& lane_ = *find_lane("boxes/f32/cpu");
  const std::vector<strata::PairSource> sources_ = strata::stratum_sources(3, 2000, {"uniform", "lattice"});
};

// The changed source finds own.h in the original's folder.
TEST_F(EpsilonSweep, TheTextAsItIsDecidesLikeTheLane) {
  const auto source = subjects::tunable_source(lane_, "");
  const auto same = subjects::rebuilt(lane_, source.text, lane_.scalar);
  const auto other =
      subjects::rebuilt(lane_, with_value(source.text, {source.epsilon}, 0, source.language), lane_.scalar);
  int differ = 0;
  for (const strata::PairSource& from : sources_) {
    for (std::uint64_t i = 0; i < 300; ++i) {
      const Pair pair = from.pair(i);
      EXPECT_EQ(decide_one(DecideBlock(*same), pair), decide_one(lane_.decide, pair));
      differ += decide_one(DecideBlock(*other), pair) != decide_one(lane_.decide, pair);
    }
  }
  EXPECT_GT(differ, 10);
}

TEST_F(EpsilonSweep, CountsTheErrorsOfEachValue) {
  const auto source = subjects::tunable_source(lane_, "kEps");
  UnderEpsilon under(lane_, source);
  const std::vector<std::string> policies = {"", "abs:0.75", "abs:0", "abs:0.1", "abs:1e+06", "abs:0.75"};
  const std::vector<PolicyErrors> found = epsilon_sweep(under)(policies, sources_);
  ASSERT_EQ(found.size(), policies.size());
  for (std::size_t p = 0; p < found.size(); ++p) {
    EXPECT_EQ(found[p].policy, policies[p]);
    EXPECT_EQ(found[p].pairs, 2000u);
  }
  EXPECT_TRUE(found[0].changes_nothing());
  EXPECT_TRUE(found[1].changes_nothing());
  EXPECT_EQ(Counts(found[0]), Counts(found[1]));
  EXPECT_LT(found[2].false_negative, found[0].false_negative);
  EXPECT_EQ(found[4].false_positive, 0u);
  EXPECT_GT(found[4].false_negative, 100u);
  EXPECT_EQ(epsilon_sweep(under, 1)(policies, sources_), found);
}

TEST_F(EpsilonSweep, TuneFindsAValueThatIsBetterOnOtherPairs) {
  const auto source = subjects::tunable_source(lane_, "kEps");
  UnderEpsilon under(lane_, source);
  TuneSpec spec;
  spec.sweep = epsilon_sweep(under);
  spec.by_value = true;
  spec.sources = sources_;
  spec.others = strata::stratum_sources(4, 2000, {"uniform", "lattice"});
  spec.forbid = Forbid::false_negative;
  spec.max_rate = 0.01;
  spec.max_other = 0.9;
  const Tuned tuned = tune(spec);
  ASSERT_EQ(tuned.curves.size(), 1u);
  EXPECT_EQ(tolerance_of(tuned.curves[0].points.front().policy), 0);
  EXPECT_LT(tuned.curves[0].points.size(), 45u);  // each point takes a build
  ASSERT_FALSE(tuned.chosen.empty());
  EXPECT_LT(tolerance_of(tuned.chosen), 0.75);
  EXPECT_NE(tuned.result, TuneResult::not_satisfiable);
  EXPECT_LT(10 * tuned.confirmed.false_negative, tuned.zero_confirmed.false_negative);
}

TEST_F(EpsilonSweep, FailuresAndConventionsCountAsInACampaign) {
  std::ofstream(folder_ / "fails.c")
      << "#include <stdlib.h>\nstatic const float eps = 1e-6f;\nint intersects(const float "
         "a[9], const float b[9]) { if (a[0] > 0.9f) abort(); return a[0] > eps; }\n";
  subjects::open({"fails", folder_ / "fails.c", {}});
  const Lane& fails = *find_lane("fails/f32/cpu");
  const auto source = subjects::tunable_source(fails, "");
  UnderEpsilon under(fails, source);
  const auto few = strata::stratum_sources(3, 400, {"uniform"});
  const PolicyErrors errors = epsilon_sweep(under)(std::vector<std::string>{"abs:0.5"}, few).front();
  Counts expected;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const Pair pair = few[0].pair(i);
    const Verdict truth = decide_one(find_lane("exact/f32/cpu")->decide, pair);
    const Verdict verdict = pair.a[0].x > 0.9f   ? Verdict::crashed
                            : pair.a[0].x > 0.5f ? Verdict::intersects
                                                 : Verdict::disjoint;
    if (verdict != truth) ++expected.of(verdict);
  }
  EXPECT_GT(expected.crashed, 0u);
  EXPECT_EQ(Counts(errors), expected);
}

TEST_F(EpsilonSweep, WhatCannotBeBuiltAgainIsSaid) {
  subjects::open({"line", "cmd:while read l; do echo 1; done", {}});
  EXPECT_THROW(subjects::tunable_source(*find_lane("line/f32/cpu"), ""), UsageError);
  std::ofstream(folder_ / "flag.c") << "#ifndef EPS\n#define EPS 1e-6f\n#endif\nint intersects(const float a[9], const "
                                       "float b[9]) { return a[0] > b[0] + EPS; }\n";
  subjects::open({"flag", folder_ / "flag.c", {"-DEPS=0.5f"}});
  EXPECT_THROW(subjects::tunable_source(*find_lane("flag/f32/cpu"), ""), UsageError);
}

}  // namespace
}  // namespace graze::analysis
