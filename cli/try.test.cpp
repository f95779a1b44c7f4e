// SPDX-License-Identifier: Apache-2.0
// `graze try` as users run it: on each kind of code, again after an edit, in a mesh, and interrupted.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "cli/run_graze.h"
#include "reports/screen.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

// This code compares only boxes: it is wrong on many disjoint pairs, and right on all pairs that meet.
constexpr const char* kBoxes =
    "#include <algorithm>\n"
    "bool meet(const float p[9], const float q[9]) {\n"
    "  for (int i = 0; i < 3; ++i)\n"
    "    if (std::max({p[i], p[i + 3], p[i + 6]}) < std::min({q[i], q[i + 3], q[i + 6]}) ||\n"
    "        std::max({q[i], q[i + 3], q[i + 6]}) < std::min({p[i], p[i + 3], p[i + 6]}))\n"
    "      return false;\n"
    "  return true;\n"
    "}\n";

class TryCommand : public CommandTest {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(shell.folder / name) << text; }
  Json answer_of(const std::string& arguments) const {
    const Ran ran = shell.done("export XDG_CACHE_HOME=$PWD/cache; graze try " + arguments + " --json");
    return Json::parse(ran.out, nullptr, false);
  }
};

TEST_F(TryCommand, AnswersOnOneScreen) {
  write("mine.cpp", kBoxes);
  const Ran ran = shell.done("graze try mine.cpp:meet --pairs 2000");
  EXPECT_LE(std::count(ran.out.begin(), ran.out.end(), '\n'), 30) << ran.out;
  EXPECT_TRUE(ran.out.starts_with("mine/f32/cpu is wrong on ")) << ran.out;
  std::string in_one_line = ran.out;
  for (std::size_t at; (at = in_one_line.find("\n  ")) != std::string::npos;) in_one_line.replace(at, 3, " ");
  EXPECT_TRUE(has(in_one_line, {" of 2,000 pairs: ", "\nBy group of strata: general", "\nOther builds: f32/cpu-fma",
                                "\nEpsilon: ", "\nInstead: exact/f32/cpu is right on all 2,000 pairs.\n",
                                "\nA call of one pair takes ", " in mine/f32/cpu, ", " in exact/f32/cpu, ",
                                " passes over 2,000 pairs, on one core of ", "\nWrote try/report.html, try/cases/",
                                ", try/case.cpp ", "\nNext: graze explain try/cases/"}))
      << ran.out;
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(reports::width_of(line), 80) << line;
  EXPECT_FALSE(has(ran.err, {" failures"}));  // no progress without a terminal
}

// The numbers on the screen are those of the campaign, and every other verb works on the folder.
TEST_F(TryCommand, TheFolderIsACampaigns) {
  write("mine.cpp", kBoxes);
  const Json answer = answer_of("mine.cpp:meet --pairs 2000 --seed 5");
  const Json summary = shell.json("try/summary.json");
  std::uint64_t wrong = 0;
  for (const auto& [stratum, row] : summary["strata"].items()) {
    EXPECT_EQ(row["lanes"]["mine/f32/cpu"]["false_negative"], 0) << stratum;
    EXPECT_EQ(row["lanes"]["exact/f32/cpu"]["false_positive"], 0) << stratum;
    wrong += row["lanes"]["mine/f32/cpu"]["false_positive"].get<std::uint64_t>();
  }
  EXPECT_GT(wrong, 200u);
  EXPECT_EQ(answer["wrong"]["count"], wrong);
  EXPECT_EQ(answer["wrong"]["of"], 2000);
  std::uint64_t by_kind = 0;
  for (const auto& [kind, share] : answer["wrong_by_group"].items()) by_kind += share["count"].get<std::uint64_t>();
  EXPECT_EQ(by_kind, wrong);
  ASSERT_EQ(answer["failures"].size(), 3u);
  for (const Json& failure : answer["failures"]) {
    const std::string file = failure["case"];
    EXPECT_TRUE(has(shell.file(file), {"kind=minimised"})) << file;
    const std::string text = shell.file(file), pair = failure["pair"];
    EXPECT_LT(text.find(pair), text.find("kind=minimised")) << file;
    expect_done("graze repro " + file);
  }
  for (const char* lane : {"own", "exact", "cheapest"})
    EXPECT_GT(answer["nanoseconds_a_call"][lane]["middle"], 0) << lane;
  const Ran test = shell("cd try && head -n 1 case.cpp | cut -c 4- > run.sh && bash run.sh");
  EXPECT_TRUE(has(test.out, {" 1 FAILED TEST"})) << test.err;
  EXPECT_TRUE(has(shell.file("try/case.cpp"), {"#include \"../mine.cpp\"\n"}));
  expect_done("graze failures try && graze report try && graze minimize try && graze status try");
}

TEST_F(TryCommand, AgainGivesTheSameAndAfterAnEditKeepsTheRunBefore) {
  write("mine.cpp", kBoxes);
  const auto without_times = [](Json answer) {
    answer.erase("nanoseconds_a_call");
    return answer.dump(1);
  };
  const Json first = answer_of("mine.cpp:meet --pairs 1000 --threads 1");
  EXPECT_EQ(without_times(answer_of("mine.cpp:meet --pairs 1000 --threads 2")), without_times(first));
  EXPECT_EQ(answer_of("other=mine.cpp:meet --pairs 100 --out o")["lane"], "other/f32/cpu");
  write("mine.cpp", "bool meet(const float*, const float*) { return true; }\n");
  const Json edited = answer_of("mine.cpp:meet --pairs 1000");
  EXPECT_EQ(edited["earlier"], "try.1");
  EXPECT_GT(edited["wrong"]["count"], first["wrong"]["count"]);
  EXPECT_EQ(answer_of("mine.cpp:meet --pairs 500")["earlier"], "try.2");
  expect_done("test -f try.1/summary.json && test -f try.2/summary.json");
  write("other.cpp", kBoxes);  // other code does not rename earlier results
  const Ran refused = shell("graze try other.cpp:meet --pairs 1000");
  EXPECT_NE(refused.status, 0);
  EXPECT_TRUE(names(refused.err.substr(0, refused.err.find('\n')), {"try"})) << refused.err;
}

TEST_F(TryCommand, CodeThatAlwaysFailsIsSaidAtOnce) {
  write("dead.sh", "exit 1\n");
  write("dead.c", "#include <stdlib.h>\nint meet(const float a[9], const float b[9]) { abort(); }\n");
  for (const char* what : {"'cmd:sh dead.sh'", "dead.c:meet"}) {
    const bool is_program = std::string(what).find("cmd:") != std::string::npos;
    expect_error(std::string("graze try ") + what + " --out d", 1,
                 {"dead", "crashed, crashed, crashed", is_program ? "echo" : "by hand"});
    EXPECT_FALSE(std::filesystem::exists(shell.folder / "d"));
  }
}

TEST_F(TryCommand, AShouldBeIntOnlyForAnUnstableSharedObject) {
  write("wavers.c", "static int n;\nint meet(const float a[9], const float b[9]) { return ++n & 1; }\n");
  write("hangs.c", "int meet(const float a[9], const float b[9]) { for (;;) ; }\n");
  expect_done("for name in wavers hangs; do cc -shared -fPIC $name.c -o $name.so; done");
  for (const auto& [file, failure, told] : {std::tuple{"./wavers.so", "unstable", true},
                                            {"wavers.c", "unstable", false},
                                            {"./hangs.so", "timed_out", false},
                                            {"hangs.c", "timed_out", false}}) {
    const std::string command = fmt::format("graze try {}:meet --subject-timeout 0.2 --out d", file);
    expect_error(command, 1, {file, failure, "by hand"});
    EXPECT_EQ(shell(command).err.find("must return int") != std::string::npos, told) << file;
  }
}

TEST_F(TryCommand, OnlyBoolsAndIntsOfPythonAreVerdicts) {
  if (shell("command -v python3").status != 0) GTEST_SKIP() << "no python3";
  write("shapes.py",
        "def never(a, b):\n    return -7\n"
        "def text(a, b):\n    return 'yes'\n"
        "def number(a, b):\n    return float('nan')\n"
        "def nothing(a, b):\n    pass\n"
        "def generator(a, b):\n    yield True\n"
        "async def coroutine(a, b):\n    return True\n"
        "def raises(a, b):\n    raise ValueError('no area')\n");
  const Json never = answer_of("shapes.py:never --pairs 30");
  EXPECT_EQ(never["wrong"]["count"], 0);
  const Json summary = shell.json("try/summary.json");
  int declined = 0;
  for (const Json& row : summary["strata"]) declined += row["lanes"]["shapes/f32/cpu"]["declined"].get<int>();
  EXPECT_EQ(declined, 30);
  for (const auto& [function, found] : {std::pair{"text", "a str"},
                                        {"number", "a float"},
                                        {"nothing", "None"},
                                        {"generator", "a generator"},
                                        {"coroutine", "a coroutine"}}) {
    expect_error(fmt::format("graze try shapes.py:{} --out d", function), 1,
                 {"shapes.py", fmt::format("says: {} returned {}", function, found), "bool", "int", "below 0", "echo"});
  }
  expect_error("graze try shapes.py:raises --out d", 1, {"says: ValueError: no area"});
}

// If a program exits on some pairs, its last line on stderr is shown once.
TEST_F(TryCommand, AProgramThatCrashesOnSomePairsIsToldWithItsReason) {
  write("p.c", R"(#include <stdio.h>
#include <string.h>
int main(void) {
  for (char line[2000]; fgets(line, sizeof line, stdin); fflush(stdout)) {
    double x = 0;
    sscanf(line, "%la", &x);
    if (x > 0.5) return fprintf(stderr, "started\nno idea about %g\n", x), 3;
    puts(strncmp(line, "describe", 8) ? "1" : "f32");
  }
})");
  expect_done("cc p.c -o p");
  const Ran ran = shell.done("graze try 'cmd:./p' --pairs 40");
  const std::size_t told = ran.err.find("p/f32/cpu crashes on some pairs: no idea about ");
  ASSERT_NE(told, ran.err.npos) << ran.err;
  EXPECT_EQ(ran.err.find("crashes on some pairs", told + 20), ran.err.npos) << ran.err;
  EXPECT_FALSE(has(ran.err, {"started"}));
}

// A program that keeps running but gives an invalid answer is not reported as ended.
TEST_F(TryCommand, AnAnswerThatIsNoneIsToldByExplain) {
  expect_done(
      "graze fuzz --subject 'y=cmd:while read l; do echo yes; done' --lanes 'y/*' --strata uniform --pairs 3 --out y");
  const Ran why = shell("graze explain y/cases/$(ls y/cases | head -n 1) --lanes 'y/*'");
  EXPECT_TRUE(has(why.out, {"its line was not 1, 0 or ?"})) << why.err;
}

TEST_F(TryCommand, WorksOnEachKindOfCode) {
  const std::string by_x = "int meet(const float a[9], const float b[9]) { return a[0] < b[0]; }\n";
  write("own.c", by_x);
  expect_done("cc -shared -fPIC own.c -o libown.so");
  write("own.py", "import sys\nfor line in sys.stdin:\n    print(1, flush=True)\n");
  write("shapes.py",
        "class Shapes:\n    @staticmethod\n    def meet(a, b):\n        print('asked')\n        return a[0][0] < "
        "b[2][1]\n");
  write("own.sh", "while read line; do echo 0; done\n");
  write("own.js", "require('readline').createInterface({input: process.stdin}).on('line', () => console.log(1));\n");
  write("own.cu", "__device__ bool meet(const float a[9], const float b[9]) { return a[0] * a[1] > b[0] * b[1]; }\n");
  write("moller_1997.c", by_x);
  struct Code {
    const char *source, *lane, *needs;
    bool is_timed;
  };
  const Code codes[] = {{"./own.c:meet", "own/f32/cpu", "", true},
                        {"./libown.so:meet", "libown/f32/cpu", "", true},
                        {"own.py", "own/f32/cpu", "python3", false},
                        {"shapes.py:Shapes.meet", "shapes/f32/cpu", "python3", false},
                        {"'cmd:bash own.sh'", "own/f32/cpu", "", false},
                        {"own.js", "own/f32/cpu", "node", false},
                        {"own.cu:meet", "own/f32/cuda-fma", "NVRTC", false},
                        {"moller_1997.c:meet", "my_moller_1997/f32/cpu", "", true}};
  int tried = 0;
  for (const Code& code : codes) {
    const std::string needs = code.needs, out = "out-" + std::to_string(&code - codes);
    const bool is_there = needs == "NVRTC" ? shell("graze lanes --subject cu=./own.cu:meet").err.empty()
                                           : needs.empty() || shell("command -v " + needs).status == 0;
    if (!is_there) continue;
    // On a machine that is busy for seconds, a shorter limit would leave some sources without a cost.
    const std::string arguments = std::string(code.source) + " --pairs 30 --subject-timeout 60 --out " + out;
    const Json answer = answer_of(arguments);
    ASSERT_TRUE(answer.is_object()) << code.source;
    EXPECT_EQ(answer["lane"], code.lane);
    EXPECT_GT(answer["wrong"]["count"], 0) << code.source;
    EXPECT_FALSE(answer["failures"].empty()) << code.source;
    EXPECT_TRUE(std::filesystem::exists(shell.folder / out / "report.html")) << code.source;
    EXPECT_EQ(answer["test"], out + "/case.cpp") << code.source;
    const bool is_source = std::string(code.source).find(".c") != std::string::npos;
    const std::string why = answer["why_not_tuned"];
    EXPECT_TRUE(names(why, {"Graze cannot change its epsilon", is_source ? "none" : "it is a"})) << code.source;
    EXPECT_EQ(answer["tune"], "") << code.source;
    EXPECT_EQ(answer["nanoseconds_a_call"]["own"].contains("middle"), code.is_timed) << code.source;
    if (needs == "NVRTC") {
      const Ran text = shell("graze try own.cu:meet --pairs 30 --out text");
      EXPECT_TRUE(has(text.out, {"CPU against GPU: graze discrepancy --campaign text\n"}));
      expect_done("graze discrepancy --campaign text > /dev/null");
    }
    if (std::string(code.source).find(".py:") != std::string::npos) {
      EXPECT_EQ(answer["wrapper"], out + ".py");
      // The recorded command runs, and an edit of the function is noticed.
      const Json report = shell.json(out + "/report.json");
      expect_done(report["run"]["command"].get<std::string>() + " > /dev/null");
      expect_done("sed -i 's/</>/' shapes.py");
      EXPECT_NE(answer_of(arguments)["earlier"], "");
      expect_error("graze try shapes.py:none --pairs 30 --out none", 1, {"shapes.py", "crashed"});
    }
    ++tried;
  }
  EXPECT_GE(tried, 4);
}

// The user's code is our exact decision, which is right.
TEST_F(TryCommand, OfRightCodeSaysHowMuchThatProves) {
  write("right.cpp",
        "#include \"core/exact/exact.h\"\n"
        "bool meet(const float* a, const float* b) { return graze::exact::intersects(a, b); }\n");
  const Ran ran =
      shell.done("graze try right.cpp:meet --pairs 1000 --flags='-std=c++20 -U__FAST_MATH__ -I" GRAZE_SOURCE_DIR "'");
  EXPECT_TRUE(ran.out.starts_with("right/f32/cpu is wrong on none of the 1,000 pairs that it decides: with 95 %\n"))
      << ran.out;
  EXPECT_TRUE(has(ran.out, {"Epsilon: no failure that was examined shows an absolute epsilon."}));
}

TEST_F(TryCommand, AMeshOrASceneSaysWhereThePairsAreDrawn) {
  std::ostringstream mesh;
  mesh << "OFF\n18 16 0\n";
  for (int i = 0; i < 9; ++i) mesh << i % 3 << ' ' << i / 3 << ' ' << 0.1 * (i % 2) << '\n';
  for (int i = 0; i < 9; ++i) mesh << i % 3 + 0.3 << ' ' << i / 3 + 0.2 << ' ' << 0.2 - 0.1 * (i % 3) << '\n';
  for (int of : {0, 9}) {
    for (int i : {0, 1, 3, 4}) {
      mesh << "3 " << of + i << ' ' << of + i + 1 << ' ' << of + i + 3 << "\n3 " << of + i + 1 << ' ' << of + i + 4
           << ' ' << of + i + 3 << '\n';
    }
  }
  write("arm.off", mesh.str());
  write("mine.cpp", kBoxes);
  const Json on_mesh = answer_of("mine.cpp:meet arm.off --pairs 400 --out m");
  EXPECT_TRUE(on_mesh["wrong_by_group"].contains("mesh")) << on_mesh.dump(1);
  const Json in_scene = answer_of("mine.cpp:meet m.toml --pairs 400 --out s");
  EXPECT_EQ(in_scene["wrong"], on_mesh["wrong"]);
  EXPECT_EQ(on_mesh["scene"], "m.toml");
  EXPECT_EQ(in_scene["scene"], "");
  ASSERT_FALSE(on_mesh["strata_left_out"].empty());
  EXPECT_FALSE(on_mesh["strata_left_out"][0]["why"].get<std::string>().empty());
  expect_out("graze try mine.cpp:meet arm.off --pairs 400 --out t/",
             {"\nLeft out, because the scene cannot contain them: ", "t.toml"});
  expect_done("test -f t.toml && test ! -e t/.toml && mkdir full && touch full/letter");
  expect_error("graze try mine.cpp:meet arm.off --out full/", 2, {"full", "campaign directory"});
  expect_done("test ! -e full.toml && test ! -e full/.toml");
  expect_error("graze try mine.cpp:meet mine.cpp", 2, {"mesh", "scene", "mine.cpp"});
  expect_error("graze try none.cpp", 1, {"none.cpp"});
  expect_error("graze try none.py", 1, {"none.py"});
  expect_error("graze try own.txt", 2, {"--subject own", "FILE.cpp"});
}

TEST_F(TryCommand, TheCommandForMorePairsRunsAsItStands) {
  write("mine.cpp", "#ifdef MEETS\nbool meet(const float*, const float*) { return MEETS; }\n#endif\n");
  const Json answer =
      answer_of("mine.cpp:meet --pairs 30 --seed 7 --flags='-O1 -DMEETS=true' --subject-timeout 2.5 --out 'my try'");
  const std::string again = answer["again"];
  EXPECT_EQ(again,
            "graze try mine.cpp:meet --pairs 300 --seed 7 '--flags=-O1 -DMEETS=true' --subject-timeout 2.5 --out "
            "'my try'");
  const Json more = Json::parse(shell(again + " --json").out, nullptr, false);
  ASSERT_TRUE(more.is_object());
  EXPECT_EQ(more["pairs"], 300);
  EXPECT_EQ(more["seed"], 7);
  EXPECT_EQ(more["earlier"], "my try.1");
}

// Returns the counts in "1 of the 146 wrong pairs are no longer wrong, and 2 others become wrong."
std::vector<int> counts_in(const std::string& sentence) {
  std::vector<int> counts;
  std::smatch found;
  if (std::regex_search(sentence, found,
                        std::regex(", (\\d+) of the (\\d+) wrong pairs? are no longer wrong, and (\\d+) ")))
    counts = {std::stoi(found[1]), std::stoi(found[2]), std::stoi(found[3])};
  return counts;
}

TEST_F(TryCommand, NamesTheEpsilonAndTheCommandThatTunesIt) {
  const std::string by_x = "bool meet(const float p[9], const float q[9]) { return p[0] - q[0] < ";
  write("one.cpp", by_x + "1e-6f; }\n");
  const Json one = answer_of("one.cpp:meet --pairs 300");
  EXPECT_TRUE(names(one["epsilon"].get<std::string>(), {"in place of 1e-6f at one.cpp:1"})) << one["epsilon"];
  EXPECT_EQ(one["tune"], "graze tune one/f32/cpu --from try");
  EXPECT_EQ(one["why_not_tuned"], "");
  // The stated effect equals that of replacing the epsilon by a negligible number.
  EXPECT_TRUE(one["epsilon"].get<std::string>().starts_with("Epsilon: with 1e-36f in place of ")) << one["epsilon"];
  write("tiny.cpp", by_x + "1e-36f; }\n");
  const auto changed = counts_in(one["epsilon"]);
  ASSERT_EQ(changed.size(), 3u) << one["epsilon"];
  EXPECT_EQ(changed[1], one["wrong"]["count"]);
  EXPECT_EQ(answer_of("tiny.cpp:meet --pairs 300 --out tiny")["wrong"]["count"], changed[1] - changed[0] + changed[2]);
  const Ran screen = shell("graze try one.cpp:meet --pairs 300");
  EXPECT_TRUE(has(screen.out, {"\nTune it: graze tune one/f32/cpu --from try\n"}));
  expect_done("export XDG_CACHE_HOME=$PWD/cache; " + one["tune"].get<std::string>() + " --pairs 2000");
  write("two.cpp", "const float kEps = 1e-6f;\nconst float kTol = 1e-4f;\n" + by_x + "kEps * kTol; }\n");
  const Json two = answer_of("two.cpp:meet --pairs 300 --out two");
  EXPECT_TRUE(names(two["epsilon"].get<std::string>(), {"1e-6f at two.cpp:1 and 1e-4f at two.cpp:2"}))
      << two["epsilon"];
  EXPECT_TRUE(has(two["tune"].get<std::string>(), {"graze tune two/f32/cpu --from two --epsilon k"})) << two["tune"];
  EXPECT_EQ(shell("graze tune two/f32/cpu --from two").status, 2);  // it would ask for --epsilon
  // The first number is a guard, the second one decides.
  write("guarded.cpp", "bool meet(const float p[9], const float q[9]) {\n  if (p[0] * p[0] < 1e-30f) return false;\n" +
                           by_x.substr(by_x.find("return")) + "1e-3f; }\n");
  EXPECT_EQ(answer_of("guarded.cpp:meet --pairs 300 --out guarded")["tune"],
            "graze tune guarded/f32/cpu --from guarded --epsilon 1e-3f");
  write("large.cpp", by_x + "0.05f; }\n");
  const Json large = answer_of("large.cpp:meet --pairs 300 --out large");
  EXPECT_TRUE(names(large["epsilon"].get<std::string>(), {"0.05f at large.cpp:1"})) << large["epsilon"];
  EXPECT_EQ(large["tune"], "");
  EXPECT_EQ(shell("graze tune large/f32/cpu --from large").status, 2);
}

// After the campaign has written its results, the program under test checks that the folder is still locked.
TEST_F(TryCommand, NoOtherProcessMayUseTheFolderWhileItMinimises) {
  write("own.sh",
        "n=0\n"
        "while read line; do\n"
        "  if [ -f try/summary.json ] && [ $((n = n + 1)) -le 3 ]; then\n"
        "    flock -n try true && echo free >> seen || echo held >> seen\n"
        "  fi\n"
        "  echo 0\n"
        "done\n");
  expect_done("graze try 'cmd:bash own.sh' --pairs 60");
  const std::string seen = shell.file("seen");
  EXPECT_TRUE(has(seen, {"held"}));
  EXPECT_FALSE(has(seen, {"free"}));
  expect_error("flock try graze try 'cmd:bash own.sh' --pairs 90", 1, {"try", "another process"});
  expect_done("test -f try/summary.json && test ! -e try.1");
}

// What a kill or a full disk leaves before the campaign begins.
TEST_F(TryCommand, AnEmptyDatabaseIsNoEarlierRun) {
  write("mine.cpp", kBoxes);
  expect_done("mkdir -p try/cases && : > try/campaign.sqlite");
  EXPECT_EQ(answer_of("mine.cpp:meet --pairs 60")["earlier"], "");
}

TEST_F(TryCommand, EndsInOrderWhileItAsksTheFirstPairs) {
  write("waits.sh",
        "while read line; do\n  [ \"$line\" = describe ] && { echo; continue; }\n  touch asked\n  sleep 3600\ndone\n");
  const Ran ran =
      signalled("timeout -s KILL 120 graze try 'cmd:bash waits.sh' --subject-timeout 3600", "TERM", "test -f asked");
  EXPECT_EQ(ran.status, 130) << ran.err;
  EXPECT_EQ(ran.err, "graze: interrupted\n");
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "try"));
}

TEST_F(TryCommand, GoesOnWhereItWasInterrupted) {
  write("mine.cpp", kBoxes);
  const Ran ran = signalled("graze try mine.cpp:meet --pairs 30000", "TERM", "test -f try/status.json");
  EXPECT_EQ(ran.status, 130) << ran.err;
  EXPECT_TRUE(names(ran.err.substr(0, ran.err.find('\n')), {"interrupted", "resumes"})) << ran.err;
  const Json answer = answer_of("mine.cpp:meet --pairs 30000");
  EXPECT_EQ(answer["earlier"], "");
  EXPECT_EQ(answer["pairs"], 30000);
}

}  // namespace
}  // namespace graze::cli
