// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "reports/counts.h"

namespace graze::reports {

// What a campaign says, in five sentences: the safest lane, the worst, what contraction changes, how often CPU and GPU
// differ on the thesis's triangles, which strata are dangerous. One sentence where no pair is decided yet.
std::vector<std::string> answer(const CampaignCounts& counts);

// "12.3 %", "1 in 3,270", "0".
std::string rate_words(double rate);

}  // namespace graze::reports
