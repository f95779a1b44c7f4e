// SPDX-License-Identifier: Apache-2.0
// Tests guided search. The bytes are the same for any number of threads and interruptions, kept pairs match their
// records, and each mutation makes the change that it is named after.
#include "fuzz/hunt/hunt.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/message_testing.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/hunt/feedback.h"
#include "fuzz/hunt/hunt_rounds.h"
#include "fuzz/hunt/round.h"
#include "fuzz/hunt/round_bytes.h"
#include "fuzz/shards/merge.h"
#include "strata/scene/envelope.h"
#include "strata/scene/sources.h"

namespace graze::fuzz {
namespace {

template <class Real>
int shared_vertices(const BasicPair<Real>& pair) {
  return static_cast<int>(std::count_if(std::begin(pair.a), std::end(pair.a), [&](const Vec3<Real>& u) {
    return std::find(std::begin(pair.b), std::end(pair.b), u) != std::end(pair.b);
  }));
}

template <class Draws>
class Mutations : public testing::Test {
 protected:
  using Pair = DrawnPair<Draws>;

  static Pair drawn(std::uint64_t seed, strata::Stratum stratum, std::uint64_t index) {
    if constexpr (std::is_same_v<Draws, strata::Draws>) {
      return strata::generate(seed, stratum, index);
    } else {
      return strata::generate_doubles(seed, stratum, index);
    }
  }

  // Mutates pairs of the stratum and counts those for which holds(before, after) is true.
  template <class Holds>
  static int count_after(Mutation mutation, Holds holds, strata::Stratum stratum = strata::Stratum::uniform) {
    int count = 0;
    for (std::uint64_t i = 0; i < 200; ++i) {
      Draws draws(1, 1000, i);
      const Pair pair = drawn(1, stratum, i), other = drawn(2, stratum, i);
      count += holds(pair, mutated(mutation, pair, other, draws));
    }
    return count;
  }
};
using EitherType = testing::Types<strata::Draws, strata::DoubleDraws>;
TYPED_TEST_SUITE(Mutations, EitherType);

TYPED_TEST(Mutations, EachChangesThePairAndAFreshOneIsOfASource) {
  using Own = DrawnPair<TypeParam>;
  for (int m = 1; m < kMutationCount; ++m) {
    const int changed = this->count_after(static_cast<Mutation>(m), [](const Own& before, const Own& after) {
      return std::memcmp(&before, &after, sizeof before) != 0;
    });
    EXPECT_GT(changed, 100) << kMutationIds[static_cast<std::size_t>(m)];
  }
  const bool in_doubles = sizeof(Own) == sizeof(DoublePair);
  const Drawn drawn{strata::stratum_sources(1, 10, {in_doubles ? "lattice_15" : "lattice"},
                                            in_doubles ? PairTypes::f64 : PairTypes::f32),
                    nullptr};
  EXPECT_EQ(drawn.in_doubles(), in_doubles);
  TypeParam draws(1, 1000, 1);
  const Own pair = fresh_pair(drawn, draws);
  for (int i = 0; i < kCoordinates; ++i) EXPECT_EQ(coordinates(pair)[i], std::nearbyint(coordinates(pair)[i]));
}

TYPED_TEST(Mutations, DoWhatTheyAreNamedAfter) {
  using Own = DrawnPair<TypeParam>;
  const auto shares = [](int vertices) {
    return [vertices](const Own&, const Own& after) { return shared_vertices(after) == vertices; };
  };
  EXPECT_EQ(this->count_after(Mutation::onto_vertex, shares(1)), 200);
  EXPECT_EQ(this->count_after(Mutation::shared_edge, shares(2)), 200);
  const auto flat = [](const Own&, const Own& after) { return oracle::hulls(after).coplanar; };
  EXPECT_EQ(this->count_after(Mutation::coplanar,
                              [](const Own&, const Own& after) {
                                return oracle::cgal_verdict(after) == Verdict::intersects &&
                                       oracle::margin_bucket(after, Verdict::intersects) < make_bucket(-1, 7);
                              }),
            0)
      << "pairs deeper than 2^8 ulps are far from a common plane";
  const auto of_whole_numbers =
      sizeof(Own) == sizeof(DoublePair) ? strata::Stratum::lattice_15 : strata::Stratum::lattice;
  EXPECT_GT(this->count_after(Mutation::coplanar, flat, of_whole_numbers), 10);
  const auto degenerate = [](const Own&, const Own& after) {
    const Hulls hulls = oracle::hulls(after);
    return std::min(hulls.dimension_a, hulls.dimension_b) < 2;
  };
  EXPECT_GT(this->count_after(Mutation::collinear, degenerate), 30);
  EXPECT_EQ(this->count_after(Mutation::reordered,
                              [](const Own& before, const Own& after) {
                                return oracle::cgal_verdict(before) == oracle::cgal_verdict(after);
                              }),
            200);
  EXPECT_EQ(this->count_after(Mutation::ulps,
                              [](const Own& before, const Own& after) {
                                int changed = 0;
                                for (int i = 0; i < kCoordinates; ++i)
                                  changed += coordinates(before)[i] != coordinates(after)[i];
                                return changed >= 1 && changed <= 3;
                              }),
            200);
}

// Checks mutations in a scene around `origin` on a grid of 2^-6.   type: the line with the coordinate type.
template <class Draws>
void expect_within_the_scene(const std::string& type, double origin) {
  using Real = typename Draws::Real;
  const strata::SceneFile file = strata::parse_scene(
      "scene.toml",
      fmt::format("{}extent = [[{}, {}], [0, 8], [1, 2]]\nedges = [0.5, 2]\ngrid = {{ power_of_two = -6 }}\n", type,
                  origin - 4, origin + 4));
  const strata::Scene scene = strata::resolved(file);
  const Drawn drawn{strata::scene_sources(file, "", 1, 10, {"uniform"}).sources, &scene};
  int mutations = 0;
  Draws first(1, 1000, 0);
  BasicPair<Real> pair = fresh_pair(drawn, first);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Draws draws(1, 1001, i);
    Mutation mutation;
    pair = next_pair<Draws>(drawn, pair, nullptr, draws, mutation);
    mutations += mutation != Mutation::fresh;
    for (const Vec3<Real>& v : {pair.a[0], pair.a[1], pair.a[2], pair.b[0], pair.b[1], pair.b[2]}) {
      for (int axis = 0; axis < 3; ++axis) {
        const double x = static_cast<double>(component(v, axis));
        ASSERT_GE(x, component(scene.low, axis));
        ASSERT_LE(x, component(scene.high, axis));
        ASSERT_EQ(x * 64, std::nearbyint(x * 64));
      }
    }
  }
  EXPECT_GT(mutations, 1000);
}

TEST(MutationsInAScene, StayWithinIt) {
  expect_within_the_scene<strata::Draws>("", 0);
  expect_within_the_scene<strata::DoubleDraws>("coordinates = \"f64\"\n", 5400000);  // float32: steps of 1/2
}

TEST(Feedback, ShowsMarginsFailuresAndContractions) {
  const SelectedLanes under_test = select_lanes({"moller_1997/f32/cpu", "moller_1997/f32/cuda-*fma"}, Executor::twin);
  Campaign campaign;
  campaign.under_test = &under_test;
  campaign.sources = strata::stratum_sources(1, 1, {"near_edge_edge"});
  PairJudge judge(campaign);
  const Feedback feedback(under_test.lanes);
  BatchResult counts = no_counts(campaign);
  std::size_t most = 0, least = 1000, wrong = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Pair pair = campaign.sources[0].pair(i);
    const PairJudge::Found found = judge.judge(pair, i, counts);
    const Features features = feedback.features(pair, found);
    EXPECT_EQ(features, feedback.features(pair, found));
    EXPECT_TRUE(std::is_sorted(features.begin(), features.end()));
    most = std::max(most, features.size());
    least = std::min(least, features.size());
    wrong += !found.failures.empty();
  }
  EXPECT_GT(least, 3u);
  EXPECT_GT(most, least + 5);
  EXPECT_EQ(counts.disagreements, wrong);
  EXPECT_GT(wrong, 10u);
}

class HuntFiles : public CampaignFiles {
 protected:
  void SetUp() override {
    if (!has_libfuzzer()) GTEST_SKIP() << "this build has no libFuzzer";
  }

  Hunt hunt_of(const std::string& name, int threads) const {
    Hunt hunt;
    hunt.pairs = 5000;
    hunt.drawn.sources = strata::stratum_sources(3, hunt.pairs, {}, types_);
    hunt.campaign.seed = 3;
    hunt.campaign.under_test = &under_test_;
    hunt.campaign.threads = threads;
    hunt.campaign.directory = root_ / name;
    hunt.campaign.spec = hunt_spec(hunt);
    hunt.campaign.build = build_info(under_test_);
    return hunt;
  }

  Json run(const std::string& name, int threads, std::uint64_t rounds = ~0ull) const {
    Hunt hunt = hunt_of(name, threads);
    std::atomic<bool> stop{false};
    return run_hunt(
               hunt, stop,
               [&](const HuntProgress& progress) { stop = progress.done_here >= rounds * round_pairs(hunt.pairs); })
        .summary;
  }

  Json run_shard(const std::string& name, const Shard& shard, std::uint64_t rounds = ~0ull) const {
    Hunt hunt = hunt_of(name, 2);
    hunt.campaign.shard = shard;
    std::atomic<bool> stop{false};
    return run_hunt(hunt, stop, [&](const HuntProgress& progress) { stop = progress.done_here >= rounds * 256; })
        .summary;
  }

  // Checks that every pair of every case fails as its signature describes.   Returns: the number of pairs.
  std::size_t expect_cases_are_true(const std::string& name, const Json& summary) const {
    Campaign campaign;
    campaign.under_test = &under_test_;
    campaign.sources = {source_of_hunt(5000, types_ == PairTypes::f64, nullptr)};
    PairJudge judge(campaign);
    BatchResult counts = no_counts(campaign);
    std::size_t cases = 0;
    for (const Json& row : summary["signatures"]) {
      for (const corpus::Entry& entry : corpus::read_pairs(case_file(root_ / name, row), PairTypes::both)) {
        const auto failures = judge.judge(corpus::pair_of(entry), cases++, counts).failures;
        EXPECT_TRUE(std::any_of(failures.begin(), failures.end(),
                                [&](const auto& f) { return analysis::key(f) == row["key"].get<std::string>(); }));
        EXPECT_TRUE(corpus::origin_of(entry).starts_with(campaign.sources[0].id + ":3:"));
      }
    }
    return cases;
  }

  void expect_same_hunt(const std::string& one, const std::string& other) const {
    expect_same_bytes(one, other);
    EXPECT_EQ(read_whole(root_ / one / "hunt.json"), read_whole(root_ / other / "hunt.json"));
    for (const auto& round : std::filesystem::directory_iterator(root_ / one / "hunt"))
      EXPECT_EQ(read_whole(round.path()), read_whole(root_ / other / "hunt" / round.path().filename())) << round;
  }

  PairTypes types_ = PairTypes::f32;
  SelectedLanes under_test_ = select_lanes(
      {"moller_1997/f32/cpu", "moller_1997/f32/cuda-*fma", "projected_sat/f32/cpu", "exact/*"}, Executor::twin);
};

TEST_F(HuntFiles, GivesTheSameBytesOnAnyThreadsAfterInterruptionsAndDamage) {
  const Json summary = run("whole", 2);
  ASSERT_TRUE(summary["complete"].get<bool>());
  EXPECT_EQ(summary["strata"]["hunt"]["pairs"], 5000);
  run("one", 1);
  expect_same_hunt("whole", "one");
  EXPECT_TRUE(run("one", 2, 0)["complete"].get<bool>());  // stopped at once, but finished before
  expect_same_hunt("whole", "one");
  for (int part = 0; !run("parts", 2, 3)["complete"].get<bool>(); ++part) {
    ASSERT_LT(part, 10);
    std::ofstream(root_ / "parts/hunt/000000.round", std::ios::app) << "x";  // the damaged round runs again
  }
  expect_same_hunt("whole", "parts");
}

TEST_F(HuntFiles, RunsRoundsAgainWhoseFilesAreOfOtherRounds) {
  run("whole", 2);
  const auto file = [&](const char* round) { return root_ / "moved/hunt" / round; };
  run("moved", 2, 2);
  const std::string first = read_whole(file("000000.round")), second = read_whole(file("000001.round"));
  ASSERT_FALSE(first.empty() || second.empty());
  write_whole(file("000000.round"), second);
  write_whole(file("000001.round"), first);
  run("moved", 2);
  expect_same_hunt("whole", "moved");
  EXPECT_EQ(read_whole(file("000000.round")), first);
  write_whole(file("000001.round"), first);
  run("moved", 2);
  expect_same_hunt("whole", "moved");
  EXPECT_NE(read_whole(file("000001.round")), first);
}

TEST_F(HuntFiles, RemovesNothingThatItDidNotWrite) {
  run("tidy", 2, 1);
  const std::filesystem::path folder = root_ / "tidy/hunt", others = root_ / "others";
  write_whole(folder / "notes.txt", "kept");
  write_whole(folder / "000004.result.txt", "kept");
  write_whole(folder / "000004.result", error_bytes("of a killed process", false));
  write_whole(folder / "000099.result", "kept");
  std::filesystem::create_directories(others);
  write_whole(others / "a", "kept");
  std::filesystem::create_directory_symlink(others, folder / "000005.result");
  run("tidy", 2);
  EXPECT_EQ(read_whole(folder / "notes.txt"), "kept");
  EXPECT_EQ(read_whole(folder / "000004.result.txt"), "kept");
  EXPECT_FALSE(std::filesystem::exists(folder / "000004.result"));
  EXPECT_EQ(read_whole(folder / "000099.result"), "kept");
  EXPECT_EQ(read_whole(others / "a"), "kept");
}

TEST_F(HuntFiles, KeepsPairsThatFailAsTheirSignatureSays) {
  const Json summary = run("kept", 2);
  ASSERT_GT(summary["signatures"].size(), 20u);
  EXPECT_GT(expect_cases_are_true("kept", summary), 20u);
  const Json told = Json::parse(read_whole(root_ / "kept/hunt.json"));
  std::uint64_t pairs = 0, wrong = 0;
  for (const Json& row : told["mutations"]) {
    pairs += row["pairs"].get<std::uint64_t>();
    wrong += row["disagreements"].get<std::uint64_t>();
  }
  EXPECT_EQ(pairs, 5000u);
  EXPECT_EQ(wrong, summary["disagreements"]);
  EXPECT_GT(told["kinds"].size(), 3u);
}

TEST_F(HuntFiles, ShardsMergeByKindInAnyOrder) {
  std::vector<std::filesystem::path> parts;
  std::set<std::string> kinds;
  std::uint64_t wrong = 0, units = 0, new_kinds = 0;
  for (std::uint64_t k = 1; k <= 3; ++k) {
    const std::string name = "part-" + std::to_string(k);
    parts.push_back(root_ / name);
    if (k == 2) {  // interrupted, then resumed
      EXPECT_FALSE(run_shard(name, {k, 3}, 2)["complete"].get<bool>());
    }
    const Json summary = run_shard(name, {k, 3});
    EXPECT_EQ(summary["shard"], std::to_string(k) + "/3");
    EXPECT_TRUE(summary["complete"].get<bool>());
    EXPECT_FALSE(std::filesystem::exists(parts.back() / "summary.json"));
    EXPECT_EQ(read_status(parts.back())["state"], "done");
    EXPECT_GT(read_status(parts.back())["ways"].size(), 3u);
    const Json told = Json::parse(read_whole(parts.back() / "hunt.json"));
    for (const Json& kind : told["kinds"]) kinds.insert(kind["key"]);
    new_kinds += told["kinds"].size();
    wrong += summary["disagreements"].get<std::uint64_t>();
    units += told["units"].get<std::uint64_t>();
  }
  EXPECT_LT(kinds.size(), new_kinds);  // because several shards found the same kinds

  const Outcome merged = merge({parts, root_ / "merged", false});
  EXPECT_TRUE(merged.complete);
  EXPECT_EQ(merged.summary["strata"]["hunt"]["pairs"], 5000);
  EXPECT_EQ(merged.summary["disagreements"], wrong);
  EXPECT_GT(expect_cases_are_true("merged", merged.summary), 20u);
  const Json told = Json::parse(read_whole(root_ / "merged/hunt.json"));
  EXPECT_EQ(told["pairs"], 5000);
  EXPECT_EQ(told["units"], units);
  std::set<std::string> once;
  for (const Json& kind : told["kinds"]) EXPECT_TRUE(once.insert(kind["key"]).second) << kind;
  EXPECT_EQ(once, kinds);

  std::reverse(parts.begin(), parts.end());
  merge({parts, root_ / "backwards", false});
  expect_same_hunt("merged", "backwards");
  merge({{root_ / "merged"}, root_ / "again", false});
  expect_same_hunt("merged", "again");

  const auto refusal = [&](const MergeOptions& options) {
    const std::string error = error_of([&] { merge(options); });
    EXPECT_FALSE(std::filesystem::exists(options.out));
    return error;
  };
  EXPECT_TRUE(names(refusal({{parts[0], parts[2]}, root_ / "none", false}), {"2/3", "graze hunt --runs 5000"}));
  EXPECT_TRUE(names(refusal({parts, root_ / "none", true}), {"--partial", "hunt"}));
  const std::string own = read_whole(parts[1] / "hunt/000001.round");
  write_whole(parts[1] / "hunt/000001.round", read_whole(parts[1] / "hunt/000002.round"));
  EXPECT_TRUE(names(refusal({parts, root_ / "none", false}), {"part-2/hunt", "1667", "1411", "--shard 2/3"}));
  write_whole(parts[1] / "hunt/000001.round", own);
  std::ofstream(parts[1] / "hunt/000001.round", std::ios::app) << "x";
  EXPECT_TRUE(names(refusal({parts, root_ / "none", false}), {"part-2/hunt", "1667", "1411", "--shard 2/3"}));
  run_shard("part-2", {2, 3});  // runs the same round again
  merge({parts, root_ / "repaired", false});
  expect_same_hunt("merged", "repaired");
  EXPECT_THROW(run("merged", 1), UsageError);
}

class HuntOfDoubles : public HuntFiles {
 protected:
  HuntOfDoubles() {
    types_ = PairTypes::f64;
    under_test_ = select_lanes({"moller_1997/*/cpu", "moller_1997/f64/cuda-*fma", "exact/*"}, Executor::twin);
    select_for_doubles(under_test_);
  }
};

TEST_F(HuntOfDoubles, IsTheSameBytesOnAnyThreadsAndItsPartsMerge) {
  const Json summary = run("whole", 2);
  ASSERT_TRUE(summary["complete"].get<bool>());
  EXPECT_EQ(summary["strata"]["hunt/f64"]["pairs"], 5000);
  run("one", 1);
  expect_same_hunt("whole", "one");
  EXPECT_GT(expect_cases_are_true("whole", summary), 20u);
  std::size_t beyond_float32 = 0, wrong_in_double = 0;
  for (const Json& row : summary["signatures"]) {
    wrong_in_double += row["key"].get<std::string>().find("f64") != std::string::npos;
    for (const corpus::Entry& entry : corpus::read_pairs(case_file(root_ / "whole", row), PairTypes::both)) {
      ASSERT_TRUE(entry.doubles);
      const DoublePair stored = in_doubles(stored_in_float32(*entry.doubles));
      beyond_float32 += std::memcmp(&stored, &*entry.doubles, sizeof stored) != 0;
    }
  }
  EXPECT_GT(wrong_in_double, 10u);
  EXPECT_GT(beyond_float32, 20u);

  run_shard("part-1", {1, 2});
  EXPECT_FALSE(run_shard("part-2", {2, 2}, 2)["complete"].get<bool>());
  run_shard("part-2", {2, 2});
  const Outcome merged = merge({{root_ / "part-2", root_ / "part-1"}, root_ / "merged", false});
  EXPECT_EQ(merged.summary["strata"]["hunt/f64"]["pairs"], 5000);
  EXPECT_GT(expect_cases_are_true("merged", merged.summary), 20u);
}

TEST_F(HuntFiles, SaysWhatWentWrongInARound) {
  const Hunt hunt = hunt_of("errors", 1);
  const std::vector<Unit> none;
  const RoundTask task{&hunt.campaign, &hunt.drawn, {0, 0, 5000}, &none};
  EXPECT_THROW(parse_result(error_bytes("apart", true), task), oracle::OracleMismatch);
  EXPECT_THROW(parse_result(error_bytes("full", false), task), std::runtime_error);
  EXPECT_FALSE(parse_round("short", 1));
}

}  // namespace
}  // namespace graze::fuzz
