// SPDX-License-Identifier: Apache-2.0
// Tests that merging gives the same bytes as one run, for any number, executors and order of the shards.
#include "fuzz/shards/merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "core/error.h"
#include "core/message_testing.h"
#include "cuda/engine/host_engine_testing.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/cpu_engine.h"
#include "fuzz/campaign/rank_stores.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/sums.h"
#include "fuzz/ranks/rank_campaign.h"
#include "fuzz/sealed.h"
#include "strata/mesh.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

class MergeTest : public CampaignFiles {
 protected:
  Campaign campaign(const std::string& name, const Shard& shard = {}) const {
    Campaign c = campaign_of(
        twins_, strata::stratum_sources(3, 3'001, {"near_edge_edge", "degenerate", "extreme_scale"}), 3, name);
    c.shard = shard;
    return c;
  }

  // Runs all shards, every third one with the GPU engine's steps, and interrupts every fifth one after each batch.
  // Returns: the shards' directories.
  std::vector<fs::path> run_shards(std::uint64_t of) const {
    std::vector<fs::path> parts;
    for (std::uint64_t k = 1; k <= of; ++k) {
      Campaign c = campaign("of" + std::to_string(of) + "-" + std::to_string(k), {k, of});
      if (k % 3 == 0) c.engines.push_back(cuda::make_host_engine(twins_.lanes, twins_.on_host, {}));
      if (k % 3 == 0) c.engine_batch = 19;
      if (k % 5 == 0) {
        run_in_parts(c);
      } else {
        run(c);
      }
      parts.push_back(c.directory);
    }
    return parts;
  }

  std::string refusal(const std::vector<fs::path>& parts) const {
    const std::string error = error_of([&] { merge({parts, root_ / "refused", false}); });
    EXPECT_EQ(fs::exists(root_ / "refused"), error.empty());
    EXPECT_FALSE(fs::exists(root_ / "refused.graze.part"));
    return error;
  }

  fs::path database(const std::string& name) const { return root_ / name / kDatabase; }

  SelectedLanes twins_ =
      select_lanes({"moller_1997/f32/cuda*", "projected_sat/f32/cuda*", "exact/f32/cuda*"}, Executor::twin);
};

TEST_F(MergeTest, AnyNumberOfShardsInAnyOrderLeavesTheBytesOfTheWhole) {
  const Json whole = run(campaign("whole"));
  EXPECT_GT(whole["signatures"].size(), 20u);
  std::mt19937 random(1);
  // A shard's store has one row for each source, however many batches the shard ran.
  const Campaign rows = campaign("rows", {2, 3});
  EXPECT_GT(run_in_parts(rows), 1);
  EXPECT_EQ(SQLite::Database(database("rows").string()).execAndGet("SELECT count(*) FROM batch").getInt64(), 3);
  for (const std::uint64_t of : {1, 2, 3, 7, 64}) {
    std::vector<fs::path> parts = run_shards(of);
    std::shuffle(parts.begin(), parts.end(), random);
    const std::string name = "merged" + std::to_string(of);
    const Outcome outcome = merge({parts, root_ / name, false});
    EXPECT_TRUE(outcome.complete);
    EXPECT_EQ(outcome.summary.dump(), whole.dump()) << of;
    expect_same_bytes("whole", name);
    // The store belongs to a finished campaign, so nothing is judged again.
    Campaign again = campaign(name);
    std::atomic<bool> stop{false};
    EXPECT_TRUE(run_campaign(again, stop, [](const Progress&) { ADD_FAILURE() << "a batch"; }).complete);
    expect_same_bytes("whole", name);
  }
}

TEST_F(MergeTest, MergesOfMergesAreTheSame) {
  run(campaign("whole"));
  const std::vector<fs::path> of7 = run_shards(7), of2 = run_shards(2);
  merge({{of7[5], of7[1], of7[3]}, root_ / "odd", true});
  merge({{of7[6], root_ / "odd"}, root_ / "more", true});
  merge({{of7[2], root_ / "more", of7[0], of7[4]}, root_ / "all", false});
  expect_same_bytes("whole", "all");
  // The first half is shard 1/2; the second half is shards 3/4 and 4/4. Shard 1/2 ends where 3/4 begins.
  std::vector<fs::path> mixed{of2[0]};
  for (const Shard& shard : {Shard{3, 4}, Shard{4, 4}}) {
    const Campaign c = campaign("quarter" + std::to_string(shard.number), shard);
    run(c);
    mixed.push_back(c.directory);
  }
  merge({mixed, root_ / "mixed", false});
  expect_same_bytes("whole", "mixed");
}

TEST_F(MergeTest, APartialMergeIsACampaignToGoOnWith) {
  run(campaign("whole"));
  const std::vector<fs::path> parts = run_shards(7);
  const Outcome partial = merge({{parts[6], parts[2]}, root_ / "partial", true});
  EXPECT_FALSE(partial.complete);
  EXPECT_FALSE(partial.summary["complete"].get<bool>());
  EXPECT_TRUE(run(campaign("partial"))["complete"].get<bool>());
  expect_same_bytes("whole", "partial");
}

// The folder beside the target is replaced only if a killed merge left it; anything else of that name is kept.
TEST_F(MergeTest, OnlyWhatAKilledMergeLeftIsReplaced) {
  const std::vector<fs::path> parts = run_shards(2);
  const fs::path out = root_ / "all", beside = out.string() + kPart, other = root_ / "other";
  fs::create_directories(beside / "campaign.graze.part/cases");
  fs::create_directories(root_ / "all.part/campaign.part");
  fs::create_directory(other);
  for (const fs::path& theirs : {root_ / "all.part/campaign.part/mine", other / "mine"})
    write_whole(theirs, "precious");
  write_whole(beside / "mine", "precious");
  EXPECT_THROW(merge({parts, out, false}), UsageError);
  EXPECT_EQ(read_whole(beside / "mine"), "precious");
  fs::rename(beside, root_ / "moved");
  fs::create_directory_symlink(other, beside);
  EXPECT_THROW(merge({parts, out, false}), UsageError);
  fs::remove(beside);
  fs::rename(root_ / "moved", beside);
  fs::remove(beside / "mine");
  EXPECT_TRUE(merge({parts, out, false}).complete);
  EXPECT_FALSE(fs::exists(beside));
  for (const fs::path& theirs : {root_ / "all.part/campaign.part/mine", other / "mine"})
    EXPECT_EQ(read_whole(theirs), "precious");
}

TEST_F(MergeTest, AMergeThatIsDoneIsSaidToBe) {
  const std::vector<fs::path> parts = run_shards(2);
  const auto refused = [&](const fs::path& out) { return error_of<UsageError>([&] { merge({parts, out, false}); }); };
  merge({parts, root_ / "all", false});
  EXPECT_TRUE(names(refused(root_ / "all"), {(root_ / "all").string(), "already"}));
  merge({{parts[0]}, root_ / "half", true});
  run(campaign("other", {1, 3}));
  for (const char* name : {"half", "other"})
    EXPECT_TRUE(names(refused(root_ / name), {(root_ / name).string(), "other files"})) << name;
}

TEST_F(MergeTest, WhatIsWrongGetsOneLineAndLeavesNothing) {
  const std::vector<fs::path> parts = run_shards(3);
  run(campaign("whole"));
  const std::string command =
      "graze fuzz --pairs 3001 --seed 3 --strata near_edge_edge,degenerate,extreme_scale --lanes ";
  const auto expect = [&](const std::vector<fs::path>& of, const std::vector<std::string>& said) {
    EXPECT_TRUE(names(refusal(of), said));
  };
  expect({parts[0], parts[2]}, {"2/3", command, "--shard 2/3 --out " + (root_ / "shard-2").string()});
  expect({parts[2]}, {"1, 2", "graze fuzz", "--shard 1/3"});
  expect({parts[0], parts[1], parts[0]},
         {parts[0].string() + ", shard 1/3 and " + parts[0].string() + ", shard 1/3", "pairs"});
  expect({parts[0], root_ / "whole"}, {"of3-1, shard 1/3 and " + (root_ / "whole").string(), "pairs"});
  expect({parts[0], root_ / "none"}, {(database("none")).string(), "No such file or directory"});
  const fs::path foreign = run_shards(1)[0];
  SQLite::Database(database("of1-1").string(), SQLite::OPEN_READWRITE).exec("PRAGMA application_id = 7");
  expect({foreign}, {database("of1-1").string(), "another program"});

  Campaign other = campaign("other", {2, 3});
  other.spec["seed"] = 4;
  run(other);
  expect({parts[0], root_ / "other"}, {(root_ / "other").string(), parts[0].string(), "seed", "3", "4"});
  other = campaign("build", {2, 3});
  other.build["flags"] = "-O9";
  run(other);
  expect({parts[0], root_ / "build"}, {(root_ / "build").string(), "another build", "flags", "\"-O9\""});
  Campaign stopped = campaign("stopped", {2, 3});
  run(stopped, 1);
  expect({parts[0], root_ / "stopped", parts[2]}, {(root_ / "stopped").string() + ", shard 2/3", "not done", command,
                                                   "--shard 2/3 --out " + (root_ / "stopped").string()});

  // The hash detects a bit that changed in copying; the row's checksum detects an edit that the hash does not cover.
  std::string bytes = read_whole(database("of3-2"));
  const std::string good = bytes;
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_whole(database("of3-2"), bytes);
  expect(parts, {database("of3-2").string(), "hash", "--shard 2/3", "--discard-damaged"});
  write_whole(database("of3-2"), good);
  const auto with_other = [&](const fs::path& file, const std::string& text, const std::string& expected) {
    const std::string before = read_whole(file);
    std::ofstream(file) << text;
    expect(parts, {"cannot use " + file.string() + ": " + expected});
    std::ofstream(file) << before;
  };
  Json timings = Json::parse(read_whole(parts[0] / "timings.json"));
  timings["runs"].back()["costs"]["passes"] = 0;
  with_other(parts[0] / "timings.json", sealed(timings).dump(), "its costs have an invalid number of passes");
  with_other(parts[0] / "timings.json", timings.dump(), "it has been changed or damaged since graze wrote it");
  with_other(parts[1] / "status.json", "{", "it has been changed or damaged since graze wrote it");
  fs::remove(parts[1] / "status.json");
  SQLite::Database(database("of3-2").string(), SQLite::OPEN_READWRITE).exec("UPDATE batch SET first = first + 1");
  expect(parts, {database("of3-2").string(), "damaged", "--shard 2/3", "--discard-damaged"});
  write_whole(database("of3-2"), "");
  expect(parts, {database("of3-2").string(), "empty"});
  write_whole(database("of3-2"), good);
  EXPECT_EQ(refusal(parts), "");
}

// The command that reruns a part of a campaign requests as many pairs as the user did, not counting the mesh's.
TEST_F(MergeTest, CommandsNameTheMeshAndThePairsBesideIt) {
  fs::create_directories(root_);
  const std::string file = (root_ / "mesh.off").string();
  write_whole(file, "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n3 0 2 3\n3 1 2 3\n");
  const strata::MeshPairs mesh = strata::read_bodies({file});
  ASSERT_EQ(mesh.size(), 6u);
  const Json of_mesh = {{"files", {file}}, {"content", fmt::format("{:016x}", mesh.content_hash)}};
  const auto command = [&](const char* strata, std::uint64_t pairs, bool with_mesh) {
    Json spec = {{"seed", 3}, {"pairs", pairs}, {"strata", Json::parse(strata)}, {"lanes", {"exact/f32/cpu"}}};
    if (with_mesh) spec["mesh"] = of_mesh;
    return command_of(spec, {2, 3}, "o");
  };
  const std::string of_lanes = " --lanes exact/f32/cpu --shard 2/3 --out o";
  EXPECT_EQ(command(R"(["thesis"])", 50, false), "graze fuzz --pairs 50 --seed 3 --strata thesis" + of_lanes);
  EXPECT_EQ(command(R"(["thesis", "mesh"])", 56, true),
            "graze fuzz --mesh " + file + " --pairs 50 --seed 3 --strata thesis" + of_lanes);
  EXPECT_EQ(command(R"(["mesh"])", 6, true), "graze fuzz --mesh " + file + " --seed 3" + of_lanes);
}

// The user also requested the lanes that were left out. Each of the patterns also matched a lane that ran.
TEST_F(MergeTest, CommandsAskForTheLanesThatWereLeftOutToo) {
  const SelectedLanes some = select_lanes({"moller_1997/f32/cuda-*", "exact/f32/cpu"}, Executor::twin);
  Json spec = {
      {"seed", 3}, {"pairs", 9}, {"strata", {"thesis"}}, {"lanes", {"moller_1997/f32/cuda-fma", "exact/f32/cpu"}}};
  spec["lanes_left_out"] = left_out_json(some);
  EXPECT_EQ(spec["lanes_left_out"].dump(), R"({"patterns":["moller_1997/f32/cuda-*","exact/f32/cpu"],)"
                                           R"("why":{"moller_1997/f32/cuda-fast":"no twin"}})");
  EXPECT_EQ(command_of(spec, {}, "o"),
            "graze fuzz --pairs 9 --seed 3 --strata thesis --lanes "
            "'moller_1997/f32/cuda-*,exact/f32/cpu' --executor twin --out o");
  // Without patterns, the user requested exactly the lanes that run here.
  EXPECT_TRUE(select_lanes({}, Executor::twin).left_out.empty());
  EXPECT_TRUE(left_out_json(select_lanes({"moller_1997/f32/cuda-*fma"}, Executor::twin)).is_null());
}

TEST_F(MergeTest, WhatRanTheLanesIsSaidOfAll) {
  Json one = {{"commit", "c"}, {"device", nullptr}, {"executors", {{"a", "twin, verified on X"}, {"b", "device"}}}};
  Json other = {{"commit", "c"}, {"device", "H100"}, {"executors", {{"a", "device"}, {"b", "device"}}}};
  const Json both = common_build(one, other, "d");
  EXPECT_EQ(both.dump(),
            R"({"commit":"c","device":"H100","executors":{"a":"device; twin, verified on X","b":"device"}})");
  EXPECT_EQ(common_build(other, one, "d").dump(), both.dump());
  EXPECT_EQ(common_build(both, other, "d").dump(), both.dump());
  other["commit"] = "d";
  EXPECT_THROW(common_build(one, other, "d"), std::runtime_error);
}

TEST(Shard, PartsAreTheWholeEachIndexOnce) {
  for (const std::uint64_t pairs : {std::uint64_t{0}, std::uint64_t{5}, std::uint64_t{1000}, std::uint64_t{1} << 53}) {
    for (const std::uint64_t of : {std::uint64_t{1}, std::uint64_t{7}, std::uint64_t{64}, kMostShards}) {
      std::uint64_t at = 0;
      for (std::uint64_t k = 1; k <= of; ++k) {
        const PairRange share = share_of({k, of}, 2, pairs);
        ASSERT_EQ(share.first, at);
        at += share.pairs;
      }
      EXPECT_EQ(at, pairs);
    }
  }
  EXPECT_EQ(share_of({2, 4}, 0, 10).first, share_of({1, 2}, 0, 5).pairs);
  EXPECT_EQ(parse_shard("3/16")->name(), "3/16");
  for (const char* text : {"", "3", "0/4", "5/4", "1/", "/4", "1/2/3", "-1/2", "1/1000001", "a/b"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

// One process acts as all ranks in turn.
TEST_F(MergeTest, BlocksOfRanksAreTheWholeAndWhatARankLeftIsTakenIn) {
  const Json whole = run(campaign("whole"));
  const Campaign left = campaign("left");
  std::vector<PairRange> all;
  for (int s = 0; s < 3; ++s) all.push_back({s, 0, left.sources[static_cast<std::size_t>(s)].pairs});
  const Blocks blocks(all, 100);
  std::uint64_t pairs = 0;
  for (int rank = 0; rank < 3; ++rank) {
    StoreSpec of_rank = store_spec(left);
    of_rank.directory = rank_directory(left.directory, rank);
    fs::create_directories(of_rank.directory);
    Store store(of_rank);
    for (std::uint64_t b = static_cast<std::uint64_t>(rank); b < blocks.count(); b += 4) {  // as if rank 3 had died
      const PairRange block = blocks.at(b);
      store.commit(block, judge(left, block.source, block.pairs, [&](std::size_t i) { return block.first + i; }));
      pairs += block.pairs;
    }
  }
  std::uint64_t judged = 0;
  std::atomic<bool> stop{false};
  const Outcome outcome = run_campaign(left, stop, [&](const Progress& progress) { judged = progress.done_here; });
  EXPECT_EQ(judged, 3'001 - pairs);
  EXPECT_EQ(outcome.summary.dump(), whole.dump());
  EXPECT_TRUE(rank_directories(left.directory).empty());
}

TEST_F(MergeTest, SumsOfRanksTravelAsBytes) {
  const Campaign c = campaign("sums");
  Sums direct(c.sources, static_cast<int>(twins_.lanes.size())), root = direct, leaf = direct;
  for (std::uint64_t b = 0; b < 9; ++b) {
    const PairRange range{static_cast<int>(b % 3), b * 100, 50};
    const StoredCounts counts = judge(c, range.source, range.pairs, [&](std::size_t i) { return range.first + i; });
    direct.add(range, counts, 0);
    (b % 2 == 0 ? root : leaf).add(range, counts, 0);
  }
  root.add(leaf.bytes());
  EXPECT_EQ(root.bytes(), direct.bytes());
  EXPECT_THROW(root.add(leaf.bytes()), Sums::Overlap);
  EXPECT_THROW(root.add("nonsense"), Damaged);
  EXPECT_EQ(direct.gaps().size(), 3u + 4u + 4u);  // of the first source, only the first pairs are there
}

}  // namespace
}  // namespace graze::fuzz
