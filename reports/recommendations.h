// SPDX-License-Identifier: Apache-2.0
// Which lane to use and which to avoid. Each sentence follows from counts and costs alone; a comparison whose intervals
// overlap is "not settled".
#pragma once

#include "reports/costs.h"
#include "reports/lane_words.h"

namespace graze::reports {

struct Sentence {
  std::string text;
  bool known = true;  // false: it says that the campaign cannot tell
};

// The exact lane, and what it costs beside the fastest published lane.
Sentence lane_to_use(const CampaignCounts& counts, const Costs* costs);

// Both require: a published lane, and pairs.
Sentence lane_to_avoid(const CampaignCounts& counts, const Costs* costs);
Sentence least_wrong_lane(const CampaignCounts& counts, const Costs* costs);

}  // namespace graze::reports
