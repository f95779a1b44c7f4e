// SPDX-License-Identifier: Apache-2.0
// Compares two campaigns. Differences that chance alone explains are not reported.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace graze::reports {

// A rate counts as changed if chance makes so large a difference in fewer than one in a million comparisons. A kind of
// failure counts as gained or lost if one campaign has none of its signatures although at least kLeastSignatures were
// expected, which happens by chance about as rarely. If both campaigns ran on the same pairs, one signature is enough,
// provided that a verdict of the subject changed.
inline constexpr double kLeastChance = 1e-6;
inline constexpr double kLeastSignatures = 14;

// Adds `compare` to the second campaign's report: {"other": run, "headline", "differences": [sentence], "rates":
// [{"lane", "stratum", "before", "after", "changed", "errors"}], "gained", "lost": [{"key", "signatures", "count"}],
// "kinds_compared", "verdicts"}. Rates are matched by lane and stratum. `errors` lists the kinds of error whose own
// rate changed. On different pairs, each rate has `unseen`: a change smaller than this could be chance.
//
// If both campaigns ran on the same pairs, every different count is a change, and the headline is about `verdicts`.
// This list has a row for each lane and stratum: {"lane", "stratum", "pairs", "known": "same", "changed" or "unknown",
// "least", "most"}. "least" and "most" bound the number of changed verdicts. If the changes were counted, the row
// also has "broken" (the number that became wrong), "mended" (the number no longer wrong),
// "smallest_broken" and "smallest_mended".
//
// Kinds, and rates over all strata, are compared only if both campaigns have the same strata in the same shares. A
// subject's kinds are compared only if it has the same lanes in both campaigns.
// kinds, kinds_before: as `graze failures` lists them; null if unknown.   verdicts: null if unknown.
void add_comparison(nlohmann::ordered_json& report, const nlohmann::ordered_json& before,
                    const nlohmann::ordered_json& kinds, const nlohmann::ordered_json& kinds_before,
                    const nlohmann::ordered_json& verdicts = nullptr);

// Whether both campaigns are complete and ran on the same pairs. If so, a different count means a different verdict.
// False for hunts, because a hunt's pairs depend on the lanes.   Requires: two reports.
bool same_pairs(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after);

inline constexpr const char* kAllStrata = "all strata";  // the stratum of rates over all strata

// Returns the start of a comparison's headline: the number of changed verdicts and their lanes.
std::string paired_headline(const nlohmann::ordered_json& verdicts);

// Throws: std::runtime_error for rows whose counts are impossible in a campaign of this many pairs.
// Requires: rows whose shape has been checked.
void expect_possible_changes(const nlohmann::ordered_json& verdicts, std::uint64_t campaign);

// Returns a sentence for each lane with changed verdicts, then one for each lane and stratum with verdicts that changed
// or may have changed. The latter sentences name the smallest case that became wrong, and the smallest that is no
// longer wrong. If there are more than kMostChanged such lanes and strata, the last sentence gives the number of the
// others. Requires: "compare" of a report.
inline constexpr std::size_t kMostChanged = 12;
std::vector<std::string> changed_sentences(const nlohmann::ordered_json& compare);

}  // namespace graze::reports
