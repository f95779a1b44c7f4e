// SPDX-License-Identifier: Apache-2.0
// Tests that the cards of a small campaign are consistent and describe their kinds, pairs and lanes correctly.
#include "reports/failure_cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/sealed.h"
#include "oracle/truth.h"
#include "reports/report.h"
#include "reports/snippet.h"
#include "reports/test_campaign.h"
#include "reports/ulp_map_picture.h"

namespace graze::reports {
namespace {

Pair shown_pair(const Json& card) {
  Pair pair;
  for (int i = 0; i < kCoordinates; ++i)
    coordinates(pair)[i] = parse_float32(card["pair"]["hex"][static_cast<std::size_t>(i)].get<std::string>()).value();
  return pair;
}

Pair worst_pair(const Json& card) {
  std::istringstream in("graze-pairs 1\n" + card["kind"]["worst"]["pair"].get<std::string>() + "\n");
  return corpus::PairReader(in, "worst").next()->pair;
}

class FailureCards : public CampaignTest {
 protected:
  static void SetUpTestSuite() {
    CampaignTest::SetUpTestSuite();
    report_ = make_report(root_ / "one");
    kinds_ = fuzz::read_kinds(root_ / "one");
  }

  // The lanes of the kind that are wrong on the pair.
  static std::set<std::string> wrong_of_kind(const Json& kind, const Pair& pair) {
    const fuzz::SelectedLanes under_test = lanes();
    const std::string subject = kind["subject"];
    const oracle::Truth truth = oracle::truth(pair);
    const std::string_view shape = fuzz::shape_name(truth.hulls, analysis::nesting_of(pair, truth));
    std::set<std::string> found;
    for (const fuzz::LaneReason& reason : fuzz::reasons_of(under_test, subject, pair, truth.verdict)) {
      if (kind["key"] == fuzz::kind_key(subject, reason, shape)) found.insert(reason.lane->id);
    }
    return found;
  }

  static inline Json report_, kinds_;
};

TEST_F(FailureCards, AreTheCommonestKinds) {
  ASSERT_GT(report_["cards"].size(), 10u);
  EXPECT_EQ(report_["cards"].size(), std::min(fuzz::kMostShown, kinds_.size()));
  std::set<std::string> keys;
  for (std::size_t i = 0; i < report_["cards"].size(); ++i) {
    const Json& kind = report_["cards"][i]["kind"];
    EXPECT_EQ(kind["key"], kinds_[i]["key"]);
    EXPECT_TRUE(keys.insert(kind["key"]).second);
    if (i > 0) {
      EXPECT_GE(report_["cards"][i - 1]["kind"]["pairs"], kind["pairs"]);
    }
  }
}

// Checks that each card's title, verdicts, sentence and drawing agree.
TEST_F(FailureCards, DoNotContradictThemselves) {
  const fuzz::SelectedLanes under_test = lanes();
  std::size_t with_line = 0;
  for (const Json& card : report_["cards"]) {
    const Json& kind = card["kind"];
    const std::string subject = kind["subject"], line = kind["line"], key = kind["key"];
    const Pair pair = shown_pair(card);
    const oracle::Truth truth = oracle::truth(pair);
    EXPECT_EQ(kind["shape"], fuzz::shape_name(truth.hulls, analysis::nesting_of(pair, truth))) << key;
    EXPECT_EQ(card["truth"]["verdict"], name(truth.verdict)) << key;
    EXPECT_EQ(card["drawing"]["contact"].empty(), truth.verdict == Verdict::disjoint) << key;

    std::vector<const Lane*> apart;
    const std::vector<Verdict> verdicts = decide(under_test, pair, apart);
    ASSERT_EQ(card["verdicts"].size(), under_test.lanes.size());
    std::set<std::string> wrong;
    for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
      const Json& row = card["verdicts"][l];
      EXPECT_EQ(report_["lanes"][row["lane"].get<std::size_t>()]["id"], under_test.lanes[l]->id);
      EXPECT_EQ(row["verdict"], name(verdicts[l])) << key;
      EXPECT_EQ(row["wrong"], verdicts[l] != truth.verdict) << key;
      if (row["wrong"].get<bool>()) wrong.insert(under_test.lanes[l]->id);
    }
    const std::set<std::string> own = wrong_of_kind(kind, pair);
    const auto named = kind["lanes"].get<std::set<std::string>>();
    EXPECT_FALSE(own.empty()) << key;
    EXPECT_TRUE(std::includes(wrong.begin(), wrong.end(), own.begin(), own.end())) << key;
    EXPECT_TRUE(std::includes(named.begin(), named.end(), own.begin(), own.end())) << key;

    ASSERT_FALSE(card["sentences"].empty()) << key;
    const std::string first = card["sentences"][0];
    EXPECT_TRUE(first.starts_with(subject + "/")) << first;
    EXPECT_TRUE(contains(first, line)) << key << ": " << first;
    EXPECT_TRUE(contains(first, truth.verdict == Verdict::disjoint ? "says intersects" : "says disjoint") ||
                contains(first, "declines"))
        << first;
    with_line += !line.empty();
  }
  EXPECT_GT(with_line, report_["cards"].size() / 2);
}

TEST_F(FailureCards, TheirNumbersAddUp) {
  std::map<std::size_t, std::size_t> rows;  // by card
  for (const Json& row : report_["signatures"]) {
    EXPECT_TRUE(std::is_sorted(row["cards"].begin(), row["cards"].end()));
    for (const Json& place : row["cards"]) {
      ++rows[place.get<std::size_t>()];
      EXPECT_EQ(report_["cards"][place.get<std::size_t>()]["kind"]["subject"], row["algorithm"]);
    }
  }
  for (std::size_t i = 0; i < report_["cards"].size(); ++i) {
    const Json& kind = report_["cards"][i]["kind"];
    std::uint64_t pairs = 0, kept = 0, in_margins = 0, in_strata = 0;
    for (const Json& row : report_["signatures"]) {
      if (std::find(row["cards"].begin(), row["cards"].end(), i) == row["cards"].end()) continue;
      pairs += row["count"].get<std::uint64_t>();
      kept += row["pairs"].size();
      EXPECT_TRUE(kind["margins"].contains(row["margin"].get<std::string>())) << row["margin"];
    }
    for (const auto& [bucket, count] : kind["margins"].items()) in_margins += count.get<std::uint64_t>();
    for (const auto& [stratum, count] : kind["strata"].items()) in_strata += count.get<std::uint64_t>();
    EXPECT_EQ(kind["signatures"], rows[i]);
    EXPECT_EQ(kind["pairs"], pairs);
    EXPECT_EQ(in_margins, pairs);
    EXPECT_EQ(in_strata, kept);
    EXPECT_LE(kind["settled"][0], kind["settled"][1]);
  }
}

TEST_F(FailureCards, TheWorstPairIsOfTheKindToo) {
  for (const Json& card : report_["cards"]) {
    const Json& kind = card["kind"];
    const Pair pair = worst_pair(card);
    EXPECT_FALSE(wrong_of_kind(kind, pair).empty()) << kind["key"];
    EXPECT_EQ(kind["worst"]["margin_ulps"], oracle::truth(pair).margin_ulps) << kind["key"];
    EXPECT_GE(std::abs(kind["worst"]["margin_ulps"].get<double>()),
              std::abs(card["truth"]["margin_ulps"].get<double>()))
        << kind["key"];
  }
}

Json map_of(const Pair& pair) {
  const std::vector<analysis::Cell> cells(analysis::kMapSize * analysis::kMapSize, analysis::Cell::disjoint);
  return to_json(analysis::UlpMap{pair, {9, 10}, {{nullptr, cells}}});
}

TEST_F(FailureCards, HaveTheirProgramsAndTheStoredMaps) {
  run("mapped", 2);
  store_kinds("mapped");
  for (const Json& kind : fuzz::read_kinds(root_ / "mapped")) {
    std::istringstream in("graze-pairs 1\n" + kind["simplest"]["pair"].get<std::string>() + "\n");
    const Pair shown = corpus::PairReader(in, "simplest").next()->pair;
    fuzz::write_whole(
        fs::path(root_ / "mapped" / kind["simplest"]["case"].get<std::string>()).replace_extension(".maps.json"),
        fuzz::sealed(map_of(shown)).dump());
  }
  const Json report = make_report(root_ / "mapped");
  const fs::path one =
      root_ / "mapped" / fs::path(report["cards"][0]["file"].get<std::string>()).replace_extension(".maps.json");
  const std::string maps = fuzz::read_whole(one);
  for (const std::string& text : {std::string("{}"), std::string(maps).replace(maps.find("b[0].x"), 6, "b[0].z")}) {
    std::ofstream(one) << text;
    try {
      make_report(root_ / "mapped");
      ADD_FAILURE() << text;
    } catch (const corpus::FormatError& error) {
      EXPECT_TRUE(contains(error.what(), one.string() + ": it has been changed or damaged")) << error.what();
      EXPECT_TRUE(contains(error.what(), "graze minimize")) << error.what();
    }
  }
  // Even if the checksum is right, a map of a lane that did not run is rejected.
  Json other = Json::parse(maps);
  other.erase("checksum");
  other["panels"].push_back({{"name", "never_ran/f32/cpu"}, {"shows", "right everywhere"}, {"png", ""}});
  std::ofstream(one) << fuzz::sealed(other).dump();
  EXPECT_TRUE(make_report(root_ / "mapped")["cards"][0]["maps"].is_null());
  std::ofstream(one) << maps;
  std::set<std::string> files;
  for (const Json& card : report["cards"]) {
    if (files.insert(card["file"]).second) {
      EXPECT_EQ(card["maps"]["title"], "b[0].x and b[0].y moved by up to 128 ulps");
      EXPECT_EQ(card["maps"]["panels"][0]["shows"], "65,536 disjoint");
      EXPECT_FALSE(card["maps"].contains("pair"));
    }
    EXPECT_TRUE(contains(card["snippets"][0]["text"], "g++") || contains(card["snippets"][0]["text"], "nvcc"));
    // The report contains the algorithm's source once.
    const std::string subject = card["kind"]["subject"];
    EXPECT_TRUE(contains(card["snippets"][0]["text"], std::string(kSourceMark)));
    EXPECT_EQ(report["sources"][subject], amalgamated_source(subject));
  }
}

TEST_F(FailureCards, WithoutTheMinimiserAReportSaysWhatItLacks) {
  run("bare", 2);
  const Json bare = make_report(root_ / "bare");
  EXPECT_TRUE(bare["cards"].empty());
  ASSERT_EQ(bare["missing"].size(), 2u) << bare["missing"];
  EXPECT_EQ(bare["missing"][1],
            "The kinds of failure are not known yet: `graze minimize DIR` finds and explains them.");
  for (const Json& row : bare["signatures"]) EXPECT_TRUE(row["cards"].empty());
  // The kinds were found, but no case was minimised or mapped.
  const std::size_t cards = report_["cards"].size();
  const std::string missing = report_["missing"].dump();
  EXPECT_TRUE(contains(missing, fmt::format("{0} of {0} cards show a pair as it was found", cards))) << missing;
  EXPECT_TRUE(contains(missing, fmt::format("{0} of {0} cards have no ulp map", cards))) << missing;
  EXPECT_EQ(contains(missing, "`graze failures` lists all"), kinds_.size() > cards);
}

}  // namespace
}  // namespace graze::reports
