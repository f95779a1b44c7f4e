// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/carded_signatures.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace graze::fuzz {
namespace {

Json summary_of(const std::vector<std::string>& keys) {
  Json rows = Json::array();
  for (const std::string& key : keys) rows.push_back({{"key", key}, {"count", 1}, {"case", "c"}});
  return {{"signatures", rows}};
}

TEST(Cards, AreTheCommonestAndThoseWhereContractionDecides) {
  std::vector<std::string> keys;
  for (int i = 0; i < 60; ++i) keys.push_back(fmt::format("point/22/skew/+2^{}/moller_1997:----....", i));
  keys.push_back("point/22/skew/0/moller_1997:---.....");  // place 60: f32/cuda-fma is right, and no other
  keys.push_back("point/22/skew/0/moller_1997:-__-...._");
  keys.push_back("point/22/skew/0/moller_1997:-__.___.");
  const std::vector<std::size_t> cards = carded_signatures(summary_of(keys));
  ASSERT_EQ(cards.size(), kMostCards - kMostCards / 4 + 2);
  EXPECT_EQ(cards[29], 29u);
  EXPECT_EQ(cards[30], 60u);
  EXPECT_EQ(cards[31], 62u);
}

TEST(Cards, AlgorithmsShareThem) {
  std::vector<std::string> keys{"executors/moller_1997/f32/cuda-fma"};
  for (int i = 0; i < 60; ++i) {
    keys.push_back(fmt::format("point/22/skew/+2^{}/moller_1997:-__.....", i));
    if (i > 50) keys.push_back(fmt::format("point/22/skew/+2^{}/projected_sat:-.......", i));
  }
  const std::vector<std::size_t> cards = carded_signatures(summary_of(keys));
  ASSERT_EQ(cards.size(), kMostCards / 2 + 9);
  EXPECT_EQ(cards.front(), 1u);
  EXPECT_EQ(cards.back(), keys.size() - 1);
}

TEST(Cards, OfACampaignWithoutFailuresAreNone) { EXPECT_TRUE(carded_signatures(summary_of({})).empty()); }

}  // namespace
}  // namespace graze::fuzz
