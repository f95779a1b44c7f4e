// SPDX-License-Identifier: Apache-2.0
// Campaigns on pairs of doubles: double-precision lanes decide the doubles, and single-precision lanes decide the pairs
// rounded to float32. Counts must match verdicts decided singly, and the bytes must not depend on how the campaign ran.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "core/lanes/verdicts.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/shards/merge.h"
#include "oracle/truth.h"

namespace graze::fuzz {
namespace {

class CampaignOfDoubles : public CampaignFiles {
 protected:
  CampaignOfDoubles() { select_for_doubles(lanes_); }

  Campaign campaign(const std::string& name, std::uint64_t pairs, const std::vector<std::string>& strata = {},
                    PairTypes types = PairTypes::f64) const {
    return campaign_of(lanes_, strata::stratum_sources(5, pairs, strata, types), 5, name);
  }

  SelectedLanes lanes_ = select_lanes({}, Executor::twin);
};

// The summary's margins are the same as GMP's, although most large ones are found from the pairs rounded to float32.
TEST_F(CampaignOfDoubles, MarginsAreTheOracles) {
  const Campaign c = campaign("margins", 28 * 200);
  const Json strata = run(c)["strata"];
  for (const strata::PairSource& source : c.sources) {
    std::map<std::string, std::uint64_t> expected, found;
    for (std::uint64_t index = 0; index < source.pairs; ++index) {
      const DoublePair pair = source.double_pair(index);
      ++expected[name_of_bucket(oracle::margin_bucket(pair, oracle::cgal_verdict(pair)))];
    }
    for (const auto& [bucket, row] : strata[source.id]["margins"].items()) found[bucket] = row["pairs"];
    EXPECT_EQ(found, expected) << source.id;
  }
}

struct Expected {
  std::uint64_t false_positive = 0, false_negative = 0, declined = 0, stored = 0;
};

TEST_F(CampaignOfDoubles, CountsAreThoseOfEachPairAlone) {
  const Campaign c = campaign("counts", 28 * 150);
  const Json strata = run(c)["strata"];
  ASSERT_EQ(strata.size(), 28u);
  std::uint64_t stored = 0, computed = 0, wrong_in_double = 0;
  for (const strata::PairSource& source : c.sources) {
    std::vector<Expected> expected(lanes_.lanes.size());
    for (std::uint64_t index = 0; index < source.pairs; ++index) {
      const DoublePair pair = source.double_pair(index);
      const Pair in_float32 = stored_in_float32(pair);
      const Verdict truth = oracle::truth(pair).verdict;
      for (std::size_t l = 0; l < lanes_.lanes.size(); ++l) {
        const Lane& lane = *lanes_.lanes[l];
        const bool in_double = lane.scalar == Scalar::f64;
        const Verdict verdict =
            in_double ? decide_one(lanes_.on_host[l], pair) : decide_one(lanes_.on_host[l], in_float32);
        if (verdict == truth) continue;
        Expected& of = expected[l];
        ++(verdict == Verdict::declined     ? of.declined
           : verdict == Verdict::intersects ? of.false_positive
                                            : of.false_negative);
        if (verdict == Verdict::declined) continue;
        const bool by_storing = !in_double && (!is_finite(in_float32) || oracle::truth(in_float32).verdict == verdict);
        of.stored += by_storing;
        (in_double ? wrong_in_double : by_storing ? stored : computed) += 1;
      }
    }
    for (std::size_t l = 0; l < lanes_.lanes.size(); ++l) {
      const Json& row = strata[source.id]["lanes"][lanes_.lanes[l]->id];
      const std::string where = source.id + ' ' + lanes_.lanes[l]->id;
      EXPECT_EQ(row["false_positive"], expected[l].false_positive) << where;
      EXPECT_EQ(row["false_negative"], expected[l].false_negative) << where;
      EXPECT_EQ(row["declined"], expected[l].declined) << where;
      EXPECT_EQ(row.contains("stored"), lanes_.lanes[l]->scalar == Scalar::f32) << where;
      EXPECT_EQ(row.value("stored", std::uint64_t{0}), expected[l].stored) << where;
    }
    EXPECT_EQ(strata[source.id]["lanes"]["exact/f64/cpu"]["false_positive"], 0);
    // The exact lane in float32 is wrong only where storing the doubles changes the verdict.
    const Json& exact = strata[source.id]["lanes"]["exact/f32/cpu"];
    EXPECT_EQ(exact["stored"], exact["false_positive"].get<int>() + exact["false_negative"].get<int>()) << source.id;
  }
  EXPECT_GT(stored, 1000u);
  EXPECT_GT(computed, 1000u);
  EXPECT_GT(wrong_in_double, 1000u);
}

TEST_F(CampaignOfDoubles, LanesAreThoseThatTakeThem) {
  const auto has = [](const auto& rows, const std::string& id) {
    return std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
      if constexpr (std::is_pointer_v<std::decay_t<decltype(row)>>) {
        return row->id == id;
      } else {
        return row.id == id;
      }
    });
  };
  EXPECT_TRUE(has(lanes_.lanes, "exact/f64/cpu"));
  EXPECT_TRUE(has(lanes_.lanes, "moller_1997/f32/cuda-fma"));  // decides the pairs rounded to float32
  EXPECT_TRUE(has(lanes_.lanes, "moller_1997/f64/cuda-fma"));
  EXPECT_TRUE(has(lanes_.lanes, "exact/f64/cuda"));
  EXPECT_TRUE(lanes_.left_out.empty());
  SelectedLanes tolerant = select_lanes({"moller_1997/f64/*/abs:1e-6"}, Executor::twin);
  EXPECT_TRUE(select_for_doubles(tolerant).empty());
  EXPECT_TRUE(has(tolerant.lanes, "moller_1997/f64/cuda-fma/abs:1e-6"));
  EXPECT_TRUE(has(tolerant.lanes, "moller_1997/f64/cpu/abs:1e-6"));
  for (const char* exact : {"exact/f64/cpu", "exact/f64/cuda"}) {
    EXPECT_FALSE(has(select_lanes({"exact/*"}, Executor::twin).lanes, exact));  // not selected for float32 pairs
    EXPECT_TRUE(has(select_lanes({exact}, Executor::twin).lanes, exact));
  }
}

// With both coordinate types in one campaign, the float32 strata give the same results as in a separate campaign.
TEST_F(CampaignOfDoubles, LeavesTheSameBytesHoweverItRan) {
  const std::vector<std::string> strata = {"near_edge_edge", "extreme_scale", "stored", "degenerate"};
  const Json whole = run(campaign("whole", 7003, strata, PairTypes::both));
  ASSERT_EQ(whole["strata"].size(), 7u);
  run_in_parts(campaign("parts", 7003, strata, PairTypes::both));
  expect_same_bytes("whole", "parts");
  Campaign exact = campaign("exact", 7003, strata, PairTypes::both);
  exact.exact = find_lane(kExactDoubles)->decide;
  run(exact);
  expect_same_bytes("whole", "exact");
  std::vector<std::filesystem::path> shards;
  for (std::uint64_t k = 1; k <= 3; ++k) {
    Campaign shard = campaign("shard" + std::to_string(k), 7003, strata, PairTypes::both);
    shard.shard = {k, 3};
    run(shard);
    shards.push_back(shard.directory);
  }
  merge({shards, root_ / "merged", false});
  expect_same_bytes("whole", "merged");
  Campaign floats = campaign("floats", 3002, {"near_edge_edge", "extreme_scale", "degenerate"}, PairTypes::f32);
  const Json alone = run(floats)["strata"];
  EXPECT_EQ(alone.size(), 3u);
  EXPECT_FALSE(alone["near_edge_edge"]["lanes"]["moller_1997/f32/cpu"].contains("stored"));
}

TEST_F(CampaignOfDoubles, RecordsAreReadBackAndChecked) {
  const Json summary = run(campaign("records", 900, {"near_vertex_face", "extreme_scale"}));
  const std::filesystem::path directory = root_ / "records";
  EXPECT_EQ(checked_summary(directory), summary);
  ASSERT_GT(summary["signatures"].size(), 10u);
  for (const Json& row : summary["signatures"]) {
    for (const corpus::Entry& entry : read_cases(directory, summary["spec"], row)) ASSERT_TRUE(entry.doubles);
  }
  const std::vector<strata::PairSource> again = recorded_sources(summary["spec"]);
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0].id, "near_vertex_face/f64");
  const DoublePair one = again[1].double_pair(7),
                   other = campaign("x", 900, {"extreme_scale"}).sources[0].double_pair(7);
  EXPECT_TRUE(std::equal(coordinates(one), coordinates(one) + kCoordinates, coordinates(other)));
  const std::vector<std::string> words = command_words(summary["spec"], {}, "o", summary);
  EXPECT_NE(std::find(words.begin(), words.end(), "--coordinates"), words.end());
  // After one hex digit of a case is changed, it is no longer the pair that the stratum draws.
  const std::filesystem::path file = directory / summary["signatures"][0]["case"].get<std::string>();
  std::string text = read_whole(file);
  const std::size_t at = text.find("p", text.find("0x1.")) - 1;
  text[at] = text[at] == '4' ? '5' : '4';
  write_whole(file, text);
  EXPECT_THROW(read_cases(directory, summary["spec"], summary["signatures"][0]), corpus::FormatError);
  // A summary is rejected if an exact lane has errors that rounding to float32 does not cause, or if it counts more
  // errors from this rounding than errors in all.
  std::filesystem::remove(directory / kDatabase);
  EXPECT_EQ(checked_summary(directory), summary);  // even without a database
  for (const char* lane : {"exact/f32/cpu", "exact/f64/cpu"}) {
    Json wrong = summary;
    Json& row = wrong["strata"]["near_vertex_face/f64"];
    row["lanes"][lane]["false_positive"] = row["lanes"][lane]["false_positive"].get<int>() + 1;
    for (auto& [name, margin] : row["margins"].items()) {
      if (!name.starts_with('+')) continue;
      margin["wrong"][lane] = margin["wrong"].value(lane, 0) + 1;
      break;
    }
    write_whole(directory / "summary.json", wrong.dump(1) + '\n');
    EXPECT_THROW(checked_summary(directory), std::runtime_error) << lane;
  }
  Json edited = summary;
  edited["strata"]["near_vertex_face/f64"]["lanes"]["moller_1997/f32/cpu"]["stored"] = 451;
  write_whole(directory / "summary.json", edited.dump(1) + '\n');
  EXPECT_THROW(checked_summary(directory), std::runtime_error);
}

TEST_F(CampaignOfDoubles, PatternsMatchNamesWithAndWithoutTheType) {
  const auto ids = [](const std::vector<std::string>& globs, PairTypes types) {
    std::vector<std::string> found;
    for (const strata::PairSource& source : strata::stratum_sources(1, 100, globs, types)) found.push_back(source.id);
    return found;
  };
  using Ids = std::vector<std::string>;
  EXPECT_EQ(ids({"uniform"}, PairTypes::f32), Ids{"uniform"});
  EXPECT_EQ(ids({"uniform"}, PairTypes::f64), Ids{"uniform/f64"});
  EXPECT_EQ(ids({"uniform"}, PairTypes::both), (Ids{"uniform", "uniform/f64"}));
  EXPECT_EQ(ids({"uniform/f64"}, PairTypes::both), Ids{"uniform/f64"});
  EXPECT_EQ(ids({"uniform", "!*/f64"}, PairTypes::both), Ids{"uniform"});
  EXPECT_EQ(ids({}, PairTypes::both).size(), 49u);
  EXPECT_THROW(ids({"stored"}, PairTypes::f32), UsageError);
  EXPECT_THROW(ids({"uniform/f64"}, PairTypes::f32), UsageError);
  EXPECT_EQ(strata::named_sources(1, 5, {"uniform", "uniform/f64"}).size(), 2u);
  EXPECT_THROW(strata::named_sources(1, 5, {"stored"}), UsageError);
  EXPECT_THROW(strata::expect_float32(strata::named_sources(1, 5, {"stored/f64"}), "tune"), UsageError);
}

}  // namespace
}  // namespace graze::fuzz
