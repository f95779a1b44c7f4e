// SPDX-License-Identifier: Apache-2.0
// Shards as processes: killed, resumed, started twice at once, and run by ranks; and their status messages. The results
// have the same bytes as those of one run.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

class Shards : public CommandTest {
 protected:
  // Compares the summary, the cases and the report's data.
  void expect_same(const std::string& one, const std::string& other) const {
    expect_done("for d in " + one + ' ' + other + "; do graze report $d > /dev/null || exit 9; done; " + "diff " + one +
                "/summary.json " + other + "/summary.json && diff -r " + one + "/cases " + other + "/cases && diff " +
                one + "/report.json " + other + "/report.json");
  }

  // Returns the command that follows `before` in the message.
  static std::string command_in(const std::string& said, const std::string& before) {
    const std::size_t at = said.find(before);
    EXPECT_NE(at, std::string::npos) << said;
    return at == std::string::npos ? "false" : said.substr(at + before.size());
  }
};

TEST_F(Shards, KilledAndResumedInAnyOrderLeaveTheBytesOfTheWhole) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 120000 --strata 'near_*,degenerate' --lanes '*/f32/c*,exact*' ";
  expect_done(fuzz + "--out whole");
  for (const int k : {4, 2, 5, 1, 3}) {
    const std::string shard = fuzz + "--shard " + std::to_string(k) + "/5 --out part-" + std::to_string(k);
    const std::string scratch = k % 2 == 0 ? " --scratch local" : "";
    for (const int write : {1, 20, 100})
      ASSERT_EQ(shell(signal_at_write(SIGKILL, write) + shard + scratch + " --threads 1").status, 128 + SIGKILL);
    const Ran ran = shell.done(shard + scratch);
    EXPECT_TRUE(ran.out.starts_with("Shard " + std::to_string(k) + "/5: 24,000 pairs, ")) << ran.out;
  }
  EXPECT_EQ(shell("ls local").out, "");
  expect_done("graze merge part-3 part-5 part-1/ part-2 part-4 --out all");
  expect_same("whole", "all");
}

// The name of a mesh or scene is never taken for an option, and the printed command repeats it unchanged.
TEST_F(Shards, AMissingShardOfAFileWhoseNameBeginsWithADashIsRunToo) {
  std::ofstream(shell.folder / "-m.off") << "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 1 1\n3 0 1 2\n3 1 2 3\n";
  expect_done("graze scene ./-m.off --out ./-s.toml");
  for (const std::string of : {"--mesh=-m.off --mesh ./-m.off", "--scene=-s.toml --pairs 200"}) {
    const std::string fuzz = "graze fuzz " + of + " --lanes 'moller*/f32/cpu' ";
    for (const char* k : {"1", "3"}) ASSERT_EQ(shell(fuzz + "--shard " + k + "/3 --out q-" + k).status, 0) << of;
    const std::string missing = command_in(shell("graze merge q-1 q-3 --out all").err, "to run it: ");
    ASSERT_EQ(shell(missing).status, 0) << missing;
    expect_done("graze merge q-1 q-3 shard-2 --out all && rm -r q-1 q-3 shard-2 all");
  }
}

TEST_F(Shards, WhatIsMissingIsRunByTheCommandThatIsPrinted) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 900 --strata 'near_*' --lanes 'moller*/f32/cpu' ";
  expect_done(fuzz + "--out whole");
  for (const char* k : {"1", "3"}) expect_done(fuzz + "--shard " + k + "/3 --out p-" + k);
  expect_error("graze merge p-* --out all", 1, {"2/3", "graze fuzz"});
  const std::string missing = command_in(shell("graze merge p-1 p-3 --out all").err, "to run it: ");
  ASSERT_EQ(shell(missing).status, 0) << missing;
  expect_done("graze merge p-1 p-3 shard-2 --out all");
  expect_same("whole", "all");
  expect_error("graze merge p-1 p-3 shard-2 --out all", 2, {"empty", "--out"});
  // The suggested folder is neither the merge's own nor one with other files. A shard that had begun is resumed.
  const auto place = [&](const std::string& merge) { return command_in(shell(merge).err, "--out "); };
  EXPECT_EQ(place("graze merge p-1 p-3 --out all-of-it"), "shard-2\n");
  expect_done("mv shard-2 other && mkdir shard-2 && echo mine > shard-2/notes");
  EXPECT_EQ(place("graze merge p-1 p-3 --out all-of-it"), "shard-2.1\n");
  EXPECT_EQ(place("graze merge p-1 p-3 --out shard-2.1"), "shard-2.2\n");
  expect_done("rm -r shard-2 && mv other shard-2");

  // A damaged shard can be repaired and merged; its rows with a correct checksum are kept.
  expect_done(
      "sqlite3 p-3/campaign.sqlite 'UPDATE batch SET pairs = pairs + 1 WHERE id = 2' 2> /dev/null || python3 -c "
      "\"import sqlite3; c = sqlite3.connect('p-3/campaign.sqlite'); c.execute('UPDATE batch SET pairs = pairs + 1 "
      "WHERE id = 2'); c.commit()\"");
  const std::string said = shell("graze merge p-1 p-3 shard-2 --out again").err;
  const std::string repair = command_in(said, "copy it again, or run: ");
  EXPECT_TRUE(has_word(said, "p-3/campaign.sqlite") && has_word(said, "hash")) << said;
  ASSERT_EQ(shell(repair).status, 0) << repair;
  expect_done("graze merge p-1 p-3 shard-2 --out again");
  expect_same("whole", "again");
}

TEST_F(Shards, MergingGoesThroughLinksAndSaysFirstWhereItCannotGo) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 900 --strata 'near_*' --lanes 'moller*/f32/cpu' ";
  for (const char* k : {"1", "2"}) expect_done(fuzz + "--shard " + k + "/2 --out p-" + k);
  const std::string merge = "graze merge $OLDPWD/p-1 $OLDPWD/p-2 --out ";
  expect_done("mkdir a empty && ln -s ../empty a/link && ln -s ../new a/dangling && ln -s loop a/loop");
  expect_done("cd a && " + merge + "link && test -s ../empty/summary.json && test -L link");
  expect_done("cd a && " + merge + "dangling && cmp ../new/summary.json ../empty/summary.json && test -L dangling");
  expect_done("cd a && " + merge + "./b/../c/ && cmp c/summary.json ../empty/summary.json");
  expect_done("cd a && mkdir -p x/y && ln -s x/y into && " + merge +
              "into/../c && cmp x/c/summary.json ../empty/summary.json");
  expect_error("cd a && " + merge + "loop", 2, {"loop", "Too many levels of symbolic links"});
  expect_error("mkdir here && cd here && " + merge + ".", 2, {".", "working directory"});
  expect_done("test -z \"$(ls -d *.part a/*.part 2> /dev/null)\" && test -z \"$(ls -A here)\"");
  const std::string mounted = "mkdir -p m && cd a && unshare -rm sh -c 'mount -t tmpfs none ../m && ";
  if (shell(mounted + "true'").status != 0) GTEST_SKIP() << "no mount namespaces here";
  expect_error(mounted + merge + "../m'", 2, {"../m", "mount point", "--out"});
  expect_done(mounted + merge + "../m/campaign && cmp ../m/campaign/summary.json ../empty/summary.json'");
}

TEST_F(Shards, MinimizingTakesShardsOfTheSignatures) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 900 --strata 'near_*' --lanes 'moller*/f32/cpu' ";
  expect_done(fuzz + "--out whole && cp -r whole parts && graze minimize whole");
  const Ran ran =
      shell("graze minimize parts --shard 2/3 && graze minimize parts --shard 1/3 && cat parts/failures.json");
  EXPECT_TRUE(has(ran.out, {"shard 2/3: "})) << ran.err;
  EXPECT_EQ(ran.status, 1);  // failures.json needs all signatures
  EXPECT_EQ(
      shell(
          "graze minimize parts --shard 3/3 && graze minimize parts && diff whole/failures.json parts/failures.json && "
          "diff -r whole/cases parts/cases")
          .status,
      0);
  expect_error("graze minimize uniform:1:1 --shard 1/2", 2, {"--shard"});
}

TEST_F(Shards, WrongUseIsOneLine) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 900 --strata 'near_*' --lanes 'moller*/f32/cpu' ";
  for (const char* text : {"0/3", "4/3", "3", "x"}) expect_error(fuzz + "--shard " + text + " --out a", 2, {"K/N"});
  expect_error(fuzz + "--shard 1/3 --fail-above 0 --out a", 2, {"--fail-above"});
  expect_error(fuzz + "--scratch here --out a", 2, {"--scratch", "--shard"});
  expect_done(fuzz + "--shard 1/3 --out a");
  expect_error(fuzz + "--shard 2/3 --out a", 2, {"a", "1/3", "2/3", "--out"});
  expect_error(fuzz + "--out a", 2, {"a", "1/3"});
  expect_error("graze report a", 1, {"summary.json"});
  expect_error("graze merge --out b", 2, {"DIR"});
  EXPECT_EQ(Json::parse(shell(fuzz + "--shard 1/3 --out a --json").out)["pairs"], 300);
}

TEST_F(Shards, WhatCannotBeCopiedFromScratchIsSaidWithItsReason) {
  expect_error(
      "mkdir -p out/campaign.sqlite.graze.part; graze fuzz --pairs 900 --strata uniform "
      "--lanes 'moller*/f32/cpu' --shard 1/3 --scratch here --out out",
      1, {"out/campaign.sqlite", "out/campaign.sqlite.graze.part", "in the way"});
  expect_done("test -d out/campaign.sqlite.graze.part");
}

TEST_F(Shards, AForeignFileBesideTheDatabaseStays) {
  const std::string fuzz =
      "graze fuzz --pairs 900 --strata uniform --lanes 'moller*/f32/cpu' --shard 1/3 --scratch here --out out";
  expect_done("mkdir out && " + fuzz + " && echo precious > out/campaign.sqlite.part && " + fuzz +
              " && cmp out/campaign.sqlite.part <(echo precious)");
}

TEST_F(Shards, TwoProcessesOfOneShardAreRefused) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 3000000 --strata 'near_*' --shard 1/2 --out a ";
  for (const char* scratch : {"", "--scratch local"}) {
    const Ran ran = shell(fuzz + scratch +
                          " & for i in $(seq 1200); do grep -qs running a/status.json && break; sleep 0.1; done; "
                          "kill -STOP $!; " +
                          fuzz + scratch + "; echo second $?; kill -TERM $!; kill -CONT $!; wait $!; echo first $?");
    EXPECT_EQ(ran.out, "second 1\nfirst 130\n") << ran.err;
    EXPECT_TRUE(has(ran.err, {"another process"}));
  }
}

TEST_F(Shards, ScenesPoliciesAndSubjectsMergeToo) {
  std::ofstream(shell.folder / "arm.toml") << "extent = [0, 64]\nedges = [1, 2]\n";
  std::ofstream(shell.folder / "mine.cpp")
      << "bool intersects(const float a[9], const float b[9]) { return a[0] <= b[0]; }\n";
  const std::string fuzz =
      "graze fuzz --seed 2 --pairs 600 --scene arm.toml --subject mine=mine.cpp "
      "--lanes 'moller_1997/f32/cpu,moller_1997/f32/cpu/rel:24,mine/f32/cpu' ";
  ASSERT_EQ(shell(fuzz + "--out whole").status, 0) << shell(fuzz + "--out whole").err;
  for (const char* k : {"1", "2"}) expect_done(fuzz + "--shard " + k + "/3 --out p-" + k);
  expect_done(command_in(shell("graze merge p-1 p-2 --out all").err, "to run it: "));
  expect_done("graze merge p-1 p-2 shard-3 --out all");
  expect_same("whole", "all");
  std::ofstream(shell.folder / "one.sh") << "while read line; do echo 1; done\n";
  const Ran told = shell.done(
      "graze fuzz --pairs 100 --strata lattice --subject c='cmd:sh one.sh' --lanes 'c/*' --shard 1/2 --out c-1");
  EXPECT_TRUE(told.out.ends_with("\nc: Graze does not notice changes to what its files load.\n")) << told.out;
}

TEST_F(Shards, OfAHuntMergeByKind) {
  const std::string hunt = "graze hunt --runs 3000 --seed 5 --strata 'near_*' --lanes 'moller*/f32/cpu' ";
  const Ran first = shell(hunt + "--shard 1/2 --out p-1");
  if (first.err.find("libFuzzer") != std::string::npos) GTEST_SKIP() << first.err;
  EXPECT_TRUE(first.out.starts_with("Shard 1/2: 1,500 pairs, ")) << first.out << first.err;
  const std::string missing = command_in(shell("graze merge p-1 --out all").err, "to run it: ");
  ASSERT_EQ(shell(missing).status, 0) << missing;
  const Ran status = shell.done("graze status p-1 shard-2 --json");
  const Json shards = Json::parse(status.out)["shards"];
  EXPECT_EQ(shards[0]["done"], 1500);
  EXPECT_GT(shards[0]["new"], 3);
  EXPECT_LT(shards[1]["new"], shards[0]["new"]);  // most of them are in the first shard too
  const Ran merged =
      shell.done("graze merge shard-2 p-1 --out all && graze failures all && graze report all && graze minimize all");
  EXPECT_TRUE(has(merged.out, {"\n3,000 pairs: some lane is wrong on "}));
  expect_error(hunt + "--out all", 2, {"merged", "shards"});
}

TEST_F(Shards, StatusTellsWhatRunsAndWhatNeedsHelp) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 3000000 --strata 'near_*' ";
  const Ran ran = shell(
      "graze fuzz --seed 5 --pairs 900 --strata 'near_*' --shard 1/3 --out done > /dev/null; " + fuzz +
      "--shard 2/3 --out killed & for i in $(seq 1200); do grep -qs running killed/status.json && break; sleep 0.1; "
      "done; kill -STOP $!; graze status done killed none; echo $?; kill -KILL $!; wait; "
      "graze status done killed none --json --prometheus p.prom > s.json; echo $?");
  EXPECT_TRUE(has(ran.out, {" 1/3 done ", " 2/3 running ", " - not begun", "1 done, 1 running, 1 not begun\n0\n"}));
  EXPECT_TRUE(ran.out.ends_with("\n1\n")) << ran.out;
  const Json status = shell.json("s.json");
  EXPECT_EQ(status["states"], (Json{{"done", 1}, {"killed", 1}, {"not begun", 1}}));
  EXPECT_EQ(status["shards"][0]["done"], 300);
  const std::string prometheus = shell.file("p.prom");
  EXPECT_TRUE(has(prometheus, {"graze_done{directory=\"done\",shard=\"1/3\",state=\"done\"} 300\n"}));
  // A run on another machine that has not reported for a long time counts as stalled.
  Json old = shell.json("killed/status.json");
  old["host"] = "elsewhere";
  old["updated"] = old["updated"].get<std::int64_t>() - 1000;
  std::ofstream(shell.folder / "killed/status.json") << sealed(old);
  const Ran stalled = shell("graze status killed");
  EXPECT_EQ(stalled.status, 1);
  EXPECT_TRUE(has(stalled.out, {" stalled "}));
  expect_done("graze status killed --stalled 3000");
}

// Another campaign's records are not accepted as a shard's own.
TEST_F(Shards, RecordsOfAnotherCampaignAreRefused) {
  const std::string fuzz = "graze fuzz --pairs 600 --strata thesis,near_vertex_face --lanes moller_1997/f32/cpu --out ";
  expect_done("for k in 1 2 3; do " + fuzz + "s$k --shard $k/3 || exit 1; done; " + fuzz + "whole");
  expect_done("graze status s1 s2 s3 whole && mkdir kept && cp s3/*.json kept");
  expect_done("cp whole/timings.json s3");
  expect_error("graze merge s1 s2 s3 --out m", 1, {"s3/timings.json", "600", "200"});
  expect_done("cp kept/*.json s3 && graze merge s1 s2 s3 --out m && cp whole/status.json s3");
  expect_error("graze status s3", 1, {"s3", "status.json has 600 pairs", "198 to 202"});
  expect_done("cp s2/status.json whole");
  expect_error("graze status whole", 1, {"whole", "status.json has 200 pairs", "600"});
}

// A run that ends while its status is read is not reported as killed.
TEST_F(Shards, ARunThatEndsIsNotKilled) {
  expect_done(
      "for k in 1 2 3 4; do graze fuzz --seed $k --pairs 3000 --strata 'near_*' --lanes '*/f32/cpu' --out r$k > "
      "/dev/null & for i in $(seq 2000); do graze status r$k > said 2>&1 || { cat said; exit 1; }; "
      "grep -q ' done ' said && break; done; wait; done");
}

// A damaged status, or one with impossible counts, is not reported as a shard that has not begun.
TEST_F(Shards, StatusRefusesADamagedStatus) {
  expect_done("graze fuzz --seed 5 --pairs 400 --strata near_edge_edge --lanes '*/f32/cpu' --out c > /dev/null");
  const Json whole = shell.json("c/status.json");
  ASSERT_EQ(whole["state"], "done");
  const auto refused = [&](const std::string& text, const std::string& found) {
    std::ofstream(shell.folder / "c/status.json") << text;
    expect_error("graze status c", 1, {"status.json", found});
  };
  const std::string damaged = "damaged", way = whole["ways"].at(0);
  for (const std::string& text : {std::string(), std::string("[]"), whole.dump().substr(0, 90)}) refused(text, damaged);
  for (const auto& [field, value, found] : {std::tuple<const char*, Json, std::string>("done", 399, "399 done"),
                                            {"done", 401, "401 done"},
                                            {"disagreements", 401, "401 disagreements"},
                                            {"disagreements", 18446744073709551616.0, damaged},
                                            {"signatures", -1, damaged},
                                            {"signatures", 0, "0 signatures"},
                                            {"ways", Json::array(), "0 ways"},
                                            {"signatures", 9007199254740992, "9007199254740992 signatures"},
                                            {"disagreements", whole["disagreements"].get<int>() - 1, "disagreements"},
                                            {"state", "unknown", "unknown"},
                                            {"state", nullptr, damaged},
                                            {"shard", "2/1", "2/1"},
                                            {"rate", -1, "rate"},
                                            {"ways", {1}, damaged},
                                            {"ways", {way, way}, "twice"},
                                            {"ways", {"such"}, "not a hash"},
                                            {"process", -1, "process"},
                                            {"hash", "", "hash"},
                                            {"updated", "x", "updated"}}) {
    Json other = whole;
    other[field] = value;
    refused(sealed(other), found);
    refused(other.dump(), "its checksum differs");
  }
  std::ofstream(shell.folder / "c/status.json") << sealed(whole);
  expect_error("graze status c ./c", 2, {"./c", "twice"});
  Json foreign = whole;
  foreign["why"] = "a\x1b[31m\nb";
  std::ofstream(shell.folder / "c/status.json") << sealed(foreign);
  EXPECT_TRUE(has(shell("graze status c").out, {"a\\x1b[31m\\x0ab"}));
  for (const char* field : {"state", "shard", "pairs", "done", "disagreements", "signatures", "updated"}) {
    Json other = whole;
    other.erase(field);
    refused(sealed(other), damaged);
  }
  std::filesystem::remove(shell.folder / "c/status.json");
  expect_error("graze status c", 1, {"c/status.json", "missing"});
  std::filesystem::remove(shell.folder / "c/campaign.sqlite");
  expect_done("graze status c | grep 'not begun'");
  std::ofstream(shell.folder / "c/status.json") << whole;
  expect_done("graze status c | grep ' done '");
}

TEST_F(Shards, AShardIsNoRank) {
  const std::string of = "graze fuzz --pairs 200 --strata uniform --lanes '*/f32/cpu' ";
  expect_done(of + "--shard 1/2 --out s && mkdir -p r/rank-0 && cp s/* r/rank-0");
  expect_error(of + "--out r", 1, {"r/rank-0", "shard 1/2", "graze merge"});
  expect_done("cmp s/campaign.sqlite r/rank-0/campaign.sqlite");
}

TEST_F(Shards, AStatusOfAnotherProgramIsNotReplaced) {
  const std::string command = "graze fuzz --pairs 40 --strata uniform --lanes '*/f32/cpu' --out c";
  expect_done(command);
  const std::string foreign = "{\"hello\": [1, 2, 3]}";
  std::ofstream(shell.folder / "c/status.json") << foreign;
  expect_error(command, 2, {"c/status.json", "--force"});
  EXPECT_EQ(shell.file("c/status.json"), foreign);
  std::ofstream(shell.folder / "c/status.json") << "{\n \"state\": \"runn";  // cut short by a full disk
  expect_done(command);
}

// A shard's folder and the merged campaign's folder, without its cases, are at most as large as planned.
TEST_F(Shards, ThePlannedDiskIsEnough) {
  for (const char* of : {" --pairs 20000 --strata 'near_*' --lanes '*/f32/cpu' ",
                         " --pairs 20000 --strata extreme_scale,far_from_origin --lanes '*/cpu*' "}) {
    const Json plan = Json::parse(shell(fmt::format("graze plan --json --cores 2{}", of)).out);
    ASSERT_EQ(plan["shards"], 2);
    const auto bytes_in = [&](const std::string& folder) {
      return std::stod(shell("find " + folder + " -maxdepth 1 -type f | xargs cat | wc -c").out);
    };
    for (const char* k : {"1", "2"}) {
      expect_done(fmt::format("rm -rf s-{0}; graze fuzz{1}--shard {0}/2 --out s-{0}", k, of));
      EXPECT_LE(bytes_in(fmt::format("s-{}", k)), plan["shard_bytes"].get<double>()) << of;
    }
    expect_done("rm -rf all; graze merge s-1 s-2 --out all");
    EXPECT_LE(bytes_in("all"), plan["merged_bytes"].get<double>()) << of;
    EXPECT_GE(3 * bytes_in("all"), plan["merged_bytes"].get<double>()) << of;
  }
}

// mpirun refuses to run as root without an extra option.
TEST_F(Shards, RanksLeaveTheBytesOfOneProcessAlsoWhenOneIsKilled) {
  const Ran found = shell("command -v mpirun && test -e '" + std::string(GRAZE_BINARY_DIR) + "/libgraze_mpi.so'");
  if (found.status != 0) GTEST_SKIP() << "no mpirun, or a build without MPI";
  const std::string fuzz =
      "graze fuzz --seed 5 --pairs 200000 --strata 'near_*,degenerate' --lanes '*/f32/c*' --threads 1 ";
  const std::string mpirun =
      "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1; mpirun ";
  expect_done(fuzz + "--out whole");
  // Rank 2 stops itself at its 20th write, while it stores its first blocks and holds no MPI lock. The other ranks do
  // all the remaining work, and then rank 2 is killed.
  const std::string rank = fuzz + "--out ranks ";
  const Ran killed =
      shell(mpirun + "-n 2 " + rank + ": -n 1 env " + signal_at_write(SIGSTOP, 20) + rank + ": -n 1 " + rank +
            "& for i in $(seq 6000); do [ $(grep -ls stopped ranks/rank-*/status.json | wc -l) -eq 3 ] && break; "
            "sleep 0.1; done; rank=$(grep -h '\"process\"' ranks/rank-2/status.json | grep -o '[0-9]*'); "
            "graze status ranks | tail -n 1; kill -KILL $rank; wait $!; echo $?; ls -d ranks/rank-*");
  EXPECT_TRUE(has(killed.out, {"3 stopped, 1 running\n"})) << killed.err;
  EXPECT_FALSE(has(killed.out, {"\n0\n"})) << killed.err;
  EXPECT_TRUE(has(killed.out, {"ranks/rank-3"}));
  expect_out(mpirun + "-n 4 " + rank, {"Wrote ranks/summary.json"});
  EXPECT_EQ(shell("ls ranks | grep rank-").out, "");
  const Json run = shell.json("ranks/timings.json")["runs"].back();
  EXPECT_EQ(run["ranks"], 4);
  // All committed pairs are kept. The killed rank loses only its current block, about 1/256 of the pairs.
  EXPECT_LE(run["pairs"], 200'000 / 128);
  expect_same("whole", "ranks");
  const Ran wrong = shell(mpirun + "-n 4 " + fuzz + "--shard 1/2 --out x");
  EXPECT_TRUE(has(wrong.err, {"under mpirun"}));
}

}  // namespace
}  // namespace graze::cli
