// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/lane_costs.h"

#include <algorithm>
#include <utility>

#include "analysis/trade.h"

namespace graze::fuzz {
namespace {

Json quartiles(std::vector<double> passes) {
  const analysis::Cost cost = analysis::quartiles(std::move(passes));
  const auto rounded = [](double value) {
    return static_cast<double>(static_cast<std::int64_t>(value * 10 + 0.5)) / 10;
  };
  return {{"low", rounded(cost.low)}, {"middle", rounded(cost.middle)}, {"high", rounded(cost.high)}};
}

}  // namespace

Json measure_costs(const Campaign& campaign) {
  std::vector<std::vector<Pair>> blocks;
  for (const strata::PairSource& source : campaign.sources) {
    std::vector<Pair>& block = blocks.emplace_back();
    for (std::uint64_t i = 0; i < std::min(source.pairs, kPairsTimed); ++i) block.push_back(source.pair(i));
  }
  std::vector<const Lane*> lanes;
  for (const Lane* lane : campaign.under_test->lanes) {
    if (lane->decide && !lane->foreign && runs_on_this_cpu(*lane)) lanes.push_back(lane);
  }
  std::vector<std::vector<std::vector<double>>> taken(lanes.size(), std::vector<std::vector<double>>(blocks.size()));
  for (int pass = 0; pass < kPassesTimed; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      for (std::size_t s = 0; s < blocks.size(); ++s) {
        if (!blocks[s].empty()) taken[l][s].push_back(analysis::nanoseconds_a_pair(lanes[l]->decide, blocks[s]));
      }
    }
  }
  Json rows = Json::object();
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    for (std::size_t s = 0; s < blocks.size(); ++s) {
      if (blocks[s].empty()) continue;
      Json& row = rows[lanes[l]->id][campaign.sources[s].id] = {{"pairs", blocks[s].size()}};
      row.update(quartiles(taken[l][s]));
    }
  }
  return {{"passes", kPassesTimed}, {"lanes", std::move(rows)}};
}

}  // namespace graze::fuzz
