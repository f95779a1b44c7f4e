// SPDX-License-Identifier: Apache-2.0
#include "reports/tables.h"

#include "reports/failure_cards.h"
#include "reports/test_campaign.h"

namespace graze::reports {
namespace {

const std::vector<std::string> kMapped = {"m/f32/cpu", "m/f32/x86-gcc", "m/f32/arm64-gcc", "m/f32/x87",
                                          "m/f64/cpu", "m/f64/x86-gcc", "m/f64/arm64-gcc"};

// A summary of these lanes. Each signature is given as its wrong lanes and its number of pairs.
Json campaign_of(const std::vector<std::pair<std::string, int>>& signatures) {
  Json summary = summary_of(kMapped, {"thesis"}, {});
  for (const auto& [wrong, count] : signatures)
    summary["signatures"].push_back({{"key", "point/22/skew/-2^-3/m:" + wrong}, {"count", count}});
  return summary;
}

Json map_of(const Json& summary) {
  const CampaignCounts counts = counts_of(summary);
  return toolchain_map(counts, signature_rows(counts, summary));
}

// The differences in the cell of this row, such as "m/f32", and this variant.
Json differs(const Json& map, const std::string& row, const std::string& variant) {
  for (const Json& r : map["rows"]) {
    if (r["algorithm"].get<std::string>() + '/' + r["scalar"].get<std::string>() != row) continue;
    for (const Json& cell : r["cells"]) {
      if (map["variants"][cell["variant"].get<std::size_t>()] == variant) return cell["differs"];
    }
  }
  return "no such cell";
}

TEST(ToolchainMap, CountsThePairsThatSignaturesMarkDifferently) {
  const Json map = map_of(campaign_of({{"-f32/cpu;-f32/x86-gcc;-f32/arm64-gcc", 7},
                                       {"-f32/arm64-gcc;-f32/x87", 20},
                                       {"+f32/cpu;+f32/x86-gcc;+f32/x87", 300}}));
  EXPECT_EQ(map["reference"], "x86-gcc");
  EXPECT_EQ(differs(map, "m/f32", "x86-gcc")["count"], 0);
  EXPECT_EQ(differs(map, "m/f32", "cpu")["count"], 0);
  EXPECT_EQ(differs(map, "m/f32", "arm64-gcc")["count"], 320);
  EXPECT_EQ(differs(map, "m/f32", "x87")["count"], 27);
  EXPECT_EQ(differs(map, "m/f64", "arm64-gcc")["count"], 0);
  EXPECT_EQ(differs(map, "m/f64", "x87"), "no such cell");
  EXPECT_EQ(map["agree"], Json::parse(R"([["cpu", "x86-gcc"]])"));
  ASSERT_EQ(map["sentences"].size(), 2u);
  EXPECT_TRUE(contains(map["sentences"][0], "cpu, x86-gcc agree on all 1,000 pairs"));
  EXPECT_TRUE(contains(map["sentences"][1], "m/f32/arm64-gcc differs most from x86-gcc: on 320 pairs"));
}

// Variants with different lanes form no group, even if they agree where both have lanes.
TEST(ToolchainMap, GroupsHaveTheSameLanes) {
  EXPECT_EQ(map_of(campaign_of({}))["agree"], Json::parse(R"([["cpu", "x86-gcc", "arm64-gcc"]])"));
}

// A pair that one lane declines has a signature only if another lane is wrong.
TEST(ToolchainMap, LanesThatDeclineAreNotCounted) {
  Json summary = campaign_of({{"-f32/arm64-gcc", 20}});
  summary["strata"]["thesis"]["lanes"]["m/f32/x86-gcc"]["declined"] = 1;
  const Json map = map_of(summary);
  EXPECT_TRUE(differs(map, "m/f32", "arm64-gcc").is_null());
  EXPECT_EQ(differs(map, "m/f64", "arm64-gcc")["count"], 0);
  EXPECT_EQ(map["agree"], Json::array());
}

TEST(ToolchainMap, NeedsAToolchain) {
  EXPECT_TRUE(map_of(summary_of({"m/f32/cpu", "m/f32/cpu-fma"}, {"thesis"}, {})).is_null());
  EXPECT_EQ(map_of(summary_of({"m/f32/cpu", "m/f32/x87"}, {"thesis"}, {}))["reference"], "cpu");
  EXPECT_EQ(map_of(summary_of({"m/f32/cpu-fma", "m/f32/x87"}, {"thesis"}, {}))["reference"], "cpu-fma");
}

}  // namespace
}  // namespace graze::reports
