// SPDX-License-Identifier: Apache-2.0
// What a lane costs on a campaign's own pairs, in nanoseconds a pair on one core: for timings.json, since it depends on
// the machine and on the moment.
#pragma once

#include <map>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

inline constexpr std::uint64_t kPairsTimed = 1024;  // of each source, its first ones
inline constexpr int kPassesTimed = 9;

// Times the lanes of the host; those of a device and their twins have no cost here, nor has foreign code, whose time
// would be that of its processes. All lanes take turns on all pairs,
// so many passes over: what else the machine does then falls on all of them, and no lane finds its branches remembered.
// Returns: {"passes", "lanes": {lane: {source: {"pairs", "low", "middle", "high"}}}}, of the passes the quartiles.
Json measure_costs(const Campaign& campaign);

// Of costs that a file holds: lanes and sources (id, pairs) are those of the campaign, and times can be.
// Throws: std::runtime_error that says what is wrong; Json::exception for another shape.
void expect_possible_costs(const Json& costs, const std::vector<std::string>& lanes,
                           const std::map<std::string, std::uint64_t>& sources);

// The same of one of the runs in timings.json, with its costs if it has any. pairs: of the whole campaign.
void expect_possible_run(const Json& run, const std::vector<std::string>& lanes,
                         const std::map<std::string, std::uint64_t>& sources, std::uint64_t pairs);

}  // namespace graze::fuzz
