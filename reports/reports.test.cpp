// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "reports/margin_figure.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

nlohmann::ordered_json example() {
  return nlohmann::ordered_json::parse(R"({
    "spec": {"lanes": ["moller_1997/f32/cpu", "moller_1997/f32/cpu-fma"]},
    "strata": {"uniform": {"pairs": 1234567, "intersects": 617283,
      "lanes": {"moller_1997/f32/cpu": {"false_positive": 12, "false_negative": 1234, "declined": 0, "differs_from_cpu": 0},
                "moller_1997/f32/cpu-fma": {"false_positive": 0, "false_negative": 0, "declined": 0, "differs_from_cpu": 1246}},
      "margins": {"-2^3": {"pairs": 100, "wrong": {"moller_1997/f32/cpu": 50}}, "0": {"pairs": 10, "wrong": {}}}}},
    "disagreements": 1246, "signatures": [{"key": "k", "count": 1246, "case": "c"}]})");
}

TEST(Terminal, SummaryShowsSharesAndCounts) {
  std::ostringstream out;
  print_summary(out, example(), {{"cgal", 1234567}, {"gmp", 2451}, {"device", 0}, {"apart", 0}});
  EXPECT_NE(out.str().find("1,234,567"), std::string::npos);
  EXPECT_NE(out.str().find("50 %"), std::string::npos);
  EXPECT_NE(out.str().find("0.101 %"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("some lane is wrong on 1,246, in 1 signatures"), std::string::npos);
}

TEST(Terminal, NumbersAreGrouped) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(1234567890), "1,234,567,890");
}

TEST(Terminal, PairMarksWrongLanes) {
  const Pair pair{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  const std::vector<const Lane*> run{&lanes()[0], &lanes()[1]};
  std::ostringstream out;
  print_pair(out, pair, {Verdict::disjoint, Contact::none, 1, 8388608}, run,
             std::vector{Verdict::disjoint, Verdict::intersects});
  EXPECT_NE(out.str().find("margin 1 (8388608 ulps)"), std::string::npos);
  EXPECT_NE(out.str().find("disjoint      intersects !"), std::string::npos) << out.str();
}

TEST(MarginFigure, DrawsALineForEachCpuLane) {
  const std::string svg = margin_figure(example());
  EXPECT_NE(svg.find("<polyline"), std::string::npos);
  EXPECT_EQ(svg.find("<polyline"), svg.rfind("<polyline"));  // the cpu-fma lane is not drawn
  EXPECT_NE(svg.find("moller_1997"), std::string::npos);
}

}  // namespace
}  // namespace graze::reports
