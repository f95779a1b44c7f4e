// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as five sentences.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// What share of values and of verdicts differs, where differences start, which lane is nearer to the exact values, how
// near to zero signs differ, and the remedy. Also names open questions. Then a sentence for each comparison of verdicts
// only. json: discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

}  // namespace graze::reports
