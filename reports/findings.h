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

enum class Bound { none, lower, upper };

// "12.3 %", "1 in 3,270", "0". Bounds are rounded outward: the printed number is never below an upper bound or above a
// lower bound.
std::string rate_words(double rate, Bound bound = Bound::none);

// The rate count / of in words; "0" if `of` is 0.
std::string rate_words(std::uint64_t count, std::uint64_t of);

}  // namespace graze::reports
