// SPDX-License-Identifier: Apache-2.0
// Tests the answer's sentences on artificial summaries.
#include "reports/findings.h"

#include "reports/test_campaign.h"

namespace graze::reports {
namespace {

std::vector<std::string> answer_of(const Json& summary) { return answer(counts_of(summary), nullptr); }

// Whether some sentence of the answer contains the text.
bool says(const Json& summary, const std::string& text) {
  const std::vector<std::string> said = answer_of(summary);
  return std::any_of(said.begin(), said.end(), [&](const std::string& sentence) { return contains(sentence, text); });
}

TEST(Answer, OfOneLaneComparesNothing) {
  const auto said = answer_of(summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {3, 2, 0, 0}));
  ASSERT_EQ(said.size(), 6u);
  EXPECT_EQ(said[0],
            "The only published lane, moller_1997/f32/cpu, is wrong on 5 (0.5 %, 95 % interval 0.213 % to 1.17 %) of "
            "1,000 pairs.");
  EXPECT_EQ(said[1], "The only stratum is uniform (0.5 % of all verdicts wrong).");
  // Open questions come last.
  EXPECT_EQ(said[2], "No exact lane ran, so there is none to recommend for every pair.");
  EXPECT_EQ(said[3], "Only published lanes of moller_1997/f32 ran, so the campaign does not say which to avoid.");
  EXPECT_TRUE(contains(said[4], "No lane with contraction ran"));
  EXPECT_TRUE(contains(said[5], "were not drawn"));
}

// Nothing shows that a stratum is safe if verdicts on it were declined.
TEST(Answer, CallsAStratumSafeOnlyIfEveryVerdictCounts) {
  Json summary = summary_of({"mine/f32/cpu"}, {"uniform", "lattice", "shared_edge"}, {});
  Json& strata = summary["strata"];
  const auto of = [&](const char* stratum) -> Json& { return strata[stratum]["lanes"]["mine/f32/cpu"]; };
  of("lattice")["false_positive"] = 50;
  of("uniform")["false_positive"] = 5;
  EXPECT_TRUE(says(summary, "; the safest is shared_edge (no wrong verdict)."));
  of("shared_edge")["declined"] = 1000;
  EXPECT_TRUE(says(summary, "The most dangerous strata are lattice (5 % of all verdicts wrong) and uniform"));
  EXPECT_FALSE(says(summary, "safest"));
  of("uniform")["false_positive"] = 0;
  EXPECT_TRUE(says(summary, "; the safest on which every verdict counts is uniform (no wrong verdict)."));
}

// The share of wrong verdicts leaves out exact lanes, because they are never wrong.
TEST(Answer, NamesTheLanesOfAStratumsShare) {
  Json summary = summary_of({"moller_1997/f32/cpu", "exact/f32/cpu"}, {"uniform"}, {});
  summary["strata"]["uniform"]["lanes"]["moller_1997/f32/cpu"]["false_positive"] = 5;
  EXPECT_TRUE(says(summary, "uniform (0.5 % of the published lanes' verdicts wrong"));
}

TEST(Answer, CallsAPersonsOwnCodeNotPublished) {
  const auto said = answer_of(summary_of({"moller_1997/f32/cpu", "mine/f32/cpu"}, {"uniform"}, {}));
  EXPECT_TRUE(said[0].starts_with("mine/f32/cpu is wrong on none of the 1,000 pairs that it decides")) << said[0];
  EXPECT_TRUE(said[2].starts_with("All 2 inexact lanes are wrong on none of 1,000 pairs")) << said[2];
  const auto alone = answer_of(summary_of({"mine/f32/cpu"}, {"uniform"}, {3, 2, 0, 0}));
  EXPECT_TRUE(alone[0].starts_with("mine/f32/cpu is wrong on 5 (0.5 %")) << alone[0];
  for (const std::string& text : alone) EXPECT_EQ(text.find("published lane"), std::string::npos) << text;
}

TEST(Answer, WithoutErrorsSaysHowMuchThatProves) {
  const auto said = answer_of(summary_of(
      {"moller_1997/f32/cpu", "moller_1997/f32/cuda-nofma", "moller_1997/f32/cuda-fma"}, {"thesis", "uniform"}, {}));
  EXPECT_EQ(said[0], "No lane need be avoided: none is wrong on any pair of this campaign.");
  EXPECT_EQ(said[1],
            "All 3 published lanes are wrong on none of 2,000 pairs, so with 95 % confidence each errs on fewer than "
            "0.15 % of such pairs.");
  EXPECT_EQ(said[2], "None of the 2 strata shows a wrong verdict.");
  EXPECT_EQ(said[3], "Contraction changes no verdict of the one lane that ran with and without it.");
  EXPECT_TRUE(contains(said[4], "none of 2 CUDA lanes differs from its cpu lane on any of 1,000 pairs")) << said[4];
}

TEST(Answer, TellsWhatContractionChanges) {
  Json summary = summary_of(
      {"interval_overlap/f32/cpu", "interval_overlap/f32/cuda-nofma", "interval_overlap/f32/cuda-fma", "exact/f32/cpu"},
      {"thesis"}, {});
  summary["strata"]["thesis"]["lanes"]["interval_overlap/f32/cuda-fma"] = {
      {"false_positive", 7}, {"false_negative", 3}, {"declined", 0}, {"differs_from_cpu", 10}};
  const auto said = answer_of(summary);
  EXPECT_EQ(said[0],
            "Use exact/f32/cpu: right on all 1,000 pairs. Its cost depends on the machine; costs.json has it if the "
            "campaign was timed.");
  EXPECT_EQ(
      said[1],
      "Of the 3 published lanes the least wrong are interval_overlap/f32/cpu and interval_overlap/f32/cuda-nofma: on "
      "none of 1,000 pairs (with 95 % confidence fewer than 0.3 %).");
  EXPECT_TRUE(contains(said[3], "a different verdict from interval_overlap/f32/cuda-nofma on 10 pairs (1")) << said[3];
  EXPECT_TRUE(contains(said[3], "its wrong verdicts go from 0 to 10; 1 of 1 lanes")) << said[3];
  EXPECT_TRUE(contains(said[4], "in interval_overlap/f32/cuda-fma: on 10 (1 %")) << said[4];
  EXPECT_TRUE(contains(said[4], "of 1,000 pairs; without contraction on none.")) << said[4];
  // The figures on the rate of 2012 must be those in docs/measurements.md.
  const std::string measured = fuzz::read_whole(fs::path(GRAZE_SOURCE_DIR) / "docs/measurements.md");
  for (const char* rate : {"3,270", "1,300"}) {
    EXPECT_TRUE(contains(said[4], std::string("1 in ") + rate)) << said[4];
    EXPECT_TRUE(contains(measured, rate)) << rate;
  }
}

TEST(Answer, WithoutCpuLanesCountsWrongVerdicts) {
  Json summary = summary_of({"interval_overlap/f32/cuda-nofma", "interval_overlap/f32/cuda-fma"}, {"thesis", "sliver"},
                            {1, 0, 0, 0});
  summary["strata"]["sliver"]["lanes"]["interval_overlap/f32/cuda-fma"]["false_positive"] = 5;
  const auto said = answer_of(summary);
  EXPECT_TRUE(contains(said[1], "The most dangerous stratum is sliver (0.3 % of all verdicts wrong")) << said[1];
  EXPECT_TRUE(contains(said[2], "its wrong verdicts go from 2 to 6 of 2,000 pairs")) << said[2];
  EXPECT_TRUE(contains(said[2], "without a cpu lane beside them")) << said[2];
  EXPECT_TRUE(contains(said[3], "no CUDA lane ran beside its cpu lane")) << said[3];
}

TEST(Answer, NamesWhatItLeavesOut) {
  EXPECT_TRUE(says(summary_of({"moller_1997/f32/cpu", "moller_1997/f32/x86-gcc-v3"}, {"near_edge_edge"}, {1, 0, 0, 0}),
                   "the map of the toolchains shows where their verdicts differ"));
  EXPECT_TRUE(says(summary_of({"interval_overlap/f64/cpu", "interval_overlap/f64/cuda-fma"}, {"thesis/f64"}, {}),
                   "On the 2012 thesis's triangles, in doubles, CPU and GPU agree: none of 1 CUDA lanes"));
  Json summary = summary_of({"moller_1997/f32/cpu/bound", "separating_axes/f64/cpu"}, {"degenerate"}, {3, 0, 0, 0});
  summary["strata"]["degenerate"]["lanes"]["moller_1997/f32/cpu/bound"] = {
      {"false_positive", 1}, {"false_negative", 0}, {"declined", 1}, {"differs_from_cpu", 0}};
  EXPECT_TRUE(says(summary, "its best lane, moller_1997/f32/cpu/bound, which declines 1)"));
}

TEST(Answer, OfExactLanesOnlyAndOfNothing) {
  EXPECT_EQ(answer_of(summary_of({"exact/f32/cpu"}, {"uniform"}, {})),
            std::vector<std::string>{"Only exact lanes ran, and none of their verdicts on 1,000 pairs are wrong."});
  Json begun = summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {});
  begun["strata"]["uniform"]["pairs"] = begun["strata"]["uniform"]["intersects"] = 0;
  EXPECT_EQ(answer_of(begun), std::vector<std::string>{"No pair has been decided yet."});
}

}  // namespace
}  // namespace graze::reports
