// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "reports/costs.h"
#include "reports/counts.h"

namespace graze::reports {

// What a campaign says, the most useful sentence first: the lane to use, the lane to avoid, the least wrong of the
// published ones, which strata are dangerous, what contraction changes, how often CPU and GPU differ on the thesis's
// triangles. What the campaign cannot tell comes last; what its data does not settle is called "not settled". One
// sentence where no pair is decided yet. costs null: none were measured.
std::vector<std::string> answer(const CampaignCounts& counts, const Costs* costs);

enum class Bound { none, lower, upper };

// "12.3 %", "1 in 3,270", "0". A bound is rounded outward: what is printed is not below an upper bound, nor above a
// lower one.
std::string rate_words(double rate, Bound bound = Bound::none);

}  // namespace graze::reports
