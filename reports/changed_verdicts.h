// SPDX-License-Identifier: Apache-2.0
// Which verdicts changed between two campaigns on the same pairs, in words. The rows are those of add_comparison.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

inline constexpr const char* kAllStrata = "all strata";  // the stratum of rates over all of them

// The headline of a comparison, without its end: whether verdicts changed, how many and of how many lanes.
std::string paired_headline(const nlohmann::ordered_json& verdicts);

// Throws: std::runtime_error for rows with counts that cannot be in a campaign of so many pairs.   Requires: their
// shape.
void expect_possible_changes(const nlohmann::ordered_json& verdicts, std::uint64_t campaign);

// A sentence for each lane and stratum whose verdicts changed, or may have, with the smallest case of each direction.
// The last one counts those beyond kMostChanged.   Requires: "compare" of a report.
inline constexpr std::size_t kMostChanged = 12;
std::vector<std::string> changed_sentences(const nlohmann::ordered_json& compare);

}  // namespace graze::reports
