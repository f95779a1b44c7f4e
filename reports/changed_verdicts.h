// SPDX-License-Identifier: Apache-2.0
// Describes which verdicts changed between two campaigns on the same pairs. comparison.h describes the rows.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

inline constexpr const char* kAllStrata = "all strata";  // the stratum of rates over all strata

// Returns the start of a comparison's headline, which counts the changed verdicts and their lanes.
std::string paired_headline(const nlohmann::ordered_json& verdicts);

// Throws: std::runtime_error for rows whose counts are impossible in a campaign of this many pairs.
// Requires: rows whose shape has been checked.
void expect_possible_changes(const nlohmann::ordered_json& verdicts, std::uint64_t campaign);

// Returns a sentence for each lane with changed verdicts, then one for each lane and stratum in which verdicts changed
// or may have changed. The latter names the smallest case that became wrong, and the smallest that became right. If
// there are more than kMostChanged such lanes and strata, the last sentence counts the rest.
// Requires: "compare" of a report.
inline constexpr std::size_t kMostChanged = 12;
std::vector<std::string> changed_sentences(const nlohmann::ordered_json& compare);

}  // namespace graze::reports
