// SPDX-License-Identifier: Apache-2.0
// Tests the guarantees of campaigns: the same bytes for any number of threads and interruptions, and no lost results.
#include "fuzz/campaign/campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>

#include "core/error.h"
#include "core/message_testing.h"
#include "corpus/pair_format.h"
#include "cuda/twin/twin.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/changed_verdicts.h"
#include "fuzz/campaign/checked_summary.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

class CampaignTest : public CampaignFiles {
 protected:
  Campaign campaign(const std::string& name, int threads, std::uint64_t pairs = 200'000) const {
    Campaign c = campaign_of(
        under_test_, strata::stratum_sources(3, pairs, {"near_edge_edge", "degenerate", "extreme_scale"}), 3, name);
    c.threads = threads;
    return c;
  }

  SelectedLanes under_test_ = select_lanes({"*/f32/*"}, Executor::twin);
};

TEST_F(CampaignTest, SameBytesForOneThreadAndMany) {
  run(campaign("one", 1));
  run(campaign("many", 4));
  EXPECT_EQ(lasting_files(root_ / "one"), lasting_files(root_ / "many"));
}

// A lane's code changes between two campaigns on the same pairs. Only the strata on which a verdict changed are
// reported as changed. The bounds on the number of changes hold for any number of threads and any judge.
TEST_F(CampaignTest, ChangedVerdictsShowInDigests) {
  const SelectedLanes one = select_lanes({"moller_1997/f32/cpu", "exact/f32/cpu"}),
                      other = select_lanes({"guigue_devillers_2003/f32/cpu"});
  SelectedLanes changed_lanes = select_lanes({"moller_1997/f32/cpu", "exact/f32/cpu"});
  Lane edited = *one.lanes[0];
  edited.decide = other.lanes[0]->decide;
  changed_lanes.lanes[0] = &edited;
  changed_lanes.on_host[0] = other.on_host[0];
  const std::vector<strata::PairSource> sources =
      strata::stratum_sources(3, 9'000, {"uniform", "degenerate", "lattice"});
  Campaign before = campaign_of(one, sources, 3, "before"), after = campaign_of(changed_lanes, sources, 3, "after"),
           again = campaign_of(one, sources, 3, "again");
  again.threads = 1;
  again.exact = find_lane("exact/f32/cpu")->decide;
  for (const Campaign* c : {&before, &after, &again}) run(*c);
  for (const ChangedVerdicts& row : changed_verdicts(before.directory, again.directory)) {
    EXPECT_EQ(row.known, ChangedVerdicts::Known::same);
    EXPECT_EQ(row.pairs, 3'000u);
  }
  const std::vector<ChangedVerdicts> found = changed_verdicts(before.directory, after.directory);
  ASSERT_EQ(found.size(), 2 * sources.size());
  std::uint64_t all = 0;
  for (std::size_t row = 0; row < found.size(); ++row) {
    const strata::PairSource& source = sources[row % sources.size()];
    std::uint64_t differs = 0;
    for (std::uint64_t i = 0; i < source.pairs && row < sources.size(); ++i)
      differs += decide_one(one.lanes[0]->decide, source.pair(i)) != decide_one(edited.decide, source.pair(i));
    EXPECT_EQ(found[row].known == ChangedVerdicts::Known::changed, differs > 0)
        << found[row].lane << found[row].stratum;
    EXPECT_LE(found[row].least, differs);
    EXPECT_GE(found[row].most, differs);
    all += differs;
  }
  EXPECT_GT(all, 0u);
}

TEST_F(CampaignTest, SameBytesWhenInterruptedAfterEveryBatch) {
  run(campaign("whole", 2));
  EXPECT_EQ(run_in_parts(campaign("parts", 2)), 3 * 3);  // for each source: a few pairs, a batch, and the rest
  EXPECT_EQ(lasting_files(root_ / "parts"), lasting_files(root_ / "whole"));
}

TEST_F(CampaignTest, CountsEveryPairAndStoresCasesThatAreDisagreements) {
  const Json summary = run(campaign("counts", 2));
  std::uint64_t pairs = 0, in_margins = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) {
    pairs += row["pairs"].get<std::uint64_t>();
    for (const auto& [bucket, counts] : row["margins"].items()) in_margins += counts["pairs"].get<std::uint64_t>();
  }
  EXPECT_EQ(pairs, 200'000u);
  EXPECT_EQ(in_margins, pairs);
  const Json oracle = Json::parse(read_whole(root_ / "counts" / "timings.json"))["oracle"];
  EXPECT_EQ(oracle["cgal"], pairs);
  ASSERT_FALSE(summary["signatures"].empty());
  std::uint64_t failures = 0;
  for (const auto& row : summary["signatures"]) {
    failures += row["count"].get<std::uint64_t>();
    const auto cases = corpus::read_pairs(root_ / "counts" / row["case"].get<std::string>());
    ASSERT_FALSE(cases.empty());
    EXPECT_LE(cases.size(), kKeptCases);
    EXPECT_LE(cases.size(), row["count"].get<std::uint64_t>());
    EXPECT_EQ(*field(cases[0], "signature"), row["key"].get<std::string>());
  }
  const std::uint64_t disagreements = summary["disagreements"];
  EXPECT_GE(failures, disagreements);  // one signature for each failing algorithm
  std::uint64_t sampled = 0;           // pairs in GMP's sample on which every lane is right
  for (const strata::PairSource& source : campaign("counts", 2).sources) {
    for (std::uint64_t index = 0; index < source.pairs; index += 1024) {
      const Pair pair = source.pair(index);
      const Verdict right = oracle::cgal_verdict(pair);
      std::vector<const Lane*> apart;
      const std::vector<Verdict> verdicts = decide(under_test_, pair, apart);
      sampled += std::all_of(verdicts.begin(), verdicts.end(), [right](Verdict verdict) { return verdict == right; });
    }
  }
  EXPECT_EQ(oracle["gmp"].get<std::uint64_t>(), disagreements + sampled);
}

TEST_F(CampaignTest, CountsExtremesWhereAStratumVariesThem) {
  Campaign c = campaign("extremes", 2);
  c.sources = strata::stratum_sources(c.seed, 8000, {"extreme_scale", "far_from_origin", "degenerate"});
  c.spec = campaign_spec(c);
  const Json strata = run(c)["strata"];
  EXPECT_FALSE(strata["degenerate"].contains("extremes"));
  for (const strata::PairSource& source : c.sources) {
    if (source.axis == Axis::none) continue;
    std::map<std::string, std::map<std::string, std::uint64_t>> expected;
    for (std::uint64_t index = 0; index < source.pairs; ++index) {
      const Pair pair = source.pair(index);
      const bool truth = oracle::cgal_verdict(pair) == Verdict::intersects;
      auto& cell = expected[std::to_string(exponent_of(source.axis, place_on_axis(pair, source.axis)))];
      ++cell["pairs"];
      for (std::size_t l = 0; l < under_test_.lanes.size(); ++l) {
        std::uint64_t intersects = 0, declined = 0;
        under_test_.on_host[l](&pair, 1, &intersects, &declined);
        if (!declined && (intersects != 0) != truth) ++cell[under_test_.lanes[l]->id];
      }
    }
    const Json& extremes = strata[source.id]["extremes"];
    ASSERT_EQ(extremes.size(), 1u);
    std::map<std::string, std::map<std::string, std::uint64_t>> found;
    for (const auto& [exponent, counts] : extremes[std::string(name(source.axis))].items()) {
      for (const auto& [lane, wrong] : counts["wrong"].items()) found[exponent][lane] = wrong;
      found[exponent]["pairs"] = counts["pairs"];
    }
    EXPECT_EQ(found, expected) << source.id;
    EXPECT_GT(found.size(), 15u) << source.id;
  }
}

// Decides each pair again, and counts in each margin bucket the verdicts that differ from the cpu lane's.
TEST_F(CampaignTest, CountsDifferencesFromCpuByMargin) {
  Campaign c = campaign("differ", 2);
  c.sources = strata::stratum_sources(c.seed, 4000, {"near_edge_edge", "thesis"});
  c.spec = campaign_spec(c);
  const Json strata = run(c)["strata"];
  const std::vector<int> twins = analysis::cpu_twins(under_test_.lanes);
  std::uint64_t differ = 0;
  for (const strata::PairSource& source : c.sources) {
    std::map<std::string, std::map<std::string, std::uint64_t>> expected, found;
    for (std::uint64_t index = 0; index < source.pairs; ++index) {
      const Pair pair = source.pair(index);
      std::vector<const Lane*> apart;
      const std::vector<Verdict> verdicts = decide(under_test_, pair, apart);
      const std::string bucket = name_of_bucket(oracle::margin_bucket(pair, oracle::cgal_verdict(pair)));
      for (std::size_t l = 0; l < twins.size(); ++l) {
        if (twins[l] < 0 || verdicts[l] == verdicts[static_cast<std::size_t>(twins[l])]) continue;
        ++expected[bucket][under_test_.lanes[l]->id];
        ++differ;
      }
    }
    for (const auto& [bucket, row] : strata[source.id]["margins"].items()) {
      for (const auto& [lane, count] : row["differs_from_cpu"].items()) found[bucket][lane] = count;
    }
    EXPECT_EQ(found, expected) << source.id;
  }
  EXPECT_GT(differ, 500u);
}

// Without a database, a summary whose counts by margin do not add up is rejected.
TEST_F(CampaignTest, RefusesDifferencesFromCpuThatDoNotAddUp) {
  Campaign c = campaign("alone", 2, 3000);
  const Json summary = run(c);
  fs::remove(root_ / "alone" / "campaign.sqlite");
  EXPECT_EQ(checked_summary(root_ / "alone"), summary);
  const auto refused = [&](const Json& other) {
    write_whole(root_ / "alone" / "summary.json", other.dump(1) + "\n");
    return error_of([&] { checked_summary(root_ / "alone"); });
  };
  int tried = 0;
  for (const auto& [part, by] : {std::pair("margins", "by margin"), {"extremes", "by scale"}}) {
    Json other = summary;
    Json& rows = part == std::string_view("margins") ? other["strata"]["near_edge_edge"][part]
                                                     : other["strata"]["extreme_scale"][part]["scale"];
    for (Json& row : rows) {
      if (row["differs_from_cpu"].empty() || row["pairs"] == row["differs_from_cpu"].front()) continue;
      row["differs_from_cpu"].front() = row["differs_from_cpu"].front().get<std::uint64_t>() + 1;
      const std::string said = refused(other);
      EXPECT_NE(said.find("verdicts that differ from cpu"), std::string::npos) << said;
      EXPECT_NE(said.find(by), std::string::npos) << said;
      ++tried;
      break;
    }
  }
  EXPECT_EQ(tried, 2);
}

TEST_F(CampaignTest, RefusesADirectoryOfAnotherCampaign) {
  run(campaign("taken", 1, 4000));
  const std::string before = read_whole(root_ / "taken" / "summary.json");
  EXPECT_THROW(run(campaign("taken", 1, 5000)), UsageError);
  EXPECT_EQ(read_whole(root_ / "taken" / "summary.json"), before);
  // Another build cannot resume a campaign: commit, build type and flags must be the same.
  for (const char* key : {"commit", "type", "flags"}) {
    Campaign other = campaign("taken", 1, 4000);
    EXPECT_FALSE(other.build[key].get<std::string>().empty()) << key;
    other.build[key] = "another";
    EXPECT_THROW(run(other), UsageError) << key;
  }
}

TEST_F(CampaignTest, RefusesForeignAndDamagedDatabases) {
  fs::create_directories(root_ / "foreign");
  std::ofstream(root_ / "foreign" / "campaign.sqlite")
      << "This is not a database, but long enough to be read as one: " << std::string(4096, 'x');
  EXPECT_THROW(run(campaign("foreign", 1, 4000)), std::runtime_error);

  {
    fs::create_directories(root_ / "other");
    SQLite::Database other((root_ / "other" / "campaign.sqlite").string(),
                           SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    other.exec("CREATE TABLE t(x)");
  }
  EXPECT_THROW(run(campaign("other", 1, 4000)), std::runtime_error);

  run(campaign("cut", 1, 4000));
  const fs::path file = root_ / "cut" / "campaign.sqlite";
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_THROW(run(campaign("cut", 1, 4000)), std::runtime_error);
}

// A device that agrees with its twin except on the eighth pair of every block.
class WrongOnce final : public cuda::Device {
 public:
  void decide(std::span<const Pair> pairs, std::span<const Lane* const> cuda_lanes, std::vector<VerdictBits>& bits,
              std::span<const DoublePair>) override {
    bits.assign(cuda_lanes.size(),
                {analysis::Bits((pairs.size() + 63) / 64), analysis::Bits((pairs.size() + 63) / 64)});
    for (std::size_t l = 0; l < cuda_lanes.size(); ++l) {
      const Lane& lane = *cuda_lanes[l];
      cuda::twin_row(lane).decide(pairs.data(), pairs.size(), bits[l].intersects.data(), bits[l].declined.data());
      bits[l].intersects[0] ^= 1u << 7;
    }
    flipped.push_back(pairs[7]);
  }

  std::vector<Pair> flipped;
};

TEST(BlockVerdicts, AreTheDevicesWhereItDecidesAndNameWhereTheTwinDiffers) {
  SelectedLanes under_test = select_lanes({"moller_1997/f32/cpu", "moller_1997/f32/cuda-fma"}, Executor::twin);
  ASSERT_EQ(under_test.lanes.size(), 2u);
  under_test.device = std::make_unique<WrongOnce>();
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < 200; ++i) pairs.push_back(strata::generate(1, strata::Stratum::near_edge_edge, i));
  std::vector<VerdictBits> on_device;
  under_test.device->decide(pairs, under_test.device_lanes(), on_device);
  on_device[0].intersects[1] ^= 1u << 3;  // pair 67
  BlockVerdicts block(under_test);
  for (const std::size_t begin : {std::size_t{0}, std::size_t{64}}) {
    const std::span<const Pair> some = std::span(pairs).subspan(begin, 100);
    std::vector<std::size_t> apart;
    const std::span<const LaneVerdicts> found = block.decide(some, on_device, begin, [&](std::size_t l, std::size_t i) {
      EXPECT_EQ(l, 1u);
      apart.push_back(begin + i);
    });
    EXPECT_EQ(apart, begin == 0 ? (std::vector<std::size_t>{7, 67}) : (std::vector<std::size_t>{67}));
    for (std::size_t i = 0; i < some.size(); ++i) {
      EXPECT_EQ(found[0].at(i), decide_one(under_test.lanes[0]->decide, some[i])) << i;
      const bool differs = std::find(apart.begin(), apart.end(), begin + i) != apart.end();
      EXPECT_EQ(found[1].at(i) != decide_one(under_test.on_host[1], some[i]), differs) << i;
    }
  }
}

TEST_F(CampaignTest, ReportsEachDifferenceOfDeviceAndTwin) {
  under_test_ = select_lanes({"moller_1997/f32/cuda-fma"}, Executor::twin);
  auto device = std::make_unique<WrongOnce>();
  const std::vector<Pair>& flipped = device->flipped;
  under_test_.device = std::move(device);
  const Json summary = run(campaign("apart", 2, 4000));
  ASSERT_EQ(summary["executor_mismatches"].size(), 1u);
  const Json& apart = summary["executor_mismatches"][0];
  EXPECT_EQ(apart["lane"], "moller_1997/f32/cuda-fma");
  EXPECT_EQ(apart["count"], 3);  // one pair in each stratum
  const auto cases = corpus::read_pairs(root_ / "apart" / apart["case"].get<std::string>());
  EXPECT_TRUE(std::any_of(flipped.begin(), flipped.end(),
                          [&](const Pair& pair) { return std::memcmp(&pair, &cases.at(0).pair, sizeof pair) == 0; }));
  EXPECT_EQ(under_test_.evidence(0).substr(0, 15), "device and twin");
}

TEST(PairSource, SharesPairsEvenlyAndRefusesUnknownStrata) {
  const auto sources = strata::stratum_sources(1, 10, {"near_*"});
  ASSERT_EQ(sources.size(), 4u);
  EXPECT_EQ(sources[0].pairs, 3u);
  EXPECT_EQ(sources[3].pairs, 2u);
  EXPECT_THROW(strata::stratum_sources(1, 10, {"nearly_*"}), UsageError);
  EXPECT_THROW(strata::stratum_sources(1, 10, {"!*"}), UsageError);
  EXPECT_THROW(strata::stratum_sources(1, 10, {"near_*", "!near_*"}), UsageError);
}

TEST(SignatureCount, KeepsTheSmallestCasesInWhateverOrderTheyCome) {
  SignatureCount forwards, backwards;
  for (std::uint64_t i = 0; i < 9; ++i) {
    forwards.add(CaseKey{i, 0});
    backwards.add(CaseKey{8 - i, 0});
  }
  EXPECT_EQ(forwards.count, 9u);
  EXPECT_EQ(forwards.cases, backwards.cases);
  EXPECT_EQ(forwards.cases.size(), kKeptCases);
  EXPECT_EQ(forwards.cases[3].index, 3u);
}

}  // namespace
}  // namespace graze::fuzz
