// SPDX-License-Identifier: Apache-2.0
// `graze discrepancy`, `graze dump --values` and `graze explain` with two lanes, as users run them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class DiscrepancyCommand : public CommandTest {};

TEST_F(DiscrepancyCommand, LeavesTheSameBytesWhateverTheThreads) {
  const std::string run =
      "graze discrepancy interval_overlap/f32/cpu interval_overlap/f32/cuda-fma --executor twin "
      "--strata 'near_*,thesis' --pairs 3000 ";
  const Ran first = shell(run + "--threads 1 --out one"), second = shell(run + "--threads 3 --out three");
  ASSERT_EQ(first.status, 0) << first.err;
  ASSERT_EQ(second.status, 0) << second.err;
  expect_done("diff -r one three");
  const auto lanes = nlohmann::json::parse(contents(shell.folder / "one/discrepancy.json"))["lanes"][0];
  EXPECT_EQ(lanes["total"]["pairs"], 3000);
  std::uint64_t differs = 0;
  for (const auto& [stratum, of] : lanes["strata"].items()) differs += of["differs"].get<std::uint64_t>();
  EXPECT_EQ(lanes["total"]["differs"], differs);
  EXPECT_GT(differs, 1000u);
  EXPECT_GT(lanes["origins"]["lines"].size(), 5u);
}

// An independent program counts the values again, with rationals.
TEST_F(DiscrepancyCommand, CountsAreThoseOfAProgramThatSharesNoCode) {
  struct Case {
    const char *first, *second, *stratum;
  };
  for (const auto& [first, second, stratum] :
       {Case{"interval_overlap/f32/cpu", "interval_overlap/f32/cuda-fma", "thesis"},
        Case{"moller_1997/f64/cpu", "moller_1997/f64/cuda-fma", "coplanar_wide"},
        Case{"separating_axes/f32/cpu", "separating_axes/f32/cpu-fma", "near_edge_edge"},
        Case{"guigue_devillers_2003/f32/cuda-fma", "guigue_devillers_2003/f32/cpu", "extreme_scale"},
        Case{"projected_sat/f64/cpu", "projected_sat/f64/cuda-fma", "lattice"}}) {
    const std::string lanes = std::string(first) + " " + second, pairs = std::string(" --pairs 200 ");
    expect_done("graze discrepancy " + lanes + " --executor twin --strata " + stratum + pairs + "--seed 5 --out d");
    const Ran ran =
        shell("graze dump " + std::string(stratum) + ":5" + pairs + "--values " + first + "," + second +
              " | python3 -B " GRAZE_SOURCE_DIR "/scripts/recount_discrepancy d/discrepancy.json " + stratum);
    EXPECT_EQ(ran.status, 0) << lanes << '\n' << ran.out << ran.err;
    EXPECT_NE(ran.out.find("200 pairs, "), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find(" 0 differ"), std::string::npos) << ran.out;
  }
}

// The verdicts that differ are those that a campaign counts on the same pairs, and its report shows the answer.
TEST_F(DiscrepancyCommand, ACampaignsColumnIsTheSumOfItsVerdicts) {
  const std::string first = "interval_overlap/f32/cpu", second = "interval_overlap/f32/cuda-fma";
  expect_done("graze fuzz --lanes " + first + "," + second +
              " --executor twin --strata 'thesis,near_edge_edge,coplanar_*' --pairs 5003 --out c");
  expect_done("graze discrepancy " + first + " " + second + " --executor twin --campaign c --pairs 5003");
  const auto summary = nlohmann::json::parse(contents(shell.folder / "c/summary.json")),
             found = nlohmann::json::parse(contents(shell.folder / "c/discrepancy.json"));
  EXPECT_EQ(found["pairs"], 5003);
  std::uint64_t verdicts = 0;
  for (const auto& [stratum, of] : found["lanes"][0]["strata"].items()) {
    EXPECT_EQ(of["pairs"], summary["strata"][stratum]["pairs"]) << stratum;
    EXPECT_EQ(of["verdict"], summary["strata"][stratum]["lanes"][second]["differs_from_cpu"]) << stratum;
    verdicts += of["verdict"].get<std::uint64_t>();
  }
  EXPECT_GT(verdicts, 50u);
  expect_done("graze report c");
  EXPECT_NE(contents(shell.folder / "c/report.html").find("discrepancy.html"), std::string::npos);
  // An edited count is refused.
  auto forged = found;
  forged["lanes"][0]["strata"]["thesis"]["verdict"] = 5004;
  std::ofstream(shell.folder / "c/discrepancy.json") << forged.dump();
  EXPECT_EQ(shell("graze report c").status, 1);
}

TEST_F(DiscrepancyCommand, ExplainShowsTwoLanesSideBySide) {
  const Ran ran = shell("graze explain thesis:2012:1 --lanes interval_overlap/f32/cpu,interval_overlap/f32/cuda-fma");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_NE(ran.out.find("values differ, no comparison does"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("plane_distance.b[0]"), std::string::npos) << ran.out;
}

TEST_F(DiscrepancyCommand, ComparesTwoResults) {
  const std::string run = "graze discrepancy --executor twin --strata thesis --pairs 2000 moller_1997/f32/cpu ";
  expect_done(run + "moller_1997/f32/cuda-fma --out a");
  expect_done(run + "moller_1997/f32/cuda-fma --out b");
  expect_done(run + "moller_1997/f32/cpu-fma --out c");
  const Ran same = shell("graze discrepancy --compare a b"), other = shell("graze discrepancy --compare a c");
  EXPECT_NE(same.out.find("0 counts differ, "), std::string::npos) << same.out << same.err;
  EXPECT_NE(other.out.find("Only the first has moller_1997/f32/cpu against moller_1997/f32/cuda-fma."),
            std::string::npos)
      << other.out << other.err;
}

TEST_F(DiscrepancyCommand, RefusesWhatItCannotCompare) {
  for (const char* wrong :
       {"graze discrepancy moller_1997/f32/cpu", "graze discrepancy moller_1997/f32/cpu nosuch/f32/cpu",
        "graze discrepancy moller_1997/f32/cpu moller_1997/f64/cpu", "graze discrepancy exact/f32/cpu exact/f32/cuda",
        "graze dump thesis --values moller_1997/f32/cpu", "graze discrepancy --compare a b --pairs 5",
        "graze discrepancy --campaign c --seed 3", "graze dump thesis --values exact/f32/cpu,exact/f32/cuda"}) {
    const Ran ran = shell(wrong);
    EXPECT_EQ(ran.status, 2) << wrong << ran.out;
    EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
  }
}

}  // namespace
}  // namespace graze::cli
