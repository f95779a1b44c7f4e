// SPDX-License-Identifier: Apache-2.0
// Reports how two campaigns differ, beyond the differences that chance makes between seeds or sizes.
#pragma once

#include <nlohmann/json.hpp>

namespace graze::reports {

// A rate counts as changed if so large a difference arises by chance in less than one in a million comparisons. A kind
// of failure counts as gained or lost if one campaign has none of it, although at least kLeastSignatures of its
// signatures were expected there: chance makes it absent about as rarely. On the same pairs one signature is enough, if
// some verdict of the subject changed.
inline constexpr double kLeastChance = 1e-6;
inline constexpr double kLeastSignatures = 14;

// Adds `compare` to the second campaign's report: {"other": run, "headline", "differences": [sentence], "rates":
// [{"lane", "stratum", "before", "after", "changed", "errors"}], "gained", "lost": [{"key", "signatures", "count"}],
// "kinds_compared", "verdicts"}. Rates are matched by lane and stratum; `errors` are the kinds of error whose own rate
// changed. If both campaigns ran on the same pairs, any different count is a change, and the headline is about
// `verdicts`: a row for each lane and stratum, {"lane", "stratum", "pairs", "known": "same", "changed" or "unknown",
// "least", "most"} (bounds of the number of changed verdicts). Where changes were counted, a row also has "broken" (the
// number that became wrong), "mended", "smallest_broken" and "smallest_mended". On different pairs each rate has
// `unseen`, the difference below which a change could pass for chance. Rates of all strata together, and kinds, are
// compared only if both campaigns have the same strata in the same shares, and kinds only of subjects that have the
// same lanes in both. Kinds are those of `graze failures`, or null if unknown; `verdicts` is null if unknown.
void add_comparison(nlohmann::ordered_json& report, const nlohmann::ordered_json& before,
                    const nlohmann::ordered_json& kinds, const nlohmann::ordered_json& kinds_before,
                    const nlohmann::ordered_json& verdicts = nullptr);

// Whether two complete campaigns ran on the same pairs, so that a different count means a different verdict. False for
// hunts, whose pairs depend on the lanes.   Requires: two reports.
bool same_pairs(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after);

}  // namespace graze::reports
