// SPDX-License-Identifier: Apache-2.0
#include "reports/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/message_testing.h"
#include "reports/tables.h"

namespace graze::reports {
namespace {

using Json = nlohmann::ordered_json;

// A report with `rates` rates of n pairs each and different error probabilities; the seed determines the counts.
Json report_of(std::uint64_t seed, std::uint64_t n, int rates = 1000) {
  Json report{{"run", {{"seed", seed}, {"pairs", n * 19}, {"build", {{"commit", "c"}}}}},
              {"lanes", Json::array()},
              {"strata", {{{"id", "uniform"}, {"describes", "a cube"}, {"pairs", n}}}},
              {"rates", Json::array()}};
  std::mt19937_64 random(seed);
  for (int i = 0; i < rates; ++i) {
    const double chance = i % 7 == 0 ? 0 : i % 5 == 0 ? 1e-4 : 0.6 * i / rates;
    const std::uint64_t wrong = std::binomial_distribution<std::uint64_t>(n, chance)(random);
    report["lanes"].push_back({{"id", "lane/" + std::to_string(i)}, {"algorithm", "lane"}});
    report["rates"].push_back({{"lane", i},
                               {"stratum", 0},
                               {"false_positive", to_json(share_of(wrong, n))},
                               {"false_negative", to_json(share_of(0, n))},
                               {"wrong", to_json(share_of(wrong, n))},
                               {"declined", 0}});
  }
  return report;
}

Json kind(const std::string& key, int signatures) {
  return {{"key", key}, {"subject", "lane"}, {"signatures", signatures}, {"pairs", 10 * signatures}};
}

std::string headline(Json after, const Json& before, const Json& kinds, const Json& kinds_before) {
  add_comparison(after, before, kinds, kinds_before);
  return after["compare"]["headline"];
}

TEST(Comparison, SeedAndSizeAloneChangeNothing) {
  const Json kinds = {kind("a/rounding/x.h:1/general", 300), kind("a/logic/-/general", 3)};
  const Json fewer = {kind("a/rounding/x.h:1/general", 80)};
  const Json before = report_of(1, 50'000);
  // In 17,000 comparisons, the probability that chance alone changes one rate is 2 %; for two rates it is 0.02 %.
  int changed = 0;
  for (std::uint64_t seed = 2; seed < 22; ++seed) {
    const std::string text = headline(report_of(seed, seed % 2 == 0 ? 50'000 : 5'000), before, fewer, kinds);
    if (text.starts_with("Changed: 1 of 1,000 rates")) {
      ++changed;
      continue;
    }
    EXPECT_TRUE(text.starts_with(
        "None of 1,000 rates changed, and no kind of failure with at least 14 expected signatures came or went; "
        "differences under "))
        << text;
    EXPECT_TRUE(text.ends_with(" might not be seen.")) << text;
  }
  EXPECT_LE(changed, 1);
}

// If 290 and 205 of 500 pairs each are wrong, twice the smaller tail is 1.0e-7; for 290 and 212 it is 1.0e-6.
TEST(Comparison, TheTestIsExact) {
  const auto changed = [](std::uint64_t l, std::uint64_t r, std::uint64_t of_l, std::uint64_t of_r) {
    Json before = report_of(1, of_l, 1), after = report_of(2, of_r, 1);
    for (const char* error : {"wrong", "false_positive"}) {
      before["rates"][0][error] = to_json(share_of(l, of_l));
      after["rates"][0][error] = to_json(share_of(r, of_r));
    }
    return headline(after, before, Json::array(), Json::array()).starts_with("Changed: 1 of 1 rates");
  };
  EXPECT_TRUE(changed(290, 205, 500, 500));
  EXPECT_TRUE(changed(205, 290, 500, 500));
  EXPECT_TRUE(changed(210, 295, 500, 500));
  EXPECT_FALSE(changed(290, 230, 500, 500));
  EXPECT_TRUE(changed(24'245, 2'239, 50'000, 5'000));
  EXPECT_FALSE(changed(24'245, 2'245, 50'000, 5'000));
}

TEST(Comparison, WhatIsSmallButSureIsAChange) {
  const Json before = report_of(1, 1'000'000);
  Json after = report_of(2, 1'000'000);
  after["rates"][0]["wrong"] = to_json(share_of(40, 1'000'000));  // this lane was never wrong before
  EXPECT_TRUE(
      headline(after, before, Json::array(), Json::array())
          .starts_with("Changed: 1 of 1,000 rates; no kind of failure with at least 14 expected signatures came "
                       "or went; in the other rates, differences under "));
  // If no other rate is left, nothing is said of differences that might not be seen.
  const Json one = report_of(1, 1'000'000, 1);
  after = report_of(2, 1'000'000, 1);
  after["rates"][0]["wrong"] = to_json(share_of(40, 1'000'000));
  EXPECT_TRUE(headline(after, one, Json::array(), Json::array()).ends_with("came or went."));
}

// The numbers of wrong verdicts are equal, so only the kinds of error show the change.
TEST(Comparison, FalsePositivesThatBecomeFalseNegativesAreAChange) {
  const Json before = report_of(1, 50'000, 10);
  for (const std::uint64_t seed : {1, 2}) {
    Json after = before;
    after["run"]["seed"] = seed;
    std::swap(after["rates"][9]["false_positive"], after["rates"][9]["false_negative"]);
    add_comparison(after, before, Json::array(), nullptr);
    EXPECT_TRUE(after["compare"]["headline"].get<std::string>().starts_with(
        "Changed: 1 of 10 rates (false negatives in 1, false positives in 1); kinds of failure are not compared"));
    const Json& errors = after["compare"]["rates"][9]["errors"];
    ASSERT_EQ(errors.size(), 2u);
    EXPECT_EQ(errors[0]["error"], "false positives");
    EXPECT_EQ(errors[0]["after"], before["rates"][9]["false_negative"]);
  }
}

TEST(Comparison, OnTheSamePairsEveryOtherCountIsAChange) {
  const Json before = report_of(1, 50'000, 10);
  Json after = before;
  after["rates"][3]["declined"] = 1;
  EXPECT_EQ(headline(after, before, Json::array(), Json::array()),
            "Changed: 1 of 10 rates (declined in 1); no kind of failure came or went.");
  // Equal counts alone do not show that no verdict changed.
  EXPECT_EQ(headline(before, before, Json::array(), Json::array()),
            "None of 10 rates changed, and no kind of failure came or went; single verdicts are not compared, because "
            "a campaign's database is missing.");
  after["run"]["seed"] = 2;
  EXPECT_TRUE(headline(after, before, Json::array(), Json::array()).starts_with("None of 10 rates changed"));
}

Json verdicts_row(const char* known, std::uint64_t least, std::uint64_t most) {
  return {{"lane", "lane/0"}, {"stratum", "uniform"}, {"pairs", 100},
          {"known", known},   {"least", least},       {"most", most}};
}

TEST(Comparison, TheHeadlineOnTheSamePairsIsAboutVerdicts) {
  Json report = report_of(1, 100, 1);
  report["rates"].push_back(report["rates"][0]);
  report["rates"].back()["stratum"] = nullptr;  // all strata
  const auto said = [&](const Json& rows) {
    Json after = report;
    add_comparison(after, report, nullptr, nullptr, rows);
    std::string text = after["compare"]["headline"];
    for (const std::string& sentence : changed_sentences(after["compare"])) text += '\n' + sentence;
    return text;
  };
  EXPECT_EQ(
      said(Json::array({verdicts_row("same", 0, 0)})),
      "Nothing changed: all 100 verdicts of 1 lane are the same, pair by pair; kinds of failure are not compared.");
  Json counted = verdicts_row("changed", 5, 5);
  counted.update(
      {{"broken", 3}, {"mended", 1}, {"smallest_broken", "uniform:1:2 0 0"}, {"smallest_mended", "uniform:1:3 0 1"}});
  EXPECT_EQ(
      said(Json::array({counted})),
      "Changed: 5 verdicts of 1 of 1 lane: 3 became wrong, 1 no longer wrong, 1 changed otherwise; kinds of failure "
      "are not "
      "compared.\nlane/0: wrong on 0 of 100 pairs before, on 0 after.\nlane/0, uniform: 5 of 100 verdicts changed; 3 "
      "became wrong (smallest: uniform:1:2); 1 no "
      "longer wrong (smallest: uniform:1:3).");
  const std::string bounded = said(Json::array({verdicts_row("changed", 2, 9)})),
                    unknown = said(Json::array({verdicts_row("unknown", 0, 9)}));
  EXPECT_TRUE(names(bounded.substr(0, bounded.find('\n')), {"at least 2 verdicts", "at most 9"}));
  EXPECT_TRUE(
      names(bounded.substr(bounded.rfind('\n') + 1), {"lane/0, uniform", "at least 2", "at most 9", "not known"}));
  EXPECT_TRUE(names(unknown.substr(0, unknown.find('\n')), {"No change", "not known", "at most 9"}));
  Json many = Json::array();
  for (std::size_t i = 0; i < kMostChanged + 7; ++i) many.push_back(counted);
  EXPECT_TRUE(names(said(many).substr(said(many).rfind('\n') + 1), {"7", "compare.json"}));
}

// A rate counts as changed at the smallest difference that would be seen, but not below it.
TEST(Comparison, TheBlindSpotIsThatOfTheTest) {
  const Json before = report_of(1, 50'000, 21);
  Json after = report_of(2, 20'000, 21);
  add_comparison(after, before, nullptr, nullptr);
  for (std::size_t r = 0; r < 21; ++r) {
    const double share = before["rates"][r]["wrong"]["share"], unseen = after["compare"]["rates"][r]["unseen"];
    const auto at = static_cast<std::uint64_t>(std::llround((share + unseen) * 20'000));
    EXPECT_GT(unseen, 0);
    for (const std::uint64_t less : {0, 1}) {
      Json other = after;
      other["rates"][r]["wrong"] = to_json(share_of(at - less, 20'000));
      other["rates"][r]["false_positive"] = before["rates"][r]["false_positive"];
      other["rates"][r]["false_positive"]["of"] = 0;
      add_comparison(other, before, nullptr, nullptr);
      EXPECT_EQ(other["compare"]["rates"][r]["changed"], less == 0) << r << ' ' << share << ' ' << unseen;
    }
  }
}

TEST(Comparison, OtherCodeOfOneNameIsSaid) {
  Json before = report_of(1, 50'000, 10), after = before;
  before["run"]["subjects"] = {{{"name", "mine"}, {"what", "P/m.cpp"}, {"hash", "0a"}}};
  after["run"]["subjects"] = {{{"name", "mine"}, {"what", "Q/m.cpp"}, {"hash", "0b"}}};
  add_comparison(after, before, Json::array(), Json::array());
  EXPECT_EQ(after["compare"]["differences"],
            Json::array({"The code of mine differs: P/m.cpp (hash 0a) before, Q/m.cpp (hash 0b) after."}));
  after["run"]["subjects"][0]["hash"] = "0a";  // the file was moved
  add_comparison(after, before, Json::array(), Json::array());
  EXPECT_TRUE(after["compare"]["differences"].empty());
}

TEST(Comparison, OtherFusedProductsAreSaid) {
  const auto plan = [](const char* hash, int operations) { return Json{{"plan", hash}, {"operations", operations}}; };
  Json before = report_of(1, 50'000, 10), after = before;
  before["run"]["subjects"] = {
      {{"name", "moller_1997"},
       {"what", "published"},
       {"hash", "0a"},
       {"contraction", {{"x86-gcc-v3", {{"f32", plan("3f2a", 14)}, {"f64", plan("77", 9)}}}}}}};
  after["run"]["subjects"] = before["run"]["subjects"];
  add_comparison(after, before, Json::array(), Json::array());
  EXPECT_TRUE(after["compare"]["differences"].empty());
  Json& plans = after["run"]["subjects"][0]["contraction"];
  plans["x86-gcc-v3"]["f32"] = plan("9b1c", 14);
  plans["arm64-gcc"] = plans["x86-gcc-v3"];  // the first campaign has no lane of this toolchain
  add_comparison(after, before, Json::array(), Json::array());
  EXPECT_EQ(after["compare"]["differences"],
            Json::array({"moller_1997/f32 (x86-gcc-v3): the compiler fuses other products (plan 3f2a before, 9b1c "
                         "after); the number of changed verdicts is not known."}));
  const auto row = [](const char* lane, const char* known, int changed) {
    return Json{{"lane", lane},   {"stratum", "uniform"}, {"pairs", 50'000},
                {"known", known}, {"least", changed},     {"most", changed}};
  };
  const Json verdicts = {row("moller_1997/f32/x86-gcc-v3", "changed", 1200), row("moller_1997/f32/cpu", "changed", 7),
                         row("moller_1997/f32/x86-gcc-v3", "changed", 34)};
  add_comparison(after, before, Json::array(), Json::array(), verdicts);
  ASSERT_EQ(after["compare"]["differences"].size(), 1u);
  EXPECT_TRUE(names(after["compare"]["differences"][0], {"3f2a", "9b1c", "1,234 verdicts differ"}));
}

// Campaigns do not record which products cpu-fma lanes fuse. So if both campaigns have such lanes, the report says that
// the compiler differs.
TEST(Comparison, AnotherCompilerOfContractedLanesIsSaid) {
  Json before = report_of(1, 50'000, 10), after = before;
  before["run"]["build"]["compiler"] = "GNU 12.2.0";
  after["run"]["build"]["compiler"] = "GNU 13.1.0";
  add_comparison(after, before, Json::array(), Json::array());
  EXPECT_TRUE(after["compare"]["differences"].empty());
  before["lanes"][0]["id"] = after["lanes"][0]["id"] = "moller_1997/f32/cpu-fma";
  add_comparison(after, before, Json::array(), Json::array());
  ASSERT_EQ(after["compare"]["differences"].size(), 1u);
  EXPECT_TRUE(names(after["compare"]["differences"][0], {"GNU 12.2.0", "GNU 13.1.0", "cpu-fma"}));
}

TEST(Comparison, AKindThatWasToBeExpectedHasGone) {
  const Json many = {kind("a", 100), kind("b", 100), kind("c", 4)}, some = {kind("a", 90)};
  const Json before = report_of(1, 50'000);
  Json after = report_of(2, 50'000);
  add_comparison(after, before, some, many);
  ASSERT_EQ(after["compare"]["lost"].size(), 1u);
  EXPECT_EQ(after["compare"]["lost"][0]["key"], "b");
  add_comparison(after, before, many, some);
  EXPECT_EQ(after["compare"]["gained"].size(), 1u);
  // With a tenth of the pairs, about ten of the kind's signatures are expected, too few to call the kind lost.
  Json smaller = report_of(2, 5'000);
  add_comparison(smaller, before, some, many);
  EXPECT_TRUE(smaller["compare"]["lost"].empty());
}

// On the same pairs, one signature shows a change, unless no verdict of its subject changed.
TEST(Comparison, OnTheSamePairsEveryOtherKindIsAChange) {
  const Json few = {kind("lane/rounding/x.h:1/general", 1)}, none = Json::array();
  const Json before = report_of(1, 50'000, 10);
  const auto gained = [&](const Json& verdicts) {
    Json after = before;
    add_comparison(after, before, few, none, verdicts);
    return after["compare"]["gained"].size();
  };
  EXPECT_EQ(gained(nullptr), 1u);
  EXPECT_EQ(gained(Json::array({verdicts_row("changed", 1, 1)})), 1u);
  EXPECT_EQ(gained(Json::array({verdicts_row("unknown", 0, 1)})), 1u);
  EXPECT_EQ(gained(Json::array({verdicts_row("same", 0, 0)})), 0u);
}

// Adds a stratum on which every lane is wrong on half of the pairs, and the rates over all strata.
Json with_stratum(Json report, const std::string& id, const std::string& describes, std::uint64_t pairs) {
  const std::size_t place = report["strata"].size();
  const std::uint64_t n = report["strata"][0]["pairs"];
  report["strata"].push_back({{"id", id}, {"describes", describes}, {"pairs", pairs}});
  const Json rates = report["rates"];
  for (const Json& row : rates) {
    const std::uint64_t wrong = row["wrong"]["count"];
    report["rates"].push_back(
        {{"lane", row["lane"]}, {"stratum", place}, {"wrong", to_json(share_of(pairs / 2, pairs))}});
    report["rates"].push_back(
        {{"lane", row["lane"]}, {"stratum", nullptr}, {"wrong", to_json(share_of(wrong + pairs / 2, n + pairs))}});
  }
  return report;
}

TEST(Comparison, OnlyWhatBothHaveIsCompared) {
  const Json one = report_of(1, 50'000, 10), kinds = {kind("a", 100)}, none = Json::array();
  const auto compared = [&](Json after, const Json& before) {
    add_comparison(after, before, kinds, none);
    return after["compare"];
  };
  const Json hunt = with_stratum(one, "hunt", "made from near", 50'000);
  Json same = compared(hunt, hunt);
  EXPECT_EQ(same["rates"].size(), 30u);
  EXPECT_EQ(same["gained"].size(), 1u);
  EXPECT_TRUE(same["differences"].empty());
  // If the strata, a stratum's pairs or the shares differ, the totals would differ even if no rate changed.
  const Json others[] = {with_stratum(one, "thesis", "random", 50'000),
                         with_stratum(one, "hunt", "made from thesis", 50'000),
                         with_stratum(one, "hunt", "made from near", 5'000)};
  for (const Json& other : others) {
    const Json said = compared(other, hunt);
    EXPECT_EQ(said["rates"].size(), &other == &others[2] ? 20u : 10u);
    for (const Json& row : said["rates"]) EXPECT_NE(row["stratum"], "all strata");
    EXPECT_FALSE(said["kinds_compared"]);
    EXPECT_TRUE(said["gained"].empty());
    EXPECT_NE(said["differences"].back().get<std::string>().find("not compared"), std::string::npos);
  }
  EXPECT_EQ(compared(others[1], hunt)["differences"][0],
            "The stratum hunt differs and is not compared: made from near before, made from thesis after.");
  // A kind may have fewer signatures if its subject has other lanes.
  const Json fewer = compared(report_of(1, 50'000, 8), one);
  EXPECT_TRUE(fewer["kinds_compared"]);
  EXPECT_TRUE(fewer["gained"].empty());
  EXPECT_EQ(compared(one, one)["gained"].size(), 1u);
}

TEST(Comparison, HowTheyDifferIsSaid) {
  const Json before = report_of(1, 50'000, 10);
  Json after = report_of(2, 5'000, 8);
  add_comparison(after, before, nullptr, Json::array());
  const Json& said = after["compare"]["differences"];
  ASSERT_EQ(said.size(), 4u);
  EXPECT_EQ(said[0], "The seed differs: 1 before, 2 after.");
  EXPECT_EQ(said[1], "The number of pairs differs: 950,000 before, 95,000 after.");
  EXPECT_EQ(
      said[2],
      "The lanes differ; only lanes of both campaigns are compared. Only before: lane/8, lane/9; only after: none.");
  EXPECT_NE(said[3].get<std::string>().find("not compared"), std::string::npos);
  EXPECT_FALSE(after["compare"]["kinds_compared"]);
  Json in_scene = report_of(1, 50'000, 10);
  in_scene["run"]["scene"] = "arm.toml#1";
  add_comparison(in_scene, before, Json::array(), Json::array());
  EXPECT_EQ(in_scene["compare"]["differences"],
            Json::array({"The scene differs, so the same stratum draws other pairs: none before, arm.toml#1 after."}));
  Json same = before;
  add_comparison(same, before, Json::array(), Json::array());
  EXPECT_TRUE(same["compare"]["differences"].empty());
}

}  // namespace
}  // namespace graze::reports
