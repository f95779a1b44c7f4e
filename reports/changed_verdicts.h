// SPDX-License-Identifier: Apache-2.0
// Which verdicts changed between two campaigns on the same pairs, in words. The rows are those of add_comparison.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

inline constexpr const char* kAllStrata = "all strata";  // stands for a stratum in rates over all strata

// The start of a comparison's headline: how many verdicts changed, and of how many lanes.
std::string paired_headline(const nlohmann::ordered_json& verdicts);

// Throws: std::runtime_error for rows whose counts are impossible in a campaign of this many pairs.   Requires: rows of
// the right shape.
void expect_possible_changes(const nlohmann::ordered_json& verdicts, std::uint64_t campaign);

// A sentence for each lane and stratum whose verdicts changed or may have changed, with the smallest case in each
// direction. The last sentence counts those beyond kMostChanged.   Requires: "compare" of a report.
inline constexpr std::size_t kMostChanged = 12;
std::vector<std::string> changed_sentences(const nlohmann::ordered_json& compare);

}  // namespace graze::reports
