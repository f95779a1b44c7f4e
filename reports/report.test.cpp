// SPDX-License-Identifier: Apache-2.0
// Tests reports of small campaigns, which run here, and of damaged campaigns.
#include "reports/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/message_testing.h"
#include "corpus/pair_format.h"
#include "fuzz/sealed.h"
#include "reports/comparison.h"
#include "reports/failure_cards.h"
#include "reports/page.h"
#include "reports/pareto.h"
#include "reports/tables.h"
#include "reports/test_campaign.h"
#include "reports/tuning.h"

namespace graze::reports {
namespace {

class ReportTest : public CampaignTest {};

TEST_F(ReportTest, SameBytesAgainAndForOtherThreads) {
  run("two", 2);
  store_kinds("two");
  const Json one = make_report(root_ / "one"), again = make_report(root_ / "one"), two = make_report(root_ / "two");
  EXPECT_EQ(report_text(one), report_text(again));
  EXPECT_EQ(report_text(one), report_text(two));
  const Json none = make_choices(root_);
  EXPECT_EQ(page(one, nullptr, none), page(two, nullptr, none));
  const Json costs = make_costs(root_ / "one");
  EXPECT_EQ(report_text(costs), report_text(make_costs(root_ / "one")));
  EXPECT_FALSE(contains(report_text(one), " ns "));  // machine-dependent data is kept apart
  EXPECT_TRUE(contains(page(one, costs, none), costs["answer"][0].get<std::string>()));
  EXPECT_EQ(report_text(one).find(root_.string()), std::string::npos);
  EXPECT_EQ(Json::parse(report_text(one)), one);
}

TEST_F(ReportTest, AgreesWithTheSummary) {
  const Json report = make_report(root_ / "one"),
             summary = Json::parse(fuzz::read_whole(root_ / "one" / "summary.json"));
  EXPECT_EQ(report["answer"].size(), 6u);
  ASSERT_EQ(report["rates"].size(), report["lanes"].size() * 4);  // three strata, and all strata together
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
  EXPECT_EQ(report["cards"].size(), std::min(fuzz::kMostShown, fuzz::read_kinds(root_ / "one").size()));
  EXPECT_GT(report["cards"].size(), 10u);
  std::set<std::string> kinds;
  for (const Json& row : report["side_by_side"]) kinds.insert(row["kind"]);
  EXPECT_EQ(kinds, (std::set<std::string>{"cpu-nofma", "f32-f64", "nofma-fma"}));
}

// If a campaign file is changed in any way, the error names that file.
TEST_F(ReportTest, DamageIsBlamedOnItsFile) {
  run("damaged", 2);
  store_kinds("damaged");
  const fs::path folder = root_ / "damaged", summary_file = folder / "summary.json", timings = folder / "timings.json";
  const Json summary = Json::parse(fuzz::read_whole(summary_file));
  const auto blamed = [&](const fs::path& file, const std::string& text) -> std::string {
    const std::string before = fuzz::read_whole(file);
    std::ofstream(file) << text;
    std::string said = "nothing";
    try {
      make_report(folder);
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
    std::ofstream(file) << before;
    return has_word(said, file.string()) ? "the file" : said;
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
  for (const char* other : {"", "[]", "{}", R"({"runs": []})"}) EXPECT_EQ(blamed(timings, other), "the file") << other;
  for (const char* other :
       {R"({"runs": 1})", R"({"runs": [1]})", R"({"runs": [{"threads": "x"}]})", R"({"runs": [{"engine": true}]})",
        R"({"runs": [{"a": 1}, {"milliseconds_a_map": -1}]})", R"({"runs": [], "oracle": {"cgal": -5}})"})
    EXPECT_EQ(blamed(timings, fuzz::sealed(Json::parse(other)).dump()), "the file") << other;
  const std::string timed = fuzz::read_whole(timings);
  for (const auto& [part, value] : std::initializer_list<std::pair<const char*, double>>{
           {"middle", -1}, {"pairs", 1025}, {"low", 1'000'000}, {"low", 5e-324}, {"high", 1e300}}) {
    Json other = Json::parse(timed);
    other["runs"].back()["costs"]["lanes"]["moller_1997/f32/cpu"]["thesis"][part] = value;
    std::ofstream(timings) << fuzz::sealed(other);
    try {
      make_costs(folder);
      ADD_FAILURE() << part;
    } catch (const corpus::FormatError& error) {
      EXPECT_TRUE(
          std::string(error.what()).starts_with("cannot use " + timings.string() + ": it has impossible costs of "))
          << error.what();
    }
  }
  std::ofstream(timings) << timed;

  const Json stored = Json::parse(fuzz::read_whole(folder / "failures.json"));
  for (const char* part : {"/simplest", "/simplest/case", "/simplest/pair", "/simplest/verdicts", "/simplest/lanes",
                           "/places", "/key", "/subject", "/worst", "/lanes", "/margins"}) {
    Json other = stored;
    const Json::json_pointer place("/kinds/0" + std::string(part));
    other[place.parent_pointer()].erase(place.back());
    EXPECT_EQ(blamed(folder / "failures.json", fuzz::sealed(other).dump()), "the file") << part;
  }
  for (const char* other : {"", "[]", R"({"kinds": []})", R"({"summary": 1, "kinds": 2})"})
    EXPECT_EQ(blamed(folder / "failures.json", other), "the file") << other;

  const fs::path cases = folder / stored["kinds"][0]["simplest"]["case"].get<std::string>();
  std::string text = fuzz::read_whole(cases);
  EXPECT_EQ(blamed(cases, text.replace(text.find("margin="), 8, "margin=x")), "the file");
  EXPECT_EQ(blamed(cases, "graze-pairs 1\n" + text.substr(text.rfind("0x", text.find(" | ")))), "the file");
}

TEST_F(ReportTest, ComparesTwoCampaigns) {
  run("other", 2, 4);
  store_kinds("other");
  Json report = make_report(root_ / "other");
  const Json before = make_report(root_ / "one");
  const Json kinds = fuzz::read_kinds(root_ / "other"), kinds_before = fuzz::read_kinds(root_ / "one");
  add_comparison(report, before, kinds, kinds_before);
  const Json& compare = report["compare"];
  EXPECT_EQ(compare["other"], before["run"]);
  EXPECT_EQ(compare["rates"].size(), report["rates"].size());
  EXPECT_TRUE(compare["headline"].get<std::string>().starts_with(
      fmt::format("None of {} rates changed, and no kind of failure with at least 14 expected signatures came or "
                  "went; ",
                  report["rates"].size())));
  EXPECT_EQ(compare["differences"], Json::array({"The seed differs: 3 before, 4 after."}));
  // Now every lane is wrong on every pair, and moller_1997 has lost all its kinds of failure.
  Json worse = before, without = Json::array();
  for (Json& row : worse["rates"]) row["wrong"] = to_json(share_of(row["wrong"]["of"], row["wrong"]["of"]));
  for (const Json& kind : kinds_before) {
    if (kind["subject"] != "moller_1997") without.push_back(kind);
  }
  add_comparison(worse, before, without, kinds_before);
  EXPECT_TRUE(std::all_of(worse["compare"]["rates"].begin(), worse["compare"]["rates"].end(),
                          [](const Json& row) { return row["before"]["share"] == 1 || row["changed"].get<bool>(); }));
  EXPECT_TRUE(worse["compare"]["gained"].empty());
  EXPECT_FALSE(worse["compare"]["lost"].empty());
  for (const Json& lost : worse["compare"]["lost"])
    EXPECT_TRUE(lost["key"].get<std::string>().starts_with("moller_1997/")) << lost;
}

// Collects the path of every value, but visits only the first element of each list.
void collect(const Json& value, const Json::json_pointer& at, std::vector<Json::json_pointer>& places) {
  if (!at.empty()) places.push_back(at);
  if (value.is_object()) {
    for (const auto& [name, inner] : value.items()) collect(inner, at / name, places);
  } else if (value.is_array() && !value.empty()) {
    collect(value[0], at / 0, places);
  }
}

// Replaces each value in turn by values of another type and by impossible numbers.
// possible: the names of numbers that may have any value.
void expect_all_refused(const Json& whole, const std::set<std::string>& possible,
                        const std::function<std::string(const Json&)>& error_of) {
  ASSERT_EQ(error_of(whole), "");
  std::vector<Json::json_pointer> places;
  collect(whole, Json::json_pointer(), places);
  ASSERT_GT(places.size(), 10u);
  for (const Json::json_pointer& place : places) {
    std::vector<Json> instead = {whole[place].is_array() ? Json::object() : Json::array()};
    if (!whole[place].is_number()) instead.push_back(5);
    // Where null is valid, a text may be valid too.
    if (!whole[place].is_string() && !whole[place].is_null()) instead.push_back("x");
    if (whole[place].is_number_unsigned() && !possible.contains(place.to_string()) && !possible.contains(place.back()))
      instead.insert(instead.end(), {1'000'000'000'000, -1});
    for (const Json& value : instead) {
      Json other = whole;
      if (other[place] == value) continue;
      other[place] = value;
      const std::string error = error_of(other);
      EXPECT_NE(error, "") << place.to_string() << " was taken as " << value;
      EXPECT_EQ(error.find('\n'), error.npos) << error;
    }
  }
}

TEST_F(ReportTest, FilesOfOtherShapesAndImpossibleCountsAreRefused) {
  const fs::path file = root_ / "forged" / "report.json";
  fs::create_directories(file.parent_path());
  const auto error_of = [&](const auto& read, const fs::path& forged, const Json& json) -> std::string {
    fuzz::write_whole(forged, json.is_object() ? fuzz::sealed(json).dump() : json.dump());
    try {
      read();
    } catch (const corpus::FormatError& error) {
      EXPECT_TRUE(has_word(error.what(), forged.string())) << error.what();
      return error.what();
    }
    return "";
  };
  const std::vector<std::string> few = {"moller_1997/f32/cpu", "moller_1997/f32/cuda-fma", "exact/f32/cpu"};
  run("few", 2, 3, few);  // a small report, because each of its values is changed in a separate file
  store_kinds("few", few);
  Json report = make_report(root_ / "few");
  const Json changed = {{"lane", few[0]},
                        {"stratum", "thesis"},
                        {"pairs", 9},
                        {"known", "changed"},
                        {"least", 9},
                        {"most", 9},
                        {"broken", 6},
                        {"mended", 3},
                        {"smallest_broken", "thesis:1:2"},
                        {"smallest_mended", "thesis:1:3"}};
  add_comparison(report, Json(report), fuzz::read_kinds(root_ / "few"), fuzz::read_kinds(root_ / "few"),
                 Json::array({changed}));
  report["cards"].erase(report["cards"].begin() + 1, report["cards"].end());
  for (Json& row : report["signatures"]) row["cards"] = {0};
  expect_all_refused(report, {"seed", "exponent", "largest", "step", "size", "/compare/other/pairs"},
                     [&](const Json& json) { return error_of([&] { read_report(file); }, file, json); });
  for (const auto& [place, value] : {std::pair<const char*, Json>("strata", {{"lattice", 1}}),
                                     {"margins", {{"banana", report["cards"][0]["kind"]["pairs"]}}},
                                     {"lanes", {"x"}},
                                     {"lanes", {"exact/f32/cpu"}}}) {
    Json other = report;
    other["cards"][0]["kind"][place] = value;
    EXPECT_NE(error_of([&] { read_report(file); }, file, other), "") << place;
  }
  Json costs = make_costs(root_ / "few");
  costs["report"] = fuzz::sealed(report).at("checksum");
  expect_all_refused({{"costs", costs}}, {"passes", "low", "middle", "high"}, [&](const Json& json) {
    return error_of([&] { stored_costs(root_ / "forged" / "costs.json", report); }, root_ / "forged" / "costs.json",
                    json.is_object() ? json.value("costs", Json()) : json);
  });

  // without: the errors without a policy on the same pairs
  const auto errors = [](std::uint64_t pairs, std::uint64_t false_negatives, const char* policy,
                         std::uint64_t without) {
    analysis::PolicyErrors result;
    result.policy = policy;
    result.pairs = pairs;
    result.false_negative = false_negatives;
    result.fixed = *policy ? without : 0;
    result.broken = *policy ? false_negatives : 0;
    return result;
  };
  analysis::Tuned tuned;
  tuned.chosen = "rel:8";
  tuned.confirmed = errors(4000, 552, "rel:8", 600);
  tuned.zero_confirmed = errors(4000, 600, "", 600);
  tuned.bound = analysis::upper_bound(552, 4000);
  tuned.other_bound = analysis::other_bound(tuned.confirmed, analysis::Forbid::false_negative);
  tuned.zero = errors(400, 60, "", 60);
  tuned.curves = {{"", true, {errors(400, 50, "rel:1", 60), errors(400, 30, "rel:8", 60)}},
                  {"parallel", true, {tuned.zero}}};
  tuned.curves[1].points[0].policy = "parallel=rel:1";
  tuned.dead = {"parallel"};
  tuned.scale.down = -4;
  tuned.scale.here = errors(400, 30, "rel:8", 60);
  tuned.scale.at_down = errors(400, 200, "rel:8", 60);
  tuned.interactions = {{"a", "b", errors(400, 1, "a", 60), errors(400, 2, "b", 60), errors(400, 3, "c", 60)}};
  const Json tune = tuning_json({"moller_1997/f32/cpu", analysis::Forbid::false_negative, 1e-3, 0.1}, tuned);
  const fs::path tune_file = root_ / "forged" / "tune.json", pareto_file = root_ / "forged" / "pareto.json";
  const auto tune_error = [&](const Json& json) {
    return error_of([&] { make_choices(root_ / "forged"); }, tune_file, json);
  };
  expect_all_refused(tune, {}, tune_error);
  for (const auto& [place, value] : {std::pair<const char*, Json>("/bound", 0),
                                     {"/bound", 2},
                                     {"/bound", tuned.bound * 1.01},
                                     {"/other_bound", tuned.other_bound * 1.01},
                                     {"/max_other", 1.5},
                                     {"/scale_break", Json::object()},
                                     {"/scale_break/down/log2", 4},
                                     {"/scale_break/down/errors/policy", "rel:1"},
                                     {"/scale_break/down/from/policy", "rel:1"},
                                     {"/scale_break/down/from/broken", 31},
                                     {"/scale_break/down/from/fixed", 371},
                                     {"/curves/2", tune["curves"][1]},
                                     {"/lane", "x"},
                                     {"/forbid", "nothing"},
                                     {"/max_rate", 0.9},
                                     {"/chosen", "zero"},
                                     {"/chosen", "rel:1"},
                                     {"/confirmed/policy", "rel:1"},
                                     {"/confirmed/fixed", 601},
                                     {"/confirmed/broken", 0},
                                     {"/confirmed/false_negative", 551},
                                     {"/zero_confirmed/fixed", 1},
                                     {"/zero/policy", "rel:1"},
                                     {"/curves/0/points/0/broken", 3},
                                     {"/interactions/0/together/false_negative", 4},
                                     {"/dead", Json::array()},
                                     {"/dead", {"orientation"}},
                                     {"/result", "satisfied"},
                                     {"/result", "too few pairs"},
                                     {"/result", "not confirmed"},
                                     {"/result", "banana"}}) {
    Json other = tune;
    other[Json::json_pointer(place)] = value;
    EXPECT_NE(tune_error(other), "") << place;
  }
  const auto unsealed = [&](const fs::path& choice, Json json, const char* text) {
    fuzz::write_whole(choice, json.dump());
    EXPECT_THROW(make_choices(root_ / "forged"), corpus::FormatError) << choice;
    json = fuzz::sealed(json);
    fuzz::write_whole(choice, json.dump());
    EXPECT_NO_THROW(make_choices(root_ / "forged")) << choice;
    json[Json::json_pointer(text)] = "another text";
    fuzz::write_whole(choice, json.dump());
    EXPECT_THROW(make_choices(root_ / "forged"), corpus::FormatError) << choice;
  };
  unsealed(tune_file, tune, "/sentences/0");
  fs::remove(tune_file);

  analysis::Pareto pareto{"a machine", false, 0, {}, {}};
  pareto.offers = {{"moller_1997/f32/cpu",
                    errors(400, 20, "", 20),
                    analysis::Cost{1, 2, 3},
                    analysis::Cost{2, 3, 4},
                    false,
                    {},
                    {},
                    analysis::Cost{5, 6, 7}},
                   {"exact/f32/cpu",
                    errors(400, 0, "", 0),
                    analysis::Cost{0.5, 1, 1.5},
                    analysis::Cost{2, 3, 4},
                    false,
                    {},
                    {},
                    analysis::Cost{8, 9, 10}}};
  pareto.curves = {
      {"moller_1997/f32/cpu", analysis::Extreme::scale, {{-4, errors(400, 20, "", 20)}, {4, errors(400, 20, "", 20)}}}};
  analysis::mark_dominated(pareto.offers);
  Json traded = {{"pairs", 400}, {"seed", 1}};
  traded.update(pareto_json(pareto));
  const auto pareto_error = [&](const Json& json) {
    return error_of([&] { make_choices(root_ / "forged"); }, pareto_file, json);
  };
  expect_all_refused(traded, {"seed", "log2"}, pareto_error);
  unsealed(pareto_file, traded, "/machine");
  const Json row = traded["lanes"][0];
  for (const auto& [place, value] : {std::pair<const char*, Json>("/lanes/0/bound", 0.01),
                                     {"/pairs", 401},
                                     {"/lanes/0/lane", "x"},
                                     {"/lanes/0/lane", "moller_1997/f32/cpu"},
                                     {"/lanes/0/dominated", true},
                                     {"/lanes/1/dominated", false},
                                     {"/lanes/0/resident", row["in_cache"]},
                                     {"/lanes/0/registers", 3},
                                     {"/lanes/0/in_cache/low", 0},
                                     {"/lanes/2", row},
                                     {"/extremes/0/lane", "guigue_devillers_2003/f32/cpu"},
                                     {"/extremes/0/extreme", "banana"},
                                     {"/extremes/0/says", "as right as at 1"},
                                     {"/extremes/0/points/0/pairs", 399},
                                     {"/extremes/0/points/0/log2", 4},
                                     {"/extremes/1", traded["extremes"][0]}}) {
    Json other = traded;
    other[Json::json_pointer(place)] = value;
    EXPECT_NE(pareto_error(other), "") << place << ' ' << value;
  }
  for (const char* part : {"in_cache", "from_memory", "one_a_call"}) {
    Json other = traded;
    other["lanes"][1].erase(part);
    EXPECT_NE(pareto_error(other), "") << part;
  }
  fs::remove_all(root_ / "forged");
}

// Recomputes the thresholds from their definition in docs/formats.md.
TEST_F(ReportTest, ThresholdsAreWhereTheSummarysErrorsEnd) {
  const Json report = make_report(root_ / "one"), strata = summary("one")["strata"];
  std::string csv;
  for (const CsvTable& table : csv_tables(root_ / "one", report))
    csv += table.name == "thresholds.csv" ? table.text : "";
  int next_to_a_gap = 0, without_errors = 0, none = 0;
  std::size_t rows = 0;
  for (const Json& row : report["thresholds"]) {
    std::vector<std::string> of;
    const Json group = row["group"].is_null() ? Json() : report["groups"][row["group"].get<std::size_t>()];
    for (std::size_t s = 0; s < report["strata"].size(); ++s) {
      const Json& in_group = group.is_null() ? Json() : group["strata"];
      if (row["stratum"].is_null() ? group.is_null() || std::find(in_group.begin(), in_group.end(), s) != in_group.end()
                                   : row["stratum"] == s)
        of.push_back(report["strata"][s]["id"]);
    }
    const std::string lane = report["lanes"][row["lane"].get<std::size_t>()]["id"];
    for (const auto& [side, sign] : {std::pair("disjoint", "+2^"), {"intersects", "-2^"}}) {
      std::map<int, std::pair<std::uint64_t, std::uint64_t>> seen;  // pairs and wrong verdicts by exponent
      for (const std::string& stratum : of) {
        for (const auto& [bucket, found] : strata[stratum]["margins"].items()) {
          if (!bucket.starts_with(sign) || found["pairs"] == 0) continue;
          auto& [pairs, wrong] = seen[std::stoi(bucket.substr(3))];
          pairs += found["pairs"].get<std::uint64_t>();
          wrong += found["wrong"].value(lane, std::uint64_t{0});
        }
      }
      const auto from = [&](int e) {  // pairs and wrong verdicts at margins of at least 2^e
        std::pair<std::uint64_t, std::uint64_t> sum{};
        for (const auto& [exponent, counts] : seen) {
          sum.first += exponent >= e ? counts.first : 0;
          sum.second += exponent >= e ? counts.second : 0;
        }
        return sum;
      };
      std::string expected = ",0,1.0";  // errors up to the largest margin seen, or no pairs
      for (int e = seen.empty() ? 1 : seen.begin()->first; !seen.empty() && e <= seen.rbegin()->first; ++e) {
        if (from(e).second != 0) continue;
        const double bound = 1 - std::pow(0.05, 1.0 / static_cast<double>(from(e).first));
        EXPECT_GE(row[side]["bound"], bound);
        EXPECT_LT(row[side]["bound"], bound * 1.0002);
        expected = fmt::format("{},{},{}", e, from(e).first, row[side]["bound"].dump());
        next_to_a_gap += !seen.contains(e);
        without_errors += e == seen.begin()->first;
        break;
      }
      none += expected == ",0,1.0";
      const std::string line =
          fmt::format("{},{},{},{},{}\n", lane, group.is_null() ? "" : group["id"].get<std::string>(),
                      row["stratum"].is_null() ? "" : of.front(), side, expected);
      EXPECT_TRUE(contains(csv, "\n" + line)) << line;
      ++rows;
    }
  }
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), rows + 1);
  EXPECT_GT(next_to_a_gap, 0);
  EXPECT_GT(without_errors, 0);
  EXPECT_GT(none, 0);
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
  EXPECT_GT(rows["differs.csv"], 100u);
  EXPECT_LT(rows["differs.csv"], rows["margins.csv"]);  // cpu lanes have nothing to be compared with
  EXPECT_GT(rows["rates.csv"], report["rates"].size());
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
