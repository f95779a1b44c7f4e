// SPDX-License-Identifier: Apache-2.0
// The command as users run it: JSON contracts, one clear line for bad input, and no lost work when it is killed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTouching = "0 0 0 4 0 0 0 4 0  1 1 0 1 2 4 2 1 4";

class Cli : public CommandTest {};

TEST_F(Cli, CheckPrintsOneObjectALine) {
  const Ran ran =
      shell.done(std::string("printf '%s\\n' '") + kTouching + "' '" + kTouching + "' | graze check - --json");
  std::istringstream lines(ran.out);
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const Json object = Json::parse(line);
    EXPECT_EQ(object["pair"], count);
    EXPECT_EQ(object["truth"].dump(), R"({"verdict":"intersects","contact":"point","margin":0.0,"margin_ulps":0.0})");
    EXPECT_EQ(object["lanes"]["interval_overlap/f32/cpu"], "intersects");
    EXPECT_TRUE(object["lanes"].contains("interval_overlap/f64/cuda-fma"));  // as a twin if there is no device
    EXPECT_FALSE(object["cuda"].get<std::string>().empty());
  }
  EXPECT_EQ(count, 2);
}

TEST_F(Cli, CheckSelectsLanesAndRunsTheOracleAlone) {
  const Ran some =
      shell(std::string("echo '") + kTouching + "' | graze check - --json --lanes 'moller_*/f32/cpu,*/f64/cpu'");
  EXPECT_EQ(Json::parse(some.out)["lanes"].size(), 6u) << some.err;
  const Ran none = shell(std::string("echo '") + kTouching + "' | graze check - --json --truth-only");
  EXPECT_TRUE(Json::parse(none.out)["lanes"].empty());
}

TEST_F(Cli, CheckShowsWhatLanesSayOfNonFiniteInput) {
  const Ran ran = shell.done("echo 'nan 0 0 4 0 0 0 4 0  1 1 inf 1 2 4 2 1 4' | graze check - --json");
  const Json object = Json::parse(ran.out);
  EXPECT_EQ(object["truth"].dump(), R"({"verdict":"declined","contact":"unknown","margin":null,"margin_ulps":null})");
  EXPECT_GE(object["lanes"].size(), 10u);
}

TEST_F(Cli, BadPairsGetOneLineAndKeepWhatCameBefore) {
  const Ran ran = shell(std::string("printf '%s\\n1 2 3\\n' '") + kTouching + "' > pairs; graze check pairs --json");
  EXPECT_EQ(ran.status, 1);
  EXPECT_EQ(ran.err, "graze: pairs:2: expected 18 numbers, found 3\n");
  EXPECT_EQ(Json::parse(ran.out)["pair"], 0);
  expect_error("graze check missing.pairs", 1, {"missing.pairs", "No such file or directory"});
  expect_error(": > empty; graze check empty", 1, {"no pair", "empty"});
  expect_error("echo 'graze-pairs 2' > future; graze check future", 1, {"future:1"});
  expect_error("head -c 300 /dev/zero > zeros; graze check zeros", 1, {"zeros:1"});
  expect_error("graze repro missing.pairs", 1, {"missing.pairs", "No such file or directory"});
}

// If no verdicts were compared, the number of differences is not reported as zero.
TEST_F(Cli, NothingComparedIsSaidEverywhere) {
  const std::string fuzz = "graze fuzz --executor twin --pairs 30 --strata uniform ";
  const Ran ran = shell.done(fuzz + "--lanes 'moller_1997/f32/cuda-fma' --out c");
  EXPECT_TRUE(shell.json("c/summary.json")["strata"]["uniform"]["lanes"]["moller_1997/f32/cuda-fma"]["differs_from_cpu"]
                  .is_null());
  const std::size_t row = ran.out.rfind("moller_1997/f32/cuda-fma ");
  EXPECT_TRUE(ran.out.substr(row, ran.out.find('\n', row) - row).ends_with(" -")) << ran.out;
  const Ran beside = shell(fuzz + "--lanes 'moller_1997/f32/c*' --json --out d");
  const Json lanes = Json::parse(beside.out)["strata"]["uniform"]["lanes"];
  EXPECT_TRUE(lanes["moller_1997/f32/cpu"]["differs_from_cpu"].is_null());
  EXPECT_EQ(lanes["moller_1997/f32/cuda-nofma"]["differs_from_cpu"], 0);
  // For a stratum without pairs, no shares are printed.
  const Ran none = shell("graze fuzz --pairs 1 --strata 'uniform,thesis' --lanes 'moller_*/f32/cpu' --out e");
  EXPECT_TRUE(std::regex_search(none.out, std::regex("\nthesis +0 +- +-\n"))) << none.out;
  expect_done("graze report c && graze report d && graze report e");
  EXPECT_TRUE(shell.json("c/report.json")["rates"][0]["differs_from_cpu"].is_null());
  expect_done(
      "grep -q '^moller_1997/f32/cuda-fma,general,uniform,wrong,' c/rates.csv && ! grep differs_from_cpu c/rates.csv");
  expect_done("! grep '^moller_1997/f32/cpu,general,uniform,differs_from_cpu' d/rates.csv");
  expect_done("grep -q '^moller_1997/f32/cuda-nofma,general,uniform,differs_from_cpu,0,30,0' d/rates.csv");
}

TEST_F(Cli, MeshesThatDoNotParseAreNamed) {
  expect_error("echo 'not a mesh' > bad.off; graze fuzz --mesh bad.off", 1, {"bad.off:1"});
  expect_error("graze fuzz --mesh missing.off", 1, {"missing.off", "No such file or directory"});
  expect_error("printf 'OFF\\n3 1 0\\n0 0 0\\n1 0 0\\n0 1 nan\\n3 0 1 2\\n' > nan.off; graze fuzz --mesh nan.off", 1,
               {"nan.off:5"});
}

TEST_F(Cli, AMeshIsACampaign) {
  std::ofstream(shell.folder / "strip.off")
      << "OFF\n6 4 0\n0 0 0\n4 0 0\n0 4 0\n4 4 0\n1 1 -1\n1 1 1\n3 0 1 2\n3 1 3 2\n3 4 5 1\n3 4 5 3\n";
  const Ran ran = shell.done("graze fuzz --mesh strip.off --json --out mesh");
  const Json summary = Json::parse(ran.out);
  EXPECT_EQ(summary["spec"]["strata"].dump(), "[\"mesh\"]");
  EXPECT_EQ(summary["strata"]["mesh"]["pairs"], 6);
  EXPECT_EQ(summary["strata"]["mesh"]["intersects"], 6);
}

TEST_F(Cli, DatabasesOfOthersAreRefused) {
  expect_error("mkdir a; head -c 8192 /dev/urandom > a/campaign.sqlite; graze fuzz --pairs 1000 --out a", 1,
               {"a/campaign.sqlite"});
  expect_error(
      "graze fuzz --pairs 20000 --out b > /dev/null; truncate -s 40000 b/campaign.sqlite; graze fuzz --pairs 20000 "
      "--out b",
      1, {"b/campaign.sqlite"});
  expect_error("touch file; graze fuzz --pairs 1000 --out file", 1, {"file", "Not a directory"});
  expect_error("rm b/campaign.sqlite; touch b/summary.json; graze fuzz --pairs 1000 --out b", 2,
               {"b", "database", "--out"});
}

// If one byte of a batch or the end of the file changes, the error is one line, and --discard-damaged keeps the rest.
TEST_F(Cli, DamageIsOneLineAndWhatChecksIsKept) {
  const std::string fuzz = "graze fuzz --pairs 20000 --strata 'near_*,degenerate' --lanes '*/f32/cpu' ";
  expect_done(fuzz + "--out whole && cp -r whole c");
  const std::string database = shell.file("c/campaign.sqlite");
  const std::size_t place = database.find("separating_axes:");  // in some signature of some batch
  ASSERT_NE(place, std::string::npos);
  std::string changed = database;
  changed[place] = 'S';
  std::ofstream(shell.folder / "c/campaign.sqlite", std::ios::binary) << changed;
  expect_error(fuzz + "--out c", 1, {"c/campaign.sqlite", "checksum", "--discard-damaged"});
  const Ran kept = shell.done(fuzz + "--discard-damaged --out c");
  EXPECT_TRUE(names(kept.err.substr(0, kept.err.find_last_not_of('\n') + 1),
                    {"16,000 pairs", "4 batches", "c/campaign.sqlite.damaged"}));
  expect_done("diff c/summary.json whole/summary.json && diff -r c/cases whole/cases");
  EXPECT_EQ(shell.file("c/campaign.sqlite.damaged"), changed);
  const Ran again = shell.done(fuzz + "--discard-damaged --out c");
  EXPECT_EQ(again.err, "");
}

// flock(1) holds the folder's lock here.
TEST_F(Cli, TwoAtOnceInOneFolderAreRefused) {
  const std::string fuzz = "graze fuzz --pairs 2000 --strata degenerate --lanes '*/f32/cpu' --out c";
  expect_done(fuzz);
  const std::vector<std::string> line = {"c", "another process"};
  expect_error("flock c " + fuzz, 1, line);
  expect_error("flock c graze minimize c", 1, line);
  expect_done("graze minimize c > /dev/null && " + fuzz);
}

// If a run's folder is removed or replaced, the run does not touch the campaign that is now in its place.
TEST_F(Cli, AFolderReplacedDuringARunIsLeftAlone) {
  expect_done("echo 'while read l; do until [ $l = describe ] || [ -e go ]; do sleep 0.05; done; echo 1; done' > w.sh");
  expect_done("graze fuzz --pairs 600 --strata lattice --lanes '*/f32/cpu' --out other > /dev/null");
  const std::string fuzz =
      "graze fuzz --subject 'w=cmd:bash w.sh' --subject-timeout 600 --pairs 40 --strata lattice --lanes 'w/*' ";
  for (const char* part : {"", "--shard 1/2 "}) {
    for (const char* replace : {"rm -r c; cp -r other c", "mv c there; cp -r other c", "rm -r c",
                                "mv c/campaign.sqlite .; cp other/campaign.sqlite c"}) {
      SCOPED_TRACE(replace);
      const Ran ran = shell(fmt::format(
          "rm -rf c there go; {} {} --out c & run=$!\n"
          "until [ -e c/status.json ] && [ -s c/campaign.sqlite-wal ]; do sleep 0.02; done; {}; rm -f c/*-wal c/*-shm\n"
          "[ ! -e c ] || cp -r c kept; touch go; wait $run",
          fuzz, part, replace));
      EXPECT_EQ(ran.status, 1);
      EXPECT_TRUE(has(ran.err, {"c/campaign.sqlite: ", "replaced while this run used it"})) << ran.err;
      EXPECT_EQ(ran.out, "");
      expect_done("if [ -e kept ]; then diff -r kept c; else test ! -e c; fi; rm -rf kept");
    }
  }
}

// Uses device nodes and pipes that the test creates, never the machine's own.
TEST_F(Cli, OutGoesIntoWhatStandsThere) {
  const std::string minimize = "graze minimize exact_contact:1:1 --lanes 'guigue_*/f32/cpu' --out ";
  expect_done(minimize + "plain");
  expect_done("mkdir far && ln -s far/file link && " + minimize + "link && test -L link && cmp far/file plain");
  expect_done("mkfifo pipe; cat pipe > read & " + minimize + "pipe && wait && test -p pipe && cmp read plain");
  const Ran piped = shell(minimize + "/dev/stdout | cat");
  EXPECT_TRUE(piped.out.ends_with(shell.file("plain"))) << piped.out;
  if (shell("mknod null c 1 3 && : > null").status == 0) expect_done(minimize + "null && test -c null");
  expect_error(minimize + "far", 1, {"far", "Is a directory"});
  expect_error("ulimit -f 4; graze map lattice:1:1 --lanes 'moller_*/cpu' --out full.png > /dev/null", 1,
               {"full.png", "File too large"});
  expect_done("test ! -e full.png && test ! -e full.png.part");
  for (const char* verb : {"fuzz --out ''", "minimize exact_contact:1:1 --out ''", "map lattice:1:1 --out ''",
                           "report --from r.json --out ''", "prove-twin --out ''", "corpus list --corpus ''"})
    expect_error("graze " + std::string(verb), 2, {"''"});
}

// An empty value is not the same as no value.
TEST_F(Cli, EmptyTextsAreRefusedByTheirOption) {
  for (const auto& [verb, option] :
       std::vector<std::pair<std::string, std::string>>{{"tune moller_1997/f32/cpu --from ''", "--from"},
                                                        {"fuzz --toolchains ''", "--toolchains"},
                                                        {"map lattice:1:1 --x '' --y ''", "--x"},
                                                        {"map lattice:1:1 --x 'a[0].x' --y ''", "--y"},
                                                        {"check ''", "FILE"},
                                                        {"fuzz --mesh ''", "--mesh"},
                                                        {"fuzz --subject ''", "--subject"}})
    expect_error("graze " + verb, 2, {option, "''"});
}

TEST_F(Cli, OptionsThatCannotActAreRefused) {
  const std::string tune = "graze tune moller_1997/f32/cpu --max-other 0.5";
  expect_error(tune, 2, {"--max-other", "--forbid"});
  expect_error(tune + " --forbid any", 2, {"--max-other", "--forbid"});
  expect_error("graze tune moller_1997/f32/cpu moller_1997/f32/cuda-fma --agree --max-other 0.5", 2, {"--max-other"});
  expect_error("graze plan --gpus 2 --rate 1e6 --lanes '*/f32/cpu'", 2, {"--gpus", "projected_sat/f32/cpu"});
  const std::string toolchains = " --toolchains x86-gcc";
  for (const std::string verb :
       {"fuzz --lanes moller_1997/f32/cpu", "explain lattice:1:1 --lanes moller_1997/f32/cpu",
        "invariants --lanes moller_1997/f32/cpu", "bench", "tune moller_1997/f32/cpu", "lanes --lanes '*/f32/cpu'",
        "discrepancy moller_1997/f32/cpu moller_1997/f32/cuda-fma", "query --self none.off", "prove-twin"})
    expect_error("graze " + verb + toolchains, 2, {"--toolchains"});
  expect_done("echo 0 0 0 1 0 0 0 1 0 > r.txt && printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > m.obj");
  expect_error("graze query r.txt m.obj" + toolchains, 2, {"--toolchains"});
}

// The error must be Graze's own message, never a library's.
TEST_F(Cli, WhatIsNoSummaryAndNoReportIsNamed) {
  expect_error("mkdir a; echo '{\"signatures\":[{}],\"spec\":{\"lanes\":5}}' > a/summary.json; graze minimize a", 1,
               {"a/summary.json"});
  expect_error("cp -r a e; sed -i 's/5/[\"exact\\/f32\\/cpu\"]/' e/summary.json; graze minimize e", 1,
               {"e/summary.json"});
  expect_error("mkdir -p b/summary.json; graze report b", 1, {"b/summary.json", "Is a directory"});
  expect_error("echo '{\"format\":1,\"rates\":5}' > r.json; graze report --from r.json --out r.html", 1, {"r.json"});
  expect_error("graze minimize none", 1, {"none", "No such file or directory"});
  expect_error("graze report none", 1, {"none", "summary.json"});
  expect_error("mkdir c; echo '{\"spec\": {\"lanes\": 1}, \"signatures\": [{}]}' > c/summary.json; graze corpus add c",
               1, {"c/summary.json"});
  expect_error(
      "printf 'OFF\\n6 2 0\\n0 0 0\\n4 0 0\\n0 4 0\\n1 1 -1\\n1 1 1\\n2 1 1\\n3 0 1 2\\n3 3 4 5\\n' > $'\\xff.off'; "
      "graze fuzz --mesh $'\\xff.off'",
      2, {"--mesh", "UTF-8"});
  expect_done(
      "echo '0 0 0 1 0 0 0 1 0  0 0 1 1 0 1 0 1 1' > "
      "$'\\xff.pairs' && graze "
      "explain $'\\xff.pairs' --json");
}

// A file-size limit simulates a full disk: the error is one line, and the same command resumes once there is room.
TEST_F(Cli, AFullDiskLosesNothing) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 150000 --strata 'near_*' ";
  expect_error("ulimit -f 400; " + fuzz + "--out disk", 1, {"disk", "File too large"});
  expect_done(fuzz + "--out disk");
  expect_done(fuzz + "--out whole");
  expect_done("diff disk/summary.json whole/summary.json && diff -r disk/cases whole/cases");
  for (const char* verb : {"strata", "lanes", "lanes --json"})
    expect_error(std::string("graze ") + verb + " > /dev/full", 1, {"standard output", "No space left on device"});
  // The exit status is right even if the error message cannot be written.
  expect_error("graze dump uniform --pairs 2000 > /dev/full", 1, {"standard output", "No space left on device"});
  EXPECT_EQ(shell("graze check nofile 2> /dev/full").status, 1);
  EXPECT_EQ(shell("graze check nofile 2>&-").status, 1);
  EXPECT_EQ(shell("graze fuzz --pairs -1 2> /dev/full").status, 2);
  EXPECT_EQ(shell("graze strata > /dev/full 2>&1").status, 1);
}

// A folder that looks like a rank's, but was not made by Graze, is kept.
TEST_F(Cli, FoldersOfRanksAreKnownByTheirStores) {
  const std::string fuzz = "graze fuzz --pairs 400 --strata near_edge_edge --lanes moller_1997/f32/cpu --out r";
  expect_done(fuzz);
  ASSERT_EQ(shell("mkdir -p r/rank-7/deep other r/rank-8; echo x > r/rank-7/deep/f; echo x > other/f; "
                  "ln -s ../other r/rank-9")
                .status,
            0);
  expect_done(fuzz);
  EXPECT_EQ(shell("cat r/rank-7/deep/f other/f r/rank-9/f").out, "x\nx\nx\n");
}

// Kills a campaign at twelve points. The same command resumes it each time, and the final files have the same bytes.
TEST_F(Cli, KilledCampaignsGoOnToTheSameBytes) {
  const std::string fuzz = "graze fuzz --seed 9 --pairs 600000 --strata 'near_*,degenerate' ";
  expect_done(fuzz + "--threads 2 --out whole");
  for (int write = 1; write <= 2048; write *= 2) {
    const Ran ran = shell(signal_at_write(SIGKILL, write) + fuzz + "--threads 1 --out killed");
    ASSERT_EQ(ran.status, 128 + SIGKILL) << write << ran.err;
  }
  expect_done(fuzz + "--threads 1 --out killed");
  expect_done("diff killed/summary.json whole/summary.json && diff -r killed/cases whole/cases");
}

TEST_F(Cli, CtrlCKeepsWhatWasDoneAndSaysSo) {
  const std::string fuzz = "graze fuzz --seed 9 --pairs 600000 --strata 'near_*,degenerate' --threads 1 ";
  const Ran ran = shell(signal_at_write(SIGINT, 200) + fuzz + "--out stopped");
  EXPECT_EQ(ran.status, 130);
  EXPECT_TRUE(has(ran.err, {"graze: interrupted"})) << ran.out;
  expect_done(fuzz + "--out stopped");
  expect_done(fuzz + "--out whole");
  expect_done("diff stopped/summary.json whole/summary.json && diff -r stopped/cases whole/cases");
}

TEST_F(Cli, ReproRunsStoredCasesAndNoticesChange) {
  expect_done("graze fuzz --pairs 20000 --strata exact_contact --out c");
  const std::string first = shell.json("c/summary.json")["signatures"][0]["case"];
  expect_out("graze repro c/" + first, {"(as recorded)"});
  const Ran changed = shell("sed 's|/22/|/21/|' c/" + first + " > changed.pairs; graze repro changed.pairs");
  EXPECT_EQ(changed.status, 1);
  EXPECT_TRUE(has(changed.out, {"CHANGED"}));
  const Ran right = shell("sed 's/signature=[^ ]*/signature=foo/' c/" + first + " > foo.pairs; graze repro foo.pairs");
  EXPECT_EQ(right.status, 1);
  EXPECT_TRUE(has(right.out, {"CHANGED, recorded: foo"}));
  const Ran truth = shell("sed 's/truth=[a-z]*/truth=declined/; s/margin=/margin=1/' c/" + first +
                          " > other.pairs; graze repro other.pairs");
  EXPECT_EQ(truth.status, 1);
  EXPECT_TRUE(has(truth.out, {"CHANGED, recorded: truth=declined", "CHANGED, recorded: margin=1"}));
  expect_done("graze invariants --pairs 300 --strata exact_contact --lanes moller_1997/f32/cpu --out i");
  expect_done("cp i/cases/order.pairs order.pairs && graze repro order.pairs");
  const Ran verdict = shell("sed -i 's/says=intersects/says=disjoint/' order.pairs && graze repro order.pairs");
  EXPECT_EQ(verdict.status, 1);
  EXPECT_TRUE(has(verdict.out, {"CHANGED, recorded: moller_1997/f32/cpu disjoint"}));
  // A recorded lane that does not run now does not count as a difference.
  const std::string algorithm = shell.json("c/summary.json")["signatures"][0]["key"];
  const std::string other = algorithm.find("moller") == std::string::npos ? "moller_*" : "separating_*";
  expect_out("graze repro c/" + first + " --lanes '" + other + "'", {"not compared"});
  expect_done("echo '0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1 | stratum=x' > s.pairs; graze repro s.pairs");
}

// A build without libFuzzer prints one line; otherwise the result is a campaign directory that other verbs accept.
TEST_F(Cli, AHuntIsACampaignForOtherVerbs) {
  const std::string hunt = "graze hunt --runs 600 --lanes 'moller_1997/f32/cpu,exact/f32/cpu' --out h";
  const Ran first = shell(hunt);
  if (first.status != 0) {
    expect_error(hunt, 1, {"hunt", "libFuzzer", "libclang-rt-14-dev"});
    GTEST_SKIP() << "this build has no libFuzzer";
  }
  EXPECT_TRUE(has(first.out, {"600 pairs: some lane is wrong on", "new kinds"}));
  const std::string summary = shell.file("h/summary.json");
  EXPECT_EQ(shell(hunt).out, first.out);
  EXPECT_EQ(shell.file("h/summary.json"), summary);
  const Json row = Json::parse(summary)["signatures"][0];
  expect_done("graze repro h/" + row["case"].get<std::string>());
  EXPECT_TRUE(has(shell("graze failures h").out, {"moller_1997"}));
  expect_done("graze minimize h");
  expect_done("graze report h");
  EXPECT_EQ(shell.json("h/report.json")["run"]["command"].dump().find("graze hunt --runs 600 --seed 1"), 1u);
  EXPECT_EQ(shell("graze dump h").status, 1);
  EXPECT_EQ(shell("graze hunt --runs 601 --lanes 'moller_1997/f32/cpu,exact/f32/cpu' --out h").status, 2);
}

// SQLite reads a relative name that begins with "file:" as a URI.
TEST_F(Cli, AFolderMayBeNamedLikeAUri) {
  expect_done("mkdir d; graze fuzz --pairs 100 --strata lattice --lanes moller_1997/f32/cpu --out file:d > /dev/null");
  EXPECT_TRUE(std::filesystem::is_empty(shell.folder / "d"));
  expect_done("test -f file:d/campaign.sqlite; graze report file:d > /dev/null");
}

TEST_F(Cli, EveryVerbHasHelpWithAnExampleThatRuns) {
  for (const std::string verb :
       {"fuzz", "check", "repro", "explain", "map", "corpus add", "corpus list", "corpus verify", "dump", "lanes",
        "pareto", "plan", "strata"}) {  // prove-twin needs a device
    const Ran help = shell.done("graze " + verb + " --help");
    const std::size_t at = help.out.find("Example: ");
    ASSERT_NE(at, std::string::npos) << verb;
    const std::string example = help.out.substr(at + 9, help.out.find('\n', at) - at - 9);
    EXPECT_EQ(shell("set -o pipefail; jq() { cat; }; " + example).status, 0) << example;
  }
  expect_done("test -s map.png");
}

// `graze_campaign` is the program that scripts/campaign builds, linked by this build.
TEST_F(Cli, WhatACampaignsBuildLeavesOutSaysSo) {
  EXPECT_EQ(verbs_in_help(shell, "graze_campaign"), verbs_in_help(shell, "graze"));
  const Ran left_out = shell("graze_campaign --help | awk '/Not in this build/ {print $1}'");
  EXPECT_TRUE(has(left_out.out, {"tune\n"}));
  std::istringstream verbs(left_out.out);
  for (std::string verb; verbs >> verb;) {
    const Ran ran = shell("graze_campaign " + verb + " some thing --or other");
    EXPECT_EQ(ran.status, 1);
    EXPECT_TRUE(names(ran.err.substr(0, ran.err.find_last_not_of('\n') + 1), {"graze " + verb, "scripts/setup"}));
  }
  for (const std::string program : {"graze", "graze_campaign"}) {
    const std::string out = " by_" + program;
    EXPECT_EQ(
        shell(program + " fuzz --pairs 300 --strata near_edge_edge --lanes 'moller_1997/f32/*' --executor twin --out" +
              out + " && " + program + " minimize" + out + " && " + program + " report" + out)
            .status,
        0);
  }
  EXPECT_EQ(
      shell(
          "cmp by_graze/summary.json by_graze_campaign/summary.json && diff -r by_graze/cases by_graze_campaign/cases")
          .out,
      "");
}

TEST_F(Cli, TheLastOutAndFlagsInAnyOrderCount) {
  expect_done("graze fuzz --pairs 1000 --out a --out b && test -f b/summary.json && test ! -e a");
  expect_done(std::string("echo '") + kTouching + "' > p; graze check --lanes '*/f32/cpu' p --json");
}

TEST_F(Cli, TwinsFillTheCudaColumnsWithoutADevice) {
  const Ran ran = shell.done("graze fuzz --pairs 4000 --executor twin --lanes '*/f32/*' --json --out c");
  const Json summary = Json::parse(ran.out);
  EXPECT_EQ(summary["complete"], true);
  EXPECT_EQ(summary["build"]["executors"]["moller_1997/f32/cuda-fma"].get<std::string>().substr(0, 4), "twin");
  std::uint64_t fused = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) {
    EXPECT_EQ(row["lanes"]["moller_1997/f32/cuda-nofma"]["differs_from_cpu"], 0);
    fused += row["lanes"]["moller_1997/f32/cuda-fma"]["differs_from_cpu"].get<std::uint64_t>();
  }
  EXPECT_GT(fused, 0u);
}

TEST_F(Cli, QuietWhenNotOnATerminal) {
  const Ran ran = shell("graze fuzz --pairs 2000 --out c");
  EXPECT_EQ(ran.err, "");
  EXPECT_TRUE(has(ran.out, {"graze repro c/cases/"}));
}

}  // namespace
}  // namespace graze::cli
