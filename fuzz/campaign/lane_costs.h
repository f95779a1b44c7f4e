// SPDX-License-Identifier: Apache-2.0
// A lane's cost on the campaign's own pairs, in nanoseconds per pair on one core. Costs depend on the machine and its
// load, so they are stored in timings.json.
#pragma once

#include <map>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

inline constexpr std::uint64_t kPairsTimed = 1024;  // the first pairs of each source
inline constexpr int kPassesTimed = 9;

// Times the host lanes. Device lanes and their twins are not timed, and neither is foreign code, because its time would
// include its processes. In each of the kPassesTimed passes, the lanes run one after another, each over all pairs.
// Thus, other load on the machine affects all lanes alike, and no lane benefits from a trained branch predictor.
// Returns: {"passes", "lanes": {lane: {source: {"pairs", "low", "middle", "high"}}}}, with the quartiles of the passes.
Json measure_costs(const Campaign& campaign);

// Checks costs from a file: lanes and sources (by id, with their pairs) must be the campaign's, and times must be
// possible.
// Throws: std::runtime_error that describes the error; Json::exception if keys or types are wrong.
void expect_possible_costs(const Json& costs, const std::vector<std::string>& lanes,
                           const std::map<std::string, std::uint64_t>& sources);

// Checks a run in timings.json, with its costs if it has any. pairs: the pairs of the campaign or part that ran.
// Throws: the errors of expect_possible_costs.
void expect_possible_run(const Json& run, const std::vector<std::string>& lanes,
                         const std::map<std::string, std::uint64_t>& sources, std::uint64_t pairs);

}  // namespace graze::fuzz
