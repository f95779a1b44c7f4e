// SPDX-License-Identifier: Apache-2.0
// The counts of summary.json, by stratum and in total. A report's rates, margins and findings are derived from them.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/tally.h"
#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::reports {

struct ReportLane {
  std::string id;
  LaneName name;
  const Lane* row = nullptr;  // the lane in this build's table; null if it has no such lane
  bool exact = false;
  std::optional<std::size_t> cpu = {};  // index of the cpu lane of the same algorithm and scalar; none for that lane
};

struct WrongCounts {
  std::uint64_t pairs = 0;
  std::vector<std::uint64_t> wrong, differs_from_cpu;  // by lane: wrong verdicts; verdicts that differ from cpu's
};

struct StratumCounts {
  std::string id;
  std::uint64_t pairs = 0, intersects = 0;
  std::vector<analysis::LaneCounts> lanes;
  std::map<Bucket, WrongCounts> margins;
  std::map<std::string, std::map<int, WrongCounts>>
      extremes;  // by kind ("scale", "offset", "scale/f64", …) and exponent

  std::uint64_t wrong(std::size_t lane) const { return lanes[lane].wrong(); }
  bool in_doubles() const { return strata::stratum_in_doubles(id).has_value(); }
};

// Strata that are reported together (strata/groups.h).
struct GroupCounts {
  std::string id, describes;
  std::vector<std::size_t> strata;  // indices of the group's strata that have pairs
  StratumCounts counts;             // sum over the strata; id empty
};

struct CampaignCounts {
  std::uint64_t seed = 0, pairs = 0;  // pairs as requested
  bool complete = false;
  std::vector<ReportLane> lanes;
  std::vector<StratumCounts> strata;
  std::vector<GroupCounts> groups;  // groups that have pairs
  StratumCounts total;              // id empty

  // Both return the lane's index, or nothing if it did not run. counterpart: the lane that differs only in variant.
  std::optional<std::size_t> find(const LaneName& name) const;
  std::optional<std::size_t> counterpart(std::size_t lane, std::string_view variant) const;
  const StratumCounts* stratum(std::string_view id) const;
  const GroupCounts* group(std::string_view id) const;
  std::vector<std::size_t> drawn() const;  // indices of the strata that have pairs
};

// All margin buckets by their names in summary.json.
const std::map<std::string, Bucket>& buckets_by_name();

// Requires: the contents of summary.json.   Throws: Json::exception otherwise.
CampaignCounts counts_of(const nlohmann::ordered_json& summary);

// The description of drawn pairs, for a campaign with this spec. A scene changes the pairs of every stratum.
std::string described(std::string_view drawn, bool in_doubles, const nlohmann::ordered_json& spec);

}  // namespace graze::reports
