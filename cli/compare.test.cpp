// SPDX-License-Identifier: Apache-2.0
// Two campaigns on the same pairs are compared verdict by verdict, and campaigns on different pairs by their rates. The
// command that a report names runs the campaign again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Compare : public CommandTest {
 protected:
  static std::string fuzz(const std::string& options) {
    return "export XDG_CACHE_HOME=$PWD/cache; " + options + " > /dev/null; ";
  }
  nlohmann::json json(const std::string& file) { return shell.json(file); }

  // Compares the campaigns `before` and `after`, and checks each row's counts against those that `graze discrepancy`
  // finds on the same pairs with the two libraries that the campaigns ran.
  // build_of_lane: index into the builds cpu, cpu-fma and cpu-fast.
  void expect_counts(const std::string& strata, int pairs, std::size_t build_of_lane = 0) {
    const Ran said = shell.done("export XDG_CACHE_HOME=$PWD/cache; graze report --compare before after");
    EXPECT_TRUE(said.out.starts_with("Changed: ")) << said.out;
    const auto build = [&](const char* campaign) -> std::string {
      return json(std::string(campaign) + "/summary.json")["spec"]["subjects"][0]["builds"][build_of_lane];
    };
    expect_done(fmt::format(
        "export XDG_CACHE_HOME=$PWD/cache; cp cache/graze/{}.so libone.so; cp cache/graze/{}.so libother.so; "
        "graze discrepancy one/f32/cpu other/f32/cpu --strata {} --pairs {} --subject one=./libone.so "
        "--subject other=./libother.so --out d",
        build("before"), build("after"), strata, pairs));
    const nlohmann::json counted = json("d/discrepancy.json")["verdicts"][0]["strata"];
    std::uint64_t all = 0;
    const nlohmann::json rows = json("after/compare.json")["compare"]["verdicts"];
    for (const nlohmann::json& row : rows) {
      if (row["lane"] != (build_of_lane == 0 ? "mine/f32/cpu" : "mine/f32/cpu-fma")) continue;
      const std::uint64_t changed = counted[row["stratum"].get<std::string>()]["differs"];
      EXPECT_EQ(row["known"], changed == 0 ? "same" : "changed");
      EXPECT_EQ(row["least"], changed);
      EXPECT_EQ(row["most"], changed);
      all += changed;
      if (changed == 0) continue;
      EXPECT_LE(row["broken"].get<std::uint64_t>() + row["mended"].get<std::uint64_t>(), changed);
      for (const char* way : {"broken", "mended"})
        EXPECT_EQ(row[way] > 0, row.contains(std::string("smallest_") + way)) << row;
    }
    EXPECT_GT(all, 0u);
  }
};

// In three of the next four tests, an unpaired test of the rates would find no change.
TEST_F(Compare, AnotherCompilerIsCountedPairByPair) {
  const std::string run =
      "graze fuzz --subject mine=./mine.cpp --lanes mine/f32/cpu --strata near_edge_edge,thesis --pairs 2000 --out ";
  std::filesystem::copy_file(GRAZE_SOURCE_DIR "/cli/planted/axes.cpp", shell.folder / "mine.cpp");
  expect_done(fuzz("CXX='c++ -DEPSILON=1e-6f' " + run + "before") + "CXX='c++ -DEPSILON=2e-6f' " + run +
              "after > /dev/null");
  const nlohmann::json before = json("before/summary.json")["spec"]["subjects"][0],
                       after = json("after/summary.json")["spec"]["subjects"][0];
  EXPECT_EQ(before["source_hash"], after["source_hash"]);
  EXPECT_NE(before["hash"], after["hash"]);
  EXPECT_EQ(before["environment"]["CXX"], "c++ -DEPSILON=1e-6f");
  EXPECT_EQ(after["environment"]["CXX"], "c++ -DEPSILON=2e-6f");
  EXPECT_EQ(before["builds"].size(), 3u);
  EXPECT_TRUE(has(before["compiler"].get<std::string>(), {"++"}));
  expect_counts("near_edge_edge,thesis", 2000);
  const Ran said = shell("export XDG_CACHE_HOME=$PWD/cache; graze report --compare before after");
  EXPECT_TRUE(has(said.out, {", CXX=c++ -DEPSILON=2e-6f"}));
}

// Clang contracts within an expression, GCC across statements too.
TEST_F(Compare, ClangAgainstGccIsCountedPairByPair) {
  if (shell("command -v clang++-14 && command -v g++").status != 0)
    GTEST_SKIP() << "needs clang++-14 and g++, of the packages clang-14 and g++";
  std::filesystem::copy_file(GRAZE_SOURCE_DIR "/cli/planted/axes.cpp", shell.folder / "mine.cpp");
  const std::string run =
      "graze fuzz --subject mine=./mine.cpp --flags=-DEPSILON=1e-6f --lanes mine/f32/cpu-fma --strata "
      "coplanar_wide,exact_contact --pairs 2000 --out ";
  expect_done(fuzz("CXX=g++ " + run + "before") + "CXX=clang++-14 " + run + "after > /dev/null");
  const std::string compiler = json("after/summary.json")["spec"]["subjects"][0]["compiler"];
  EXPECT_TRUE(has(compiler, {"clang"}));
  expect_counts("coplanar_wide,exact_contact", 2000, 1);
}

// The source is edited in place: the old source is gone, but not the library built from it.
TEST_F(Compare, AnotherEpsilonIsCountedPairByPair) {
  const auto run = [](const std::string& epsilon, const std::string& out) {
    return "sed s/EPSILON/" + epsilon +
           "/g mine.cpp > e.cpp; graze fuzz --subject mine=./e.cpp --lanes mine/f32/cpu --strata near_edge_edge,thesis "
           "--pairs 2000 --out " +
           out;
  };
  std::filesystem::copy_file(GRAZE_SOURCE_DIR "/cli/planted/axes.cpp", shell.folder / "mine.cpp");
  expect_done(fuzz(run("1e-6f", "before")) + run("3e-6f", "after") + " > /dev/null");
  expect_counts("near_edge_edge,thesis", 2000);
}

TEST_F(Compare, ContractionIsCountedPairByPair) {
  shell(
      "cat > mine.cpp <<'EOF'\n"
      "#include \"core/algorithms/interval_overlap.h\"\n"
      "extern \"C\" int intersects(const float* p, const float* q) {\n"
      "  using V = graze::Vec3<float>;\n"
      "  const V a[] = {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], p[7], p[8]}};\n"
      "  const V b[] = {{q[0], q[1], q[2]}, {q[3], q[4], q[5]}, {q[6], q[7], q[8]}};\n"
      "  return graze::IntervalOverlap::decide(a, b) == graze::Verdict::intersects;\n"
      "}\nEOF\n");
  const std::string
      flags = "-I" GRAZE_SOURCE_DIR,
      contracted = " -ffp-contract=fast -mfma",
      run =
          "graze fuzz --subject mine=./mine.cpp --lanes mine/f32/cpu --strata coplanar_wide,exact_contact "
          "--pairs 2000 --flags='" +
          flags;
  expect_done(fuzz(run + "' --out before") + run + contracted + "' --out after > /dev/null");
  expect_counts("coplanar_wide,exact_contact", 2000);
}

TEST_F(Compare, TheSameVerdictsAreProvedSoAndNothingElseIs) {
  const std::string run =
      "graze fuzz --lanes 'moller_1997/f32/c*,exact/f32/cpu' --executor twin --strata near_edge_edge,thesis --pairs "
      "2000 ";
  expect_done(fuzz(run + "--threads 1 --out a") + run + "--threads 2 --judge exact --out b > /dev/null");
  const Ran same = shell("graze report --compare a b");
  EXPECT_TRUE(same.out.starts_with("Nothing changed: all ")) << same.out << same.err;
  EXPECT_TRUE(names(same.out.substr(0, same.out.find('\n')), {"pair by pair"})) << same.out;
  // Without a database, equal counts prove nothing.
  const Ran counts = shell("rm a/campaign.sqlite; graze report --compare a b");
  EXPECT_TRUE(counts.out.starts_with("None of ")) << counts.out << counts.err;
  EXPECT_TRUE(names(counts.out.substr(0, counts.out.find('\n')), {"database"})) << counts.out;
}

// Only wrong verdicts became wrong or were it: not those that were declined, nor those that a convention allows.
TEST_F(Compare, DeclinedAndAllowedVerdictsAreNotCalledWrong) {
  const auto run = [](const std::string& answer, const std::string& strata, const std::string& out) {
    return "cat > mine.c <<'EOF'\n#include <graze/subject.h>\n"
           "int meet(const float* a, const float* b) { (void)b; return " +
           answer + "; }\nGRAZE_SUBJECT(graze_subject) = {.abi = GRAZE_SUBJECT_ABI, .f32 = meet, " +
           ".outside = GRAZE_OUTSIDE_DEGENERATE};\nEOF\ngraze fuzz --subject mine=./mine.c:graze_subject "
           "--flags=-I" GRAZE_SOURCE_DIR "/subjects/include --lanes 'mine/f32/cpu,!exact/*' --pairs 1000 --strata " +
           strata + " --out " + out;
  };
  expect_done(fuzz(run("a[0] > 0", "uniform", "before")) + run("a[0] > 0 ? -1 : 0", "uniform", "after"));
  const Ran declined = shell.done("export XDG_CACHE_HOME=$PWD/cache; graze report --compare before after");
  const nlohmann::json compare = json("after/compare.json")["compare"], row = compare["verdicts"][0];
  const std::uint64_t then = compare["rates"][0]["before"]["count"], now = compare["rates"][0]["after"]["count"];
  EXPECT_EQ(row["broken"], 0);
  EXPECT_EQ(row["mended"], then - now);
  EXPECT_GT(row["least"], row["mended"]);  // some were right, and are declined
  EXPECT_TRUE(has(declined.out, {": 0 became wrong, ", " no longer wrong, ", " changed otherwise"})) << declined.out;
  // All pairs are outside the convention, so no verdict is wrong, and nothing is said of how rarely the code errs.
  expect_done(fuzz(run("1", "degenerate", "one")) + run("a[0] > 0", "degenerate", "other"));
  const Ran allowed = shell.done("export XDG_CACHE_HOME=$PWD/cache; graze report --compare one other");
  EXPECT_TRUE(has(allowed.out, {": 0 became wrong, 0 no longer wrong, "})) << allowed.out;
  expect_done("graze report other");
  const std::string said = json("other/report.json")["answer"].dump();
  EXPECT_TRUE(has(said, {"wrong on none of 1,000 pairs", "for which its convention promises nothing"})) << said;
  EXPECT_EQ(said.find("confidence"), said.npos) << said;
}

// A library is rebuilt over the old one. The old code is gone, so only the counts bound the number of changes.
TEST_F(Compare, CodeThatIsGoneIsBoundedByCounts) {
  const auto build = [](const char* answer) {
    return fmt::format(
        "echo 'int intersects(const float* a, const float* b) {{ return a[0] > {}; }}' > l.c; "
        "cc -shared -fPIC l.c -o libl.so; ",
        answer);
  };
  const std::string run =
      "graze fuzz --subject mine=./libl.so --lanes 'mine/f32/cpu,!exact/*' --strata uniform --pairs 500 --out ";
  expect_done(build("0") + run + "before > /dev/null; " + build("0.25f") + run + "after > /dev/null");
  const Ran said = shell("graze report --compare before after");
  EXPECT_TRUE(said.out.starts_with("Changed: at least ")) << said.out << said.err;
  const nlohmann::json row = json("after/compare.json")["compare"]["verdicts"][0];
  EXPECT_EQ(row["known"], "changed");
  EXPECT_FALSE(row.contains("broken"));
  EXPECT_GE(row["least"], 1);
  EXPECT_LT(row["least"], row["most"]);
  EXPECT_LE(row["most"], 500);
}

TEST_F(Compare, AnotherSeedIsNoChangeAndTheBlindSpotIsSaid) {
  const std::string run =
      "graze fuzz --lanes 'moller_1997/f32/cpu,guigue*/f32/cpu' --strata uniform,near_edge_edge,lattice --pairs 3000 ";
  for (int pair = 0; pair < 5; ++pair) {
    for (const int side : {0, 1})
      expect_done(fmt::format("{}--seed {} --out {}{} > /dev/null", run, 1 + 2 * pair + side, side, pair));
    const Ran said = shell(fmt::format("graze report --compare 0{0} 1{0}", pair));
    EXPECT_TRUE(said.out.starts_with("None of ")) << said.out << said.err;
    EXPECT_TRUE(names(said.out.substr(0, said.out.find('\n')), {"%", "might not be seen"})) << said.out;
  }
}

// For each kind of campaign, the command in the report runs unchanged and writes the same summary.json.
TEST_F(Compare, TheCommandInTheReportRunsAsItStands) {
  expect_done(
      "printf 'OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 1 2\\n3 0 1 3\\n3 0 2 3\\n3 1 2 3\\n' > 'a mesh.off'; "
      "graze scene 'a mesh.off' --out s.toml > /dev/null; mkdir inc; echo 'static const float kE = 1e-6f;' > inc/e.h; "
      "printf '#include \"e.h\"\\nint meet(const float a[9], const float b[9]) { return a[0] > b[0] + kE; }' > 'my "
      "code.c'");
  const std::string own =
      "--subject 'mine=./my code.c:meet' --flags='-Iinc -O3' --subject-timeout 2 --lanes 'mine/*/cpu,exact/f32/cpu' ";
  int number = 0;
  for (const std::string& command : std::initializer_list<std::string>{
           "graze fuzz --pairs 300 " + own, "CC='gcc -fno-math-errno' graze fuzz --pairs 300 --seed 7 " + own,
           "graze fuzz --mesh 'a mesh.off' " + own,
           "graze fuzz --mesh 'a mesh.off' --strata thesis,uniform --pairs 100 " + own,
           "graze fuzz --scene s.toml --pairs 300 --lanes 'moller_1997/f32/cpu*' ",
           std::string("graze fuzz --pairs 200 --strata 'near_*' --executor twin --lanes 'moller_1997/f32/c*' "),
           std::string("graze fuzz --pairs 200 --strata lattice --subject 'cmd=cmd:sh -c \"while read x; do echo 1; "
                       "done\"' --lanes 'cmd/f32/cpu' ")}) {
    const std::string out = fmt::format("c{}", ++number);
    expect_done("export XDG_CACHE_HOME=$PWD/cache; rm -rf campaign; " + command + "--out " + out +
                " > /dev/null && graze report " + out + " > /dev/null");
    expect_done("export XDG_CACHE_HOME=$PWD/cache; " + json(out + "/report.json")["run"]["command"].get<std::string>() +
                " > /dev/null");
    EXPECT_EQ(shell.file(out + "/summary.json"), shell.file("campaign/summary.json")) << command;
  }
  EXPECT_EQ(number, 7);
}

}  // namespace
}  // namespace graze::cli
