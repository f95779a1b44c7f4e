// SPDX-License-Identifier: Apache-2.0
// Recommends which lane to use and which to avoid, based on counts and costs. If the intervals of a comparison overlap,
// the sentence calls it "not settled".
#pragma once

#include "reports/costs.h"
#include "reports/lane_words.h"

namespace graze::reports {

struct Sentence {
  std::string text;
  bool known = true;  // false if the sentence says that the campaign cannot tell
};

// Recommends the exact lane, and compares its cost with that of the fastest published lane.
Sentence lane_to_use(const CampaignCounts& counts, const Costs* costs);

// Requires for both: pairs, and a published lane.
Sentence lane_to_avoid(const CampaignCounts& counts, const Costs* costs);
Sentence least_wrong_lane(const CampaignCounts& counts, const Costs* costs);

}  // namespace graze::reports
