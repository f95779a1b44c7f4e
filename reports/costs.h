// SPDX-License-Identifier: Apache-2.0
// Reads the costs of lanes from a campaign's timings.json (fuzz/campaign/lane_costs.h). The report has no costs,
// because it must not depend on the machine.
#pragma once

#include <optional>

#include "analysis/pareto.h"
#include "reports/counts.h"

namespace graze::reports {

// The cost of a lane, and the number of pairs that were timed.
struct Cost : analysis::Cost {
  std::uint64_t pairs = 0;
};

struct Costs {
  std::string machine;
  int passes = 0;
  std::vector<std::vector<std::optional<Cost>>> of_stratum;  // [lane][stratum]

  // The lane's mean cost over the strata, weighted by their pairs. Nothing unless the lane was timed on each stratum.
  std::optional<Cost> of(std::size_t lane, const std::vector<std::size_t>& strata) const;
};

// Returns nothing if the campaign has no lane timings.   runs: as fuzz::read_timings returns them.
// Throws: std::runtime_error for impossible costs; Json::exception for JSON of another shape.
std::optional<Costs> costs_of(const nlohmann::ordered_json& runs, const CampaignCounts& counts);

// The contents of costs.json: {"machine", "passes", "rows": [{"lane", "group", "pairs", "low", "middle", "high"}],
// "answer"}, as reports/web/src/report.ts describes it. A null group means all strata together. kinds: as for answer().
nlohmann::ordered_json to_json(const Costs& costs, const CampaignCounts& counts, const nlohmann::ordered_json& kinds);

}  // namespace graze::reports
