// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/lane_costs.h"

#include "fuzz/campaign/campaign_testing.h"

namespace graze::fuzz {
namespace {

TEST_F(CampaignFiles, CostsAreOfHostLanesOnTheCampaignsOwnPairs) {
  const SelectedLanes lanes =
      select_lanes({"moller_1997/f32/cpu", "moller_1997/f32/cuda-fma", "exact/f32/cpu"}, Executor::twin);
  const Campaign campaign = campaign_of(lanes, strata::stratum_sources(1, 4000, {"uniform", "degenerate"}), 1, "timed");
  const Json costs = measure_costs(campaign)["lanes"];
  ASSERT_EQ(costs.size(), 2u);  // twins are not timed
  for (const auto& [lane, strata] : costs.items()) {
    ASSERT_EQ(strata.size(), 2u) << lane;
    for (const auto& [stratum, cost] : strata.items()) {
      EXPECT_EQ(cost["pairs"], kPairsTimed);
      EXPECT_GT(cost["low"], 0) << lane << ' ' << stratum;
      EXPECT_LE(cost["low"], cost["middle"]);
      EXPECT_LE(cost["middle"], cost["high"]);
      EXPECT_LT(cost["middle"], 1e6);
    }
  }
}

TEST(LaneCosts, ThatCannotBeAreRefused) {
  const Json whole = {
      {"passes", 9},
      {"lanes", {{"a/f32/cpu", {{"uniform", {{"pairs", 200}, {"low", 1.5}, {"middle", 2}, {"high", 3}}}}}}}};
  const auto check = [](const Json& costs) {
    expect_possible_costs(costs, {"a/f32/cpu"}, {{"uniform", 200}, {"thesis", 1000}});
  };
  EXPECT_NO_THROW(check(whole));
  for (const auto& [place, value] : {std::pair<const char*, Json>("middle", -1),
                                     {"middle", 4},
                                     {"low", 2.5},
                                     {"low", 0},
                                     {"low", "x"},
                                     {"high", nullptr},
                                     {"pairs", 0},
                                     {"pairs", 201},
                                     {"pairs", 1'000'000},
                                     {"pairs", -1}}) {
    Json other = whole;
    other["lanes"]["a/f32/cpu"]["uniform"][place] = value;
    EXPECT_ANY_THROW(check(other)) << place << ' ' << value;
  }
  Json other = whole;
  other["passes"] = 0;
  EXPECT_ANY_THROW(check(other));
  EXPECT_ANY_THROW(expect_possible_costs(whole, {"b/f32/cpu"}, {{"uniform", 200}}));
  EXPECT_ANY_THROW(expect_possible_costs(whole, {"a/f32/cpu"}, {{"thesis", 200}}));
}

TEST(LaneCosts, RunsThatCannotBeAreRefused) {
  const auto check = [](const Json& run) { expect_possible_run(run, {"a/f32/cpu"}, {{"uniform", 200}}, 200); };
  for (const Json& run : {Json{{"machine", "m"}}, Json{{"pairs", 200}, {"seconds", 1.5}},
                          Json{{"pairs", 300}, {"merged", 2}}, Json{{"pairs", 0}, {"seconds", 0}}})
    EXPECT_NO_THROW(check(run)) << run;
  for (const Json& run : {Json{{"pairs", -1}}, Json{{"pairs", 201}}, Json{{"pairs", "x"}}, Json{{"seconds", -1}},
                          Json{{"seconds", "x"}}, Json{{"costs", {{"passes", 0}}}}})
    EXPECT_ANY_THROW(check(run)) << run;
}

TEST_F(CampaignFiles, CostsStandInTimingsOnceTheCampaignIsComplete) {
  const SelectedLanes lanes = select_lanes({"moller_1997/f32/cpu"});
  const Campaign campaign = campaign_of(lanes, strata::stratum_sources(1, 140'000, {"thesis"}), 1, "parts");
  const auto runs = [&] { return Json::parse(read_whole(campaign.directory / "timings.json"))["runs"]; };
  run(campaign, 1);
  EXPECT_FALSE(runs().back().contains("costs"));
  const Json summary = run(campaign);
  EXPECT_EQ(runs().back()["costs"]["lanes"]["moller_1997/f32/cpu"]["thesis"]["pairs"], kPairsTimed);
  EXPECT_EQ(summary.dump().find("costs"), std::string::npos);
}

}  // namespace
}  // namespace graze::fuzz
