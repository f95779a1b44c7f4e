// SPDX-License-Identifier: Apache-2.0
// The results of `graze discrepancy` as five sentences.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// Sentences about the discrepancies: how many values and verdicts differ, where that starts, which lane is nearer to
// the exact values, how near to zero it matters, and the remedy. They also name open questions. Then a sentence for
// each comparison of verdicts alone. json: discrepancy.json.
std::vector<std::string> discrepancy_answer(const nlohmann::ordered_json& json);

}  // namespace graze::reports
