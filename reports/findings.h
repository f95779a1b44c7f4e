// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "reports/costs.h"
#include "reports/counts.h"

namespace graze::reports {

// Summarises a campaign, the most useful sentence first. It begins with a person's own code, if any ran (own_code.h);
// then what it says of lanes alone is left out where it cannot tell. It names the lane to use, the lane to avoid, the
// least wrong published lane, dangerous strata, the effect of contraction, and how often CPU and GPU differ on the
// thesis's triangles. Open questions come last. A comparison that the data does not settle is called "not settled". One
// sentence if no pair is decided yet. costs: null if none were measured. kinds: of failure; null if they are not known.
std::vector<std::string> answer(const CampaignCounts& counts, const Costs* costs,
                                const nlohmann::ordered_json& kinds = nullptr);

enum class Bound { none, lower, upper };

// "12.3 %", "1 in 3,270", "0". Bounds are rounded outward: the printed number is not below an upper bound, nor above a
// lower one.
std::string rate_words(double rate, Bound bound = Bound::none);

}  // namespace graze::reports
