// SPDX-License-Identifier: Apache-2.0
// Tests recommendations on artificial data that would reveal likely mistakes.
#include "reports/findings.h"

#include <gtest/gtest.h>

#include "core/message_testing.h"
#include "reports/cost_words.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

struct MadeLane {
  std::string id;
  std::uint64_t wrong;         // false negatives on the 10,000 pairs of each stratum
  std::uint64_t declined = 0;  // declined pairs of each stratum
  std::uint64_t by_convention = 0;
};

CampaignCounts counts_with(const std::vector<MadeLane>& lanes,
                           const std::vector<std::string>& strata = {"uniform", "degenerate"}) {
  Json summary = {{"spec", {{"seed", 1}, {"pairs", 20'000}, {"lanes", Json::array()}}}, {"complete", true}};
  for (const std::string& stratum : strata) {
    Json& row = summary["strata"][stratum] = {
        {"pairs", 10'000}, {"intersects", 5'000}, {"lanes", Json::object()}, {"margins", Json::object()}};
    for (const MadeLane& lane : lanes) {
      row["lanes"][lane.id] = {
          {"false_positive", 0}, {"false_negative", lane.wrong}, {"declined", lane.declined}, {"differs_from_cpu", 0}};
      if (lane.by_convention > 0) row["lanes"][lane.id]["by_convention"] = lane.by_convention;
    }
  }
  for (const MadeLane& lane : lanes) summary["spec"]["lanes"].push_back(lane.id);
  return counts_of(summary);
}

// Costs of each lane on the strata uniform and degenerate, with a spread of 1 ns; 0 if the lane was not timed there.
Costs costs_with(const std::vector<std::pair<double, double>>& of_lanes) {
  Costs costs{"a machine", 9, {}};
  for (const auto& [uniform, degenerate] : of_lanes) {
    auto& row = costs.of_stratum.emplace_back();
    for (const double ns : {uniform, degenerate})
      row.push_back(ns == 0 ? std::nullopt : std::optional(Cost{{ns - 1, ns, ns + 1}, 100}));
  }
  return costs;
}

const std::vector<MadeLane> kThree{
    {"exact/f32/cpu", 0}, {"moller_1997/f32/cpu", 900}, {"separating_axes/f64/cpu", 100}};

TEST(Recommendations, TheExactLaneIsCheaperOnlyWhereSpreadsAreApart) {
  const CampaignCounts counts = counts_with(kThree);
  const Costs cheaper = costs_with({{38, 300}, {60, 62}, {80, 82}});
  EXPECT_EQ(
      lane_to_use(counts, &cheaper).text,
      "Use exact/f32/cpu: right on all 20,000 pairs, at 38 ns (37 to 39) a general pair against 60 ns (59 to 61) for "
      "the fastest published lane, moller_1997/f32/cpu; over all strata 169 ns (168 to 170) against 61 ns (60 to 62).");
  const Costs dearer = costs_with({{100, 300}, {60, 62}, {80, 82}});
  EXPECT_EQ(
      lane_to_use(counts, &dearer).text,
      "Use exact/f32/cpu: right on all 20,000 pairs, at 100 ns (99 to 101) a general pair. The fastest published "
      "lane, moller_1997/f32/cpu, takes 60 ns (59 to 61); over all strata 200 ns (199 to 201) against 61 ns (60 to "
      "62); it is wrong on 9 % of all pairs.");
  const Costs near = costs_with({{59, 300}, {60, 62}, {80, 82}});
  EXPECT_EQ(
      lane_to_use(counts, &near).text,
      "Use exact/f32/cpu: right on all 20,000 pairs, at 59 ns (58 to 60) a general pair. Whether the fastest "
      "published lane, moller_1997/f32/cpu at 60 ns (59 to 61), is cheaper is not settled: their spreads overlap; "
      "over all strata 180 ns (178 to 180) against 61 ns (60 to 62).");
}

TEST(Recommendations, CostsThatAreNotMeasuredAreNotSettled) {
  const CampaignCounts counts = counts_with(kThree);
  const std::string expected =
      "Use exact/f32/cpu: right on all 20,000 pairs. Its cost is not settled: the campaign has no timings of it.";
  EXPECT_EQ(lane_to_use(counts, nullptr).text,
            "Use exact/f32/cpu: right on all 20,000 pairs. Its cost depends on the machine; costs.json has it if the "
            "campaign was timed.");
  const Costs of_others = costs_with({{0, 0}, {60, 62}, {80, 82}});
  EXPECT_EQ(lane_to_use(counts, &of_others).text, expected);
  const Costs of_exact = costs_with({{38, 300}, {0, 0}, {0, 0}});
  EXPECT_EQ(lane_to_use(counts, &of_exact).text,
            "Use exact/f32/cpu: right on all 20,000 pairs, at 38 ns (37 to 39) a general pair.");
}

TEST(Recommendations, AnExactLaneThatErrsIsNotRecommended) {
  const CampaignCounts counts = counts_with({{"exact/f32/cpu", 1}, {"moller_1997/f32/cpu", 900}});
  EXPECT_EQ(lane_to_use(counts, nullptr).text,
            "exact/f32/cpu is wrong or declines on 2 of 20,000 pairs, which must never happen: trust no exact lane "
            "before this is explained.");
  const CampaignCounts none = counts_with({{"moller_1997/f32/cpu", 900}});
  EXPECT_FALSE(lane_to_use(none, nullptr).known);
}

TEST(Recommendations, TheWorstLaneIsAvoidedWhereIntervalsAreApart) {
  const CampaignCounts counts = counts_with(kThree);
  const std::string avoid =
      "Avoid moller_1997/f32/cpu: wrong on 1,800 pairs (9 %, 95 % interval 8.61 % to 9.41 %), 0 false positives and "
      "1,800 "
      "false negatives; on 9 % of the general pairs";
  EXPECT_EQ(lane_to_avoid(counts, nullptr).text, avoid + ".");
  const Costs dear = costs_with({{38, 300}, {90, 62}, {80, 82}});
  EXPECT_EQ(lane_to_avoid(counts, &dear).text,
            avoid +
                ". separating_axes/f64/cpu is both less often wrong and cheaper, 80 ns (79 to 81) a general "
                "pair against 90 ns (89 to 91).");
  const Costs near = costs_with({{38, 300}, {81, 62}, {80, 82}});
  EXPECT_EQ(lane_to_avoid(counts, &near).text, avoid + ".");
  EXPECT_EQ(
      lane_to_avoid(counts_with({{"moller_1997/f32/cpu", 900}, {"separating_axes/f64/cpu", 890}}), nullptr).text,
      "Which published lane is worst is not settled: the 95 % intervals of moller_1997/f32/cpu, wrong on 8.61 % to "
      "9.41 % of all pairs, and separating_axes/f64/cpu, on 8.51 % to 9.31 %, overlap.");
  // Even if the intervals of one algorithm's variants overlap, it is settled which lane to avoid.
  EXPECT_TRUE(lane_to_avoid(counts_with({{"moller_1997/f32/cpu", 900},
                                         {"moller_1997/f32/cpu-fma", 899},
                                         {"separating_axes/f64/cpu", 100}}),
                            nullptr)
                  .text.starts_with("Avoid moller_1997/f32/cpu: "));
}

// General pairs of both coordinate types are counted together.
TEST(Recommendations, GeneralPairsAreThoseOfBothTypes) {
  const std::vector<MadeLane> lanes = {{"moller_1997/f32/cpu", 900}, {"separating_axes/f64/cpu", 100}};
  EXPECT_TRUE(lane_to_avoid(counts_with(lanes, {"uniform", "uniform/f64", "degenerate"}), nullptr)
                  .text.ends_with("; on 9 % of the general pairs."));
  CampaignCounts counts = counts_with(lanes, {"uniform", "uniform/f64", "degenerate"});
  for (GroupCounts& group : counts.groups) {
    if (group.id == "general/f64") group.counts.lanes[0].false_negative = 100;
  }
  EXPECT_TRUE(lane_to_avoid(counts, nullptr).text.ends_with("; on 5 % of the general pairs."))
      << lane_to_avoid(counts, nullptr).text;
  EXPECT_EQ(lane_to_avoid(counts_with(lanes, {"uniform", "uniform/f64"}), nullptr).text.find("general"),
            std::string::npos);
  const Costs costs = costs_with({{38, 300}, {60, 62}, {80, 82}});
  EXPECT_NE(lane_to_use(counts_with({{"exact/f64/cpu", 0}, lanes[0], lanes[1]}, {"uniform", "uniform/f64"}), &costs)
                .text.find(", at 38 ns (37 to 39) a general pair of float32 against 60 ns"),
            std::string::npos);
}

TEST(Recommendations, TheLeastWrongLaneIsNamedWithItsCost) {
  const CampaignCounts counts = counts_with(kThree);
  const Costs costs = costs_with({{38, 300}, {60, 62}, {80, 82}});
  EXPECT_EQ(
      least_wrong_lane(counts, &costs).text,
      "Of the 2 published lanes the least wrong is separating_axes/f64/cpu: on 200 (1 %, 95 % interval 0.871 % to "
      "1.15 %) of 20,000 pairs, at 80 ns (79 to 81) a general pair.");
  EXPECT_TRUE(
      least_wrong_lane(counts_with({{"moller_1997/f32/cpu", 110}, {"separating_axes/f64/cpu", 100}}), nullptr)
          .text.starts_with(
              "Which published lane is least wrong is not settled: the 95 % intervals of separating_axes/f64/cpu"));
}

// A lane that declines all pairs is never wrong, but of no use.
TEST(Recommendations, ALaneThatDeclinesIsNotTheBest) {
  const MadeLane silent{"moller_1997/f32/cpu/bound", 0, 10'000}, cautious{"moller_1997/f32/cpu/bound", 0, 40};
  const MadeLane other{"separating_axes/f64/cpu", 100};
  EXPECT_EQ(least_wrong_lane(counts_with({silent, other}), nullptr).text,
            "Of the 2 published lanes the most often right is separating_axes/f64/cpu: wrong on 200 (1 %, 95 % "
            "interval 0.871 % to 1.15 %) of 20,000 pairs.");
  EXPECT_EQ(least_wrong_lane(counts_with({cautious, other}), nullptr).text,
            "Of the 2 published lanes the most often right is moller_1997/f32/cpu/bound: wrong on none of 20,000 pairs "
            "(with 95 % confidence fewer than 1 in 6,640); moller_1997/f32/cpu/bound declines 80 pairs.");
  EXPECT_EQ(least_wrong_lane(counts_with({silent}), nullptr).text,
            "The only published lane, moller_1997/f32/cpu/bound, is wrong on none of 20,000 pairs; "
            "moller_1997/f32/cpu/bound declines 20,000 pairs.");
  EXPECT_TRUE(least_wrong_lane(counts_with({{"moller_1997/f32/cpu/bound", 0, 95}, other}), nullptr)
                  .text.starts_with("Which published lane is most often right is not settled: the 95 % intervals of "
                                    "moller_1997/f32/cpu/bound, without a correct verdict on "));
}

// A lane that its convention excuses on every pair is never wrong, but its rate of errors where it counts is not known.
TEST(Recommendations, ALaneThatAConventionExcusesIsNotTheBest) {
  const MadeLane excused{"moller_1997/f32/cpu", 0, 0, 3'000}, other{"separating_axes/f64/cpu", 100};
  EXPECT_EQ(least_wrong_lane(counts_with({excused, other}), nullptr).text,
            "Of the 2 published lanes the most often right is separating_axes/f64/cpu: wrong on 200 (1 %, 95 % "
            "interval 0.871 % to 1.15 %) of 20,000 pairs.");
  EXPECT_EQ(least_wrong_lane(counts_with({excused}), nullptr).text,
            "The only published lane, moller_1997/f32/cpu, is wrong on none of 20,000 pairs; the convention of "
            "moller_1997/f32/cpu allows 6,000 other verdicts.");
}

TEST(Costs, HaveOneFormWithTheirSpread) {
  EXPECT_EQ(cost_words({20.9, 22.1, 24.4}), "22 ns (21 to 24)");
  EXPECT_EQ(cost_words({4.0, 4.14, 4.96}), "4.1 ns (4.0 to 5.0)");
  EXPECT_EQ(cost_words({0.0203, 0.0204, 0.0204}), "0.0204 ns (0.0203 to 0.0204)");
  EXPECT_EQ(cost_words({205, 284, 1289}), "284 ns (205 to 1,289; noisy)");
  const std::vector<std::string> of_calls = {"mine", "exact"};
  const std::vector<analysis::Cost> calm = {{40, 41, 43}, {72, 73, 75}}, one_noisy = {{40, 41, 43}, {72, 73, 175}};
  EXPECT_EQ(one_call_sentence(of_calls, calm, "256 pairs", "a machine", 101),
            "A call of one pair takes 41 ns (40 to 43) in mine, 73 ns (72 to 75) in exact: median and quartiles "
            "of 101 passes over 256 pairs, on one core of a machine.");
  EXPECT_TRUE(names(one_call_sentence(of_calls, one_noisy, "256 pairs", "a machine", 101),
                    {"73 ns (72 to 175; noisy)", "a machine."}));
  EXPECT_FALSE(is_noisy({90, 100, 115}));
  EXPECT_TRUE(is_noisy({90, 100, 115.1}));
  const std::vector<std::string> lanes = {"a", "b", "c"};
  const std::vector<analysis::Cost> costs = {{1, 2, 3}, {10, 10, 11}, {5, 8, 8}};
  EXPECT_TRUE(
      names(noisy_sentence(lanes, costs), {"a 2.0 ns (1.0 to 3.0; noisy)", "c 8.0 ns (5.0 to 8.0; noisy)", "idle"}));
  EXPECT_EQ(noisy_sentence({&lanes[1], 1}, {&costs[1], 1}), "");
  for (const auto calls : {analysis::Calls::of_blocks, analysis::Calls::of_one})
    EXPECT_TRUE(names(costs_sentence(calls, "the first 1,024 pairs of each stratum", "a machine", 9),
                      {"one core of a machine", "9 passes", "1,024 pairs of each stratum", "quartiles", "noisy",
                       calls == analysis::Calls::of_one ? "one pair a call" : "many pairs a call"}));
}

TEST(Costs, AreThoseOfTheLastTimedRunAndCountPairs) {
  const CampaignCounts counts = counts_with(kThree);
  const auto cost = [](int pairs, double ns) {
    return Json{{"pairs", pairs}, {"low", ns - 1}, {"middle", ns}, {"high", ns + 1}};
  };
  const Json lanes = {{"exact/f32/cpu", {{"uniform", cost(100, 40)}, {"degenerate", cost(300, 80)}}}};
  const Json runs = {{{"machine", "old"}, {"costs", {{"passes", 9}, {"lanes", Json::object()}}}},
                     {{"machine", "new"}, {"costs", {{"passes", 9}, {"lanes", lanes}}}},
                     {{"machine", "untimed"}}};
  const std::optional<Costs> costs = costs_of(runs, counts);
  ASSERT_TRUE(costs);
  EXPECT_EQ(costs->machine, "new");
  EXPECT_EQ(costs->of(0, {0, 1})->middle, 70);  // (100 · 40 + 300 · 80) / 400
  EXPECT_EQ(costs->of(0, {0})->high, 41);
  EXPECT_FALSE(costs->of(1, {0}));
  // Costs are rejected if more pairs were timed than the stratum has.
  CampaignCounts fewer = counts;
  fewer.strata[0].pairs = 100;
  EXPECT_TRUE(costs_of(runs, fewer));
  fewer.strata[0].pairs = 99;
  EXPECT_THROW(costs_of(runs, fewer), std::runtime_error);
  fewer.complete = false;  // an unfinished campaign may have timed pairs that are not judged yet
  EXPECT_TRUE(costs_of(runs, fewer));
  EXPECT_FALSE(costs_of(Json::array({{{"machine", "untimed"}}}), counts));
  EXPECT_FALSE(costs_of(Json::array(), counts));
}

}  // namespace
}  // namespace graze::reports
