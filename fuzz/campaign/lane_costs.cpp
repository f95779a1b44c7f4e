// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/lane_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "analysis/pareto.h"
#include "core/text.h"

namespace graze::fuzz {
namespace {

Json quartiles(std::vector<double> passes) {
  const analysis::Cost cost = analysis::quartiles(std::move(passes));
  const auto rounded = [](double value) {
    return static_cast<double>(static_cast<std::int64_t>(value * 10 + 0.5)) / 10;
  };
  return {{"low", rounded(cost.low)}, {"middle", rounded(cost.middle)}, {"high", rounded(cost.high)}};
}

constexpr std::uint64_t kMostPasses = 1'000'000;
constexpr double kLeastCost = 1e-6, kMostCost = 1e15;  // nanoseconds for a pair; 1e15 ns are eleven days

}  // namespace

Json measure_costs(const Campaign& campaign) {
  std::vector<strata::PairBlock> blocks;
  for (const strata::PairSource& source : campaign.sources)
    blocks.push_back(strata::pairs_of(source, 0, std::min(source.pairs, kPairsTimed)));
  std::vector<const Lane*> lanes;
  for (const Lane* lane : campaign.under_test->lanes) {
    if (lane->decide && !lane->foreign && runs_on_this_cpu(*lane)) lanes.push_back(lane);
  }
  std::vector<std::vector<std::vector<double>>> taken(lanes.size(), std::vector<std::vector<double>>(blocks.size()));
  for (int pass = 0; pass < kPassesTimed; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      for (std::size_t s = 0; s < blocks.size(); ++s) {
        if (blocks[s].size() > 0) taken[l][s].push_back(analysis::nanoseconds_a_pair(lanes[l]->decide, blocks[s]));
      }
    }
  }
  Json rows = Json::object();
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    for (std::size_t s = 0; s < blocks.size(); ++s) {
      if (blocks[s].size() == 0) continue;
      Json& row = rows[lanes[l]->id][campaign.sources[s].id] = {{"pairs", blocks[s].size()}};
      row.update(quartiles(taken[l][s]));
    }
  }
  return {{"passes", kPassesTimed}, {"lanes", std::move(rows)}};
}

void expect_possible_costs(const Json& costs, const std::vector<std::string>& lanes,
                           const std::map<std::string, std::uint64_t>& sources) {
  const auto refuse_name = [](const std::string& name, const char* what) {
    throw std::runtime_error(fmt::format("it has costs for {}, but the campaign has no such {}", shown(name), what));
  };
  const auto is_one_to = [](const Json& count, std::uint64_t limit) {
    return count.is_number_integer() && count >= 1 && count <= limit;
  };
  if (!is_one_to(costs.at("passes"), kMostPasses))
    throw std::runtime_error("its costs have an invalid number of passes");
  for (const auto& [lane, rows] : costs.at("lanes").get_ref<const Json::object_t&>()) {
    if (std::find(lanes.begin(), lanes.end(), lane) == lanes.end()) refuse_name(lane, "lane");
    for (const auto& [source, row] : rows.get_ref<const Json::object_t&>()) {
      const auto found = sources.find(source);
      if (found == sources.end()) refuse_name(source, "stratum");
      const std::uint64_t most = std::min(kPairsTimed, found->second);
      const double low = row.at("low").get<double>(), middle = row.at("middle").get<double>(),
                   high = row.at("high").get<double>();
      if (!is_one_to(row.at("pairs"), most) ||
          !(kLeastCost <= low && low <= middle && middle <= high && high <= kMostCost))
        throw std::runtime_error(fmt::format("it has impossible costs of {} on {} (at most {} pairs): {}", lane, source,
                                             most, shown(row.dump())));
    }
  }
}

void expect_possible_run(const Json& run, const std::vector<std::string>& lanes,
                         const std::map<std::string, std::uint64_t>& sources, std::uint64_t pairs) {
  if (run.contains("pairs")) {
    // If a database was damaged, the parts of a merged campaign may have judged some pairs twice.
    const Json& judged = run["pairs"];
    if (!judged.is_number_integer() || judged < 0 || (judged > pairs && !run.contains("merged")))
      throw std::runtime_error(
          fmt::format("it has a run of {} pairs, but the campaign has {}", shown(judged.dump()), pairs));
  }
  if (run.contains("seconds") && !(run["seconds"].is_number() && run["seconds"] >= 0))
    throw std::runtime_error(fmt::format("it has a run of {} seconds", shown(run["seconds"].dump())));
  if (run.contains("costs")) expect_possible_costs(run["costs"], lanes, sources);
}

}  // namespace graze::fuzz
