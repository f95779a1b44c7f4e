// SPDX-License-Identifier: Apache-2.0
#include "fuzz/ranks/rank_campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "core/error.h"
#include "fuzz/campaign/lane_costs.h"
#include "fuzz/campaign/rank_stores.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/sums.h"

namespace graze::fuzz {
namespace {

constexpr std::uint64_t kMostOnCpu = std::uint64_t{1} << 20;  // pairs per block of the CPU engine; a few seconds

// The root's plan for all ranks: {"build", "size", "gaps": [[source, first, pairs], …]} or {"error"}.
Json plan_of(const Campaign& campaign, const Store& store, int ranks) {
  Json gaps = Json::array();
  std::uint64_t left = 0;
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    for (const PairRange& gap : store.gaps(static_cast<int>(s))) {
      gaps.push_back({gap.source, gap.first, gap.pairs});
      left += gap.pairs;
    }
  }
  const std::uint64_t most = campaign.engines.empty() ? kMostOnCpu : campaign.engine_batch;
  return {{"build", campaign.build}, {"size", block_pairs(left, ranks, most)}, {"gaps", std::move(gaps)}};
}

}  // namespace

std::uint64_t block_pairs(std::uint64_t left, int ranks, std::uint64_t most) {
  constexpr std::uint64_t kLeast = 1024, kBlocksOfRank = 64;  // makes all ranks finish at nearly the same time
  return std::clamp(left / (kBlocksOfRank * static_cast<unsigned>(ranks)), kLeast, most);
}

Blocks::Blocks(std::vector<PairRange> ranges, std::uint64_t pairs) : ranges_(std::move(ranges)), pairs_(pairs) {
  std::uint64_t blocks = 0;
  for (const PairRange& range : ranges_) until_.push_back(blocks += (range.pairs + pairs_ - 1) / pairs_);
  stride_ = blocks * 2 / 5 + 1;
  while (std::gcd(stride_, blocks) != 1 && blocks > 0) ++stride_;
}

PairRange Blocks::at(std::uint64_t number) const {
  const auto place = static_cast<std::uint64_t>(static_cast<unsigned __int128>(number) * stride_ % count());
  const auto r = static_cast<std::size_t>(std::upper_bound(until_.begin(), until_.end(), place) - until_.begin());
  const PairRange& range = ranges_[r];
  const std::uint64_t skipped = (place - (r == 0 ? 0 : until_[r - 1])) * pairs_;
  return {range.source, range.first + skipped, std::min(pairs_, range.pairs - skipped)};
}

std::optional<Outcome> run_on_ranks(Campaign& campaign, Ranks& ranks, const std::atomic<bool>& stop) {
  const auto start = std::chrono::steady_clock::now();
  std::optional<Store> store;  // only on the root; holds the campaign's lock
  Json plan;
  if (ranks.rank == 0) {
    try {
      store.emplace(store_spec(campaign));
      expect_usable_records(campaign.directory);
      take_in_ranks(campaign, *store);
      plan = plan_of(campaign, *store, ranks.size);
    } catch (const std::exception& error) {
      ranks.from_root(Json{{"error", true}}.dump());
      throw;
    }
  }
  plan = Json::parse(ranks.from_root(plan.dump()));
  if (plan.contains("error")) return {};
  if (plan["build"] != campaign.build)
    throw std::runtime_error(fmt::format("rank {} has a different build or device from rank 0: {}; run shards instead",
                                         ranks.rank, first_difference(plan["build"], campaign.build)));
  std::vector<PairRange> gaps;
  for (const Json& gap : plan["gaps"]) gaps.push_back({gap[0], gap[1], gap[2]});
  const Blocks blocks(gaps, plan["size"]);

  const std::filesystem::path directory = campaign.directory;
  campaign.directory = rank_directory(directory, ranks.rank);
  campaign.take = [&]() -> std::optional<PairRange> {
    const std::uint64_t number = ranks.next();
    if (number >= blocks.count()) return {};
    return blocks.at(number);
  };
  run_campaign(campaign, stop, [](const Progress&) {});
  const StoreSpec own = store_spec(campaign);
  campaign.directory = directory;
  campaign.take = nullptr;
  if (!ranks.all(!stop)) return {};

  Sums sums(campaign.sources, static_cast<int>(campaign.under_test->lanes.size()));
  for_each_row(own, [&](const PairRange& range, const StoredCounts& counts) { sums.add(range, counts, 0); });
  ranks.reduce([&] { return sums.bytes(); }, [&](const std::string& bytes) { sums.add(bytes); });
  if (ranks.rank != 0) return {};
  for (std::size_t s = 0; s < campaign.sources.size(); ++s)
    store->complete(static_cast<int>(s), sums.of_source(static_cast<int>(s)));
  for (const std::filesystem::path& rank : rank_directories(campaign.directory)) remove_store(rank);
  Outcome outcome{true, write_summary(campaign, *store, true), store->oracle()};
  append_timing(campaign.directory,
                {{"pairs", std::accumulate(gaps.begin(), gaps.end(), std::uint64_t{0},
                                           [](std::uint64_t sum, const PairRange& gap) { return sum + gap.pairs; })},
                 {"seconds", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()},
                 {"ranks", ranks.size},
                 {"machine", machine_name()},
                 {"engine", campaign.engines.empty() ? "cpu" : "gpu"},
                 {"costs", measure_costs(campaign)}},
                outcome.oracle);
  return outcome;
}

}  // namespace graze::fuzz
