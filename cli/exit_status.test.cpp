// SPDX-License-Identifier: Apache-2.0
// The exit statuses that docs/formats.md promises, for every verb: done, a failed run, wrong use, interrupted.
#include <set>
#include <vector>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

struct Verb {
  const char *name, *done, *fails;  // command lines without `graze`; empty if this machine cannot run one
};

constexpr const char* kMoller = " --lanes moller_1997/f32/cpu ";

const std::vector<Verb>& verbs() {
  static const std::vector<Verb> all = {
      {"try", "mine.c --pairs 60 --out t", "none.c --out x"},
      {"fuzz", "--pairs 60 --strata near_edge_edge --lanes 'moller_1997/f32/cpu' --out c", "--mesh none.off --out x"},
      {"pack", "c", "none"},
      {"merge", "s1 s2 --out merged", "none --out x"},
      {"status", "s1 s2", "broken"},
      {"plan", "--pairs 1000 --lanes moller_1997/f32/cpu", "--pairs 1000 --scene none.toml"},
      {"hunt", "", "--runs 10 --scene none.toml --out x"},
      {"check", "p", "none.pairs"},
      {"repro", "p", "none.pairs"},
      {"minimize", "p --lanes 'guigue*/f32/cpu'", "none.pairs"},
      {"corpus", "add p --corpus r", "verify --corpus none"},
      {"explain", "p --lanes 'guigue*/f32/cpu'", "none.pairs"},
      {"failures", "c", "none"},
      {"league", "--subjects subjects.txt --pairs 40 --strata uniform --out l", "--subjects none.txt --out x"},
      {"map", "p --lanes moller_1997/f32/cpu --out map.png", "none.pairs --out x.png"},
      {"view", "", "none.pairs --out x.html"},
      {"dump", "uniform --pairs 5", "none/"},
      {"report", "c", "none"},
      {"scene", "mesh.off", "none.off"},
      {"lanes", "", ""},
      {"strata", "", ""},
      {"invariants", "--pairs 40 --strata uniform --lanes moller_1997/f32/cpu --out invariants",
       "--scene none.toml --out x"},
      {"discrepancy",
       "guigue_devillers_2003/f32/cpu guigue_devillers_2003/f32/cuda-nofma --pairs 40 --strata uniform --out "
       "discrepancy",
       "--scene none.toml --out x"},
      {"pareto", "--pairs 1000 --strata uniform --lanes moller_1997/f32/cpu,exact/f32/cpu --out pareto",
       "--scene none.toml --out x"},
      {"tune", "moller_1997/f32/cpu --pairs 100 --strata uniform --out tuned",
       "moller_1997/f32/cpu --scene none.toml --out x"},
      {"prove-twin", "", ""},
      {"query", "'mesh.off#0' mesh.off", "none.txt mesh.off"},
      {"bench", "", "--mesh none.off"},
      {"toolchain", "'cc -O2 -ffp-contract=off' --json toolchain.json", "--toolchains none.toml"},
  };
  return all;
}

class ExitStatus : public CommandTest {
 protected:
  void SetUp() override {
    std::ofstream(shell.folder / "p") << "0.1 0.2 0.3 0.4 0.9 0.2 0.7 0.1 0.6 0.1 0.2 0.3 0.5 0.5 0.9 -0.3 0.8 0.4\n";
    std::ofstream(shell.folder / "mesh.off")
        << "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 1\n3 0 1 2\n3 3 4 5\n";
    std::ofstream(shell.folder / "mine.c")
        << "int intersects(const float a[9], const float b[9]) { return a[0] < b[0]; }\n";
    std::ofstream(shell.folder / "subjects.txt") << "mine=" << (shell.folder / "mine.c").string() << '\n';
    std::filesystem::create_directories(shell.folder / "broken");
    std::ofstream(shell.folder / "broken/status.json") << "{}";
    for (const char* k : {"1", "2"})
      expect_done("graze fuzz --pairs 60 --strata uniform --lanes moller_1997/f32/cpu --shard " + std::string(k) +
                  "/2 --out s" + k);
  }

  int interrupted(const std::string& command) const {
    const Ran ran = signalled("graze " + command, "TERM");
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    return ran.status;
  }
};

TEST_F(ExitStatus, OfEveryVerb) {
  const std::vector<std::string> listed = verbs_in_help(shell, "graze");
  const std::set<std::string> names(listed.begin(), listed.end());
  std::set<std::string> tested;
  for (const Verb& verb : verbs()) {
    tested.insert(verb.name);
    const std::string graze = std::string("graze ") + verb.name + ' ';
    expect_error(graze + "--no-such-option", 2, {"graze:"});
    if (*verb.done || std::string(verb.name) == "lanes") expect_done(graze + verb.done);
    if (*verb.fails) expect_error(graze + verb.fails, 1, {"graze:"});
    expect_done(graze + "--help");
  }
  EXPECT_EQ(names, tested);
  EXPECT_GT(tested.size(), 20u);
}

TEST_F(ExitStatus, InterruptedIs130) {
  expect_done(std::string("graze fuzz --pairs 20000 --strata 'near_*' --out many") + kMoller);
  EXPECT_EQ(interrupted(std::string("fuzz --pairs 1e9 --out f") + kMoller), 130);
  EXPECT_EQ(interrupted("minimize many"), 130);
  EXPECT_EQ(interrupted("failures many"), 130);
  EXPECT_EQ(interrupted("league --subjects subjects.txt --pairs 1e8 --out l"), 130);
  if (shell("graze hunt --runs 1 --out h1").status == 0) {
    EXPECT_EQ(interrupted("hunt --runs 1e9 --out h"), 130);
  }
}

TEST_F(ExitStatus, AnEmptyValueTakesNoOtherWord) {
  expect_error("graze fuzz --pairs 20 --lanes 'moller*/f32/cpu' --junit= --fail-above=0", 2, {"--junit"});
  expect_error("graze fuzz --pairs 20 --lanes 'moller*/f32/cpu' --junit --fail-above=0", 2, {"--junit"});
  expect_error("graze fuzz --pairs 20 --out= --lanes 'moller*/f32/cpu'", 2, {"--out"});
  expect_done("test ! -e ./--fail-above=0 && graze fuzz --pairs 20 --subject m=cmd:true --flags= --help");
}

TEST_F(ExitStatus, PlacesWithOtherThingsAreWrongUse) {
  std::filesystem::create_directories(shell.folder / "mine");
  std::ofstream(shell.folder / "mine/notes.txt") << "kept";
  for (const std::string out : {"mine", "/"}) {
    for (const Verb& verb : verbs()) {
      const std::string done = verb.done, name = verb.name;
      const std::size_t at = done.find("--out ");
      if (at == done.npos || name == "map") continue;
      expect_error("graze " + name + ' ' + done.substr(0, at) + "--out " + out, 2, {out, "empty"});
    }
  }
  for (const std::string file : {"p", "link"}) {
    expect_done("ln -sf p link");
    expect_error("graze minimize p --lanes 'guigue*/f32/cpu' --out " + file, 2, {file, "--force"});
    expect_error("graze scene mesh.off --out " + file, 2, {file, "--force"});
    expect_error("graze query 'mesh.off#0' mesh.off --obj " + file, 2, {file, "--force"});
    expect_error("graze status s1 --prometheus " + file, 2, {file, "--force"});
    expect_error("graze toolchain x86-gcc --json " + file, 2, {file, "--force"});
  }
  EXPECT_EQ(shell.file("p").substr(0, 4), "0.1 ");
  EXPECT_EQ(shell.file("mine/notes.txt"), "kept");
  expect_done(
      "graze minimize p --lanes 'guigue*/f32/cpu' --out link --force && test -L link && head -n 1 p | grep -q "
      "graze-pairs");
  expect_done("graze minimize p --lanes 'guigue*/f32/cpu' --out link");  // the file is graze's own by now
}

}  // namespace
}  // namespace graze::cli
