// SPDX-License-Identifier: Apache-2.0
// Tests the interactive page and the plain page.
#include "reports/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/fnv1a.h"
#include "core/margin/bucket.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/sealed.h"
#include "oracle/truth.h"
#include "reports/comparison.h"
#include "reports/failure_cards.h"
#include "reports/report.h"
#include "reports/test_campaign.h"
#include "reports/ulp_map_picture.h"

namespace graze::reports {
namespace {

class PageTest : public CampaignTest {};

const Json kNone = {{"tuned", nullptr}, {"pareto", nullptr}, {"discrepancy", nullptr}};

TEST(Page, KnowsTheOutermostBuckets) {
  const std::string page = fuzz::read_whole(fs::path(GRAZE_SOURCE_DIR) / "reports/web/src/margin_chart.ts");
  EXPECT_TRUE(contains(page, fmt::format("kOutermost = [{}, {}];", kBucketLowest, kBucketHighest)));
  EXPECT_TRUE(contains(page, fmt::format("kNearest = {};", kBucketLowest - 1)));
}

TEST(Page, HoldsTheReportInItsElement) {
  const Json report = {{"text", "</script><!--"}};
  const std::string text = filled(
      "<p><script type=\"application/json\" id=\"costs\">null</script>"
      "<script type=\"application/json\" id=\"choices\"></script>"
      "<script type=\"application/json\" id=\"report\">old</script><script>code</script>",
      report, {{"passes", 9}}, {{"tuned", "<"}});
  EXPECT_EQ(text,
            "<p><script type=\"application/json\" id=\"costs\">{\"passes\":9}</script>"
            "<script type=\"application/json\" id=\"choices\">{\"tuned\":\"\\u003c\"}</script>"
            "<script type=\"application/json\" id=\"report\">{\"text\":\"\\u003c/script>\\u003c!--\"}</script>"
            "<script>code</script>");
  EXPECT_THROW(filled("<p>", report, nullptr, kNone), std::logic_error);
}

// `graze report --from` accepts any file, so a report with a missing part must be rejected.
TEST_F(PageTest, APlainPageOfARestOfAReportIsRefused) {
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
        plain_page(rest, nullptr, kNone);
      } catch (const Json::exception&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 100u);
}

// Checks that opened elements are closed in order. This is sufficient for the output of plain_page.
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

TEST_F(PageTest, PlainPageIsWellFormedAndShowsEverything) {
  Json report = make_report(root_ / "one");
  add_comparison(report, report, Json::array(), Json::array());
  report["missing"].push_back("a <b> & \"c\"");
  const std::string text = plain_page(report, make_costs(root_ / "one"), make_choices(root_ / "one"));
  expect_well_formed(text);
  EXPECT_TRUE(contains(text, "a &lt;b&gt; &amp; &quot;c&quot;"));
  EXPECT_TRUE(contains(text, "without Node"));
  EXPECT_LT(text.find(") a general pair"), text.find("<h2>What was run"));
  EXPECT_EQ(text.find("<script"), std::string::npos);
  EXPECT_EQ(text.find("http"), std::string::npos);
  std::size_t drawings = 0;
  for (std::size_t at = text.find("<polygon"); at != std::string::npos; at = text.find("<polygon", at + 1)) ++drawings;
  EXPECT_GE(drawings, 2 * report["cards"].size());
}

TEST(Page, OfManySignaturesIsUnderTenMebibytes) {
  if (!has_interactive_page()) GTEST_SKIP() << "this build has no interactive page: it takes Node and npm's packages";
  // Every bucket has kPairs pairs. In each bucket of intersecting pairs, every lane of one subject is wrong on kWrong
  // pairs.
  constexpr std::uint64_t kPairs = 19'999'999'999, kWrong = 2'345'676'000, kExponents = 70;
  constexpr std::uint64_t kSignatures = 12'000, kOfSignature = 19 * (kBucketMost + 1) * (kWrong / kSignatures);
  static_assert(kWrong % kSignatures == 0);
  Json summary = summary_of({"moller_1997/f32/cpu"}, {"uniform"}, {1, 1, 0, 0});
  std::vector<std::string> ids, wrong_ids;
  std::string wrong;  // the wrong lanes, as in a signature
  for (const Lane& lane : lanes()) {
    if (fuzz::is_exact_on_doubles(lane)) continue;  // not run in a campaign of float32
    ids.push_back(lane.id);
    if (lane.info->id != std::string_view("guigue_devillers_2003")) continue;
    wrong_ids.push_back(lane.id);
    wrong += (wrong.empty() ? "-" : ";-") + lane.lane_name().within_subject();
  }
  summary["spec"]["lanes"] = ids;
  Json stratum = summary["strata"]["uniform"];
  stratum["pairs"] = kBucketCount * kPairs;
  stratum["intersects"] = (kBucketMost + 1) * kPairs;
  Json counts = stratum["lanes"]["moller_1997/f32/cpu"];
  counts["false_positive"] = counts["false_negative"] = 0;
  for (const std::string& lane : ids) {
    counts["differs_from_cpu"] = fuzz::is_compared_with_cpu(lane, ids) ? Json(1) : Json(nullptr);
    stratum["lanes"][lane] = counts;
  }
  for (const std::string& lane : wrong_ids) stratum["lanes"][lane]["false_negative"] = (kBucketMost + 1) * kWrong;
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    Json& row = stratum["margins"][name_of_bucket(static_cast<Bucket>(b))];
    row = {{"pairs", kPairs}, {"wrong", Json::object()}, {"differs_from_cpu", Json::object()}};
    for (const std::string& lane : ids) {
      if (b == 0 && fuzz::is_compared_with_cpu(lane, ids)) row["differs_from_cpu"][lane] = 1;
    }
    for (const std::string& lane : wrong_ids) row["wrong"][lane] = b <= 0 ? kWrong : 0;
  }
  for (std::uint64_t e = 0; e < kExponents; ++e) {
    const auto share = [&](std::uint64_t all) { return all / kExponents + (e < all % kExponents); };
    Json cell = {
        {"pairs", share(kBucketCount * kPairs)}, {"wrong", Json::object()}, {"differs_from_cpu", Json::object()}};
    for (const std::string& lane : ids) {
      if (e == 0 && fuzz::is_compared_with_cpu(lane, ids)) cell["differs_from_cpu"][lane] = 1;
    }
    for (const std::string& lane : wrong_ids) cell["wrong"][lane] = share((kBucketMost + 1) * kWrong);
    stratum["extremes"]["scale"][std::to_string(4 * static_cast<int>(e) - 152)] = cell;
    stratum["extremes"]["offset"][std::to_string(static_cast<int>(e) - 38)] = cell;
  }
  summary["spec"]["pairs"] = 19 * kBucketCount * kPairs;
  summary["strata"] = Json::object();
  summary["spec"]["strata"] = Json::array();
  for (int s = 0; s < 19; ++s) {
    const std::string name = "a_stratum_with_a_name_" + std::to_string(s);
    summary["strata"][name] = stratum;
    summary["spec"]["strata"].push_back(name);
  }
  const fs::path directory = fs::temp_directory_path() / ("graze_size_" + std::to_string(getpid()));
  fs::create_directories(directory / "cases");
  const Pair pair{{{0.1f, 0.2f, 0.3f}, {1.7f, 0.3f, 0.7f}, {0.3f, 1.9f, 1e-30f}},
                  {{0.11f, 1e30f, 3.7e-9f}, {1.3f, 0.19f, 0.123456f}, {0.7f, 1.1f, 2.3f}}};
  const oracle::Truth truth = oracle::truth(pair);
  std::string fields;
  for (const auto& [name, value] : fuzz::truth_fields(truth)) fields += name + '=' + value + ' ';
  const std::string bucket = name_of_bucket(oracle::margin_bucket(pair, truth.verdict));
  const auto stratum_of = [](std::uint64_t i, std::size_t k) {
    return "a_stratum_with_a_name_" + std::to_string((i + k) % 19);
  };
  constexpr std::uint64_t kOfAKind = 9;  // each kind has every ninth signature
  ASSERT_EQ(truth.verdict, Verdict::intersects);
  Json kinds = Json::array();
  const std::vector<analysis::Cell> cells(analysis::kMapSize * analysis::kMapSize, analysis::Cell::disjoint);
  Json map = to_json(analysis::UlpMap{pair, {9, 10}, {{nullptr, cells}}});
  map["panels"][0]["png"] = std::string(100'000, 'A');
  const std::string maps = fuzz::sealed(map).dump();
  summary["disagreements"] = kSignatures * kOfSignature;
  for (std::uint64_t i = 0; i < kSignatures; ++i) {
    const std::string key = fmt::format("{}/22/skew/{}/guigue_devillers_2003:{};-f64/cuda-fma/abs:{}",
                                        name(truth.contact), bucket, wrong, i);
    const std::string file = fmt::format("cases/{:016x}.pairs", fnv1a(key));
    std::string text = fmt::format("graze-pairs 1\n# {}: {} pairs\n", key, kOfSignature);
    for (std::size_t k = 0; k < fuzz::kKeptCases; ++k)
      text += fmt::format("{} | stratum={} seed=1 index={} {}signature={}\n", fuzz::pair_text(pair), stratum_of(i, k),
                          k, fields, key);
    fuzz::write_whole(directory / file, text);
    if (i < kOfAKind) fuzz::write_whole(fs::path(directory / file).replace_extension(".maps.json"), maps);
    summary["signatures"].push_back({{"key", key}, {"count", kOfSignature}, {"case", file}});
  }
  fuzz::write_whole(directory / "summary.json", summary.dump());
  Json kind = {
      {"subject", "guigue_devillers_2003"},
      {"cause", "rounding"},
      {"shape", "general"},
      {"simplest",
       {{"pair", fuzz::pair_text(pair)}, {"verdicts", Json::object()}, {"sentences", {std::string(400, 's')}}}},
      {"worst", {{"pair", fuzz::pair_text(pair)}, {"margin_ulps", truth.margin_ulps}}}};
  kind["lanes"] = kind["simplest"]["lanes"] = wrong_ids;
  for (const std::string& lane : ids) kind["simplest"]["verdicts"][lane] = name(truth.verdict);
  for (const std::string& lane : wrong_ids) kind["simplest"]["verdicts"][lane] = name(Verdict::disjoint);
  for (std::uint64_t k = 0; k < 100; ++k) {  // a hundred kinds, as if the lanes were wrong for many reasons
    kind["line"] = fmt::format("core/algorithms/range.h:{}", 100 + k);
    kind["key"] = fmt::format("guigue_devillers_2003/rounding/range.h:{}/general", 100 + k);
    kind["places"] = Json::array();
    std::map<std::string, std::uint64_t> strata;
    for (std::uint64_t i = k % kOfAKind; i < kSignatures; i += kOfAKind) {
      kind["places"].push_back(i);
      for (std::size_t c = 0; c < fuzz::kKeptCases; ++c) ++strata[stratum_of(i, c)];
    }
    const std::uint64_t places = kind["places"].size();
    kind["strata"] = strata;
    kind["signatures"] = places;
    kind["pairs"] = places * kOfSignature;
    kind["intersecting"] = truth.verdict == Verdict::intersects ? places * kOfSignature : 0;
    kind["margins"] = {{bucket, places * kOfSignature}};
    kind["settled"] = {1, places * kind["lanes"].size()};
    for (const char* which : {"simplest", "worst"}) {
      kind[which]["case"] = summary["signatures"][static_cast<std::size_t>(k % kOfAKind)]["case"];
      kind[which]["from"] = stratum_of(k % kOfAKind, 0) + ":1:0";
    }
    kinds.push_back(kind);
  }
  std::stable_sort(kinds.begin(), kinds.end(), [](const Json& l, const Json& r) { return l["pairs"] > r["pairs"]; });
  fuzz::SelectedLanes under_test;
  for (const Lane& lane : lanes())
    if (!fuzz::is_exact_on_doubles(lane)) under_test.lanes.push_back(&lane);
  fuzz::write_kinds(directory, under_test, kinds);
  const Json report = make_report(directory);
  const std::string html = page(report, nullptr, kNone);
  EXPECT_EQ(report["cards"].size(), fuzz::kMostShown);
  EXPECT_EQ(report["signatures"].size(), kMostSignatures);
  EXPECT_EQ(report["signature_count"], 12'000);
  EXPECT_LT(html.size(), 10u << 20);

  EXPECT_GT(html.size(), 5u << 20);
  fs::remove_all(directory);
}

}  // namespace
}  // namespace graze::reports
