// SPDX-License-Identifier: Apache-2.0
#include "cli/progress.h"

#include <gtest/gtest.h>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

TEST(Progress, SaysDurationsAsPeopleDo) {
  EXPECT_EQ(duration(0), "0 s");
  EXPECT_EQ(duration(0.2), "1 s");
  EXPECT_EQ(duration(119), "119 s");
  EXPECT_EQ(duration(120), "2 min");
  EXPECT_EQ(duration(7100), "118 min");
  EXPECT_EQ(duration(7500), "2 h 5 min");
}

TEST(Progress, OnATerminalIsOneLineRewritten) {
  Progress progress("signatures", 7512, true);
  EXPECT_FALSE(progress.line(1, 0.1, 3.0));
  EXPECT_EQ(progress.line(16, 0.3, {}), "\r  0%  16 of 7,512 signatures\033[K");
  EXPECT_FALSE(progress.line(17, 0.4, 3.0));
  EXPECT_EQ(progress.line(3756, 50, 49.1), "\r 50%  3,756 of 7,512 signatures, 50 s left\033[K");
  EXPECT_EQ(progress.end(), "\r\033[K");
}

TEST(Progress, OtherwiseIsALineForEveryTenth) {
  Progress progress("signatures", 7512, false);
  EXPECT_FALSE(progress.line(1000, 9, 60.0));  // too soon
  EXPECT_EQ(progress.line(1001, 10, 60.0), " 13%  1,001 of 7,512 signatures, 60 s left\n");
  EXPECT_FALSE(progress.line(1400, 30, 60.0));  // the same tenth
  EXPECT_EQ(progress.line(1600, 40, 600.0), " 21%  1,600 of 7,512 signatures, 10 min left\n");
  EXPECT_EQ(progress.end(), "");
}

TEST(Progress, WithoutTerminalHalfAMinuteIsTheLongestSilence) {
  Progress progress("signatures", 7512, false);
  EXPECT_FALSE(progress.line(5, 29, {}));
  EXPECT_EQ(progress.line(6, 30, 7200.0), "  0%  6 of 7,512 signatures, 2 h 0 min left\n");
  EXPECT_FALSE(progress.line(7, 59, 7200.0));
  EXPECT_TRUE(progress.line(8, 60, 7200.0));
}

TEST(Progress, NeverWraps) {
  const auto line = Progress("signatures", 999'999'999, false).line(999'999'998, 1e6, 3.6e6);
  ASSERT_TRUE(line);
  EXPECT_LE(line->size(), 80u);  // including the newline
  const std::vector<std::string> more{"1,234,567,890 disagreements", "7,562 signatures", "123,456 pairs/s",
                                      "most in near_vertex_vertex"};
  std::size_t widest = 0;
  for (int columns = 1; columns <= 200; ++columns) {
    const auto shown =
        Progress("pairs", 1'000'000'000, true, {columns, false}).line(999'999'999, 1e6, 3.6e6, more).value();
    ASSERT_TRUE(shown.starts_with('\r') && shown.ends_with("\033[K"));
    ASSERT_LT(shown.size() - 4, static_cast<std::size_t>(columns)) << shown;
    ASSERT_GE(shown.size(), widest);  // with more room, more is shown
    widest = shown.size();
  }
  EXPECT_TRUE(has(fitting(more, 200), {"most in"}));
  EXPECT_FALSE(has(fitting(more, 80), {"most in"}));
}

}  // namespace
}  // namespace graze::cli
