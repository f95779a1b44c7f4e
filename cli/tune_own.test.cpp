// SPDX-License-Identifier: Apache-2.0
// `graze tune` on a user's own code: it builds the source with other values of its epsilon.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class TuneOwnCode : public CommandTest {
 protected:
  void write(const std::string& value) const {
    const std::string epsilon = "EPSILON";
    std::string text = contents(GRAZE_SOURCE_DIR "/cli/planted/axes.cpp");
    text.replace(text.find(epsilon), epsilon.size(), value);
    std::ofstream(shell.folder / "mine.cpp") << text;
  }
  Ran tune(const std::string& options) const {
    return shell("export XDG_CACHE_HOME=$PWD/cache; graze tune mine/f32/cpu " + options);
  }
  void expect_refused(const std::string& options, const std::vector<std::string>& words) const {
    expect_error("export XDG_CACHE_HOME=$PWD/cache; graze tune " + options, 2, words);
  }
};

// The test writes tune's value into the source; a campaign on the same fresh pairs then counts the same errors.
TEST_F(TuneOwnCode, ACampaignOfTheChangedSourceConfirmsTheValue) {
  write("0.25f");
  const std::string options =
      "--subject mine=./mine.cpp --strata uniform,shared_vertex,near_vertex_face --pairs 9k --forbid false-positive "
      "--max-rate 0.35 --max-other 0.3 ";
  const Ran ran = tune(options + "--out t");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out.find("Use kEps = "), 0u) << ran.out;
  EXPECT_TRUE(has(ran.out, {"mine.cpp:3", "(now 0.25f)"}));
  const auto json = shell.json("t/tune.json");
  ASSERT_EQ(json["result"], "satisfied") << ran.out;
  EXPECT_EQ(json["epsilon"]["name"], "kEps");
  EXPECT_EQ(json["epsilon"]["written"], "0.25f");
  EXPECT_EQ(json["epsilon"]["lines"], std::vector<int>{3});
  EXPECT_EQ(json["subjects"][0]["name"], "mine");
  // The command after "Next:" runs unchanged.
  const std::size_t next = ran.out.find("Next: ");
  ASSERT_NE(next, std::string::npos);
  expect_done("export XDG_CACHE_HOME=$PWD/cache; " + ran.out.substr(next + 6));
  // The result does not depend on the number of threads, and cached builds give the same bytes.
  const Ran again = tune(options + "--threads 1 --out u");
  ASSERT_EQ(again.status, 0) << again.err;
  expect_done("cmp t/tune.json u/tune.json");

  write(json["epsilon"]["chosen"]);
  expect_done(
      "export XDG_CACHE_HOME=$PWD/cache; graze fuzz --subject mine=./mine.cpp --lanes mine/f32/cpu --strata "
      "uniform,shared_vertex,near_vertex_face --pairs 9k --seed 2 --out c > /dev/null");
  std::uint64_t positives = 0, negatives = 0;
  const auto summary = shell.json("c/summary.json");
  for (const auto& [stratum, row] : summary["strata"].items()) {
    positives += row["lanes"]["mine/f32/cpu"]["false_positive"].get<std::uint64_t>();
    negatives += row["lanes"]["mine/f32/cpu"]["false_negative"].get<std::uint64_t>();
  }
  EXPECT_EQ(json["confirmed"]["false_positive"], positives);
  EXPECT_EQ(json["confirmed"]["false_negative"], negatives);
  EXPECT_LT(2 * positives, json["zero_confirmed"]["false_positive"].get<std::uint64_t>());
}

TEST_F(TuneOwnCode, SaysThatNoValueHelps) {
  write("1e-6f");
  const Ran ran = tune("--subject mine=./mine.cpp --strata near_vertex_face --pairs 2k --max-rate 1e-6 --out t");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out.find("No value that was tried is good enough here: none keeps"), 0u) << ran.out;
  EXPECT_EQ(shell.json("t/tune.json")["result"], "not satisfiable");
}

// In a scene, the sentence has the scene's unit. The campaign knows the subject, and its report includes the result.
TEST_F(TuneOwnCode, UsesTheScenesUnitsAndACampaignsSubjects) {
  write("0.25f");
  std::ofstream(shell.folder / "part.toml")
      << "units = \"mm\"\nextent = [[0, 10], [0, 10], [0, 10]]\nedges = [1, 2, 4]\n";
  expect_done(
      "export XDG_CACHE_HOME=$PWD/cache; graze fuzz --subject mine=./mine.cpp --lanes mine/f32/cpu --scene part.toml "
      "--strata uniform,shared_edge --pairs 3k --out c > /dev/null");
  const Ran ran = tune("--from c --max-rate 0.3 --pairs 3k --out c");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, {" mm"}));
  EXPECT_EQ(shell.json("c/tune.json")["epsilon"]["units"], "mm");
  EXPECT_EQ(shell.file("c/changes.csv").find("stratum,seed,index"), 0u);
  expect_done("graze report c");
  EXPECT_TRUE(has(shell.file("c/report.html"), {"kEps"}));
  // After the source has changed, the campaign's counts no longer belong to the code.
  write("0.125f");
  expect_error("export XDG_CACHE_HOME=$PWD/cache; graze tune mine/f32/cpu --from c --out d", 1,
               {"mine.cpp", "changed"});
  const Ran now = tune("--from c --resubject --max-rate 0.3 --pairs 3k --out d");
  EXPECT_EQ(now.status, 0) << now.err;
  EXPECT_TRUE(has(now.err, {"mine"}));
  EXPECT_EQ(shell.json("d/tune.json")["epsilon"]["written"], "0.125f");
}

TEST_F(TuneOwnCode, CudaSourcesAreBuiltAgainToo) {
  std::ofstream(shell.folder / "mine.cu")
      << "#define EPS 0.25f\n__device__ bool intersects(const float a[9], const float b[9]) {\n"
         "  for (int k = 0; k < 3; ++k) {\n    const float high = fmaxf(a[k], fmaxf(a[k + 3], a[k + 6]));\n"
         "    if (fminf(b[k], fminf(b[k + 3], b[k + 6])) > high - EPS) return false;\n  }\n  return true;\n}\n";
  const Ran ran = shell(
      "export XDG_CACHE_HOME=$PWD/cache; graze tune cu/f32/cuda-nofma --subject cu=./mine.cu --strata uniform --pairs "
      "300 --forbid false-negative --max-rate 0.5 --max-other 1 --out t");
  if (ran.err.find("NVRTC") != std::string::npos) GTEST_SKIP() << "no NVRTC";
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_TRUE(has(ran.out, {"EPS", "mine.cu:1"}));
}

TEST_F(TuneOwnCode, WhatCannotBeTunedGetsOneLine) {
  write("1e-6f");
  const std::string subject = "mine/f32/cpu --subject mine=./mine.cpp ";
  expect_refused(subject + "--epsilon kGap", {"--epsilon kGap", "mine.cpp", "kEps"});
  expect_refused("py/f32/cpu --subject 'py=cmd:while read l; do echo 1; done'", {"py/f32/cpu", "command"});
  expect_refused("moller_1997/f32/cpu --subject mine=./mine.cpp", {"--subject mine", "LANE"});
  expect_refused("moller_1997/f32/cpu --epsilon kEps", {"--epsilon", "moller_1997/f32/cpu"});
  expect_refused("mine/f32/cpu mine/f32/cpu-fma --agree --subject mine=./mine.cpp",
                 {"--agree", "graze discrepancy", "graze tune LANE"});
  std::ofstream(shell.folder / "flag.c") << "#ifndef EPS\n#define EPS 1e-6f\n#endif\nint intersects(const float a[9], "
                                            "const float b[9]) { return a[0] > b[0] + EPS; }\n";
  expect_refused("flag/f32/cpu --subject flag=./flag.c --flags=-DEPS=3", {"-DEPS=3", "flag.c"});
}

}  // namespace
}  // namespace graze::cli
