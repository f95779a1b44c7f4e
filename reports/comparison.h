// SPDX-License-Identifier: Apache-2.0
// What has changed between two campaigns, beyond what another seed or size changes by chance.
#pragma once

#include <nlohmann/json.hpp>

namespace graze::reports {

// A rate has changed when a difference as large comes about by chance in less than one of a million comparisons. A kind
// of failure has come or gone when one campaign has none of it where at least kLeastSignatures of its signatures were
// to be expected; that is as rare.
inline constexpr double kLeastChance = 1e-6;
inline constexpr double kLeastSignatures = 14;

// Fills `compare` of the second campaign's report: {"other": run, "headline", "differences": [sentence], "rates",
// "gained", "lost": [{"key", "signatures", "count"}], "kinds_compared"}. Rates are compared by the names of lane and
// stratum; kinds as `graze failures` has them, null where they are not known.
void add_comparison(nlohmann::ordered_json& report, const nlohmann::ordered_json& before,
                    const nlohmann::ordered_json& kinds, const nlohmann::ordered_json& kinds_before);

}  // namespace graze::reports
