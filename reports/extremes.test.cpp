// SPDX-License-Identifier: Apache-2.0
#include "reports/extremes.h"

#include <gtest/gtest.h>

#include "reports/tables.h"
#include "reports/test_campaign.h"

namespace graze::reports {
namespace {

using analysis::ErrorsAt;
using Points = std::vector<ErrorsAt>;

TEST(RightWords, NameTheEndsAndWhereTheLaneErrsMore) {
  const Points points{{-8, 3'000, 10'000}, {-4, 1'000, 10'000}, {0, 1'000, 10'000},
                      {4, 1'000, 10'000},  {8, 2'000, 10'000},  {12, 3'000, 10'000}};
  EXPECT_EQ(right_words(points, 0), "as right as at 1 (errs on 10 %) from 2^-4 to 2^4; errs more at 2^-8 and 2^12");
  // A point of a campaign stands for four exponents, so the right range ends where the next point begins.
  EXPECT_EQ(right_words(points, 4), "as right as at 1 (errs on 10 %) from 2^-4 to 2^8; errs more at 2^-8 and 2^12");
  EXPECT_EQ(right_words(std::span(points).subspan(2), 0),
            "as right as at 1 (errs on 10 %) up to 2^4; errs more at 2^12");
  EXPECT_EQ(right_words(std::span(points).subspan(2, 3), 0),
            "as right as at 1 (errs on 10 %) up to 2^4; not settled above 2^4");
  EXPECT_EQ(right_words(std::span(points).subspan(1, 3), 0), "as right as at 1 (errs on 10 %) everywhere, 2^-4 to 2^4");
}

TEST(RightWords, SayWhatIsMissing) {
  EXPECT_EQ(right_words(Points{}, 0), "not settled: too few pairs");
  EXPECT_EQ(right_words(Points{{0, 3, 800}, {8, 3, 800}}, 0),
            "not settled: errs on 3 of 800 pairs at 1, too few to compare with");
  EXPECT_EQ(right_words(Points{{0, 0, 800}, {8, 0, 800}}, 0), "errs on none of 1,600 pairs, 1 to 2^8");
  EXPECT_EQ(right_words(Points{{6, 1'000, 10'000}, {7, 1'000, 10'000}}, 1),
            "no pairs at 1; as right as at 2^6 (errs on 10 %) everywhere, 2^6 to 2^8");
  EXPECT_EQ(right_words(Points{{0, 1, 2}, {6, 1'000, 10'000}, {7, 1'000, 10'000}}, 1),
            "few pairs at 1; as right as at 2^6 (errs on 10 %) from 2^6 to 2^8; not settled below 2^6");
}

TEST(RightWords, AnOriginWithoutErrorsHasNoRatioAbove) {
  Json row = {{"step", 4},
              {"cells",
               {{{"exponent", 0}, {"wrong", to_json(share_of(0, 10'000))}},
                {{"exponent", 4}, {"wrong", to_json(share_of(500, 10'000))}}}}};
  add_right_range(row);
  EXPECT_EQ(row["origin"], 0);
  const Json& times = row["cells"][1]["times"];
  EXPECT_FALSE(row["cells"][0].contains("times"));
  EXPECT_TRUE(times[0].is_null());
  EXPECT_TRUE(times[2].is_null());
  EXPECT_GT(times[1], 100);  // 4.6 % against at most 0.038 %
  row["cells"][0]["wrong"] = to_json(share_of(250, 10'000));
  add_right_range(row);
  EXPECT_EQ(row["cells"][1]["times"][0], 2);
  EXPECT_LT(row["cells"][1]["times"][1], 1.7);
  EXPECT_GT(row["cells"][1]["times"][2], 2.3);
}

// A campaign's sentences about its extremes must also hold on other pairs of the same strata. At the ends of the named
// range the lane must be as right, and beyond them less often right.
TEST_F(CampaignTest, ExtremesAreTrueOfFreshPairs) {
  const fuzz::SelectedLanes under_test =
      lanes({"*/f32/cpu", "interval_overlap/f64/cpu", "guigue_devillers_2003/f64/cpu"});
  const auto rows_of = [&](std::uint64_t seed) {
    fuzz::Campaign c;
    c.seed = seed;
    c.sources = strata::stratum_sources(seed, 200'000, {"extreme_scale", "far_from_origin"});
    c.under_test = &under_test;
    c.exact = find_lane("exact/f32/cpu")->decide;
    c.threads = 2;
    c.directory = root_ / std::to_string(seed);
    c.spec = fuzz::campaign_spec(c);
    c.build = fuzz::build_info(under_test);
    return extremes(counts_of(fuzz::run_campaign(c, std::atomic<bool>(false), [](const fuzz::Progress&) {}).summary));
  };
  const Json said = rows_of(11), fresh = rows_of(12);
  ASSERT_EQ(said.size(), 2 * under_test.lanes.size());
  int ends = 0, beyond = 0;
  for (std::size_t r = 0; r < said.size(); ++r) {
    Points points;
    std::map<int, double> share;
    for (const Json& cell : said[r]["cells"])
      points.push_back({cell["exponent"], cell["wrong"]["count"], cell["wrong"]["of"]});
    for (const Json& cell : fresh[r]["cells"]) share[cell["exponent"]] = cell["wrong"]["share"];
    const auto range = analysis::right_range(points);
    ASSERT_TRUE(range);
    if (!range->settled) continue;
    const double most = std::max(analysis::kAsRight * share.at(range->origin.exponent), analysis::kRightShare);
    for (const analysis::RightSide& side : {range->down, range->up}) {
      EXPECT_LE(share.at(side.right), most) << said[r]["says"];
      ++ends;
      if (!side.worse) continue;
      EXPECT_GT(share.at(*side.worse), most) << said[r]["says"];
      ++beyond;
    }
  }
  EXPECT_GE(ends, 20);
  EXPECT_GE(beyond, 8);
}

}  // namespace
}  // namespace graze::reports
