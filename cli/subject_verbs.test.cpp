// SPDX-License-Identifier: Apache-2.0
// Every verb whose help offers --subject runs a subject, shows it and never drops it; every verb says which requested
// lanes do not run, and why.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

// Hides all devices, so that CUDA lanes without a twin do not run.
constexpr const char* kWithoutDevice = "export CUDA_VISIBLE_DEVICES= XDG_CACHE_HOME=$PWD/cache; graze ";

struct SubjectVerb {
  const char* verb;
  const char* arguments;  // the verb's other arguments
  const char* shows;      // a file that shows the subject; empty: the output does
};

// Verbs of two words are written as in their help.
const std::vector<SubjectVerb>& subject_verbs() {
  static const std::vector<SubjectVerb> all = {
      {"fuzz", "--lanes 'mine/*' --strata uniform --pairs 40 --out f", ""},
      {"hunt", "--lanes 'mine/*' --runs 200 --strata uniform --out h", ""},
      {"check", "p --lanes 'mine/*'", ""},
      {"invariants", "--lanes 'mine/*' --strata uniform --pairs 20 --out i", ""},
      {"repro", "p --lanes 'mine/*'", ""},
      {"minimize", "p --lanes 'mine/*/cpu'", ""},
      {"explain", "p --lanes 'mine/*/cpu'", ""},
      {"map", "p --lanes 'mine/*/cpu' --out m.png", ""},
      {"discrepancy", "--strata uniform --pairs 40 --out d", ""},
      {"view", "p --out v.html", "v.html"},
      {"lanes", "--lanes 'mine/*'", ""},
      {"tune", "mine/f32/cpu --epsilon kGap --strata uniform --pairs 40 --out t", ""},
      {"pareto", "--lanes 'mine/*/cpu,exact/f32/cpu' --strata uniform --pairs 1000 --out o", ""},
      {"query", "'mesh.off#0' mesh.off", ""},
      {"bench", "--triangles 1000 --lanes 'mine/*/cpu'", ""},
      {"plan", "--pairs 1000 --lanes 'mine/*' --json", "plan"},
      {"corpus add", "p --corpus r --lanes 'mine/*/cpu'", "r/cases.pairs"},
      {"corpus verify", "--corpus r --lanes 'mine/*/cpu,exact/f32/cpu'", "r/cases.pairs"},
      {"dump", "uniform --pairs 3", ""},
      {"prove-twin", "", ""},  // only for CUDA sources, and on a device: WhatHasNoUseForASubjectSaysSo
  };
  return all;
}

class SubjectVerbs : public CommandTest {
 protected:
  void SetUp() override {
    std::ofstream(shell.folder / "mine.c")
        << "static const float kGap = 1e-3f;\nint intersects(const float a[9], const "
           "float b[9]) { return a[0] > b[0] + kGap; }\n";
    std::ofstream(shell.folder / "p") << "0 0 0 4 0 0 0 4 0  1 1 -1 1 1 1 3 3 1\n";
    std::ofstream(shell.folder / "mesh.off")
        << "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n3 3 1\n3 0 1 2\n3 3 4 5\n";
  }

  // Returns the verbs whose help contains the text, including verbs of two words such as "corpus add".
  std::vector<std::string> verbs_whose_help_has(const std::string& text) const {
    std::vector<std::string> found;
    for (const std::string& verb : verbs_in_help(shell, "graze")) {
      const std::vector<std::string> within = verbs_in_help(shell, "graze " + verb);
      for (const std::string& part : within) {
        if (shell("graze " + verb + ' ' + part + " --help | grep -q -e '" + text + "'").status == 0)
          found.push_back(verb + ' ' + part);
      }
      if (within.empty() && shell("graze " + verb + " --help | grep -q -e '" + text + "'").status == 0)
        found.push_back(verb);
    }
    return found;
  }
};

TEST_F(SubjectVerbs, EveryVerbThatOffersSubjectsRunsAndShowsThem) {
  const std::vector<std::string> offered = verbs_whose_help_has("--subject NAME=WHAT");
  EXPECT_GE(offered.size(), 20u);
  const std::set<std::string> absent = [&] {  // from a build without libFuzzer, or without npm
    std::set<std::string> verbs;
    if (shell("graze hunt --runs 1 --out one").status != 0) verbs.insert("hunt");
    if (has(shell("graze view p --out one.html").err, {"not in this build"})) verbs.insert("view");
    return verbs;
  }();
  std::map<std::string, const SubjectVerb*> known;
  for (const SubjectVerb& row : subject_verbs()) known[row.verb] = &row;
  for (const std::string& verb : offered) {
    SCOPED_TRACE(verb);
    ASSERT_TRUE(known.contains(verb)) << "add a row for it";
    const SubjectVerb& row = *known[verb];
    if (verb == "prove-twin" || absent.contains(verb)) continue;
    const Ran ran = shell.done(kWithoutDevice + verb + ' ' + row.arguments + " --subject mine=./mine.c");
    if (verb == "plan") continue;  // shows no lane; it refuses lanes that do not exist
    const std::string shown = *row.shows ? shell.file(row.shows) : ran.out;
    EXPECT_TRUE(has(shown, {"mine"})) << ran.err;
    known.erase(verb);
  }
  known.erase("prove-twin");
  known.erase("plan");
  for (const std::string& verb : absent) known.erase(verb);
  EXPECT_TRUE(known.empty()) << known.begin()->first << " does not offer --subject";
}

// If no lane of a subject is selected, every verb reports an error; none ignores the subject.
TEST_F(SubjectVerbs, NoVerbDropsASubject) {
  for (const std::string command :
       {"fuzz --strata uniform --pairs 40 --out f", "hunt --runs 20 --out h", "check p",
        "invariants --strata uniform --pairs 20 --out i", "repro p", "minimize p", "explain p", "map p --out m.png",
        "lanes", "pareto --strata uniform --pairs 1000 --out o", "query 'mesh.off#0' mesh.off", "bench --triangles 100",
        "plan --pairs 100", "corpus add p --corpus r", "dump uniform --pairs 3"}) {
    if (command.starts_with("hunt") && shell("graze hunt --runs 1 --out one").status != 0) continue;
    expect_error(kWithoutDevice + command + " --lanes moller_1997/f32/cpu --subject mine=./mine.c", 2,
                 {"--subject mine", "--lanes"});
  }
  expect_error(std::string(kWithoutDevice) + "discrepancy moller_1997/f32/cpu exact/f32/cpu --subject mine=./mine.c", 2,
               {"--subject mine", "LANE LANE"});
  expect_error(std::string(kWithoutDevice) +
                   "dump uniform --values moller_1997/f32/cpu,moller_1997/f32/cpu-fma "
                   "--subject mine=./mine.c",
               2, {"--subject", "--values"});
  expect_error(std::string(kWithoutDevice) + "query --self mesh.off --subject mine=./mine.c", 2,
               {"--self", "--subject"});
  expect_error(std::string(kWithoutDevice) + "prove-twin --subject mine=./mine.c", 2, {"CUDA source"});
}

// If code crashes on some pairs, pareto, query and tune count crashes, not declined verdicts.
TEST_F(SubjectVerbs, CrashesAreCountedAsSuch) {
  std::ofstream(shell.folder / "mine.c") << "#include <stdlib.h>\nstatic const float kGap = 1e-3f;\nint "
                                            "intersects(const float a[9], const float b[9]) { if "
                                            "(b[0] == 1) abort(); return a[0] > b[0] + kGap; }\n";
  const Ran query = shell.done(std::string(kWithoutDevice) +
                               "query 'mesh.off#0' mesh.off --lanes exact,mine/f32/cpu --subject mine=./mine.c --json");
  const auto other = nlohmann::json::parse(query.out)["others"][0];
  EXPECT_EQ(other["lane"], "mine/f32/cpu");
  EXPECT_EQ(other["failed"], 1) << query.out;
  EXPECT_EQ(other["declined"], 0) << query.out;
  EXPECT_TRUE(has(shell.file("mismatches.pairs"), {"said_by_mine_f32_cpu=crashed"}));
  std::ofstream(shell.folder / "mine.c") << "#include <stdlib.h>\nint intersects(const float a[9], const float b[9]) { "
                                            "if (a[0] > 0.9f && a[0] < 0.91f) abort(); return 1; }\n";
  expect_done(
      std::string(kWithoutDevice) +
      "pareto --subject mine=./mine.c --lanes mine/f32/cpu,exact/f32/cpu --strata uniform --pairs 1000 --out o");
  const auto pareto = shell.json("o/pareto.json");
  ASSERT_EQ(pareto["not_timed"].size(), 1u) << pareto;
  EXPECT_GE(pareto["not_timed"][0]["errors"]["crashed"], 1);
  EXPECT_EQ(pareto["subjects"][0]["name"], "mine");
}

// The cost of a user's function does not include the exchange with its process.
TEST_F(SubjectVerbs, ParetoComparesTheCostOfOwnCode) {
  expect_done(std::string(kWithoutDevice) +
              "pareto --subject mine=./mine.c --subject 'line=cmd:sed -u s/.*/1/' --lanes "
              "mine/f32/cpu,line/f32/cpu,exact/f32/cpu --strata uniform --pairs 1000 --out o > table");
  const auto pareto = shell.json("o/pareto.json");
  ASSERT_EQ(pareto["lanes"].size(), 2u) << pareto;
  for (const auto& row : pareto["lanes"]) EXPECT_GT(row["one_a_call"]["middle"], 0) << row;
  ASSERT_EQ(pareto["not_timed"].size(), 1u);
  EXPECT_EQ(pareto["not_timed"][0]["lane"], "line/f32/cpu");
  EXPECT_TRUE(has(shell.file("table"), {"line/f32/cpu"}));
}

// A campaign records its subjects. If a subject's code has changed, verbs say so, do not run it, and show the stored
// verdicts; --resubject runs the changed code.
TEST_F(SubjectVerbs, ChangedCodeIsSaidAndStoredVerdictsAreShown) {
  expect_done(
      std::string(kWithoutDevice) +
      "fuzz --subject mine=./mine.c --lanes 'mine/f32/cpu,moller_1997/f32/cpu' --strata uniform --pairs 60 --out "
      "c > /dev/null && cp $(grep -l 'mine:' c/cases/*.pairs | head -n 1) c/cases/one.pairs");
  const std::vector<std::string> verbs = {"check c/cases/one.pairs", "repro c/cases/one.pairs",
                                          "explain c/cases/one.pairs", "map c/cases/one.pairs --out m.png",
                                          "dump c --pairs 3 --lanes 'm*/f32/cpu'"};
  for (const std::string& verb : verbs) {
    const Ran ran = shell(kWithoutDevice + verb);
    EXPECT_TRUE(has(ran.out, {"mine"})) << verb << ran.err;
    EXPECT_EQ(ran.err, "") << verb;
  }
  expect_done("sed -i 's/ + kGap/ - kGap/' mine.c");
  for (const std::string& verb : verbs) {
    SCOPED_TRACE(verb);
    const Ran ran = shell.done(kWithoutDevice + verb);
    EXPECT_TRUE(
        names(ran.err.substr(0, ran.err.find('\n')), {"left out", "mine.c", "changed", "--resubject", "mine/f32/cpu"}))
        << ran.err;
    const bool of_a_case = verb.find("one.pairs") != verb.npos && !verb.starts_with("map");
    EXPECT_EQ(ran.out.find("stored by the campaign: mine/f32/cpu ") != std::string::npos, of_a_case) << ran.out;
    const Ran again = shell(kWithoutDevice + verb + " --resubject");
    EXPECT_TRUE(
        names(again.err.substr(0, again.err.find('\n')), {"mine: its code is not the code that the campaign ran"}))
        << again.err;
    EXPECT_TRUE(has(again.out, {"mine"}));
  }
  // A pattern that selects only lanes that do not run is an error.
  expect_error(std::string(kWithoutDevice) + "check c/cases/one.pairs --lanes 'mine/*'", 2,
               {"mine/f32/cpu", "changed", "--resubject"});
  expect_error(std::string(kWithoutDevice) + "minimize c", 1, {"mine.c", "changed"});
  // The campaign's report says that other results in its folder are about other code.
  const std::string other = "not about the code that the campaign ran";
  expect_done("graze report c");
  EXPECT_FALSE(has(shell.file("c/report.html"), {other}));
  for (const std::string results :
       {"pareto --lanes 'mine/f32/cpu,exact/f32/cpu' --pairs 1000", "tune mine/f32/cpu --pairs 100"}) {
    expect_done("rm -f c/pareto.json; graze " + results +
                " --strata uniform --subject mine=./mine.c --out c > out && "
                "graze report c");
    EXPECT_TRUE(has(shell.file("c/report.html"), {other})) << results;
  }
  expect_done("rm c/tune.json");
  // Verbs that do not run the code still work.
  expect_done(std::string(kWithoutDevice) + "report c && graze dump c > /dev/null && graze status c");
  if (shell("graze view --out v.html").status == 0) {
    expect_done(std::string(kWithoutDevice) + "view c/cases/one.pairs --out v.html");
    EXPECT_TRUE(has(shell.file("v.html"), {"\"stored\":true"}));
  }
}

// Lanes without a twin do not run here. Each verb that takes patterns names these lanes in its text and its JSON, with
// the reason and with what would make them run. A pattern that selects only such lanes is an error.
TEST_F(SubjectVerbs, LanesThatDoNotRunAreSaid) {
  struct Row {
    std::string command;  // without --lanes
    std::string json;     // a JSON file, or "out" for the output; empty: the verb has none
  };
  const std::string some = " --lanes 'moller_1997/f32/c*[ut]'",  // cpu, cpu-fast, cuda-fast
      none = " --lanes moller_1997/f32/cuda-fast";
  const std::vector<Row> rows = {{"fuzz --strata uniform --pairs 40 --executor twin --out f", "f/summary.json"},
                                 {"check p --json", "out"},
                                 {"check p", ""},
                                 {"invariants --strata uniform --pairs 20 --out i", "i/invariants.json"},
                                 {"repro p", ""},
                                 {"minimize p", ""},
                                 {"explain p --json", "out"},
                                 {"map p --out m.png", ""},
                                 {"pareto --strata uniform --pairs 1000 --out o", "o/pareto.json"},
                                 {"query 'mesh.off#0' mesh.off --json", "out"},
                                 {"bench --triangles 100 --json", "out"},
                                 {"plan --pairs 1000 --json", "out"},
                                 {"corpus verify --corpus r", ""},
                                 {"corpus add near_edge_edge:1:42 --corpus s", ""},
                                 {"dump uniform --pairs 3", ""}};
  expect_done(std::string(kWithoutDevice) + "corpus add near_edge_edge:1:42 --corpus r --lanes '*/f32/cpu'");
  for (const auto& [command, json] : rows) {
    SCOPED_TRACE(command);
    const Ran ran = shell(kWithoutDevice + command + some);
    EXPECT_TRUE(has(ran.err, {"moller_1997/f32/cuda-fast", "left out (", "a CUDA device runs it"}));
    if (!json.empty()) {
      const std::string text = json == "out" ? ran.out : shell.file(json);
      EXPECT_TRUE(has(text, {"lanes_left_out"}));
    }
    const Ran nothing = shell(kWithoutDevice + command + none);
    EXPECT_EQ(nothing.status, 2) << nothing.out << nothing.err;
    EXPECT_TRUE(has(nothing.err, {"moller_1997/f32/cuda-fast"}));
  }
  expect_error("graze lanes --lanes nosuch", 2, {"'nosuch'"});
}

TEST_F(SubjectVerbs, AHuntSeesTheCodesVerdicts) {
  if (shell("graze hunt --runs 1 --out h1").status != 0) GTEST_SKIP() << "this build has no libFuzzer";
  expect_done("cc -shared -fPIC mine.c -o mine.so");
  for (const std::string kind : {"c", "so"}) {
    SCOPED_TRACE(kind);
    expect_done("export XDG_CACHE_HOME=$PWD/cache; graze hunt --subject mine=./mine." + kind +
                " --lanes 'mine/f32/cpu,exact/f32/cpu' --runs 400 --strata uniform --out " + kind + " > /dev/null");
    const auto summary = nlohmann::json::parse(contents(shell.folder / kind / "summary.json"));
    const auto& counts = summary["strata"]["hunt"]["lanes"]["mine/f32/cpu"];
    EXPECT_EQ(counts["crashed"], 0);
    EXPECT_GT(counts["false_positive"], 0);
    EXPECT_GT(counts["false_negative"], 0);
  }
}

}  // namespace
}  // namespace graze::cli
