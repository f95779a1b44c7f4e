// SPDX-License-Identifier: Apache-2.0
#include "fuzz/cost_estimate.h"

#include <gtest/gtest.h>

#include <numeric>

namespace graze::fuzz {
namespace {

// Artificial costs in seconds per pair, as far apart as the costs of uniform and mixed_scale. The highest comes last.
const std::vector<double> kCosts{1e-5, 2e-5, 1e-5, 4e-5, 9e-5, 1e-3};
constexpr std::uint64_t kPairs = 40'000, kFew = 512;

TEST(CostEstimate, IsRightOnceAFewOfEachKindAreDone) {
  CostEstimate estimate(std::vector<std::uint64_t>(kCosts.size(), kPairs));
  EXPECT_FALSE(estimate.seconds_left());
  double left = std::accumulate(kCosts.begin(), kCosts.end(), 0.0) * kPairs;
  const auto run = [&](std::size_t kind, std::uint64_t units) {
    estimate.add(kind, units, static_cast<double>(units) * kCosts[kind]);
    left -= static_cast<double>(units) * kCosts[kind];
  };
  for (std::size_t k = 0; k < kCosts.size(); ++k) run(k, kFew);
  ASSERT_NEAR(*estimate.seconds_left(), left, 1e-6 * left);
  for (std::size_t k = 0; k + 1 < kCosts.size(); ++k) {
    run(k, kPairs - kFew);
    ASSERT_NEAR(*estimate.seconds_left(), left, 1e-6 * left) << k;
  }
  // Extrapolating the average rate assumes that the remaining pairs cost the same, which is wrong here.
  const double done = static_cast<double>(kCosts.size() - 1) * kPairs + kFew;
  const double all = std::accumulate(kCosts.begin(), kCosts.end(), 0.0) * kPairs;
  EXPECT_GT(left, 4 * (all - left) / done * (kPairs - kFew));
  run(kCosts.size() - 1, kPairs - kFew);
  EXPECT_NEAR(*estimate.seconds_left(), 0, 1e-6);
}

TEST(CostEstimate, WhatIsNotMeasuredCostsTheMean) {
  CostEstimate estimate({100, 100, 100});
  estimate.add(0, 10, 10);
  estimate.add(1, 10, 30);
  EXPECT_TRUE(estimate.measured(0));
  EXPECT_FALSE(estimate.measured(2));
  EXPECT_DOUBLE_EQ(*estimate.seconds_left(), 90 * 1 + 90 * 3 + 100 * 2);
}

TEST(CostEstimate, WhatWasDoneBeforeCostsNothing) {
  CostEstimate estimate({100, 50});
  estimate.skip(0, 60);
  EXPECT_FALSE(estimate.seconds_left());
  estimate.add(0, 10, 20);
  estimate.skip(1, 50);
  EXPECT_DOUBLE_EQ(*estimate.seconds_left(), 30 * 2);
}

}  // namespace
}  // namespace graze::fuzz
