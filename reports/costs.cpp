// SPDX-License-Identifier: Apache-2.0
#include "reports/costs.h"

#include <fmt/format.h>

#include "core/text.h"
#include "fuzz/campaign/lane_costs.h"
#include "reports/cost_words.h"
#include "reports/findings.h"
#include "reports/terminal.h"

namespace graze::reports {

using Json = nlohmann::ordered_json;

std::optional<Cost> Costs::of(std::size_t lane, const std::vector<std::size_t>& strata) const {
  Cost sum;
  for (const std::size_t s : strata) {
    const std::optional<Cost>& one = of_stratum[lane][s];
    if (!one) return std::nullopt;
    const auto pairs = static_cast<double>(one->pairs);
    sum = {{sum.low + pairs * one->low, sum.middle + pairs * one->middle, sum.high + pairs * one->high},
           sum.pairs + one->pairs};
  }
  if (sum.pairs == 0) return std::nullopt;
  const auto pairs = static_cast<double>(sum.pairs);
  return Cost{{sum.low / pairs, sum.middle / pairs, sum.high / pairs}, sum.pairs};
}

std::optional<Costs> costs_of(const Json& runs, const CampaignCounts& counts) {
  std::optional<Costs> costs;
  std::vector<std::string> lanes;
  std::map<std::string, std::uint64_t> sources;
  for (const ReportLane& lane : counts.lanes) lanes.push_back(lane.id);
  // An unfinished campaign may have timed pairs that are not judged yet.
  for (const StratumCounts& stratum : counts.strata)
    sources[stratum.id] = counts.complete ? stratum.pairs : counts.pairs;
  for (const Json& run : runs) {
    fuzz::expect_possible_run(run, lanes, sources, counts.pairs);
    if (!run.contains("costs")) continue;
    const Json& found = run["costs"];
    costs = Costs{run.value("machine", "an unknown machine"), found.at("passes"), {}};
    for (const ReportLane& lane : counts.lanes) {
      auto& row = costs->of_stratum.emplace_back(counts.strata.size());
      const Json strata = found.at("lanes").value(lane.id, Json::object());
      for (std::size_t s = 0; s < counts.strata.size(); ++s) {
        if (!strata.contains(counts.strata[s].id)) continue;
        const Json& cost = strata[counts.strata[s].id];
        row[s] = Cost{{cost.at("low"), cost.at("middle"), cost.at("high")}, cost.at("pairs")};
      }
    }
  }
  return costs;
}

Json to_json(const Costs& costs, const CampaignCounts& counts, const Json& kinds) {
  const auto rounded = [](double value) { return *parse_float64(fmt::format("{:.4g}", value)); };
  Json rows = Json::array();
  const auto add = [&](std::size_t l, const Json& group, const std::vector<std::size_t>& strata) {
    if (const std::optional<Cost> cost = costs.of(l, strata)) {
      rows.push_back({{"lane", l},
                      {"group", group},
                      {"pairs", cost->pairs},
                      {"low", rounded(cost->low)},
                      {"middle", rounded(cost->middle)},
                      {"high", rounded(cost->high)}});
    }
  };
  for (std::size_t l = 0; l < counts.lanes.size(); ++l) {
    add(l, nullptr, counts.drawn());
    for (std::size_t g = 0; g < counts.groups.size(); ++g) add(l, g, counts.groups[g].strata);
  }
  Json said = answer(counts, &costs, kinds);
  said.push_back(costs_sentence(analysis::Calls::of_blocks,
                                fmt::format("the first {} pairs of each stratum", grouped(fuzz::kPairsTimed)),
                                costs.machine, costs.passes));
  return {{"machine", costs.machine}, {"passes", costs.passes}, {"rows", rows}, {"answer", said}};
}

}  // namespace graze::reports
