// SPDX-License-Identifier: Apache-2.0
#include "analysis/extremes.h"

#include <gtest/gtest.h>

#include <vector>

namespace graze::analysis {
namespace {

using Points = std::vector<ErrorsAt>;

TEST(RightRange, EndsBeforeTheFirstExponentThatIsNotShownToBeAsRight) {
  // At 2^0 the share of errors is 10 %, with bounds of about 9.5 and 10.5 %. So a lane counts as equally right up to a
  // share of 18 %, and as less right above 21 %.
  const auto range = right_range(Points{{-16, 9'000, 10'000},
                                        {-8, 1'500, 10'000},
                                        {0, 1'000, 10'000},
                                        {8, 1'700, 10'000},
                                        {16, 2'000, 10'000},  // not settled
                                        {24, 1'000, 10'000},
                                        {32, 2'500, 10'000},
                                        {40, 100, 10'000}});
  ASSERT_TRUE(range);
  EXPECT_TRUE(range->settled);
  EXPECT_EQ(range->origin.exponent, 0);
  EXPECT_EQ(range->down.right, -8);
  EXPECT_EQ(range->down.worse, -16);
  EXPECT_EQ(range->down.last, -16);
  EXPECT_EQ(range->up.right, 8);
  EXPECT_EQ(range->up.worse, 32);
  EXPECT_EQ(range->up.last, 40);
}

// A lane that errs on at most 0.1 % of the pairs counts as one without errors, if there are enough pairs.
TEST(RightRange, TakesALaneThatHardlyErrsForRight) {
  EXPECT_TRUE(right_range(Points{{0, 0, 4'000}, {8, 0, 4'000}})->settled);
  EXPECT_FALSE(right_range(Points{{0, 0, 3'500}, {8, 0, 4'000}})->settled);
  const auto range = right_range(Points{{0, 0, 10'000}, {2, 3, 10'000}, {4, 9, 10'000}, {6, 30, 10'000}});
  EXPECT_EQ(range->up.right, 2);
  EXPECT_EQ(range->up.worse, 6);
  EXPECT_EQ(range->down.right, 0);
  EXPECT_FALSE(range->down.worse);
}

// Exponents with few pairs show nothing: they neither end a range nor serve as its origin.
TEST(RightRange, LeavesOutFewPairs) {
  EXPECT_FALSE(right_range(Points{}));
  EXPECT_FALSE(right_range(Points{{0, 50, kFewPairs - 1}}));
  const auto range = right_range(Points{{5, 2, 2}, {6, 1'000, 10'000}, {7, 99, 99}, {8, 1'000, 10'000}, {9, 0, 1}});
  ASSERT_TRUE(range);
  EXPECT_EQ(range->origin.exponent, 6);
  EXPECT_EQ(range->up.right, 8);
  EXPECT_EQ(range->up.last, 9);
  EXPECT_EQ(range->down.last, 5);
  EXPECT_FALSE(range->up.worse);
}

}  // namespace
}  // namespace graze::analysis
