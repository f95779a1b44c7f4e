// SPDX-License-Identifier: Apache-2.0
#include "reports/discrepancy.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <regex>

#include "analysis/discrepancy.h"
#include "analysis/lane_trace.h"
#include "analysis/tuning.h"
#include "reports/possible_counts.h"
#include "reports/terminal.h"
#include "strata/strata.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

class DiscrepancyResult : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    analysis::DiscrepancySpec spec;
    const auto lane = [](const char* id) -> const Lane& { return *find_lane(id); };
    spec.lanes.emplace_back(lane("interval_overlap/f32/cpu"), lane("interval_overlap/f32/cuda-fma"));
    spec.lanes.emplace_back(lane("moller_1997/f64/cpu"), lane("moller_1997/f64/cuda-nofma"));
    spec.sources = strata::stratum_sources(4, 9000, {"thesis", "near_edge_edge", "extreme_scale"});
    const auto simpler = [](const AnyPair&, const AnyPair&) { return false; };
    json_ = {{"pairs", 9000u},
             {"seed", 4u},
             {"build", {{"version", "1"}, {"commit", "a"}, {"compiler", "GCC"}, {"cuda", nullptr}}}};
    const analysis::Discrepancies found = analysis::discrepancies(spec);
    json_.update(discrepancy_json(
        spec, found, {analysis::origins(*spec.lanes[0].second, spec.sources, 500, 0, simpler), std::nullopt}));
    csv_ = discrepancy_csv(json_);
    for (const auto& of_lanes : found) {
      for (const analysis::DiscrepancyCounts& of : of_lanes)
        counted_ = std::accumulate(of.counts.begin(), of.counts.end(), counted_);
    }
  }

  static inline std::uint64_t counted_ = 0;
  static inline Json json_;
  static inline std::string csv_;
};

TEST_F(DiscrepancyResult, EveryCountThatIsEditedIsRefused) {
  EXPECT_NO_THROW(expect_possible_discrepancy(json_));
  const Json flat = json_.flatten();
  std::size_t edited = 0, passed = 0;
  for (const auto& [place, value] : flat.items()) {
    const bool origins = place.find("/origins/") != std::string::npos;
    if (!value.is_number_unsigned() || !(origins || place.find("/strata/") != std::string::npos)) continue;
    if (++edited % 7 != 0) continue;  // test only some counts
    for (const Json& count : {Json(origins ? std::uint64_t{1} << 39 : value.get<std::uint64_t>() + 1),
                              Json(std::uint64_t{1} << 40), Json(-5)}) {
      Json other = json_;
      other[Json::json_pointer(place)] = count;
      EXPECT_THROW(expect_possible_discrepancy(other), std::exception) << place;
      ++passed;
    }
  }
  EXPECT_GT(passed, 200u);
  for (const auto& [place, value] :
       {std::pair<const char*, Json>("/pairs", 8999u),
        {"/seed", -1},
        {"/seed", 1.5},
        {"/build", nullptr},
        {"/lanes/0/questions", nullptr},
        {"/lanes/0/questions/0/degree", -7},
        {"/lanes/0/strata/thesis/unlike", {1e308, 0.5}},
        {"/lanes/0/origins/verdicts", json_["lanes"][0]["total"]["verdict"].get<std::uint64_t>() + 1},
        {"/lanes/0/second", json_["lanes"][0]["first"]},
        {"/lanes/0/second", "interval_overlap/f32/cuda-nofma"},
        {"/lanes/1", json_["lanes"][0]},
        {"/lanes/1/origins", json_["lanes"][0]["origins"]},
        {"/lanes/0/origins/starts/0/by_line", {{"99", 1}}},
        {"/lanes/0/origins/starts/0/by_line", {{"abc", 1}}},
        {"/lanes/0/origins/starts/0/by_line", {{"1x", 1}}},
        {"/lanes/0/origins/starts/1", json_["lanes"][0]["origins"]["starts"][0]},
        {"/lanes/0/origins/lines/0/line", 3}}) {
    Json other = json_;
    other[Json::json_pointer(place)] = value;
    EXPECT_THROW(expect_possible_discrepancy(other), std::exception) << place;
  }
  for (const char* place : {"/lanes", "/lanes/0/first", "/lanes/0/total/questions", "/lanes/1/strata/thesis/sites"}) {
    Json other = json_;
    other[Json::json_pointer(place)] = Json::array();
    EXPECT_THROW(expect_possible_discrepancy(other), std::exception) << place;
  }
}

TEST_F(DiscrepancyResult, TheTableHasEveryCount) {
  std::uint64_t in_table = 0, in_json = 0;
  std::istringstream lines(csv_);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "first,second,stratum,question,value,count,bucket,pairs");
  while (std::getline(lines, line)) in_table += std::stoull(line.substr(line.rfind(',') + 1));
  for (const Json& lanes : json_["lanes"]) {
    const Json flat = lanes["strata"].flatten();
    for (const auto& [place, value] : flat.items()) {
      if (value.is_number_unsigned() && place.find("/unlike/") == std::string::npos)
        in_json += value.get<std::uint64_t>();
    }
  }
  EXPECT_EQ(in_table, in_json);
  EXPECT_EQ(in_table, counted_);
  EXPECT_GT(in_table, 100'000u);
}

// The bounds in the answer are rounded outward.
TEST_F(DiscrepancyResult, TheAnswersBoundsHold) {
  const std::vector<std::string> answer = discrepancy_answer(json_);
  ASSERT_EQ(answer.size(), 5u);
  std::smatch found;
  ASSERT_TRUE(std::regex_search(answer[3], found,
                                std::regex("at most ([0-9.e+-]+) bounds.* fewer than ([0-9.e+-]+) of the pairs\\.$")))
      << answer[3];
  double widest = 0;
  std::uint64_t without_bound = 0;
  for (const Json& lanes : json_["lanes"]) {
    for (const Json& question : lanes["total"]["questions"])
      without_bound += question["band"].value("unknown", std::uint64_t{0});
  }
  ASSERT_GT(without_bound, 0u);  // the bound is not about these comparisons, and says so
  EXPECT_NE(answer[3].find(fmt::format("except in {} comparisons whose error has no bound. At 95 % confidence, such a "
                                       "difference, where the error has a bound, occurs",
                                       grouped(without_bound))),
            std::string::npos)
      << answer[3];
  for (const Json& question : json_["lanes"][0]["total"]["questions"]) {
    widest = std::max(widest, question["largest_in_bounds"].get<double>());
  }
  EXPECT_GE(std::stod(found[1]), widest);
  EXPECT_LT(std::stod(found[1]), widest * 1.2);
  EXPECT_GE(std::stod(found[2]), analysis::upper_bound(0, 9000));  // comparisons on one pair are not independent
  EXPECT_LT(std::stod(found[2]), analysis::upper_bound(0, 9000) * 1.2);
  EXPECT_NE(answer[4].find("-fmad=false mends it"), std::string::npos) << answer[4];
}

// Each point in the pictures of extremes has the counts for its scale or offset.
TEST_F(DiscrepancyResult, ThePageDrawsTheExtremes) {
  const std::string page = discrepancy_page(json_);
  int drawn = 0;
  const Json& strata = json_["lanes"][0]["strata"];
  EXPECT_TRUE(strata["thesis"]["extremes"].empty());
  for (const auto& [place, counts] : strata["extreme_scale"]["extremes"]["scale"].items()) {
    if (counts["pairs"] < 30) continue;
    for (const char* count : {"differs", "sign", "outcome", "verdict"}) {
      EXPECT_NE(page.find("<title>2^" + place + ": " + counts[count].dump() + " of " + counts["pairs"].dump() + "<"),
                std::string::npos)
          << place << ' ' << count;
      ++drawn;
    }
  }
  EXPECT_GT(drawn, 100);
}

// Rows are matched by their names. Every number is compared, and numbers that only one result has are reported.
TEST_F(DiscrepancyResult, EveryNumberIsCompared) {
  const Screen wide{.columns = 200};
  const std::string same = discrepancy_changes(json_, json_, wide);
  EXPECT_EQ(same.find("0 numbers differ, "), 0u) << same;
  EXPECT_EQ(same.find("in only one result"), std::string::npos) << same;
  Json other = json_;
  Json& questions = other["lanes"][0]["total"]["questions"];
  std::reverse(questions.begin(), questions.end());
  EXPECT_EQ(discrepancy_changes(json_, other, wide), same);
  Json changed = other;
  changed["lanes"][0]["total"]["questions"][0]["largest_in_bounds"] = 7.5;  // a number that is in no table
  EXPECT_EQ(discrepancy_changes(json_, changed, wide).find("1 numbers differ, "), 0u)
      << discrepancy_changes(json_, changed, wide);
  questions[0]["question"] = "another";
  EXPECT_NE(discrepancy_changes(json_, other, wide).find(" are in only one result"), std::string::npos);
}

TEST_F(DiscrepancyResult, ThePageNamesEveryQuestionThatDiffers) {
  const std::string page = discrepancy_page(json_);
  for (const Json& question : json_["lanes"][0]["total"]["questions"]) {
    if (question["differs"] == 0) continue;
    std::string name = question["question"];
    name = std::regex_replace(name, std::regex("<"), "&lt;");
    EXPECT_NE(page.find(name), std::string::npos) << name;
  }
  // The source text of a fused line.
  EXPECT_NE(page.find("return u.x * v.x + u.y * v.y + u.z * v.z;"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

// A recorded run is compiled separately, so with contraction its verdict may be another one than the lane's.
TEST(SideBySide, NamesTheVerdictOfTheLaneAndOfItsRecordedRun) {
  const analysis::LanesCompared lanes(*find_lane("interval_overlap/f32/cpu"),
                                      *find_lane("interval_overlap/f32/cpu-fma"));
  int unlike = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const AnyPair pair = strata::generate(1, strata::Stratum::near_vertex_face, i);
    const Verdict own = analysis::decide_lane(*lanes.second, pair),
                  recorded = recorded_verdict(analysis::runs_beside(lanes, pair).second.path);
    unlike += own != recorded;
    const std::string said = side_by_side(lanes, pair, Screen{400, false}),
                      words = fmt::format("second: interval_overlap/f32/cpu-fma, {}{}: ", name(recorded),
                                          own == recorded ? ""
                                                          : fmt::format(" in its recorded run, which is compiled "
                                                                        "separately from the lane itself ({})",
                                                                        name(own)));
    EXPECT_NE(said.find(words), std::string::npos) << i << '\n' << said;
  }
  fmt::print("unlike their recorded run: {}\n", unlike);
}

}  // namespace
}  // namespace graze::reports
