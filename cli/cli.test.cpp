// SPDX-License-Identifier: Apache-2.0
// The command as users meet it: contracts of its JSON, one clear line for bad input, and nothing lost when killed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTouching = "0 0 0 4 0 0 0 4 0  1 1 0 1 2 4 2 1 4";

class Cli : public CommandTest {};

TEST_F(Cli, CheckPrintsOneObjectALine) {
  const Ran ran = shell(std::string("printf '%s\\n' '") + kTouching + "' '" + kTouching + "' | graze check - --json");
  ASSERT_EQ(ran.status, 0) << ran.err;
  std::istringstream lines(ran.out);
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const Json object = Json::parse(line);
    EXPECT_EQ(object["pair"], count);
    EXPECT_EQ(object["truth"].dump(), R"({"verdict":"intersects","contact":"point","margin":0.0,"margin_ulps":0.0})");
    EXPECT_EQ(object["lanes"]["interval_overlap/f32/cpu"], "intersects");
    EXPECT_TRUE(object["lanes"].contains("interval_overlap/f64/cuda-fma"));  // without a device by its twin
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
  const Ran ran = shell("echo 'nan 0 0 4 0 0 0 4 0  1 1 inf 1 2 4 2 1 4' | graze check - --json");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Json object = Json::parse(ran.out);
  EXPECT_EQ(object["truth"].dump(), R"({"verdict":"declined","contact":"unknown","margin":null,"margin_ulps":null})");
  EXPECT_GE(object["lanes"].size(), 10u);
}

TEST_F(Cli, BadPairsGetOneLineAndKeepWhatCameBefore) {
  const Ran ran = shell(std::string("printf '%s\\n1 2 3\\n' '") + kTouching + "' > pairs; graze check pairs --json");
  EXPECT_EQ(ran.status, 1);
  EXPECT_EQ(ran.err, "graze: pairs:2: expected 18 numbers, found 3\n");
  EXPECT_EQ(Json::parse(ran.out)["pair"], 0);
  expect_error("graze check missing.pairs", 1, "missing.pairs: expected");
  expect_error(": > empty; graze check empty", 1, "empty: expected at least one pair");
  expect_error("echo 'graze-pairs 2' > future; graze check future", 1, "future:1: expected");
  expect_error("head -c 300 /dev/zero > zeros; graze check zeros", 1, "zeros:1: expected");
  expect_error("graze repro missing.pairs", 1, "missing.pairs: expected");
}

TEST_F(Cli, WrongUseExitsWithTwo) {
  expect_error("graze", 2, "expected a verb (see `graze --help`), found none");
  expect_error("graze fuzz --pairs many", 2, "--pairs");
  expect_error("graze nosuch", 2, "found 'nosuch'");
  expect_error("graze fuzz --pairs 0", 2, "found '0'");
  expect_error("graze fuzz --pairs -5", 2, "found '-5'");
  expect_error("graze fuzz --seed 99999999999999999999999", 2, "expected a whole number");
  expect_error("graze fuzz --threads -1", 2, "from 0 to 4096");
  expect_error("graze fuzz --executor gpu", 2, "gpu");
  expect_error("graze repro 'near_*:1:0'", 2, "expected one stratum");
  expect_error("graze fuzz --lanes 'moler_*'", 2, "found 'moler_*'");
  expect_error("graze fuzz --strata 'uniform,nowhere'", 2, "found 'nowhere'");
  expect_error("echo | graze check - --lanes nothing", 2, "found 'nothing'");
  expect_error("graze repro uniform:x:3", 2, "found 'x'");
  expect_error("graze repro nowhere:1:3", 2, "found 'nowhere'");
  expect_error("graze fuzz --pairs 100 --out here > /dev/null && graze fuzz --pairs 200 --out here", 2,
               "here: holds another campaign: expected pairs 200, found 100; choose another --out\n");
}

// A file or a folder that is missing is a failed run, whatever the verb; wrong use is what the command line gets wrong.
TEST_F(Cli, MissingFilesAndFoldersAreTheSameFailure) {
  for (const char* verb : {"check", "repro", "explain", "map", "minimize", "report", "corpus add", "dump",
                           "report --out r.html --from", "fuzz --mesh", "corpus list --corpus"}) {
    for (const char* name : {"no/where", "no/where.pairs"})
      expect_error(std::string("graze ") + verb + ' ' + name, 1, std::string(name));
    expect_error("mkdir -p empty; graze " + std::string(verb) + " empty", 1, "empty");
  }
}

// What cannot be read: never a library's words for it.
TEST_F(Cli, FoldersAndDevicesInAFilesPlaceAreNamed) {
  expect_error("mkdir d; graze check d", 1, "d: expected a file of pairs, found a folder");
  expect_error("graze fuzz --mesh d", 1, "d: expected");
  expect_error("graze report --from d --out r.html", 1, "d: expected");
  for (const char* verb : {"check", "explain", "fuzz --mesh", "report --out r.html --from"}) {
    const Ran ran = shell(std::string("graze ") + verb + " /proc/self/mem");  // opens, but cannot be read
    EXPECT_EQ(ran.status, 1) << verb;
    EXPECT_NE(ran.err.find("/proc/self/mem"), std::string::npos) << verb << ran.err;
    EXPECT_EQ(ran.err.find("basic_filebuf"), std::string::npos) << verb << ran.err;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
}

TEST_F(Cli, WrongWordsAreNamedWithWhatIsNearest) {
  expect_error("graze --bogus", 2, "expected a verb (see `graze --help`), found '--bogus'\n");
  expect_error("graze minimise x", 2, "found 'minimise'; did you mean 'minimize'?");
  expect_error("graze fuzz --lanes 'moler_*'", 2, "found 'moler_*'; did you mean 'moller_1997/f32/cpu'?");
  expect_error("graze fuzz --strata near_edge_egde", 2, "found 'near_edge_egde'; did you mean 'near_edge_edge'?");
  expect_error("graze fuzz --lanes ,", 2, "--lanes: expected patterns with commas between, found ','");
  expect_error("graze fuzz --strata 'uniform,,thesis'", 2, "expected patterns with commas between");
  expect_error("graze fuzz --executor nope", 2, "expected auto, device, twin or both, found 'nope'");
  expect_error("graze fuzz --engine 1", 2, "expected auto, cpu or gpu, found '1'");
  expect_error("graze repro uniform:1:1 --emit nope", 2, "obj, cgal or gtest, found 'nope'");
  expect_error("echo | graze check - --truth-only --lanes '*'", 2, "--lanes");
}

TEST_F(Cli, CountsAreWhatPeopleWrite) {
  for (const char* count : {"2000", "2_000", "2e3", "2k", "0.2e4", "0.002M"}) {
    const Ran ran =
        shell(std::string("graze fuzz --strata uniform --lanes exact/f32/cpu --json --out c --pairs ") + count);
    ASSERT_EQ(ran.status, 0) << count << ran.err;
    EXPECT_EQ(Json::parse(ran.out)["spec"]["pairs"], 2000) << count;
  }
  for (const char* count : {"1.5", "1e", "_1", "1__0", "1_", "1e99", "1x", "kM", "1e-1", ".5M"})
    expect_error(std::string("graze fuzz --pairs ") + count, 2, std::string("found '") + count + "'");
}

// What was not compared is no zero.
TEST_F(Cli, NothingComparedIsSaidEverywhere) {
  const std::string fuzz = "graze fuzz --executor twin --pairs 30 --strata uniform ";
  const Ran ran = shell(fuzz + "--lanes 'moller_1997/f32/cuda-fma' --out c");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(Json::parse(contents(
      shell.folder / "c/summary.json"))["strata"]["uniform"]["lanes"]["moller_1997/f32/cuda-fma"]["differs_from_cpu"]
                  .is_null());
  const std::size_t row = ran.out.find("moller_1997/f32/cuda-fma");
  EXPECT_TRUE(ran.out.substr(row, ran.out.find('\n', row) - row).ends_with(" -")) << ran.out;
  const Ran beside = shell(fuzz + "--lanes 'moller_1997/f32/c*' --json --out d");
  const Json lanes = Json::parse(beside.out)["strata"]["uniform"]["lanes"];
  EXPECT_TRUE(lanes["moller_1997/f32/cpu"]["differs_from_cpu"].is_null());
  EXPECT_EQ(lanes["moller_1997/f32/cuda-nofma"]["differs_from_cpu"], 0);
  // A stratum without pairs has no shares.
  const Ran none = shell("graze fuzz --pairs 1 --strata 'uniform,thesis' --lanes 'moller_*/f32/cpu' --out e");
  EXPECT_NE(none.out.find("\nthesis                         0           -                       -\n"),
            std::string::npos)
      << none.out;
  expect_done("graze report c && graze report d && graze report e");
  EXPECT_TRUE(Json::parse(contents(shell.folder / "c/report.json"))["rates"][0]["differs_from_cpu"].is_null());
  expect_done("grep -q '^moller_1997/f32/cuda-fma,uniform,differs_from_cpu,,,,,$' c/rates.csv");
  expect_done("grep -q '^moller_1997/f32/cpu,uniform,differs_from_cpu,,,,,$' d/rates.csv");
  expect_done("grep -q '^moller_1997/f32/cuda-nofma,uniform,differs_from_cpu,0,30,0' d/rates.csv");
}

TEST_F(Cli, ForeignTextDoesNotReachTheTerminal) {
  std::ofstream(shell.folder / "a:b:c")
      << kTouching << R"( | name="a\x1b[31mb" stratum="\x1b]0;t" seed=1 index=2 signature="\x07/x:")";
  for (const char* verb : {"check", "repro", "explain", "repro --emit obj", "repro --emit python"}) {
    const Ran ran = shell(std::string("graze ") + verb + " a:b:c");  // the file, for there is one
    EXPECT_LE(ran.status, 1) << verb << ran.err;
    EXPECT_EQ((ran.out + ran.err).find_first_of("\x1b\x07"), std::string::npos) << verb << ran.out;
  }
  EXPECT_NE(shell("graze check a:b:c").out.find("a\\x1b[31mb"), std::string::npos);
}

// Decimals that float32 rounds to another pair: both truths are told.
TEST_F(Cli, WhatFloat32MakesOfDecimalsIsSaid) {
  std::ofstream(shell.folder / "near.pairs")
      << "0 0 1 1 0 1 0 1 1  0 0 1.00000000001 1 0 1.00000000001 0 1 1.00000000001\n";
  const std::string note = "as written: disjoint, 1e-11 apart; as stored in float32: they share an area";
  for (const std::string command :
       {"graze check near.pairs", "graze check near.pairs --json", "graze explain near.pairs",
        "graze minimize near.pairs", "graze corpus add near.pairs"}) {
    const Ran ran = shell(command);
    EXPECT_NE((ran.out + ran.err).find(note), std::string::npos) << command << ran.out << ran.err;
    expect_error(command + " --exact-input", 2,
                 "near.pairs:1: expected numbers that float32 holds as written (--exact-input), found "
                 "\"1.00000000001\" as number 12");
  }
  // A double in hex that float32 cannot hold.
  const Ran hex = shell(
      "echo '0 0 1 1 0 1 0 1 1  0 0 0x1.0000000000001p0 1 0 0x1.0000000000001p0 0 1 "
      "0x1.0000000000001p0' | graze check -");
  EXPECT_NE(hex.out.find("as written: disjoint, 2.22e-16 apart; as stored in float32: they share an area"),
            std::string::npos)
      << hex.out;
  // Rounding that changes nothing is not worth a word.
  expect_done("echo '0.1 0 0 4 0 0 0 4 0  1 1 0.3 1 2 4 2 1 4' > p; graze check p > out; ! grep -q written out");
  expect_done(std::string("echo '") + kTouching + "' | graze check - --exact-input");
}

// As people paste it, in every verb that takes a pair: here two segments that meet in a point.
TEST_F(Cli, PastedPairsAreReadByEveryVerb) {
  const std::pair<const char*, const char*> pasted[] = {
      {"commas", "0, 0, 0, 4, 0, 0, 2, 0, 0, 1, 0, 0, 1, 0, 4, 1, 0, 2\n"},
      {"c",
       "float t[2][3][3] = {{{0.f, 0.f, 0.f}, {4.f, 0.f, 0.f}, {2.f, 0.f, 0.f}},\n"
       "                    {{1.f, 0.f, 0.f}, {1.f, 0.f, 4.f}, {1.f, 0.f, 2.f}}};\n"},
      {"lines", "0 0 0\n4 0 0\n2 0 0\n1 0 0\n1 0 4\n1 0 2\n"},
      {"obj", "v 0 0 0\nv 4 0 0\nv 2 0 0\nv 1 0 0\nv 1 0 4\nv 1 0 2\nf 1 2 3\nf 4 5 6\n"},
      {"python", "[[(0, 0, 0), (4, 0, 0), (2, 0, 0)], [(1, 0, 0), (1, 0, 4), (1, 0, 2)]]\n"}};
  for (const auto& [name, text] : pasted) {
    std::ofstream(shell.folder / name) << text;
    for (const std::string verb : {"check", "repro", "explain"}) {
      const Ran ran = shell("graze " + verb + ' ' + name);
      EXPECT_NE(ran.out.find("truth: intersects, contact point"), std::string::npos) << verb << name << ran.err;
    }
    const std::string file = name;
    expect_done("graze repro " + file + " --emit obj && graze minimize " + file + " --out m && graze explain m && " +
                "graze map " + file + " --lanes 'moller_1997/f32/cpu' --out m.png");
    const Ran added = shell("graze corpus add " + file);
    EXPECT_TRUE(added.out.find(name == std::string("commas") ? " new, 0 seen" : "0 new, ") != std::string::npos)
        << added.out << added.err;
  }
}

TEST_F(Cli, AByteOrderMarkIsSkipped) {
  std::ofstream(shell.folder / "bom.pairs") << "\xef\xbb\xbf" << kTouching << '\n';
  expect_done("graze check bom.pairs");
}

TEST_F(Cli, PrintedCommandsRunAsTheyStand) {
  const Ran ran = shell("graze fuzz --pairs 300 --strata lattice --lanes '*/f32/cpu' --out 'my campaign'");
  const std::size_t at = ran.out.find("again: ");
  ASSERT_NE(at, std::string::npos) << ran.out;
  expect_done(ran.out.substr(at + 7, ran.out.find('\n', at) - at - 7));
  EXPECT_TRUE(ran.out.ends_with("\nNext: graze minimize 'my campaign'\n")) << ran.out;
  // Each ends with the next one.
  const Ran minimized = shell("graze minimize 'my campaign'");
  EXPECT_TRUE(minimized.out.ends_with("\nNext: graze report 'my campaign'\n")) << minimized.out << minimized.err;
  EXPECT_TRUE(shell("graze repro exact_contact:1:1").out.ends_with("\nNext: graze minimize exact_contact:1:1\n"));
  EXPECT_TRUE(shell("graze repro uniform:1:1 --lanes 'exact/*'").out.find("Next:") == std::string::npos);
  EXPECT_TRUE(shell("graze minimize exact_contact:1:1 --lanes 'guigue_*/f32/cpu' --out 'a b'")
                  .out.ends_with("\nNext: graze explain 'a b'\n"));
  EXPECT_TRUE(shell("graze explain 'a b' --lanes 'guigue_*/f32/cpu'").out.ends_with("\nNext: graze map 'a b'\n"));
  EXPECT_TRUE(shell("graze check 'a b' --lanes 'guigue_*/f32/cpu'").out.ends_with("\nNext: graze explain 'a b'\n"));
  EXPECT_EQ(shell("graze check 'a b' --lanes 'exact/*'").out.find("Next:"), std::string::npos);
  EXPECT_TRUE(shell("graze map 'a b' --lanes 'guigue_*/f32/cpu' --out m.png")
                  .out.ends_with("\nNext: graze repro 'a b' --emit cpp\n"));
  expect_done("graze repro 'a b' --emit cpp > bug.cpp");
  EXPECT_TRUE(shell("graze report 'my campaign'").out.ends_with("\nNext: graze corpus add 'my campaign'\n"));
  EXPECT_TRUE(shell("graze corpus add 'my campaign' --top 1 --corpus 'its corpus'")
                  .out.ends_with("\nNext: graze corpus verify --corpus 'its corpus'\n"));
  EXPECT_TRUE(shell("graze corpus list --corpus 'its corpus'")
                  .out.ends_with("\nNext: graze corpus verify --corpus 'its corpus'\n"));
  expect_done("graze corpus verify --corpus 'its corpus'");
  for (const char* verb : {"lanes", "strata"}) {  // what they print runs
    const std::string table = shell(std::string("graze ") + verb).out;
    expect_done(table.substr(table.find("Next: ") + 6, table.size() - table.find("Next: ") - 7) + " --pairs 50 --out " +
                verb);
  }
  // What another program reads has no such line.
  EXPECT_EQ(shell("graze check 'a b' --json; graze explain 'a b' --json; graze lanes --json; graze dump lattice")
                .out.find("Next"),
            std::string::npos);
}

TEST_F(Cli, MeshesThatDoNotParseAreNamed) {
  expect_error("echo 'not a mesh' > bad.off; graze fuzz --mesh bad.off", 1, "bad.off:1: expected OFF");
  expect_error("graze fuzz --mesh missing.off", 1, "missing.off: expected");
  expect_error("printf 'OFF\\n3 1 0\\n0 0 0\\n1 0 0\\n0 1 nan\\n3 0 1 2\\n' > nan.off; graze fuzz --mesh nan.off", 1,
               "nan.off:5: expected a coordinate that is finite");
}

TEST_F(Cli, AMeshIsACampaign) {
  std::ofstream(shell.folder / "strip.off")
      << "OFF\n6 4 0\n0 0 0\n4 0 0\n0 4 0\n4 4 0\n1 1 -1\n1 1 1\n3 0 1 2\n3 1 3 2\n3 4 5 1\n3 4 5 3\n";
  const Ran ran = shell("graze fuzz --mesh strip.off --json --out mesh");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const Json summary = Json::parse(ran.out);
  EXPECT_EQ(summary["spec"]["strata"].dump(), "[\"mesh\"]");
  EXPECT_EQ(summary["strata"]["mesh"]["pairs"], 6);
  EXPECT_EQ(summary["strata"]["mesh"]["intersects"], 6);
}

TEST_F(Cli, DatabasesOfOthersAreRefused) {
  expect_error("mkdir a; head -c 8192 /dev/urandom > a/campaign.sqlite; graze fuzz --pairs 1000 --out a", 1,
               "a/campaign.sqlite: expected a Graze campaign database");
  expect_error(
      "graze fuzz --pairs 20000 --out b > /dev/null; truncate -s 40000 b/campaign.sqlite; graze fuzz --pairs 20000 "
      "--out b",
      1, "b/campaign.sqlite: expected");
  expect_error("touch file; graze fuzz --pairs 1000 --out file", 1, "file: expected a directory");
  expect_error("rm b/campaign.sqlite; touch b/summary.json; graze fuzz --pairs 1000 --out b", 2, "not their database");
}

// One byte of a batch, and the end of the file: one line, and the way on keeps the rest.
TEST_F(Cli, DamageIsOneLineAndWhatChecksIsKept) {
  const std::string fuzz = "graze fuzz --pairs 20000 --strata 'near_*,degenerate' --lanes '*/f32/cpu' ";
  ASSERT_EQ(shell(fuzz + "--out whole && cp -r whole c").status, 0);
  const std::string database = contents(shell.folder / "c/campaign.sqlite");
  const std::size_t place = database.find("separating_axes:");  // in some signature of some batch
  ASSERT_NE(place, std::string::npos);
  std::string changed = database;
  changed[place] = 'S';
  std::ofstream(shell.folder / "c/campaign.sqlite", std::ios::binary) << changed;
  expect_error(fuzz + "--out c", 1, "and its checksum do not agree; --discard-damaged keeps the batches that check");
  const Ran kept = shell(fuzz + "--discard-damaged --out c");
  EXPECT_EQ(kept.status, 0) << kept.err;
  EXPECT_EQ(
      kept.err,
      "graze: kept 16,000 pairs in 4 batches that check; the damaged database is now c/campaign.sqlite.damaged\n");
  expect_done("diff c/summary.json whole/summary.json && diff -r c/cases whole/cases");
  EXPECT_EQ(contents(shell.folder / "c/campaign.sqlite.damaged"), changed);
  const Ran again = shell(fuzz + "--discard-damaged --out c");
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.err, "");
}

// The folder's lock, held here by flock(1).
TEST_F(Cli, TwoAtOnceInOneFolderAreRefused) {
  const std::string fuzz = "graze fuzz --pairs 2000 --strata degenerate --lanes '*/f32/cpu' --out c";
  ASSERT_EQ(shell(fuzz).status, 0);
  const std::string line = "c: expected to be alone, found: another process at work in it";
  expect_error("flock c " + fuzz, 1, line);
  expect_error("flock c graze minimize c", 1, line);
  expect_done("graze minimize c > /dev/null && " + fuzz);
}

// Device nodes and pipes of our own, never those of the machine.
TEST_F(Cli, OutGoesIntoWhatStandsThere) {
  const std::string minimize = "graze minimize exact_contact:1:1 --lanes 'guigue_*/f32/cpu' --out ";
  ASSERT_EQ(shell(minimize + "plain").status, 0);
  expect_done("mkdir far && ln -s far/file link && " + minimize + "link && test -L link && cmp far/file plain");
  expect_done("mkfifo pipe; cat pipe > read & " + minimize + "pipe && wait && test -p pipe && cmp read plain");
  const Ran piped = shell(minimize + "/dev/stdout | cat");
  EXPECT_TRUE(piped.out.ends_with(contents(shell.folder / "plain"))) << piped.out;
  if (shell("mknod null c 1 3 && : > null").status == 0) expect_done(minimize + "null && test -c null");
  expect_error(minimize + "far", 1, "far: expected a file, found: a folder");
  expect_error("ulimit -f 4; graze map lattice:1:1 --lanes 'moller_*' --out full.png > /dev/null", 1,
               "full.png: expected to write it, found: File too large");
  expect_done("test ! -e full.png && test ! -e full.png.part");
  for (const char* verb : {"fuzz --out ''", "minimize exact_contact:1:1 --out ''", "map lattice:1:1 --out ''",
                           "report --from r.json --out ''", "prove-twin --out ''", "corpus list --corpus ''"})
    expect_error("graze " + std::string(verb), 2, "expected a name, found ''");
}

// Never a library's message.
TEST_F(Cli, WhatIsNoSummaryAndNoReportIsNamed) {
  expect_error("mkdir a; echo '{\"signatures\":[{}],\"spec\":{\"lanes\":5}}' > a/summary.json; graze minimize a", 1,
               "a/summary.json: expected a campaign's summary, found something else");
  expect_error("cp -r a e; sed -i 's/5/[\"exact\\/f32\\/cpu\"]/' e/summary.json; graze minimize e", 1,
               "e/summary.json: expected a campaign's summary, found something else");
  expect_error("mkdir -p b/summary.json; graze report b", 1,
               "b/summary.json: expected to read it, found: Is a directory");
  expect_error("echo '{\"format\":1,\"rates\":5}' > r.json; graze report --from r.json --out r.html", 1,
               "r.json: expected a report of `graze report`, found something else");
  expect_error("graze minimize none", 1, "none: expected");
  expect_error("graze report none", 1, "none: expected");
  expect_error("mkdir c; echo '{\"spec\": {\"lanes\": 1}, \"signatures\": [{}]}' > c/summary.json; graze corpus add c",
               1, "c/summary.json: expected a campaign's summary, found something else");
  expect_error(
      "printf 'OFF\\n6 2 0\\n0 0 0\\n4 0 0\\n0 4 0\\n1 1 -1\\n1 1 1\\n2 1 1\\n3 0 1 2\\n3 3 4 5\\n' > $'\\xff.off'; "
      "graze fuzz --mesh $'\\xff.off'",
      2, "--mesh: expected a file name in UTF-8");
  expect_done(
      "echo '0 0 0 1 0 0 0 1 0  0 0 1 1 0 1 0 1 1' > "
      "$'\\xff.pairs' && graze "
      "explain $'\\xff.pairs' --json");
}

// A full disk, played by a limit on the size of files: one line, and the same command goes on once there is room.
TEST_F(Cli, AFullDiskLosesNothing) {
  const std::string fuzz = "graze fuzz --seed 5 --pairs 150000 --strata 'near_*' ";
  expect_error("ulimit -f 400; " + fuzz + "--out disk", 1, "disk");
  ASSERT_EQ(shell(fuzz + "--out disk").status, 0);
  ASSERT_EQ(shell(fuzz + "--out whole").status, 0);
  EXPECT_EQ(shell("diff disk/summary.json whole/summary.json && diff -r disk/cases whole/cases").status, 0);
  EXPECT_NE(shell("graze strata > /dev/full").status, 0);
}

// kill -9 at many moments; each time the same command goes on, and the end is the same bytes.
TEST_F(Cli, KilledCampaignsGoOnToTheSameBytes) {
  const std::string fuzz = "graze fuzz --seed 9 --pairs 600000 --strata 'near_*,degenerate' ";
  ASSERT_EQ(shell(fuzz + "--threads 2 --out whole").status, 0);
  int killed = 0;
  for (int i = 0; i < 12; ++i) {
    const Ran ran = shell("timeout -s KILL 0." + std::to_string(2 + i % 5) + " " + fuzz + "--threads 1 --out killed");
    if (ran.status != 0) ++killed;
  }
  EXPECT_GT(killed, 2);
  ASSERT_EQ(shell(fuzz + "--threads 1 --out killed").status, 0);
  EXPECT_EQ(shell("diff killed/summary.json whole/summary.json && diff -r killed/cases whole/cases").status, 0);
}

TEST_F(Cli, CtrlCKeepsWhatWasDoneAndSaysSo) {
  const std::string fuzz = "graze fuzz --seed 9 --pairs 600000 --strata 'near_*,degenerate' --threads 1 ";
  const Ran ran = shell("timeout -s INT 0.4 " + fuzz + "--out stopped; echo status $?");
  EXPECT_NE(ran.err.find("graze: interrupted"), std::string::npos) << ran.out << ran.err;
  ASSERT_EQ(shell(fuzz + "--out stopped").status, 0);
  ASSERT_EQ(shell(fuzz + "--out whole").status, 0);
  EXPECT_EQ(shell("diff stopped/summary.json whole/summary.json && diff -r stopped/cases whole/cases").status, 0);
}

TEST_F(Cli, ReproRunsStoredCasesAndNoticesChange) {
  ASSERT_EQ(shell("graze fuzz --pairs 20000 --strata exact_contact --out c").status, 0);
  const std::string first = Json::parse(contents(shell.folder / "c/summary.json"))["signatures"][0]["case"];
  const Ran same = shell("graze repro c/" + first);
  EXPECT_EQ(same.status, 0) << same.out;
  EXPECT_NE(same.out.find("(as recorded)"), std::string::npos);
  const Ran changed = shell("sed 's|/22/|/21/|' c/" + first + " > changed.pairs; graze repro changed.pairs");
  EXPECT_EQ(changed.status, 1);
  EXPECT_NE(changed.out.find("CHANGED"), std::string::npos);
  // Lanes that do not run now change nothing.
  const std::string algorithm = Json::parse(contents(shell.folder / "c/summary.json"))["signatures"][0]["key"];
  const std::string other = algorithm.find("moller") == std::string::npos ? "moller_*" : "separating_*";
  const Ran others = shell("graze repro c/" + first + " --lanes '" + other + "'");
  EXPECT_EQ(others.status, 0) << others.out;
  EXPECT_NE(others.out.find("not compared"), std::string::npos);
  EXPECT_EQ(shell("echo '0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1 | stratum=x' > s.pairs; graze repro s.pairs").status, 0);
}

TEST_F(Cli, EveryVerbHasHelpWithAnExampleThatRuns) {
  for (const std::string verb :
       {"fuzz", "check", "repro", "explain", "dump", "lanes", "strata"}) {  // prove-twin needs a device
    const Ran help = shell("graze " + verb + " --help");
    EXPECT_EQ(help.status, 0);
    const std::size_t at = help.out.find("Example: ");
    ASSERT_NE(at, std::string::npos) << verb;
    const std::string example = help.out.substr(at + 9, help.out.find('\n', at) - at - 9);
    EXPECT_EQ(shell("set -o pipefail; jq() { cat; }; " + example).status, 0) << example;
  }
}

TEST_F(Cli, TheLastOutAndFlagsInAnyOrderCount) {
  EXPECT_EQ(shell("graze fuzz --pairs 1000 --out a --out b && test -f b/summary.json && test ! -e a").status, 0);
  EXPECT_EQ(shell(std::string("echo '") + kTouching + "' > p; graze check --lanes '*/f32/cpu' p --json").status, 0);
}

TEST_F(Cli, TwinsFillTheCudaColumnsWithoutADevice) {
  const Ran ran = shell("graze fuzz --pairs 4000 --executor twin --lanes '*/f32/*' --json --out c");
  ASSERT_EQ(ran.status, 0) << ran.err;
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
  EXPECT_NE(ran.out.find("graze repro c/cases/"), std::string::npos);
}

}  // namespace
}  // namespace graze::cli
