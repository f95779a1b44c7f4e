// SPDX-License-Identifier: Apache-2.0
// Reports of small campaigns, run here, and of made-up ones.
#include "reports/report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <set>

#include "core/error.h"
#include "core/margin/bucket.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/carded_signatures.h"
#include "fuzz/minimise/case_facts.h"
#include "reports/csv.h"
#include "reports/failure_cards.h"
#include "reports/findings.h"
#include "reports/page.h"
#include "reports/snippet.h"
#include "reports/tables.h"
#include "reports/wilson.h"
#include "strata/groups.h"

namespace graze::reports {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

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

// A summary of these lanes, with the same counts in each stratum.
Json summary_of(const std::vector<std::string>& lanes, const std::vector<std::string>& strata,
                const analysis::LaneCounts& counts) {
  Json summary = {
      {"spec", {{"seed", 1}, {"pairs", 1000 * strata.size()}, {"strata", strata}, {"lanes", lanes}}},
      {"build", {{"version", "0"}, {"commit", "c"}, {"compiler", "g"}, {"cuda", nullptr}, {"device", nullptr}}},
      {"complete", true},
      {"strata", Json::object()},
      {"disagreements", 0},
      {"signatures", Json::array()}};
  for (const std::string& stratum : strata) {
    Json& row = summary["strata"][stratum] = {
        {"pairs", 1000}, {"intersects", 400}, {"lanes", Json::object()}, {"margins", Json::object()}};
    for (const std::string& lane : lanes) {
      row["lanes"][lane] = {{"false_positive", counts.false_positive},
                            {"false_negative", counts.false_negative},
                            {"declined", counts.declined},
                            {"differs_from_cpu", lane.ends_with("/cpu") ? 0 : counts.differs_from_cpu}};
    }
  }
  return summary;
}

std::vector<std::string> answer_of(const Json& summary) { return answer(counts_of(summary), nullptr); }

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Answer, OfOneLaneComparesNothing) {
  const auto said = answer_of(summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {3, 2, 0, 0}));
  ASSERT_EQ(said.size(), 6u);
  EXPECT_EQ(said[0],
            "The only published lane, moller_1997/f32/cpu, is wrong on 5 (0.5 %, 95 % interval 0.214 % to 1.17 %) of "
            "1,000 pairs.");
  EXPECT_EQ(said[1], "The only stratum is uniform (0.5 % of all verdicts wrong).");
  // What the campaign cannot tell comes last.
  EXPECT_EQ(said[2], "No exact lane ran, so there is none to recommend for every pair.");
  EXPECT_EQ(said[3],
            "Of the published lanes only those of moller_1997/f32 ran, so the campaign does not say which to avoid.");
  EXPECT_TRUE(contains(said[4], "No lane with contraction ran"));
  EXPECT_TRUE(contains(said[5], "were not drawn"));
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
            "Use exact/f32/cpu: right on all 1,000 pairs. What it costs is not settled: the campaign has no timings of "
            "it.");
  EXPECT_EQ(
      said[1],
      "Of the 3 published lanes the least wrong are interval_overlap/f32/cpu and interval_overlap/f32/cuda-nofma: on "
      "none of 1,000 pairs (with 95 % confidence fewer than 0.299 %).");
  EXPECT_TRUE(contains(said[3], "another verdict than interval_overlap/f32/cuda-nofma on 10 pairs (1 %")) << said[3];
  EXPECT_TRUE(contains(said[3], "its wrong verdicts go from 0 to 10; 1 of 1 lanes")) << said[3];
  EXPECT_TRUE(contains(said[4], "in interval_overlap/f32/cuda-fma: on 10 (1 %")) << said[4];
  EXPECT_TRUE(contains(said[4], "of 1,000 pairs; without contraction on none.")) << said[4];
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

TEST(Answer, OfExactLanesOnlyAndOfNothing) {
  EXPECT_EQ(answer_of(summary_of({"exact/f32/cpu"}, {"uniform"}, {})),
            std::vector<std::string>{"Only exact lanes ran, and none of their verdicts on 1,000 pairs are wrong."});
  Json begun = summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {});
  begun["strata"]["uniform"]["pairs"] = begun["strata"]["uniform"]["intersects"] = 0;
  EXPECT_EQ(answer_of(begun), std::vector<std::string>{"No pair has been decided yet."});
}

// What was not compared is null in a summary and in a report, and of no pairs there is no share.
TEST(Tables, OfNothingThereIsNoShare) {
  Json summary = summary_of({"moller_1997/f32/cuda-fma"}, {"uniform"}, {0, 3, 0, 0});
  summary["strata"]["uniform"]["intersects"] = 1000;  // so that none can be a false positive
  summary["strata"]["uniform"]["lanes"]["moller_1997/f32/cuda-fma"]["differs_from_cpu"] = nullptr;
  const Json row = rates(counts_of(summary)).front();
  EXPECT_TRUE(row["differs_from_cpu"].is_null());
  EXPECT_EQ(row["false_positive"].dump(), R"({"count":0,"of":0,"share":null,"low":null,"high":null})");
  EXPECT_EQ(row["false_negative"]["share"], 0.003);
}

// What stands in thresholds for a group or stratum, by id; for all of them for "".
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
    summary["strata"][stratum]["margins"][name] = {{"pairs", pairs}, {"wrong", Json::object()}};
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
  const CampaignCounts counts = counts_of(summary);
  for (const Json& row : {threshold_of(counts, "general"), threshold_of(counts, "", "uniform")}) {
    EXPECT_EQ(row["disjoint"]["exponent"], 2);
    EXPECT_EQ(row["disjoint"]["above"], 50);
    EXPECT_NEAR(row["disjoint"]["bound"], 1 - std::pow(0.05, 1 / 50.0), 1e-6);
    EXPECT_TRUE(row["intersects"]["exponent"].is_null());
    EXPECT_EQ(row["intersects"]["bound"], 1);
    EXPECT_EQ(row["intersects"]["largest"], 4);
  }
  const Json other = threshold_of(counts, "degenerate"), all = threshold_of(counts, "");
  EXPECT_TRUE(other["disjoint"]["exponent"].is_null());
  EXPECT_EQ(other["disjoint"]["largest"], 9);
  EXPECT_TRUE(other["intersects"]["largest"].is_null());  // no such pairs
  EXPECT_TRUE(all["disjoint"]["exponent"].is_null());     // what pooling makes of it
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

TEST(Tables, ExtremesOfAllStrataAddUp) {
  Json summary = summary_of({"moller_1997/f32/cpu"}, {"extreme_scale", "mixed_scale"}, {});
  for (const char* stratum : {"extreme_scale", "mixed_scale"})
    summary["strata"][stratum]["extremes"]["scale"]["-152"] = {{"pairs", 10}, {"wrong", {{"moller_1997/f32/cpu", 2}}}};
  const Json rows = extremes(counts_of(summary));
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0]["cells"][0]["exponent"], -152);
  EXPECT_EQ(rows[0]["cells"][0]["wrong"]["count"], 4);
  EXPECT_EQ(rows[0]["cells"][0]["wrong"]["of"], 20);
}

TEST(Page, KnowsTheOutermostBuckets) {
  const std::string page = fuzz::read_whole(fs::path(GRAZE_SOURCE_DIR) / "reports/web/src/margins.ts");
  EXPECT_TRUE(contains(page, fmt::format("kOutermost = [{}, {}];", kBucketLowest, kBucketHighest)));
  EXPECT_TRUE(contains(page, fmt::format("kNearest = {};", kBucketLowest - 1)));
}

TEST(Command, NamesLanesAndStrata) {
  EXPECT_EQ(campaign_command(summary_of({"moller_1997/f32/cpu", "exact/f32/cpu"}, {"thesis", "sliver"}, {})),
            "graze fuzz --pairs 2000 --seed 1 --strata thesis,sliver --lanes 'moller_1997/f32/cpu,exact/f32/cpu' --out "
            "campaign");
  std::vector<std::string> all;
  for (const Lane& lane : lanes()) all.push_back(lane.id);
  EXPECT_EQ(campaign_command(summary_of(all, {"thesis"}, {})),
            "graze fuzz --pairs 1000 --seed 1 --strata thesis --out campaign");
}

// A small campaign in a directory of its own.
class ReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("graze_report_" + std::to_string(getpid()));
    run("one", 1);
    run("two", 2);
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static void run(const std::string& name, int threads, std::uint64_t seed = 3) {
    const fuzz::LanesUnderTest under_test =
        fuzz::select_lanes({"moller_1997/*", "interval_overlap/*", "exact/f32/cpu"}, fuzz::Executor::twin);
    fuzz::Campaign c;
    c.seed = seed;
    c.sources = strata::stratum_sources(c.seed, 30'000, {"near_edge_edge", "extreme_scale", "thesis"});
    c.under_test = &under_test;
    c.threads = threads;
    c.directory = root_ / name;
    c.spec = fuzz::campaign_spec(c);
    c.build = fuzz::build_info(under_test);
    fuzz::run_campaign(c, std::atomic<bool>(false), [](const fuzz::Progress&) {});
  }

  static inline fs::path root_;
};

TEST_F(ReportTest, SameBytesAgainAndForOtherThreads) {
  const Json one = make_report(root_ / "one"), again = make_report(root_ / "one"), two = make_report(root_ / "two");
  EXPECT_EQ(report_text(one), report_text(again));
  EXPECT_EQ(report_text(one), report_text(two));
  EXPECT_EQ(page(one, nullptr), page(two, nullptr));
  const Json costs = make_costs(root_ / "one");
  EXPECT_EQ(report_text(costs), report_text(make_costs(root_ / "one")));
  EXPECT_FALSE(contains(report_text(one), " ns "));  // what depends on the machine stays apart
  EXPECT_TRUE(contains(page(one, costs), costs["answer"][0].get<std::string>()));
  EXPECT_EQ(report_text(one).find(root_.string()), std::string::npos);
  EXPECT_EQ(Json::parse(report_text(one)), one);
}

TEST_F(ReportTest, AgreesWithTheSummary) {
  const Json report = make_report(root_ / "one"),
             summary = Json::parse(fuzz::read_whole(root_ / "one" / "summary.json"));
  EXPECT_EQ(report["answer"].size(), 6u);
  ASSERT_EQ(report["rates"].size(), report["lanes"].size() * 4);  // three strata, and all
  for (const Json& row : report["rates"]) {
    if (row["stratum"].is_null()) continue;
    const std::string stratum = report["strata"][row["stratum"].get<std::size_t>()]["id"],
                      lane = report["lanes"][row["lane"].get<std::size_t>()]["id"];
    const Json& counts = summary["strata"][stratum]["lanes"][lane];
    EXPECT_EQ(row["false_positive"]["count"], counts["false_positive"]);
    EXPECT_EQ(row["false_negative"]["of"], summary["strata"][stratum]["intersects"]);
    EXPECT_EQ(row["differs_from_cpu"].is_null(), lane.ends_with("/cpu"));
  }
  EXPECT_EQ(report["signatures"].size(), summary["signatures"].size());
  EXPECT_EQ(report["cards"].size(), fuzz::carded_signatures(summary).size());
  EXPECT_GT(report["cards"].size(), 10u);
  std::set<std::string> kinds;
  for (const Json& row : report["side_by_side"]) kinds.insert(row["kind"]);
  EXPECT_EQ(kinds, (std::set<std::string>{"cpu-nofma", "f32-f64", "nofma-fma"}));
}

TEST_F(ReportTest, CardsWithoutTheMinimiserSayWhatTheSignatureDoes) {
  const Json report = make_report(root_ / "one");
  const fuzz::LanesUnderTest under_test =
      fuzz::select_lanes({"moller_1997/*", "interval_overlap/*"}, fuzz::Executor::twin);
  for (const Json& card : report["cards"]) {
    const Json& signature = report["signatures"][card["signature"].get<std::size_t>()];
    EXPECT_EQ(card["minimised"], false);
    Pair pair;
    for (int i = 0; i < kCoordinates; ++i)
      coordinates(pair)[i] = parse_float32(card["pair"]["hex"][static_cast<std::size_t>(i)].get<std::string>()).value();
    std::vector<const Lane*> apart;
    const std::vector<Verdict> verdicts = decide(under_test, pair, apart);
    std::size_t compared = 0;
    for (const Json& row : card["verdicts"]) {
      const std::string lane = report["lanes"][row["lane"].get<std::size_t>()]["id"];
      EXPECT_EQ(lane.substr(0, lane.find('/')), signature["algorithm"]);
      for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
        if (under_test.lanes[l]->id != lane) continue;
        EXPECT_EQ(row["verdict"], name(verdicts[l])) << lane;
        ++compared;
      }
    }
    EXPECT_EQ(compared, signature["marks"].get<std::string>().size());
    const std::size_t points = card["drawing"]["contact"].size();
    EXPECT_EQ(points == 0, card["truth"]["contact"] == "none");
  }
  ASSERT_EQ(report["missing"].size(), 3u);  // not minimised, explained, mapped
}

TEST_F(ReportTest, CardsTellWhatTheMinimiserStored) {
  run("minimised", 2);
  const Json summary = Json::parse(fuzz::read_whole(root_ / "minimised" / "summary.json"));
  const fuzz::LanesUnderTest under_test =
      fuzz::select_lanes(summary["spec"]["lanes"].get<std::vector<std::string>>(), fuzz::Executor::twin);
  for (const std::size_t place : fuzz::carded_signatures(summary)) {
    const fs::path file = root_ / "minimised" / summary["signatures"][place]["case"].get<std::string>();
    fuzz::store_facts(under_test, file);
    Json pair = Json::array();
    for (int i = 0; i < kCoordinates; ++i)
      pair.push_back(fmt::format("{:a}", coordinates(fuzz::shown_case(corpus::read_pairs(file)).pair)[i]));
    fuzz::write_whole(fs::path(file).replace_extension(".maps.json"), Json({{"pair", pair}, {"title", "t"}}).dump());
  }
  Json report = make_report(root_ / "minimised");
  for (const Json& card : report["cards"]) {
    EXPECT_EQ(card["verdicts"].size(), report["lanes"].size());
    ASSERT_EQ(card["sentences"].size(), 1u);
    EXPECT_TRUE(contains(card["sentences"][0], "says"));
    EXPECT_EQ(card["maps"], Json({{"title", "t"}}));
    EXPECT_TRUE(contains(card["snippets"][0]["text"], "g++") || contains(card["snippets"][0]["text"], "nvcc"));
    // The algorithm's source is in the report once.
    const std::string algorithm = report["signatures"][card["signature"].get<std::size_t>()]["algorithm"];
    EXPECT_TRUE(contains(card["snippets"][0]["text"], std::string(kSourceMark)));
    EXPECT_EQ(report["sources"][algorithm], amalgamated_source(algorithm));
  }
  // Facts of another pair are not shown.
  const fs::path facts = fuzz::facts_file(root_ / "minimised" / report["cards"][0]["file"].get<std::string>());
  Json other = Json::parse(fuzz::read_whole(facts));
  other["pair"] = "0x0p+0";
  fuzz::write_whole(facts, other.dump());
  report = make_report(root_ / "minimised");
  EXPECT_TRUE(report["cards"][0]["sentences"].empty());
  EXPECT_FALSE(report["cards"][1]["sentences"].empty());
}

// Whatever is changed in a campaign's files: an error names the one that is to blame.
TEST_F(ReportTest, DamageIsBlamedOnItsFile) {
  run("damaged", 2);
  const fs::path folder = root_ / "damaged", summary_file = folder / "summary.json", timings = folder / "timings.json";
  const Json summary = Json::parse(fuzz::read_whole(summary_file));
  const auto blamed = [&](const fs::path& file, const std::string& text) -> std::string {
    const std::string before = fuzz::read_whole(file);
    fuzz::write_whole(file, text);
    std::string said = "nothing";
    try {
      make_report(folder);
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
    fuzz::write_whole(file, before);
    return said.starts_with(file.string() + ":") ? "the file" : said;
  };
  for (const char* part : {"/signatures", "/signatures/0/key", "/signatures/0/count", "/signatures/0/case",
                           "/strata/near_edge_edge/margins", "/spec/lanes", "/build", "/complete"}) {
    const Json::json_pointer place(part);
    for (const Json& instead :
         {Json(), Json(-1.5), Json("x"), Json::array({Json::array()}), Json("../../case.pairs")}) {
      Json other = summary;
      other[place] = instead;
      const std::string found = blamed(summary_file, other.dump());
      EXPECT_TRUE(found == "the file" || found == "nothing") << part << ' ' << instead << ": " << found;
    }
    Json other = summary;
    other[place.parent_pointer()].erase(place.back());
    EXPECT_EQ(blamed(summary_file, other.dump()), "the file") << part;
  }
  for (const char* outside : {"/etc/passwd", "cases/../../x.pairs", "cases", "../cases/x.pairs"}) {
    Json other = summary;
    other["signatures"][0]["case"] = outside;
    EXPECT_EQ(blamed(summary_file, other.dump()), "the file") << outside;
  }
  for (const char* other : {"[]", R"({"runs": 1})", R"({"runs": [1, {"machine": 1, "pairs": 2}, {"pairs": {}}]})"})
    EXPECT_EQ(blamed(timings, other), "nothing");  // only names the machine

  const fs::path cases = folder / summary["signatures"][0]["case"].get<std::string>();
  std::string text = fuzz::read_whole(cases);
  const std::string pair = fuzz::pair_text(fuzz::shown_case(corpus::read_pairs(cases)).pair);
  for (const Json& facts : {Json{{"pair", pair}}, Json{{"pair", pair}, {"verdicts", {{"a", 1}}}, {"sentences", {"b"}}},
                            Json{{"pair", pair}, {"verdicts", {{"a", "b"}}}, {"sentences", {nullptr}}}})
    EXPECT_EQ(blamed(fuzz::facts_file(cases), facts.dump()), "the file") << facts;
  EXPECT_EQ(blamed(fuzz::facts_file(cases), R"({"pair": 1})"), "nothing");
  EXPECT_EQ(blamed(cases, text.replace(text.find("margin="), 8, "margin=x")), "the file");
}

// A report comes from anywhere (`graze report --from`): one that lacks something is refused, whatever it lacks.
TEST_F(ReportTest, APlainPageOfARestOfAReportIsRefused) {
  const Json report = make_report(root_ / "one");
  std::vector<std::string> places;
  const Json flat = report.flatten();
  for (const auto& [place, value] : flat.items()) places.push_back(place);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < places.size(); i += 1 + places.size() / 150) {
    Json rest = report;
    for (Json::json_pointer place(places[i]); !place.empty(); place.pop_back()) {
      Json& parent = rest[place.parent_pointer()];
      if (parent.is_array())
        parent.erase(std::min<std::size_t>(std::stoul(place.back()), parent.size() - 1));
      else
        parent.erase(place.back());
      try {
        plain_page(rest);
      } catch (const Json::exception&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST_F(ReportTest, ComparesTwoCampaigns) {
  run("other", 2, 4);
  Json report = make_report(root_ / "other");
  const Json before = make_report(root_ / "one");
  add_comparison(report, before, report["signatures"], before["signatures"]);
  const Json& compare = report["compare"];
  EXPECT_EQ(compare["other"], before["run"]);
  EXPECT_EQ(compare["rates"].size(), report["rates"].size());
  EXPECT_EQ(report["signatures"].size() - compare["gained"].size(),
            before["signatures"].size() - compare["lost"].size());
  EXPECT_FALSE(compare["gained"].empty());
  const auto changed = std::count_if(compare["rates"].begin(), compare["rates"].end(),
                                     [](const Json& row) { return row["changed"].get<bool>(); });
  EXPECT_LT(changed, static_cast<std::ptrdiff_t>(compare["rates"].size() / 10));  // only the seed differs
  Json worse = before;
  for (Json& row : worse["rates"]) row["wrong"] = to_json(share_of(row["wrong"]["of"], row["wrong"]["of"]));
  add_comparison(worse, before, worse["signatures"], before["signatures"]);
  EXPECT_TRUE(std::any_of(worse["compare"]["rates"].begin(), worse["compare"]["rates"].end(),
                          [](const Json& row) { return row["changed"].get<bool>(); }));
}

TEST_F(ReportTest, TablesHaveARowAHeaderAndTheSameCellsEach) {
  const Json report = make_report(root_ / "one");
  std::map<std::string, std::size_t> rows;
  for (const CsvTable& table : csv_tables(root_ / "one", report)) {
    std::istringstream in(table.text);
    std::string header, line;
    std::getline(in, header);
    for (; std::getline(in, line); ++rows[table.name])
      ASSERT_EQ(std::count(line.begin(), line.end(), ','), std::count(header.begin(), header.end(), ',')) << line;
  }
  EXPECT_EQ(rows["signatures.csv"], report["signatures"].size());
  EXPECT_EQ(rows["thresholds.csv"], 2 * report["lanes"].size() * (report["groups"].size() + 3 + 1));
  EXPECT_GT(rows["margins.csv"], 100u);
  EXPECT_GT(rows["rates.csv"], report["rates"].size());
}

// Elements that are opened are closed, in order; enough for what plain_page writes.
void expect_well_formed(const std::string& text) {
  const std::set<std::string> empty{"meta", "!DOCTYPE"};
  std::vector<std::string> open;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    const std::size_t end = text.find('>', at);
    ASSERT_NE(end, std::string::npos);
    const std::string tag = text.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(tag[0] == '/', tag.find_first_of(" /\n", 1) - (tag[0] == '/'));
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), tag.substr(1)) << "at byte " << at;
      open.pop_back();
    } else if (!tag.ends_with('/') && !empty.contains(name)) {
      open.push_back(name);
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST_F(ReportTest, PlainPageIsWellFormedAndShowsEverything) {
  Json report = make_report(root_ / "one");
  add_comparison(report, report, report["signatures"], report["signatures"]);
  report["missing"].push_back("a <b> & \"c\"");
  const std::string text = plain_page(report, make_costs(root_ / "one"));
  expect_well_formed(text);
  EXPECT_TRUE(contains(text, "a &lt;b&gt; &amp; &quot;c&quot;"));
  EXPECT_TRUE(contains(text, "had no Node"));
  EXPECT_LT(text.find(" ns a general pair"), text.find("<h2>What was run"));
  EXPECT_EQ(text.find("<script"), std::string::npos);
  EXPECT_EQ(text.find("http"), std::string::npos);
  std::size_t drawings = 0;
  for (std::size_t at = text.find("<polygon"); at != std::string::npos; at = text.find("<polygon", at + 1)) ++drawings;
  EXPECT_GE(drawings, 2 * report["cards"].size());
}

TEST(Page, HoldsTheReportInItsElement) {
  const Json report = {{"text", "</script><!--"}};
  const std::string text = filled(
      "<p><script type=\"application/json\" id=\"costs\">null</script>"
      "<script type=\"application/json\" id=\"report\">old</script><script>code</script>",
      report, {{"passes", 9}});
  EXPECT_EQ(text,
            "<p><script type=\"application/json\" id=\"costs\">{\"passes\":9}</script>"
            "<script type=\"application/json\" id=\"report\">{\"text\":\"\\u003c/script>\\u003c!--\"}</script>"
            "<script>code</script>");
  EXPECT_THROW(filled("<p>", report, nullptr), std::logic_error);
}

TEST(Page, OfManySignaturesIsUnderEightMebibytes) {
  Json summary = summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {1, 1, 0, 0});
  summary["spec"]["lanes"] = Json::array();
  for (const Lane& lane : lanes()) summary["spec"]["lanes"].push_back(lane.id);
  Json stratum = summary["strata"]["uniform"];
  for (const Lane& lane : lanes()) stratum["lanes"][lane.id] = stratum["lanes"]["moller_1997/f32/cpu"];
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    stratum["margins"][name_of_bucket(static_cast<Bucket>(b))] = {{"pairs", 99'999'999'999}, {"wrong", Json::object()}};
    for (const Lane& lane : lanes())
      stratum["margins"][name_of_bucket(static_cast<Bucket>(b))]["wrong"][lane.id] = 12'345'678'901;
  }
  for (int e = -152; e <= 124; e += 4) {
    stratum["extremes"]["scale"][std::to_string(e)] = {{"pairs", 99'999'999'999}, {"wrong", Json::object()}};
    stratum["extremes"]["offset"][std::to_string(e / 4)] = {{"pairs", 99'999'999'999}, {"wrong", Json::object()}};
  }
  summary["strata"] = Json::object();
  for (int s = 0; s < 19; ++s) summary["strata"]["a_stratum_with_a_name_" + std::to_string(s)] = stratum;
  const fs::path directory = fs::temp_directory_path() / ("graze_size_" + std::to_string(getpid()));
  fs::create_directories(directory / "cases");
  const Pair pair{{{0.1f, 0.2f, 0.3f}, {1.7f, 0.3f, 0.7f}, {0.3f, 1.9f, 1e-30f}},
                  {{0.11f, 1e30f, 3.7e-9f}, {1.3f, 0.19f, 0.123456f}, {0.7f, 1.1f, 2.3f}}};
  for (int i = 0; i < 12'000; ++i) {
    const std::string key =
        "segment/22/skew/+2^-1/guigue_devillers_2003:+f32/cpu;+f32/cpu-fma;+f32/cpu-fast;-f32/cuda-nofma;"
        "-f32/cuda-fma;-f32/cuda-fast;+f64/cpu;+f64/cpu-fma;+f64/cpu-fast;+f64/cuda-nofma;+f64/cuda-fma/abs:" +
        std::to_string(i);
    summary["signatures"].push_back({{"key", key}, {"count", 99'999'999'999}, {"case", "cases/1.pairs"}});
  }
  fuzz::write_whole(directory / "cases/1.pairs", "graze-pairs 1\n" + fuzz::pair_text(pair) +
                                                     " | stratum=s seed=1 index=1 truth=disjoint contact=none "
                                                     "margin=1e-30 margin_ulps=1.25\n");
  Json pair_hex = Json::array();
  for (int i = 0; i < kCoordinates; ++i) pair_hex.push_back(fmt::format("{:a}", coordinates(pair)[i]));
  fuzz::write_whole(directory / "cases/1.maps.json",
                    Json({{"pair", pair_hex}, {"panels", Json::array({{{"png", std::string(100'000, 'A')}}})}}).dump());
  fuzz::write_whole(directory / "summary.json", summary.dump());
  const Json report = make_report(directory);
  const std::string html = page(report, nullptr);
  EXPECT_EQ(report["cards"].size(), fuzz::kMostCards);
  EXPECT_EQ(report["signatures"].size(), kMostSignatures);
  EXPECT_EQ(report["signature_count"], 12'000);
  EXPECT_LT(html.size(), 8u << 20);
  EXPECT_GT(html.size(), 5u << 20);
  fs::remove_all(directory);
}

TEST(Report, NeedsACampaign) {
  EXPECT_THROW(make_report("/nonexistent"), std::runtime_error);
  const fs::path directory = fs::temp_directory_path() / ("graze_damaged_" + std::to_string(getpid()));
  fs::create_directories(directory);
  fuzz::write_whole(directory / "summary.json", R"({"spec": {}, "strata": {}})");
  EXPECT_THROW(make_report(directory), corpus::FormatError);
  EXPECT_THROW(read_report(directory / "summary.json"), corpus::FormatError);
  fs::remove_all(directory);
}

}  // namespace
}  // namespace graze::reports
