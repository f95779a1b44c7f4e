// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <sstream>

#include "reports/pareto.h"
#include "reports/report.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

nlohmann::ordered_json example() {
  return nlohmann::ordered_json::parse(R"({
    "spec": {"seed": 1, "pairs": 1234567, "lanes": ["moller_1997/f32/cpu", "moller_1997/f32/cpu-fma"]},
    "strata": {"uniform": {"pairs": 1234567, "intersects": 617283,
      "lanes": {"moller_1997/f32/cpu": {"false_positive": 12, "false_negative": 1234, "declined": 0, "differs_from_cpu": null},
                "moller_1997/f32/cpu-fma": {"false_positive": 0, "false_negative": 0, "declined": 0, "differs_from_cpu": 1246}},
      "margins": {"-2^3": {"pairs": 100, "wrong": {"moller_1997/f32/cpu": 50}, "differs_from_cpu": {}},
                  "0": {"pairs": 10, "wrong": {}, "differs_from_cpu": {}}}}},
    "complete": true, "disagreements": 1246, "signatures": [{"key": "k", "count": 1246, "case": "c"}]})");
}

TEST(Terminal, OneIsSingular) {
  EXPECT_EQ(counted(0, "pair"), "0 pairs");
  EXPECT_EQ(counted(1, "pair"), "1 pair");
  EXPECT_EQ(counted(2000, "pair"), "2,000 pairs");
}

TEST(Terminal, SummaryShowsSharesAndCounts) {
  std::ostringstream out;
  print_summary(out, example(), {{"cgal", 1234567}, {"gmp", 2451}, {"exact", 0}, {"apart", 0}});
  EXPECT_NE(out.str().find("in % of its pairs"), std::string::npos);
  EXPECT_NE(out.str().find("uniform  1,234,567       50.0        0.101\n"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("moller_1997/f32/cpu            12     1,234"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("1,234,567 pairs: some lane is wrong on 1,246, in 1 signature."), std::string::npos);
}

// GMP checks every disagreement and a sample of the other pairs. If the exact lane judges, GMP checks a sample and the
// kept cases.
TEST(Terminal, SummarySaysWhatEachExactDecisionSaw) {
  std::ostringstream cpu, exact;
  print_summary(cpu, example(), {{"cgal", 1234567}, {"gmp", 2451}, {"exact", 0}, {"apart", 0}}, {200, false});
  EXPECT_NE(
      cpu.str().find("\nCGAL decided all pairs. GMP decided 2,451 again, the 1,246 with a wrong lane and a sample "
                     "of 1,205 others. They agree on all.\n"),
      std::string::npos)
      << cpu.str();
  print_summary(exact, example(), {{"cgal", 1500}, {"gmp", 1200}, {"exact", 1233567}, {"apart", 0}}, {200, false});
  EXPECT_NE(
      exact.str().find("\nThe exact lane decided 1,233,567 pairs. CGAL decided 1,500 of them again, including all "
                       "kept cases, and GMP 1,200 of those. They agree on all.\n"),
      std::string::npos)
      << exact.str();
}

TEST(Terminal, SharesHaveOneForm) {
  EXPECT_EQ(bare_percent(0, 7), "0");
  EXPECT_EQ(bare_percent(7, 7), "100");
  EXPECT_EQ(bare_percent(478, 1000), "47.8");
  EXPECT_EQ(bare_percent(956, 10000), "9.56");
  EXPECT_EQ(bare_percent(2, 180506), "0.001");
  EXPECT_EQ(bare_percent(1, 1'000'000), "<0.001");
  EXPECT_EQ(bare_percent(999'999, 1'000'000), ">99.9");
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
  print_pair(out, pair, {{Verdict::disjoint, Contact::none, 1, {}}, 1, 8388608}, run,
             std::vector{Verdict::disjoint, Verdict::intersects});
  EXPECT_NE(out.str().find("margin 1 (8388608 ulps)"), std::string::npos);
  EXPECT_NE(out.str().find("\n  projected_sat/f32  disjoint  intersects !\n"), std::string::npos) << out.str();
}

// If a row of decimals and hex floats would be too long, each hex float is printed below its decimal number.
TEST(Terminal, PairFitsItsScreen) {
  const Pair pair{{{0.1f, -1.23456e-30f, 3}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
  const auto first_lines = [&](int columns) {
    std::ostringstream out;
    print_pair(out, pair, {{Verdict::disjoint, Contact::none, 1, {}}, 0.1234567891, 1}, {}, {}, {columns, false});
    const std::string text = out.str();
    return text.substr(0, text.find("a[1]"));
  };
  EXPECT_EQ(first_lines(80), "  a[0]  0.1  -1.23456e-30  3  0x1.99999ap-4  -0x1.90a33cp-100  0x1.8p+1\n  ");
  EXPECT_EQ(first_lines(60),
            "  a[0]            0.1      -1.23456e-30         3\n"
            "        0x1.99999ap-4  -0x1.90a33cp-100  0x1.8p+1\n  ");
}

TEST(ParetoTable, EachRowIsWholeOnADevice) {
  analysis::Pareto pareto;
  pareto.on_device = true;
  pareto.offers.resize(2);
  pareto.offers[0].lane = "timed", pareto.offers[1].lane = "untimed";
  pareto.offers[0].near = pareto.offers[0].far = {1, 2, 3};
  pareto.offers[0].needs = cuda::KernelNeeds{128, 41, 16, 1536};
  const std::string text = pareto_table(pareto, {});
  std::istringstream lines(text);
  std::vector<std::vector<std::string>> rows;
  for (std::string line, cell; std::getline(lines, line);) {
    std::istringstream cells(line);
    for (rows.emplace_back(); cells >> cell;) rows.back().push_back(cell);
  }
  ASSERT_GE(rows.size(), 2u) << text;
  using Row = std::vector<std::string>;
  EXPECT_EQ(rows[rows.size() - 2],
            (Row{"timed", "2.0", "2.0", "41", "16", "1536", "0", "0", "0", "none:", "under", "1"}));
  EXPECT_EQ(rows.back(), (Row{"untimed", "-", "-", "-", "-", "-", "0", "0", "0", "not", "timed"})) << text;
}

TEST(MarginFigure, DrawsALineForEachCpuLane) {
  const std::string svg = margin_figure(example());
  EXPECT_NE(svg.find("<polyline"), std::string::npos);
  EXPECT_EQ(svg.find("<polyline"), svg.rfind("<polyline"));  // only cpu is drawn, not cpu-fma
  EXPECT_NE(svg.find("moller_1997"), std::string::npos);
}

}  // namespace
}  // namespace graze::reports
