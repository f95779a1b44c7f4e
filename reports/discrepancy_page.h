// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as one page without scripts: five sentences, then tables and pictures for each
// pair of lanes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// Sentences about the discrepancies: how many values and verdicts differ, where that starts, which lane is nearer to
// the exact values, how near to zero it matters, and the remedy. They also name open questions.   json:
// discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

// Throws: std::runtime_error for impossible counts: parts larger than the whole, or sums that do not agree.   json:
// discrepancy.json.
void expect_possible_discrepancy(const nlohmann::ordered_json& json);

// A self-contained HTML page.   json: discrepancy.json.
std::string discrepancy_page(const nlohmann::ordered_json& json);

}  // namespace graze::reports
