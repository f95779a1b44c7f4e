// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/lane_costs.h"

#include <algorithm>
#include <array>
#include <chrono>

namespace graze::fuzz {
namespace {

using Passes = std::array<double, kPassesTimed>;

double nanoseconds_a_pair(DecideBlock decide, const std::vector<Pair>& pairs) {
  std::array<std::uint64_t, (kPairsTimed + 63) / 64> intersects, declined;
  const auto start = std::chrono::steady_clock::now();
  decide(pairs.data(), pairs.size(), intersects.data(), declined.data());
  const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - start;
  return taken.count() / static_cast<double>(pairs.size());
}

Json quartiles(Passes passes) {
  std::sort(passes.begin(), passes.end());
  const auto rounded = [](double value) { return static_cast<double>(static_cast<std::int64_t>(value * 10 + 0.5)) / 10; };
  return {{"low", rounded(passes[kPassesTimed / 4])},
          {"middle", rounded(passes[kPassesTimed / 2])},
          {"high", rounded(passes[kPassesTimed - 1 - kPassesTimed / 4])}};
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
  std::vector<std::vector<Passes>> taken(lanes.size(), std::vector<Passes>(blocks.size()));
  for (std::size_t pass = 0; pass < kPassesTimed; ++pass) {
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      for (std::size_t s = 0; s < blocks.size(); ++s) {
        if (!blocks[s].empty()) taken[l][s][pass] = nanoseconds_a_pair(lanes[l]->decide, blocks[s]);
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
