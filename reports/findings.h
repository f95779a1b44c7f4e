// SPDX-License-Identifier: Apache-2.0
// The answer of a report: sentences that summarise a campaign.
#pragma once

#include <string>
#include <vector>

#include "reports/costs.h"
#include "reports/counts.h"

namespace graze::reports {

// Summarises a campaign, the most useful sentence first. If a user's own code ran, the sentences about it come first
// (own_code.h). If only such code ran, no sentence compares lanes. The next sentences name the lane to use, the lane to
// avoid, the least wrong published lane, dangerous strata, the effect of contraction, and how often CPU and GPU differ
// on the thesis's triangles. Open questions come last; "not settled" marks a comparison that the data does not decide.
// Before the first pair is decided, there is only one sentence.
// costs: null if they were not measured.   kinds: the kinds of failure; null if unknown.
std::vector<std::string> answer(const CampaignCounts& counts, const Costs* costs,
                                const nlohmann::ordered_json& kinds = nullptr);

// The sentences on which lane to use and which to avoid, based on counts and costs. If the intervals of a comparison
// overlap, the sentence calls it "not settled".
struct Sentence {
  std::string text;
  bool known = true;  // false if the sentence says that the campaign cannot tell
};

// Recommends the exact lane, and compares its cost with that of the fastest published lane.
Sentence lane_to_use(const CampaignCounts& counts, const Costs* costs);

// Requires for both: pairs, and a published lane.
Sentence lane_to_avoid(const CampaignCounts& counts, const Costs* costs);
Sentence least_wrong_lane(const CampaignCounts& counts, const Costs* costs);

enum class Bound { none, lower, upper };

// "12.3 %", "1 in 3,270", "0". Bounds are rounded outward: the printed number is never below an upper bound or above a
// lower bound.
std::string rate_words(double rate, Bound bound = Bound::none);

// The rate count / of in words; "0" if `of` is 0.
std::string rate_words(std::uint64_t count, std::uint64_t of);

}  // namespace graze::reports
