// SPDX-License-Identifier: Apache-2.0
// `graze league` as users run it: a file of subjects, a table, and a page whose commands reproduce its results.
#include <nlohmann/json.hpp>
#include <set>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class LeagueCommand : public CommandTest {
 protected:
  LeagueCommand() {
    std::ofstream(shell.folder / "planted.c")
        << "#include <stdlib.h>\n"
           "int no(const float a[9], const float b[9]) { return 0; }\n"
           "int dies(const float a[9], const float b[9]) { if (a[0] == b[0]) abort(); return 0; }\n";
    std::ofstream(shell.folder / "subjects.txt")
        << "# planted\nno=planted.so:no\n  version: 7|8\n  convention: says \"no\"\n  pairs: 200\n"
           "dies=planted.so:dies\nspoken=cmd:python3 spoken.py\n";
    std::ofstream(shell.folder / "spoken.py") << "import sys\nfor line in sys.stdin: print(1, flush=True)\n";
    expect_done("cc -shared -fPIC -O2 planted.c -o planted.so");
  }

  static nlohmann::json without_timings(nlohmann::json league) {
    league.erase("timings");
    return league;
  }
};

constexpr const char* kRun = "graze league --subjects subjects.txt --pairs 1000 --strata lattice,uniform --out found";

// All pairs fit into the scene: no box is wider than the scene's extent.
TEST_F(LeagueCommand, DrawsWithinAScene) {
  std::ofstream(shell.folder / "hall.toml") << "extent = [[100, 108], [0, 4], [0, 4]]\nedges = [0.5, 1, 2]\n";
  expect_done("graze league --subjects subjects.txt --pairs 600 --scene hall.toml --strata uniform --out found");
  const std::string page = shell.file("found/league.md");
  EXPECT_TRUE(has(page, {"--scene hall.toml"}));
  const auto league = shell.json("found/league.json");
  const std::string all = league.dump();
  EXPECT_FALSE(has(all, {"extreme_scale"}));
  EXPECT_GT(league["failures"].size(), 0u);
  expect_error("graze league --subjects subjects.txt --scene nowhere.toml", 1, {"nowhere.toml"});
}

TEST_F(LeagueCommand, LeavesATableAPageAndDrawings) {
  expect_out(kRun, {"on the same 1,000\npairs (general 500, degenerate 500)"});
  const auto league = shell.json("found/league.json");
  const std::string page = shell.file("found/league.md");
  for (const auto& row : league["rows"]) {
    const bool slow = row["subject"] == "no";
    EXPECT_EQ(row["total"]["pairs"], slow ? 200 : 1000) << row["lane"];
    EXPECT_EQ(row["total"]["wrong"]["of"], slow ? 200 : 1000);
    if (slow) {
      EXPECT_EQ(row["total"]["false_positive"], 0);
    }
    if (row["subject"] == "exact") {
      EXPECT_EQ(row["total"]["wrong"]["count"], 0);
    }
    if (row["subject"] == "spoken") {
      EXPECT_EQ(row["total"]["false_negative"], 0);
      EXPECT_TRUE(league["timings"]["nanoseconds"][row["lane"].get<std::string>()].is_null());
    }
    EXPECT_TRUE(has(page, {"| `" + row["lane"].get<std::string>() + "` |"}));
  }
  EXPECT_TRUE(has(page, {"| `no` | 7\\|8 | not known | says &quot;no&quot; | nothing |",
                         "| `spoken` | not known | not known | nothing stated | nothing |"}));
  std::size_t drawings = 0;
  for (const auto& file : std::filesystem::directory_iterator(shell.folder / "found/league")) {
    ++drawings;
    EXPECT_LT(file.file_size(), 4096u);
    EXPECT_TRUE(contents(file.path()).starts_with("<svg xmlns="));
    EXPECT_TRUE(has(page, {"(league/" + file.path().filename().string() + ")"}));
  }
  EXPECT_GT(drawings, 5u);
  EXPECT_LT(page.find("\n### spoken\n"), page.find("\n### moller_1997\n"));  // the libraries' failures come first
}

TEST_F(LeagueCommand, ThePagesCommandsShowItsFailures) {
  expect_done(kRun);
  const auto league = shell.json("found/league.json");
  const std::string page = shell.file("found/league.md");
  std::set<std::string> subjects;
  for (const auto& failure : league["failures"]) {
    const std::string again = failure["again"], says = failure["says"];
    EXPECT_TRUE(has(page, {again}));
    subjects.insert(failure["subject"]);
    const Ran ran = shell.done(again);
    EXPECT_TRUE(has(ran.out, {"truth: " + failure["truth"].get<std::string>()}));
    EXPECT_TRUE(has(ran.out, {says + " !"})) << again;
  }
  for (const char* subject : {"no", "dies", "spoken", "moller_1997"})
    EXPECT_TRUE(subjects.contains(subject)) << subject;
}

TEST_F(LeagueCommand, OfDoublesHasFunctionsOfDoublesAlone) {
  std::ofstream(shell.folder / "doubles.c")
      << "int meet(const double a[9], const double b[9]) { return a[0] < b[0]; }\n";
  expect_done("cc -shared -fPIC -O2 doubles.c -o doubles.so && echo 'by_x=doubles.so:meet/f64' >> subjects.txt");
  const Ran ran = shell.done(
      "graze league --subjects subjects.txt --pairs 600 --strata uniform,stored --coordinates f64 --out found");
  EXPECT_TRUE(has(ran.err, {"graze: left out spoken: it does not take doubles\n"}));
  const auto league = shell.json("found/league.json");
  EXPECT_EQ(league["coordinates"], "f64");
  EXPECT_EQ(league["strata"], nlohmann::ordered_json({"uniform/f64", "stored/f64"}));
  for (const auto& row : league["rows"]) EXPECT_TRUE(has(row["lane"].get<std::string>(), {"/f64/cpu"})) << row["lane"];
  int of_doubles = 0;
  for (const auto& failure : league["failures"]) {
    const std::string again = failure["again"], says = failure["says"];
    const Ran found = shell(again);
    EXPECT_TRUE(has(found.out, {"truth: " + failure["truth"].get<std::string>(), says + " !"})) << again;
    of_doubles += again.find(" | coordinates=f64'") != std::string::npos;
  }
  EXPECT_GT(of_doubles, 3);
  expect_error("graze league --subjects subjects.txt --coordinates both --out x", 2, {"--coordinates both"});
}

TEST_F(LeagueCommand, TheSameRunHasTheSameResultsButForTimings) {
  expect_done(kRun);
  expect_done("mv found first && " + std::string(kRun));
  EXPECT_EQ(without_timings(shell.json("found/league.json")), without_timings(shell.json("first/league.json")));
}

TEST_F(LeagueCommand, BadFilesAreOneLine) {
  const auto expect = [&](const std::string& text, const std::vector<std::string>& words) {
    std::ofstream(shell.folder / "bad.txt") << text;
    expect_error("graze league --subjects bad.txt --pairs 10 --out found", 1, words);
  };
  expect("", {"NAME=WHAT", "bad.txt"});
  expect("no\n", {"bad.txt:1", "NAME=WHAT", "\"no\""});
  expect("  version: 1\n", {"bad.txt:1", "version"});
  expect("no=planted.so:no\n  colour: red\n", {"bad.txt:2", "version", "colour: red"});
  expect("no=planted.so:no\n  pairs: few\n", {"bad.txt:2", "\"pairs: few\""});
  expect_error("graze league --pairs 10", 2, {"--subjects"});
  expect_error("graze league --subjects none.txt", 1, {"none.txt", "No such file or directory"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "found"));
}

}  // namespace
}  // namespace graze::cli
