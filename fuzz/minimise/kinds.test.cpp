// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/kinds.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "analysis/explain.h"
#include "core/message_testing.h"
#include "core/relation_of.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/files.h"
#include "fuzz/sealed.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// A small campaign on all strata, and its kinds.
class Kinds : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = fs::temp_directory_path() / ("graze_kinds_" + std::to_string(getpid()));
    fs::remove_all(directory_);
    under_test_ = select_lanes({}, Executor::twin);
    const auto sources = strata::stratum_sources(5, std::size(strata::kStrata) * 30, {"*"});
    run_campaign(campaign_in(directory_, under_test_, sources, 5), std::atomic<bool>{false}, [](const Progress&) {});
    summary_ = Json::parse(read_whole(directory_ / "summary.json"));
    kinds_ = find_kinds(under_test_, directory_, summary_);
  }
  static void TearDownTestSuite() { fs::remove_all(directory_); }

  static Pair pair_of(const Json& row) {
    std::istringstream in("graze-pairs 1\n" + row["pair"].get<std::string>() + "\n");
    return corpus::PairReader(in, "pair").next()->pair;
  }

  static inline fs::path directory_;
  static inline Json summary_, kinds_;
  static inline SelectedLanes under_test_;
};

TEST_F(Kinds, EverySignatureHasOneAndPairsAddUp) {
  ASSERT_GT(kinds_.size(), 15u);
  EXPECT_LT(kinds_.size(), summary_["signatures"].size() / 2);
  std::set<std::size_t> places;
  std::set<std::string> keys;
  for (const Json& kind : kinds_) {
    EXPECT_TRUE(keys.insert(kind["key"]).second) << kind["key"];
    std::uint64_t pairs = 0, margins = 0;
    for (const Json& place : kind["places"]) {
      const Json& row = summary_["signatures"].at(place.get<std::size_t>());
      places.insert(place.get<std::size_t>());
      pairs += row["count"].get<std::uint64_t>();
      EXPECT_NE(row["key"].get<std::string>().find("/" + kind["subject"].get<std::string>() + ":"), std::string::npos);
    }
    for (const auto& [bucket, count] : kind["margins"].items()) margins += count.get<std::uint64_t>();
    EXPECT_EQ(kind["pairs"], pairs);
    EXPECT_EQ(margins, pairs);
    EXPECT_EQ(kind["signatures"], kind["places"].size());
  }
  EXPECT_EQ(places.size(), summary_["signatures"].size());
}

// A kind's key describes its pairs: every lane it names is wrong on them, for the key's cause and at its line.
TEST_F(Kinds, TheirPairsAreOfTheKind) {
  for (const Json& kind : kinds_) {
    for (const char* which : {"simplest", "worst"}) {
      const Pair pair = pair_of(kind[which]);
      const Relation relation = relation_of(pair);
      const Verdict truth = relation.verdict;
      const std::string_view shape = shape_name(relation.hulls, analysis::nesting_of(pair, relation));
      EXPECT_EQ(kind["shape"], shape) << kind["key"];
      std::set<std::string> lanes;
      for (const LaneReason& reason : reasons_of(under_test_, kind["subject"].get<std::string>(), pair, truth)) {
        if (kind_key(kind["subject"].get<std::string>(), reason, shape) == kind["key"].get<std::string>())
          lanes.insert(reason.lane->id);
      }
      EXPECT_FALSE(lanes.empty()) << kind["key"] << ' ' << which;
      for (const std::string& lane : lanes)
        EXPECT_NE(std::find(kind["lanes"].begin(), kind["lanes"].end(), lane), kind["lanes"].end()) << lane;
      if (which == std::string("simplest")) {
        EXPECT_EQ(lanes, kind["simplest"]["lanes"].get<std::set<std::string>>()) << kind["key"];
      }
    }
    ASSERT_FALSE(kind["simplest"]["sentences"].empty());
    const std::string first = kind["simplest"]["sentences"][0];
    const std::string line = kind["line"];
    if (kind["cause"] != "logic" && !line.empty()) {
      EXPECT_NE(first.find(line), std::string::npos) << kind["key"] << first;
    }
    EXPECT_TRUE(first.starts_with(kind["subject"].get<std::string>()));
  }
}

TEST_F(Kinds, AreTheSameWithOneThreadAndAfterStoring) {
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(find_kinds(under_test_, directory_, summary_).dump(), kinds_.dump());
  }
  write_kinds(directory_, under_test_, kinds_);
  EXPECT_EQ(read_kinds(directory_).dump(), kinds_.dump());
  const std::string text = read_whole(directory_ / "summary.json");
  write_whole(directory_ / "summary.json", text + "\n");
  EXPECT_TRUE(read_kinds(directory_).is_null());
  write_whole(directory_ / "summary.json", text);
}

// If a field is missing or has the wrong type, the error names the file.
TEST_F(Kinds, StoredOnesAreWhole) {
  for (const auto& [field, value] : kinds_[0].items()) {
    Json damaged = kinds_;
    damaged[0].erase(field);
    write_kinds(directory_, under_test_, damaged);
    EXPECT_THROW(read_kinds(directory_), corpus::FormatError) << field;
    damaged[0][field] = value.is_object() ? Json(1) : Json::object();
    write_kinds(directory_, under_test_, damaged);
    EXPECT_THROW(read_kinds(directory_), corpus::FormatError) << field;
  }
  fs::remove(directory_ / "failures.json");
}

// All fields that can be computed from the summary and the cases are compared with them.
TEST_F(Kinds, StoredOnesAgreeWithTheCampaign) {
  const fs::path file = directory_ / "failures.json";
  write_kinds(directory_, under_test_, kinds_);
  const Json whole = Json::parse(read_whole(file));
  const auto error_on = [&](const std::string& text) {
    std::ofstream(file) << text;
    return error_of<corpus::FormatError>([&] { read_kinds(directory_); });
  };
  ASSERT_EQ(error_on(whole.dump()), "");
  for (const char* text : {"", "{", "[]", "7", R"({"kinds": []})", R"({"summary": 1, "cases": 2, "kinds": []})"}) {
    const std::string error = error_on(text);
    EXPECT_TRUE(error.starts_with("cannot use " + file.string() + ": it has been changed or damaged")) << text << error;
    EXPECT_TRUE(error.ends_with("; remove it, then run: graze minimize " + directory_.string())) << error;
  }
  const auto refused = [&](const char* place, const Json& value) {
    Json other = whole;
    other[Json::json_pointer(place)] = value;
    EXPECT_NE(error_on(sealed(other).dump()), "") << place << " was accepted as " << value;
  };
  Json other_sentence = whole;
  other_sentence["kinds"][0]["simplest"]["sentences"][0] = "It is right.";
  EXPECT_NE(error_on(other_sentence.dump()).find("its checksum differs"), std::string::npos);
  const std::string damaged = error_on(sealed({{"summary", 1}, {"cases", 2}, {"kinds", Json::array()}}).dump());
  EXPECT_TRUE(damaged.starts_with("cannot use " + file.string() + ": it is damaged; remove it")) << damaged;
  const auto at = [&](const char* place) -> const Json& { return whole.at(Json::json_pointer(place)); };
  const std::uint64_t pairs = at("/kinds/0/pairs");
  const std::string subject = at("/kinds/0/subject");
  refused("/kinds", Json::array());
  Json fewer = whole["kinds"];
  fewer.erase(fewer.begin(), fewer.begin() + 3);
  refused("/kinds", fewer);
  Json reversed = whole["kinds"];
  std::reverse(reversed.begin(), reversed.end());
  refused("/kinds", reversed);
  refused("/lanes", Json::array());
  refused("/lanes", {"moller_1997/f32/cpu", "banana/f32/cpu"});
  refused("/kinds/0/strata", {{"lattice", 99}});
  refused("/kinds/0/strata", Json::object());
  refused("/kinds/0/margins", {{"banana", pairs}});
  refused("/kinds/0/margins", {{"0", pairs}});
  refused("/kinds/0/pairs", pairs + 1);
  refused("/kinds/0/signatures", 1);
  refused("/kinds/0/places", Json::array());
  refused("/kinds/0/places", {whole["kinds"].size() * 1000});
  for (const char* lane : {"x", "", "/", "moller_1997/f32", "exact/f32/cpu"}) refused("/kinds/0/lanes", {lane});
  refused("/kinds/0/lanes", {subject + "/f32/banana"});
  refused("/kinds/0/lanes", Json::array());
  for (std::size_t i = 0; i < whole["kinds"].size(); ++i) {
    const std::uint64_t audited = whole["kinds"][i]["settled"][1];
    if (audited == 0) continue;
    refused(fmt::format("/kinds/{}/settled", i).c_str(), {0, audited - 1});
    break;
  }
  refused("/kinds/0/settled", {1, 1'000'000'000});
  refused("/kinds/0/settled", {1, 2, 3});
  for (const char* part : {"key", "subject", "cause", "line", "shape", "simplest/case", "simplest/pair",
                           "simplest/from", "worst/case", "worst/pair", "worst/from"})
    refused(("/kinds/0/" + std::string(part)).c_str(), "banana");
  refused("/kinds/0/worst/margin_ulps", at("/kinds/0/worst/margin_ulps").get<double>() + 1);
  refused("/kinds/0/simplest/lanes", {"x"});
  refused("/kinds/0/simplest/verdicts", Json::object());
  const std::string lane = at("/kinds/0/simplest/lanes/0");
  for (const Json verdict :
       {"banana", "declined", at("/kinds/0/simplest/verdicts")[lane] == "disjoint" ? "intersects" : "disjoint"}) {
    Json verdicts = at("/kinds/0/simplest/verdicts");
    verdicts[lane] = verdict;
    refused("/kinds/0/simplest/verdicts", verdicts);
  }
  for (std::size_t i = 0; i < whole["kinds"].size(); i += 7) {
    Json other = whole["kinds"];
    other.erase(i);
    refused("/kinds", other);
  }
  Json twice = whole["kinds"];
  twice.push_back(twice[0]);
  refused("/kinds", twice);
  fs::remove(file);
}

// If kinds were found with only some lanes, the failures of the others are still counted.
TEST_F(Kinds, SignaturesWithoutAKindAreCounted) {
  EXPECT_EQ(signatures_without_kind(summary_, kinds_), 0u);
  EXPECT_EQ(signatures_without_kind(summary_, Json::array()), summary_["signatures"].size());
  const SelectedLanes some = select_lanes({"moller_1997/*"}, Executor::twin);
  const Json kinds = find_kinds(some, directory_, summary_);
  write_kinds(directory_, some, kinds);
  EXPECT_EQ(read_kinds(directory_), kinds);
  EXPECT_GT(signatures_without_kind(summary_, kinds), 0u);
  EXPECT_LT(signatures_without_kind(summary_, kinds), summary_["signatures"].size());
  fs::remove(directory_ / "failures.json");
}

TEST_F(Kinds, StopWhenAsked) {
  EXPECT_TRUE(find_kinds(under_test_, directory_, summary_, [] { return true; }).is_null());
}

TEST_F(Kinds, ShapesHaveNames) {
  EXPECT_EQ(shape_name({2, 2, false}), "general");
  EXPECT_EQ(shape_name({2, 2, true}), "coplanar");
  EXPECT_EQ(shape_name({2, 2, true}, Nesting::b_in_a), "contained");
  EXPECT_EQ(shape_name({2, 2, false}, Nesting::b_in_a), "general");
  EXPECT_EQ(shape_name({1, 2, true}, Nesting::a_in_b), "degenerate");
  EXPECT_EQ(shape_name({1, 2, true}), "degenerate");
}

}  // namespace
}  // namespace graze::fuzz
