// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/carded_signatures.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace graze::fuzz {
namespace {

Json summary_of(const std::vector<std::string>& keys) {
  Json rows = Json::array();
  for (const std::string& key : keys) rows.push_back({{"key", key}, {"count", 1}, {"case", "c"}});
  Json lane_ids = Json::array();
  for (const char* lane : {"f32/cpu", "f32/cuda-nofma", "f32/cuda-fma", "f64/cpu", "f64/cuda-fma"}) {
    for (const char* subject : {"moller_1997/", "projected_sat/"}) lane_ids.push_back(std::string(subject) + lane);
  }
  return {{"spec", {{"lanes", lane_ids}}}, {"signatures", rows}};
}

TEST(Cards, AreTheCommonestAndThoseWhereContractionDecides) {
  std::vector<std::string> keys;
  for (int i = 0; i < 60; ++i)
    keys.push_back(fmt::format("point/22/skew/+2^{}/moller_1997:-f32/cpu;-f32/cuda-nofma;-f32/cuda-fma", i % 31));
  keys.push_back("point/22/skew/0/moller_1997:-f32/cpu;-f32/cuda-nofma");  // place 60: f32/cuda-fma is right
  keys.push_back("point/22/skew/0/moller_1997:-f64/cpu;-f64/cuda-fma");
  keys.push_back("point/22/skew/0/moller_1997:-f64/cpu");
  const std::vector<std::size_t> cards = carded_signatures(summary_of(keys));
  ASSERT_EQ(cards.size(), kMostCards - kMostCards / 4 + 2);
  EXPECT_EQ(cards[29], 29u);
  EXPECT_EQ(cards[30], 60u);
  EXPECT_EQ(cards[31], 62u);
}

TEST(Cards, AlgorithmsShareThem) {
  std::vector<std::string> keys;
  for (int i = 0; i < 60; ++i) {
    keys.push_back(fmt::format("point/22/skew/+2^{}/moller_1997:-f32/cpu", i % 31));
    if (i > 50) keys.push_back(fmt::format("point/22/skew/+2^{}/projected_sat:-f32/cpu", i - 50));
  }
  const std::vector<std::size_t> cards = carded_signatures(summary_of(keys));
  ASSERT_EQ(cards.size(), kMostCards / 2 + 9);
  EXPECT_EQ(cards.front(), 0u);
  EXPECT_EQ(cards.back(), keys.size() - 1);
}

TEST(Cards, OfACampaignWithoutFailuresAreNone) { EXPECT_TRUE(carded_signatures(summary_of({})).empty()); }

}  // namespace
}  // namespace graze::fuzz
