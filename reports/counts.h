// SPDX-License-Identifier: Apache-2.0
// What summary.json counts, by stratum and over all of them: where a report's numbers come from.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/tally.h"
#include "core/lanes/lanes.h"

namespace graze::reports {

struct ReportLane {
  std::string id;
  LaneName name;
  const Lane* row = nullptr;  // in this build's table; null where it has no such lane
  bool exact = false;
  int cpu = -1;  // place of the cpu lane of the same algorithm and scalar, if that is another one
};

struct WrongCounts {
  std::uint64_t pairs = 0;
  std::vector<std::uint64_t> wrong;  // of each lane: verdicts that are not the truth's
};

struct StratumCounts {
  std::string id;
  std::uint64_t pairs = 0, intersects = 0;
  std::vector<analysis::LaneCounts> lanes;
  std::map<Bucket, WrongCounts> margins;
  std::map<std::string, std::map<int, WrongCounts>> extremes;  // by axis ("scale", "offset") and exponent

  std::uint64_t wrong(std::size_t lane) const { return lanes[lane].wrong(); }
};

// Strata that are asked after together (strata/groups.h).
struct GroupCounts {
  std::string id, describes;
  std::vector<std::size_t> strata;  // their places, of those that have pairs
  StratumCounts counts;             // of all of them; id empty
};

struct CampaignCounts {
  std::uint64_t seed = 0, pairs = 0;  // pairs as asked for
  bool complete = false;
  std::vector<ReportLane> lanes;
  std::vector<StratumCounts> strata;
  std::vector<GroupCounts> groups;  // those that have pairs
  StratumCounts total;              // id empty

  // Place of a lane; -1 for none. counterpart: of the same lane in another variant.
  int find(const LaneName& name) const;
  int counterpart(std::size_t lane, std::string_view variant) const;
  const StratumCounts* stratum(std::string_view id) const;
  const GroupCounts* group(std::string_view id) const;
  std::vector<std::size_t> drawn() const;  // places of the strata that have pairs
};

// Requires: what summary.json holds.   Throws: Json::exception otherwise.
CampaignCounts counts_of(const nlohmann::ordered_json& summary);

}  // namespace graze::reports
