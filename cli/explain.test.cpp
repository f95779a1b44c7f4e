// SPDX-License-Identifier: Apache-2.0
// `graze explain` as users run it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

class ExplainCommand : public CommandTest {};

TEST_F(ExplainCommand, SaysWhyInOneSentenceAnAlgorithm) {
  const Ran ran = shell.done("graze explain coplanar_rounded:1:3 --all --lanes '*/f32/cuda-*fma'");
  EXPECT_TRUE(
      has(ran.out, {"cause: contraction", "interval_overlap/f32 (cuda-fma) says disjoint, but", " is true; exactly "}));
  EXPECT_EQ(ran.err, "");
}

// Rounding by an ulp or two is not reported. Only a value that is off is shown with the exact value, and only the
// deciding step has a mark.
TEST_F(ExplainCommand, SaysItsSentenceFirstAndMarksWhatMatters) {
  std::ofstream(shell.folder / "p") << "0.1 0.2 0.3 0.4 0.9 0.2 0.7 0.1 0.6 0.1 0.2 0.3 0.5 0.5 0.9 -0.3 0.8 0.4\n";
  const std::string out = shell("graze explain p --lanes 'guigue*/f32/cpu'").out;
  ASSERT_TRUE(out.starts_with("p:1\n  guigue_devillers_2003/f32 (cpu) says disjoint, but the triangles meet in a"))
      << out;
  EXPECT_TRUE(has(out, {"\n    values:\n"
                        "      guigue_devillers_2003.h:116  plane_distance: -1.490116e-08, exactly 0\n"
                        "      guigue_devillers_2003.h:116  plane_distance: -0.331\n"
                        "      guigue_devillers_2003.h:116  plane_distance: -0.06199999\n"
                        "   => guigue_devillers_2003.h:117  4.932284e-09 > 0 is true;\n"
                        "                                   exactly 0 > 0 is false\n"
                        "    mantissa bits"}));
  EXPECT_EQ(out.find("=>"), out.rfind("=>"));
}

TEST_F(ExplainCommand, JsonIsOneObjectACaseAndTheSameBytesTwice) {
  const std::string command =
      "graze fuzz --pairs 20000 --strata 'extreme_scale,lattice' --out c > /dev/null; cat $(ls c/cases/*.pairs | head "
      "-n 2) "
      "| grep -v '^graze-pairs' > some.pairs; graze explain some.pairs --json";
  const Ran ran = shell.done(command);
  std::istringstream lines(ran.out);
  std::string line;
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const Json object = Json::parse(line);
    EXPECT_EQ(object["case"], "some.pairs");
    ASSERT_FALSE(object["lanes"].empty());
    EXPECT_FALSE(object["sentences"].empty());
    for (const Json& lane : object["lanes"]) {
      EXPECT_EQ(lane["matters"].size(), 18u);
      EXPECT_EQ(lane["orders"]["of"], 72);
      EXPECT_FALSE(lane["cause"].get<std::string>().empty());
    }
  }
  EXPECT_GE(count, 2);
  EXPECT_EQ(shell("graze explain some.pairs --json").out, ran.out);
}

TEST_F(ExplainCommand, SaysWhenThereIsNothingToExplain) {
  EXPECT_TRUE(has(shell("graze explain uniform:1:1").out, {"no lane is wrong"}));
  expect_out("echo 'nan 0 0 4 0 0 0 4 0  1 1 0 1 2 4 2 1 4' > nan.pairs; graze explain nan.pairs", {"not finite"});
}

// However many cases and lanes there are, the conclusions come first, within 40 lines.
TEST_F(ExplainCommand, PrintsAtMost40LinesUnlessAllAreAsked) {
  expect_done(
      "graze fuzz --pairs 3000 --strata coplanar_rounded,lattice --out c > /dev/null && cat c/cases/*.pairs | "
      "grep -v '^graze-pairs' | head -n 30 > some.pairs");
  for (const std::string of : {"some.pairs", "coplanar_rounded:1:3", "uniform:1:1"}) {
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
    const std::string some = shell("graze explain " + of).out, all = shell("graze explain " + of + " --all").out;
    EXPECT_LE(lines(some), 40) << some;
    EXPECT_TRUE(some.starts_with(all.substr(0, all.find('\n', all.find('\n') + 1)))) << some;
    EXPECT_EQ(some.find("--all explains") != std::string::npos, lines(all) > 40) << some;
    if (of == "some.pairs") {
      EXPECT_GT(lines(all), 1000);
    }
  }
  // The conclusions on other cases come before the details of the first case.
  const std::string of_one = shell("graze explain some.pairs --lanes 'projected_sat/f32/cpu'").out;
  EXPECT_LE(std::count(of_one.begin(), of_one.end(), '\n'), 40) << of_one;
  const std::size_t second = of_one.find("\nsome.pairs:");
  EXPECT_NE(second, std::string::npos) << of_one;
  EXPECT_LT(second, of_one.find("a[0]")) << of_one;
}

TEST_F(ExplainCommand, FailuresOfACampaignFit40LinesToo) {
  expect_done("graze fuzz --pairs 3000 --strata coplanar_rounded,lattice --lanes '*/f32/cpu' --out c > /dev/null");
  const std::string some = shell("graze failures c").out, all = shell("graze failures c --all").out;
  const auto kinds = [](const std::string& text) {
    int count = text.starts_with("kind-1  ");
    for (std::size_t at = 0; (at = text.find("\nkind-", at)) != text.npos; ++at) ++count;
    return count;
  };
  EXPECT_LE(std::count(some.begin(), some.end(), '\n'), 40) << some;
  EXPECT_GE(kinds(some), 3) << some;
  EXPECT_GT(kinds(all), kinds(some));
  EXPECT_TRUE(has(some, {"and " + std::to_string(kinds(all) - kinds(some)) + " rarer kinds"}));
  EXPECT_TRUE(has(all, {"lanes audited"}));
}

TEST_F(ExplainCommand, WrongUseGetsOneLine) {
  for (const auto& [command, status] : {std::pair{"graze explain", 2},
                                        {"graze explain nowhere:1:3", 2},
                                        {"graze explain missing.pairs", 1},
                                        {"graze explain uniform:1:1 --lanes x", 2}}) {
    const Ran ran = shell(command);
    EXPECT_EQ(ran.status, status) << command;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
}

}  // namespace
}  // namespace graze::cli
