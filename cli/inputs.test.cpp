// SPDX-License-Identifier: Apache-2.0
// Tests user input (wrong words, counts, pasted pairs, missing files) and the commands that graze suggests.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTouching = "0 0 0 4 0 0 0 4 0  1 1 0 1 2 4 2 1 4";

class Inputs : public CommandTest {};

TEST_F(Inputs, WrongUseExitsWithTwo) {
  expect_error("graze", 2, {"no verb", "graze --help"});
  expect_error("graze fuzz --pairs many", 2, {"--pairs"});
  expect_error("graze nosuch", 2, {"'nosuch'"});
  expect_error("graze fuzz --pairs 0", 2, {"'0'"});
  expect_error("graze fuzz --pairs -5", 2, {"'-5'"});
  expect_error("graze fuzz --seed 99999999999999999999999", 2, {"--seed", "99999999999999999999999"});
  expect_error("graze fuzz --threads -1", 2, {"0", "4096", "'-1'"});
  expect_error("graze fuzz --executor gpu", 2, {"gpu"});
  expect_error("graze repro 'near_*:1:0'", 2, {"near_*", "several"});
  expect_error("graze fuzz --lanes 'moler_*'", 2, {"'moler_*'"});
  expect_error("graze fuzz --strata 'uniform,nowhere'", 2, {"'nowhere'"});
  expect_error("echo | graze check - --lanes nothing", 2, {"'nothing'"});
  expect_error("graze repro uniform:x:3", 2, {"'x'"});
  expect_error("graze repro nowhere:1:3", 2, {"'nowhere'"});
  expect_error("graze fuzz --pairs 100 --out here > /dev/null && graze fuzz --pairs 200 --out here", 2,
               {"here", "pairs", "100", "200", "--out"});
}

// For every verb, a missing file or folder is a failed run; only errors in the command line are wrong use.
TEST_F(Inputs, MissingFilesAndFoldersAreTheSameFailure) {
  for (const char* verb : {"check", "repro", "explain", "map", "minimize", "report", "corpus add", "dump",
                           "report --out r.html --from", "fuzz --mesh", "corpus list --corpus"}) {
    for (const char* name : {"no/where", "no/where.pairs"})
      expect_error(std::string("graze ") + verb + ' ' + name, 1, {std::string(name)});
    expect_error("mkdir -p empty; graze " + std::string(verb) + " empty", 1, {"empty"});
  }
}

// Unreadable inputs are never reported with a library's message.
TEST_F(Inputs, FoldersAndDevicesInAFilesPlaceAreNamed) {
  expect_error("mkdir d; graze check d", 1, {"d", "Is a directory"});
  expect_error("graze fuzz --mesh d", 1, {"d", "Is a directory"});
  expect_error("graze report --from d --out r.html", 1, {"d", "Is a directory"});
  // Some devices never end.
  expect_error("graze report --out r.html --from /dev/zero", 1, {"/dev/zero", "64 MiB"});
  expect_error("graze league --subjects /dev/zero --out l", 1, {"/dev/zero", "64 MiB"});
  for (const char* verb : {"check", "explain", "fuzz --mesh", "report --out r.html --from"}) {
    const Ran ran = shell(std::string("graze ") + verb + " /proc/self/mem");  // opens, but cannot be read
    EXPECT_EQ(ran.status, 1) << verb;
    EXPECT_TRUE(has(ran.err, {"/proc/self/mem"})) << verb;
    EXPECT_FALSE(has(ran.err, {"basic_filebuf"})) << verb;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
  // A read error on standard input is not mistaken for the end of the input.
  expect_error("graze check - --truth-only < /tmp", 1, {"cannot read standard input"});
}

// A refused command leaves the folder unchanged.
TEST_F(Inputs, RefusedCommandsChangeNoFolder) {
  expect_done("graze fuzz --pairs 500 --strata lattice --lanes '*/f32/cpu' --out c && rm c/campaign.sqlite");
  for (const char* verb :
       {"fuzz --pairs 500 --strata lattice --lanes '*/f32/cpu'", "fuzz --pairs 10", "hunt --runs 10"}) {
    expect_error(std::string("graze ") + verb + " --out c", 2, {"not their database"});
    expect_error("ls c/campaign.sqlite", 2, {"No such file"});
    expect_done("graze report c");
  }
  expect_done("mkdir x && echo mine > x/notes.txt");
  expect_error("graze corpus add c --top 1 --lanes '*/f32/cpu' --corpus x", 2, {"cannot write into x", "--force"});
  EXPECT_EQ(shell("ls x").out, "notes.txt\n");
  expect_done("graze corpus add c --top 1 --lanes '*/f32/cpu' --corpus x --force");
  // Even without the database, a summary whose strata were changed is refused.
  expect_done("sed -i 's/\"lattice\"$/\"thesis\"/' c/summary.json");
  expect_error("graze report c", 1, {"c/summary.json", "strata"});
  expect_error("graze fuzz --subject z=cmd:no-such-cmd --pairs 10 --out z", 1, {"no-such-cmd"});
}

TEST_F(Inputs, WrongWordsAreNamedWithWhatIsNearest) {
  expect_error("graze --bogus", 2, {"'--bogus'", "graze --help"});
  expect_error("graze minimise x", 2, {"'minimise'", "'minimize'"});
  expect_error("graze fuzz --lanes 'moler_*'", 2, {"'moler_*'", "'moller_1997/f32/cpu'"});
  expect_error("graze fuzz --strata near_edge_egde", 2, {"'near_edge_egde'", "'near_edge_edge'"});
  expect_error("graze fuzz --executor twin --lanes 'moller_1997/f32/cpu,*/f32/cuda-fast' --pairs 10", 2,
               {"'*/f32/cuda-fast'", "no twin", "projected_sat/f32/cuda-fast", "moller_1997/f32/cuda-fast"});
  expect_error("graze fuzz --lanes ,", 2, {"--lanes", "','"});
  expect_error("graze fuzz --strata 'uniform,,thesis'", 2, {"--strata", "'uniform,,thesis'"});
  expect_error("graze fuzz --executor nope", 2, {"'nope'"});
  expect_error("graze fuzz --engine 1", 2, {"'1'"});
  expect_error("graze repro uniform:1:1 --emit nope", 2, {"'nope'"});
  expect_error("echo | graze check - --truth-only --lanes '*'", 2, {"--lanes"});
  expect_error("echo | graze check - --truth-only --toolchains x86-gcc", 2, {"--toolchains"});
  expect_error("graze dump uniform --pairs 2 --toolchains x86-gcc", 2, {"--toolchains", "--lanes"});
  expect_error("graze fuzz --pairs 2 --toolchains x86-gcc,x86-clang --lanes '*/x86-gcc'", 2,
               {"--toolchains", "x86-clang", "--lanes"});
  expect_done(
      "printf '[[toolchain]]\nname = \"mine\"\ncxx = \"c++ -O2\"\n' | tee first.toml > second.toml; "
      "graze lanes --toolchains first.toml,second.toml --lanes 'moller_1997/f32/mine'");
  expect_error("graze dump uniform --pairs 2 --executor twin", 2, {"--executor", "--lanes"});
  expect_error("graze scene a.toml --sufficient 1e-3 --poses p.csv", 2, {"--poses"});
  expect_error("graze scene a.toml --sufficient 1e-3 --units mm", 2, {"--units"});
  expect_error("graze repro uniform:18446744073709551615:1", 2, {"uniform:18446744073709551615:1", "2^53"});
  expect_error("graze bench --between a.off b.off --lanes '*/f32/cpu'", 2, {"--lanes", "--triangles"});
  expect_error("graze bench --between a.off b.off --plot p.svg", 2, {"--plot", "--triangles"});
}

TEST_F(Inputs, UnknownOptionsAreNamedWithWhatIsNearest) {
  expect_error("graze fuzz --lane 'moller*'", 2, {"--lane", "did you mean '--lanes'"});
  expect_error("graze fuzz --pairs 10 --stratum=uniform --out x", 2, {"--stratum", "did you mean '--strata'"});
  expect_error("graze corpus add p --corpu r", 2, {"--corpu", "did you mean '--corpus'"});
  expect_error("graze fuzz --quite-another-thing", 2, {"--quite-another-thing", "graze fuzz --help"});
}

TEST_F(Inputs, CountsAreWhatPeopleWrite) {
  for (const char* count : {"2000", "2_000", "2e3", "2k", "0.2e4", "0.002M"}) {
    const Ran ran =
        shell.done(std::string("graze fuzz --strata uniform --lanes exact/f32/cpu --json --out c --pairs ") + count);
    EXPECT_EQ(Json::parse(ran.out)["spec"]["pairs"], 2000) << count;
  }
  for (const char* count : {"1.5", "1e", "_1", "1__0", "1_", "1e99", "1x", "kM", "1e-1", ".5M"})
    expect_error(std::string("graze fuzz --pairs ") + count, 2, {std::string("'") + count + "'"});
}

TEST_F(Inputs, ForeignTextDoesNotReachTheTerminal) {
  std::ofstream(shell.folder / "a:b:c")
      << kTouching << R"( | name="a\x1b[31mb" stratum="\x1b]0;t" seed=1 index=2 signature="\x07/x:")";
  for (const char* verb : {"check", "repro", "explain", "repro --emit obj", "repro --emit python"}) {
    const Ran ran = shell(std::string("graze ") + verb + " a:b:c");  // a file name, because the file exists
    EXPECT_LE(ran.status, 1) << verb << ran.err;
    EXPECT_EQ((ran.out + ran.err).find_first_of("\x1b\x07"), std::string::npos) << verb << ran.out;
  }
  EXPECT_TRUE(has(shell("graze check a:b:c").out, {"a\\x1b[31mb"}));
}

// Names of folders and files are escaped too.
TEST_F(Inputs, NoNameReachesTheTerminalAsItIs) {
  shell("mkdir x");
  const std::string name = "x/$'\\e[31m'";
  const std::string lanes = " --lanes '*/f32/cpu' --pairs 1000 --out " + name;
  const std::string script =
      "graze fuzz --strata lattice" + lanes + "c && graze minimize " + name + "c && graze report " + name +
      "c && graze status " + name + "c && graze status --prometheus p.prom " + name +
      "c && cat p.prom && graze pareto" + lanes + "p && graze invariants" + lanes +
      "i && graze hunt --runs 1000 --lanes '*/f32/cpu' --out " + name +
      "h && graze discrepancy moller_1997/f32/cpu moller_1997/f64/cpu --pairs 100 --out " + name +
      "d; graze tune moller_1997/f32/cpu --pairs 1000 --out " + name + "t; cp " + name + "c/cases/$(ls " + name +
      "c/cases | head -1) " + name + ".pairs && graze explain " + name + ".pairs && graze map " + name +
      ".pairs --out " + name + "m && graze check " + name + ".pairs && graze corpus add " + name + ".pairs --corpus " +
      name + "k && graze pack " + name + "c";
  std::ofstream(shell.folder / "all.sh") << script;
  const Ran ran = shell.done("bash all.sh");
  EXPECT_GT(std::count(ran.out.begin(), ran.out.end(), '\n'), 100);
  for (const std::string& text : {ran.out, ran.err}) {
    const std::size_t at = text.find('\x1b');
    EXPECT_EQ(at, text.npos) << text.substr(at > 200 && at != text.npos ? at - 200 : 0, 300);
  }
}

// If float32 rounds decimals to another pair, both truths are reported.
TEST_F(Inputs, WhatFloat32MakesOfDecimalsIsSaid) {
  std::ofstream(shell.folder / "near.pairs")
      << "0 0 1 1 0 1 0 1 1  0 0 1.00000000001 1 0 1.00000000001 0 1 1.00000000001\n";
  const std::string note = "as written: disjoint, 1e-11 apart; as stored in float32: they share an area";
  for (const std::string command :
       {"graze check near.pairs", "graze check near.pairs --json", "graze explain near.pairs",
        "graze minimize near.pairs", "graze corpus add near.pairs"}) {
    const Ran ran = shell(command);
    EXPECT_TRUE(has(ran.out + ran.err, {note})) << command;
    expect_error(command + " --exact-input", 2, {"near.pairs:1", "\"1.00000000001\"", "--exact-input", "12"});
  }
  // A hexadecimal number that float32 cannot represent makes the pair a pair of doubles.
  const Ran hex = shell(
      "echo '0 0 1 1 0 1 0 1 1  0 0 0x1.0000000000001p0 1 0 0x1.0000000000001p0 0 1 "
      "0x1.0000000000001p0' | graze check -");
  EXPECT_TRUE(has(hex.out, {"truth: disjoint", "as stored in float32: they share an area"}));
  // Doubles cannot distinguish these decimals either.
  const Ran finer = shell(
      "echo '0 0 1 1 0 1 0 1 1  0 0 1.00000000000000000001 1 0 1.00000000000000000001 0 1 1.00000000000000000001' | "
      "graze check -");
  EXPECT_TRUE(has(finer.out, {"as written: disjoint, 1e-20 apart; as doubles and as stored in float32:"}));
  EXPECT_FALSE(has(finer.out, {"it rounds"}));
  // Doubles and float32 round the pair to different distances.
  const Ran apart = shell(
      "echo '9.3 0.4 16.2 2.6 2.1 21.2 7.6 5.7 12.6  6.11 2.67 17.12 10.21 7.27 17.42 9.21 4.17 18.22' | graze check - "
      "--json");
  EXPECT_TRUE(
      has(apart.out,
          {"as written: they touch in a point; as doubles: disjoint, 9.29e-16 apart;",
           "as stored in float32: disjoint, 2.91e-07 apart (it rounds 18 numbers, the first is number 1, 9.3)"}));
  EXPECT_TRUE(has(shell("graze check near.pairs").out, {"(it rounds 3 numbers, the first is number 12, "}));
  // Rounding that does not change the truth is not reported.
  expect_done("echo '0.1 0 0 4 0 0 0 4 0  1 1 0.3 1 2 4 2 1 4' > p; graze check p > out; ! grep -q written out");
  expect_done(std::string("echo '") + kTouching + "' | graze check - --exact-input");
}

// Two parallel triangles of a model in metres, far from the origin: disjoint as written, identical in float32.
TEST_F(Inputs, WhatFloat32MakesOfMeshesIsSaid) {
  std::ofstream(shell.folder / "far.off") << "OFF\n6 2 0\n1000000.01 0 0\n1000000.01 1 0\n1000000.01 0 1\n"
                                             "1000000.02 0 0\n1000000.02 1 0\n1000000.02 0 1\n3 0 1 2\n3 3 4 5\n";
  std::ofstream(shell.folder / "first.txt") << "1000000.01 0 0 1000000.01 1 0 1000000.01 0 1\n";
  const std::string note = "far.off: float32 rounded 6 of 18 coordinates, by at most 0.021";
  for (const std::string command : {"graze query far.off#0 far.off --lanes 'exact,moller_1997/f32/cpu'",
                                    "graze query first.txt far.off --lanes moller_1997/f32/cpu",
                                    "graze fuzz --mesh far.off --lanes '*/f32/cpu' --out c"}) {
    const Ran ran = shell.done(command);
    EXPECT_TRUE(has(ran.err, {note})) << command;
    EXPECT_EQ(ran.err.find(note), ran.err.rfind(note)) << command << ran.err;
    EXPECT_EQ(ran.err.find("graze: exact decides the rounded triangles too") != std::string::npos,
              command.find("exact,moller") != std::string::npos)
        << command << ran.err;
    const std::string again = command.starts_with("graze fuzz") ? command + "2" : command;
    expect_error(again + " --exact-input", 2, {"float32", "6 of", "--exact-input"});
    EXPECT_FALSE(std::filesystem::exists(shell.folder / "c2"));
  }
  EXPECT_TRUE(
      has(shell("graze query first.txt far.off --lanes 'exact*/f32/cpu'").err, {"first.txt: float32 rounded 3 of 9"}));
  std::ofstream(shell.folder / "near.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0.5 1 0\n3 0 1 2\n";
  for (const std::string command :
       {"graze query --self far.off", "graze query far.off far.off --between", "graze query first.txt far.off",
        "graze query far.off#1 far.off --any", "graze scene far.off"}) {
    expect_error(command + " --exact-input", 2, {"float32", "6 of", "--exact-input"});
    const Ran ran = shell(command);
    EXPECT_TRUE(
        has(ran.err, {"far.off: decided in doubles, because 6 of 18 coordinates have more digits than float32 holds"}));
    EXPECT_FALSE(has(ran.err, {"rounded"}));
  }
  expect_done("graze query first.txt far.off --csv h.csv --obj h.obj --pairs h.pairs > out; grep -q '^1 of 2' out");
  expect_done("graze query far.off#1 near.off 2> err; grep -q 'far.off: decided in doubles' err");
  expect_done("grep -q 'coordinates=f64' h.pairs && graze check h.pairs --lanes exact/f64/cpu | grep -q intersects");
  expect_done("grep -q 'v 1000000.01 0 0' h.obj && grep -q 0,0,area,pierces h.csv");
  expect_done("graze query --between far.off far.off --pairs b.pairs > out && graze check b.pairs > out");
  // Numbers too small for a double are rounded to 0, which is reported too.
  std::ofstream(shell.folder / "least.off")
      << "OFF\n6 2 0\n0 0 0\n1 0 0.0\n0 1 -0\n0 0 1e-500\n1 0 1e-500\n0 1 1e-500\n3 0 1 2\n3 3 4 5\n";
  std::ofstream(shell.folder / "least.txt") << "-1 -1 1e-500 2 0 0 0 2 0\n";
  for (const std::string command : {"graze query --self least.off", "graze query least.off#0 least.off",
                                    "graze fuzz --mesh least.off --lanes exact/f32/cpu --out l"}) {
    const Ran ran = shell(command);
    EXPECT_TRUE(has(ran.err, {"least.off: float32 rounded 3 of 18 coordinates"})) << command;
    expect_error(command + " --exact-input", 2, {"least.off", "3 of 18", "--exact-input"});
  }
  expect_error("graze query least.txt near.off --exact-input", 2, {"least.txt", "1 of 9"});
  const Ran exact = shell.done("graze query --self near.off --exact-input");
  EXPECT_FALSE(has(exact.err, {"float32"}));
}

TEST_F(Inputs, PatternsThatLeaveNothingAreWrongUse) {
  for (const std::string strata : {"'!*'", "'near_*,!near_*'"}) {
    for (const std::string command :
         {"graze fuzz --pairs 100 --out c", "graze hunt --runs 100 --out c", "graze invariants --pairs 100",
          "graze discrepancy interval_overlap/f32/cpu interval_overlap/f32/cpu-fma --pairs 100 --out c",
          "graze tune moller_1997/f32/cpu --pairs 1000 --out c"})
      expect_error(command + " --strata " + strata, 2, {"leave no stratum"});
  }
  std::ofstream(shell.folder / "m.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string lanes : {"'exact,!exact'", "'!*'"})
    expect_error("graze query m.off#0 m.off --lanes " + lanes, 2, {"leave no lane"});
  expect_error("graze fuzz --pairs 100 --out c --lanes '!*'", 2, {"leave no lane"});
}

// A name in brackets is a name, not a list.
TEST_F(Inputs, NamesInBracketsAreNames) {
  expect_done("graze fuzz --strata lattice --lanes exact/f32/cpu --pairs 100 --seed 1 --out '[x]'");
  expect_done("graze fuzz --strata lattice --lanes exact/f32/cpu --pairs 200 --seed 2 --out x");
  expect_done("graze merge '[x]' --out m && grep -q '\"seed\": 1,' m/summary.json");
  const std::string mesh = "OFF\n4 2 0\n0 0 0\n1 0 0\n0.5 1 0\n0 0 1\n3 0 1 2\n3 0 1 3\n";
  std::ofstream(shell.folder / "[t].off") << mesh;
  std::ofstream(shell.folder / "[t.off]") << mesh;
  expect_done("graze scene '[t].off'");
  expect_error("graze scene '[t.off]'", 1, {"[t.off]"});
}

TEST_F(Inputs, LongExponentsAreRefused) {
  const std::string rest = " 0 0  1 0 0  0 1 0   0 0 1  1 0 1  0 1 1 | coordinates=f64\n";
  std::ofstream(shell.folder / "least.pairs") << "0x1p-99999" + rest;
  std::ofstream(shell.folder / "less.pairs") << "0x1p-100000" + rest;
  expect_done("graze check least.pairs --lanes 'exact/*/cpu'");
  expect_error("graze check less.pairs --lanes 'exact/*/cpu'", 1, {"less.pairs:1", "exponent", "0x1p-100000"});
}

// Pasted pairs, in every verb that takes a pair; here two segments that meet in a point.
TEST_F(Inputs, PastedPairsAreReadByEveryVerb) {
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
      const Ran ran = shell("graze " + verb + (verb == "explain" ? " --all " : " ") + name);
      EXPECT_TRUE(has(ran.out, {"truth: intersects, contact point"})) << verb << name << ran.err;
    }
    const std::string file = name;
    expect_done("graze repro " + file + " --emit obj && graze minimize " + file + " --out m && graze explain m && " +
                "graze map " + file + " --lanes 'moller_1997/f32/cpu' --out m.png");
    const Ran added = shell("graze corpus add " + file);
    EXPECT_TRUE(added.out.find(name == std::string("commas") ? " new, 0 seen" : "0 new, ") != std::string::npos)
        << added.out << added.err;
  }
}

TEST_F(Inputs, AByteOrderMarkIsSkipped) {
  std::ofstream(shell.folder / "bom.pairs") << "\xef\xbb\xbf" << kTouching << '\n';
  expect_done("graze check bom.pairs");
}

TEST_F(Inputs, PrintedCommandsRunAsTheyStand) {
  const Ran ran = shell("graze fuzz --pairs 300 --strata lattice --lanes '*/f32/cpu' --out 'my campaign'");
  const std::size_t at = ran.out.find("disagreement: ");
  ASSERT_NE(at, std::string::npos) << ran.out;
  expect_done(ran.out.substr(at + 14, ran.out.find('\n', at) - at - 14));
  EXPECT_TRUE(ran.out.ends_with("\nNext: graze minimize 'my campaign'\n")) << ran.out;
  // Each verb's output ends with the next command.
  const Ran minimized = shell("graze minimize 'my campaign'");
  EXPECT_TRUE(minimized.out.ends_with("\nNext: graze report 'my campaign'\n")) << minimized.out << minimized.err;
  EXPECT_TRUE(shell("graze repro exact_contact:1:1").out.ends_with("\nNext: graze minimize exact_contact:1:1\n"));
  EXPECT_TRUE(shell("graze repro uniform:1:1 --lanes 'exact/*'").out.find("Next:") == std::string::npos);
  EXPECT_TRUE(shell("graze minimize exact_contact:1:1 --lanes 'guigue_*/f32/cpu' --out 'a b'")
                  .out.ends_with("\nNext: graze explain 'a b'\n"));
  EXPECT_TRUE(shell("graze explain 'a b' --lanes 'guigue_*/f32/cpu'").out.ends_with("\nNext: graze map 'a b'\n"));
  EXPECT_TRUE(shell("graze check 'a b' --lanes 'guigue_*/f32/cpu'").out.ends_with("\nNext: graze explain 'a b'\n"));
  EXPECT_FALSE(has(shell("graze check 'a b' --lanes 'exact/*'").out, {"Next:"}));
  EXPECT_TRUE(shell("graze map 'a b' --lanes 'guigue_*/f32/cpu' --out m.png")
                  .out.ends_with("\nNext: graze repro 'a b' --emit cpp\n"));
  expect_done("graze repro 'a b' --emit cpp > bug.cpp");
  EXPECT_TRUE(shell("graze report 'my campaign'").out.ends_with("\nNext: graze corpus add 'my campaign'\n"));
  EXPECT_TRUE(shell("graze corpus add 'my campaign' --top 1 --corpus 'its corpus'")
                  .out.ends_with("\nNext: graze corpus verify --corpus 'its corpus'\n"));
  EXPECT_TRUE(shell("graze corpus list --corpus 'its corpus'")
                  .out.ends_with("\nNext: graze corpus verify --corpus 'its corpus'\n"));
  expect_done("graze corpus verify --corpus 'its corpus'");
  for (const char* verb : {"lanes", "strata"}) {  // the commands that they print can be run
    const std::string table = shell(std::string("graze ") + verb).out;
    expect_done(table.substr(table.find("Next: ") + 6, table.size() - table.find("Next: ") - 7) + " --pairs 50 --out " +
                verb);
  }
  // Output for other programs has no such line.
  EXPECT_FALSE(
      has(shell("graze check 'a b' --json; graze explain 'a b' --json; graze lanes --json; graze dump lattice").out,
          {"Next"}));
}

}  // namespace
}  // namespace graze::cli
