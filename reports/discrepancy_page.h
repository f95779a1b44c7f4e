// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as one page without scripts: five sentences, then tables and pictures for each
// pair of lanes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// What share of values and of verdicts differs, where that starts, who is nearer to exact, how near to zero it matters,
// and what mends it. What the results do not tell is named.   json: discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

// Throws: std::runtime_error for counts that cannot be: parts larger than the whole, histograms that do not add up, a
// total that is not that of the strata.   json: discrepancy.json.
void expect_possible_discrepancy(const nlohmann::ordered_json& json);

// A self-contained HTML page.   json: discrepancy.json.
std::string discrepancy_page(const nlohmann::ordered_json& json);

}  // namespace graze::reports
