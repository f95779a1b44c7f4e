// SPDX-License-Identifier: Apache-2.0
// Tests intervals, and the tables made from artificial summaries.
#include "reports/tables.h"

#include <random>
#include <set>

#include "core/message_testing.h"
#include "core/wilson.h"
#include "reports/agreement.h"
#include "reports/findings.h"
#include "reports/test_campaign.h"
#include "reports/tuning.h"
#include "strata/groups.h"

namespace graze::reports {
namespace {

// "2.04 %", "1 in 3,270" as a rate.
double read(std::string words) {
  std::erase(words, ',');
  return words.starts_with("1 in ") ? 1 / std::stod(words.substr(5)) : std::stod(words) / 100;
}

TEST(Bounds, AreRoundedOutwardWhereverTheyAreWritten) {
  EXPECT_EQ(rate_words(0.020321, Bound::upper), "2.04 %");
  EXPECT_EQ(rate_words(0.020321, Bound::lower), "2.03 %");
  EXPECT_EQ(rate_words(0.020321), "2.03 %");
  EXPECT_EQ(rate_words(1 / 3274.0, Bound::upper), "1 in 3,270");
  EXPECT_EQ(rate_words(1 / 3274.0, Bound::lower), "1 in 3,280");
  std::mt19937_64 bits(1);
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t of = 1 + bits() % (std::uint64_t{1} << bits() % 40), count = bits() % (of + 1) >> bits() % 20;
    const Share share = share_of(count, of);
    ASSERT_GE(read(rate_words(share.high, Bound::upper)), share.high) << count << " of " << of;
    ASSERT_LE(read(rate_words(share.low, Bound::lower)), share.low) << count << " of " << of;
    ASSERT_GE(read(rate_words(bound_of_none(of), Bound::upper)), bound_of_none(of)) << of;
    const Json json = to_json(share);
    ASSERT_GE(json["high"].get<double>(), share.high);
    ASSERT_LE(json["low"].get<double>(), share.low);
  }
}

// For 23 of 1,610, the upper bound is about 0.0202. This exceeds the requested 0.02, so it must not be printed as 0.02.
TEST(Bounds, ATunedPolicysBoundIsNotRoundedToWhatWasAsked) {
  const TuneQuestion question{"moller_1997/f32/cpu", analysis::Forbid::any, 0.02, 0.1};
  analysis::Tuned tuned;
  tuned.chosen = "rel:8";
  tuned.confirmed.pairs = 1610;
  tuned.confirmed.false_negative = 23;
  tuned.bound = analysis::upper_bound(23, 1610);
  ASSERT_GT(tuned.bound, 0.02);
  ASSERT_LT(tuned.bound, 0.0204);
  tuned.result = analysis::TuneResult::too_few_pairs;
  const std::string said = tuning_sentences(question, tuned)[0];
  EXPECT_NE(said.find("are under 0.021, and 0.02 was asked for"), said.npos) << said;
}

// A tolerance of 0 treats values that are exactly 0 differently from a small positive tolerance.
TEST(Tuning, ZeroIsNotSoldAsASmallValue) {
  const subjects::TunableSource source{"mine.cpp", "", {}, {"kEps", "1e-6f", 1e-6, {{0, 0, 3}}}};
  const TuneQuestion question{"mine/f32/cpu", analysis::Forbid::any, 0.02, 0.1, &source};
  analysis::Tuned tuned;
  tuned.curves = {{"", false, std::vector<analysis::PolicyErrors>(2)}};
  std::vector<analysis::PolicyErrors>& points = tuned.curves[0].points;
  points[0].policy = tuned.chosen = "abs:0";
  points[1].policy = "abs:1e-20";
  const auto warns = [&] {
    for (const std::string& sentence : tuning_sentences(question, tuned)) {
      if (sentence.starts_with("Zero "))
        return bool(names(sentence, {"kEps = 0.0f", "kEps = 1e-20f", "7 false negatives"}));
    }
    return false;
  };
  EXPECT_FALSE(warns());
  points[1].false_negative = 7;
  EXPECT_TRUE(warns());
  tuned.chosen = points[1].policy;
  EXPECT_FALSE(warns());
}

// The lower and upper bounds of the rate at which two lanes differ are also rounded outward.
TEST(Bounds, ThoseOfAnAgreementAreRoundedOutward) {
  AgreeQuestion question{{"moller_1997/f32/cpu", "moller_1997/f32/cuda-fma"}, {}, "", "", 0.02};
  analysis::Agreed agreed;
  agreed.chosen = "rel:8";
  agreed.confirmed.pairs = 1610;
  agreed.confirmed.differing = 23;
  agreed.high = analysis::upper_bound(23, 1610);  // about 0.0202
  agreed.result = analysis::TuneResult::too_few_pairs;
  std::string said = agreement_sentences(question, agreed)[0];
  EXPECT_NE(said.find("Not settled: "), said.npos) << said;
  EXPECT_NE(said.find("under 0.021, and 0.02 was asked for"), said.npos) << said;
  question.max_rate = 0.009;
  agreed.low = analysis::lower_bound(23, 1610);
  ASSERT_GT(agreed.low, 0.00975);  // nearest: 0.0098
  ASSERT_LT(agreed.low, 0.0098);
  agreed.result = analysis::TuneResult::not_satisfiable;
  said = agreement_sentences(question, agreed)[0];
  EXPECT_NE(said.find("No tolerance that was tried keeps"), said.npos) << said;
  EXPECT_NE(said.find("over 0.0097."), said.npos) << said;
}

TEST(Wilson, GivesKnownIntervals) {
  // Roots p of (p - count / of)² = z² p (1 - p) / of, found by bisection.
  const Share one = share_of(1, 10), all = share_of(10, 10), half = share_of(500, 1000), none = share_of(0, 10);
  EXPECT_NEAR(one.low, 0.0178762, 1e-6);
  EXPECT_NEAR(one.high, 0.4041500, 1e-6);
  EXPECT_NEAR(all.low, 0.7224672, 1e-6);
  EXPECT_EQ(all.high, 1);
  EXPECT_NEAR(half.low, 0.4690696, 1e-6);
  EXPECT_NEAR(half.high, 0.5309304, 1e-6);
  EXPECT_EQ(none.low, 0);
  EXPECT_NEAR(none.high, 3.8414588 / 13.8414588, 1e-6);
  EXPECT_EQ(share_of(0, 0).high, 1);
  EXPECT_TRUE(one.apart(all));
  EXPECT_FALSE(one.apart(none));
}

TEST(Wilson, BoundOfNoneIsTheRuleOfThree) {
  EXPECT_EQ(bound_of_none(0), 1);
  EXPECT_NEAR(bound_of_none(1), 0.95, 1e-12);
  EXPECT_NEAR(bound_of_none(1'000'000'000), 2.9957e-9, 1e-12);
}

// If differences were not counted, their number is null in the summary and the report. Without pairs there is no share.
TEST(Tables, OfNothingThereIsNoShare) {
  Json summary = summary_of({"moller_1997/f32/cuda-fma"}, {"uniform"}, {0, 3, 0, 0});
  summary["strata"]["uniform"]["intersects"] = 1000;  // so that no verdict can be a false positive
  summary["strata"]["uniform"]["lanes"]["moller_1997/f32/cuda-fma"]["differs_from_cpu"] = nullptr;
  const Json row = rates(counts_of(summary)).front();
  EXPECT_TRUE(row["differs_from_cpu"].is_null());
  EXPECT_EQ(row["false_positive"].dump(), R"({"count":0,"of":0,"share":null,"low":null,"high":null})");
  EXPECT_EQ(row["false_negative"]["share"], 0.003);
}

// The threshold of a group or stratum by id; "" means all of them.
Json threshold_of(const CampaignCounts& counts, const std::string& group, const std::string& stratum = "") {
  for (const Json& row : thresholds(counts)) {
    const auto is = [&](const char* key, const std::string& id, const auto& list) {
      return row[key].is_null() ? id.empty() : list[row[key].template get<std::size_t>()].id == id;
    };
    if (is("group", group, counts.groups) && is("stratum", stratum, counts.strata)) return row;
  }
  return nullptr;
}

TEST(Tables, ThresholdIsWhereErrorsEnd) {
  Json summary = summary_of({"moller_1997/f32/cpu"}, {"uniform", "degenerate"}, {});
  const auto bucket = [&](const char* stratum, const char* name, int pairs, int wrong) {
    summary["strata"][stratum]["margins"][name] = {
        {"pairs", pairs}, {"wrong", Json::object()}, {"differs_from_cpu", Json::object()}};
    if (wrong) summary["strata"][stratum]["margins"][name]["wrong"]["moller_1997/f32/cpu"] = wrong;
  };
  bucket("uniform", "+2^-3", 10, 0);
  bucket("uniform", "+2^0", 10, 1);
  bucket("uniform", "+2^2", 20, 0);
  bucket("uniform", "+2^5", 30, 0);
  bucket("uniform", "0", 5, 5);
  bucket("uniform", "-2^1", 10, 0);
  bucket("uniform", "-2^4", 10, 1);
  bucket("degenerate", "+2^9", 4, 1);
  bucket("degenerate", "-2^-7", 3, 0);
  bucket("degenerate", "-2^2", 3, 0);
  const CampaignCounts counts = counts_of(summary);
  for (const Json& row : {threshold_of(counts, "general"), threshold_of(counts, "", "uniform")}) {
    EXPECT_EQ(row["disjoint"]["exponent"], 1);  // not 2, although the next pairs are at 2^2
    EXPECT_EQ(row["disjoint"]["above"], 50);
    EXPECT_NEAR(row["disjoint"]["bound"], 1 - std::pow(0.05, 1 / 50.0), 1e-6);
    EXPECT_TRUE(row["intersects"]["exponent"].is_null());
    EXPECT_EQ(row["intersects"]["bound"], 1);
    EXPECT_EQ(row["intersects"]["largest"], 4);
  }
  const Json other = threshold_of(counts, "degenerate"), all = threshold_of(counts, "");
  EXPECT_TRUE(other["disjoint"]["exponent"].is_null());
  EXPECT_EQ(other["disjoint"]["largest"], 9);
  EXPECT_EQ(other["intersects"]["exponent"], -7);  // without an error, the threshold is the smallest margin seen
  EXPECT_EQ(other["intersects"]["above"], 6);
  EXPECT_TRUE(all["disjoint"]["exponent"].is_null());  // because all strata are pooled
}

TEST(Tables, GroupsHoldEveryStratumOnceAndAddUp) {
  std::vector<std::string> strata;
  for (const strata::StratumInfo& info : strata::kStrata) strata.emplace_back(info.id);
  const CampaignCounts counts = counts_of(summary_of({"moller_1997/f32/cpu"}, strata, {3, 2, 0, 0}));
  std::set<std::size_t> seen;
  std::uint64_t pairs = 0;
  for (const GroupCounts& group : counts.groups) {
    for (const std::size_t s : group.strata) EXPECT_TRUE(seen.insert(s).second) << counts.strata[s].id;
    EXPECT_EQ(group.counts.wrong(0), 5 * group.strata.size());
    pairs += group.counts.pairs;
  }
  EXPECT_EQ(counts.groups.size(), 4u);
  EXPECT_EQ(seen.size(), strata.size());
  EXPECT_EQ(pairs, counts.total.pairs);
  EXPECT_EQ(group_rates(counts).size(), 4u);
}

// A lane's differences from its cpu lane are counted at each margin, as shares of its pairs. The cpu lane has none.
TEST(Tables, DifferencesFromCpuAreCountedByMargin) {
  const std::string fused = "moller_1997/f32/cuda-fma";
  Json summary = summary_of({"moller_1997/f32/cpu", fused}, {"uniform", "thesis"}, {0, 0, 0, 0, 0, 0, 0, 5});
  for (const char* stratum : {"uniform", "thesis"}) {
    summary["strata"][stratum]["margins"]["+2^3"] = {
        {"pairs", 600}, {"wrong", Json::object()}, {"differs_from_cpu", {{fused, 1}}}};
    summary["strata"][stratum]["margins"]["0"] = {
        {"pairs", 400}, {"wrong", Json::object()}, {"differs_from_cpu", {{fused, 4}}}};
  }
  const Json rows = margins(counts_of(summary));
  ASSERT_EQ(rows.size(), 2u);
  for (const Json& point : rows[0]["points"]) EXPECT_FALSE(point.contains("differs"));
  EXPECT_EQ(rows[1]["points"][0]["side"], "zero");
  EXPECT_EQ(rows[1]["points"][0]["differs"], to_json(share_of(8, 800)));
  EXPECT_EQ(rows[1]["points"][1]["differs"], to_json(share_of(2, 1200)));
}

TEST(Tables, ExtremesOfAllStrataAddUp) {
  Json summary = summary_of({"moller_1997/f32/cpu"}, {"extreme_scale", "mixed_scale"}, {});
  for (const char* stratum : {"extreme_scale", "mixed_scale"})
    summary["strata"][stratum]["extremes"]["scale"]["-152"] = {
        {"pairs", 10}, {"wrong", {{"moller_1997/f32/cpu", 2}}}, {"differs_from_cpu", Json::object()}};
  const Json rows = extremes(counts_of(summary));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["cells"][0]["exponent"], -152);
  EXPECT_EQ(rows[0]["cells"][0]["wrong"]["count"], 4);
  EXPECT_EQ(rows[0]["cells"][0]["wrong"]["of"], 20);
}

}  // namespace
}  // namespace graze::reports
