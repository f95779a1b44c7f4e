// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/plan.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "fuzz/campaign/cpu_engine.h"
#include "fuzz/campaign/gpu_engine.h"

namespace graze::fuzz {
namespace {

constexpr std::uint64_t kSample = 2048, kSampleOfDevice = std::uint64_t{1} << 22;
constexpr double kShardSeconds = 3600;    // an hour suits job schedulers; a shard that dies loses nothing
constexpr double kRowPairs = 16777216;    // of the CPU engine; see store.cpp
constexpr double kDatabaseBytes = 65536;  // without rows; includes the small files beside it

// Estimates the bytes of a row of `pairs` pairs. New signatures become rarer and rarer, so this is rather too high.
double row_bytes(const Sample& sample, std::size_t source, double pairs) {
  const double more = pairs / static_cast<double>(sample.pairs_of_row);
  return sample.row_bytes[source] * std::pow(std::max(more, 1.0), sample.row_growth[source]);
}

}  // namespace

Sample measure(const Campaign& campaign) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  GpuEngine device(campaign);
  Sample sample;
  sample.pairs_of_row = campaign.engines.empty() ? kSample : kSampleOfDevice;
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    const auto source = static_cast<int>(s);
    const auto judged = [&](std::uint64_t first, std::uint64_t count, double& seconds) {
      const auto start = std::chrono::steady_clock::now();
      const StoredCounts counts = campaign.engines.empty()
                                      ? judge(campaign, source, count, [&](std::size_t i) { return first + i; })
                                      : device.judge(source, first, count);
      seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      sample.pairs += count;
      return static_cast<double>(to_bytes(counts).size());
    };
    double seconds = 0, unused = 0;
    const double few = judged(0, sample.pairs_of_row / 8, unused);
    const double bytes = judged(0, sample.pairs_of_row, seconds);
    sample.seconds_a_pair.push_back(seconds / static_cast<double>(sample.pairs_of_row));
    sample.row_bytes.push_back(bytes);
    sample.row_growth.push_back(std::clamp(std::log(bytes / few) / std::log(8), 0.0, 0.25));
  }
  return sample;
}

Plan plan(const Campaign& campaign, const Sample& sample, const Workers& workers) {
  Plan result;
  double work = 0;
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    result.pairs += campaign.sources[s].pairs;
    work += sample.seconds_a_pair[s] * static_cast<double>(campaign.sources[s].pairs);
  }
  const auto pairs = static_cast<double>(result.pairs);
  if (workers.rate) work = pairs / *workers.rate;
  result.rate = pairs / work;
  result.seconds = work / static_cast<double>(workers.count);
  const double shards = std::max(static_cast<double>(workers.count), std::ceil(work / kShardSeconds));
  result.shards = std::min<std::uint64_t>(static_cast<std::uint64_t>(shards), kMostShards);
  result.shard_seconds = work / static_cast<double>(result.shards);
  const double of_row = workers.devices ? static_cast<double>(campaign.engine_batch) : kRowPairs;
  result.shard_bytes = result.merged_bytes = kDatabaseBytes;
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    const double here = static_cast<double>(campaign.sources[s].pairs),
                 part = here / static_cast<double>(result.shards);
    result.shard_bytes += std::ceil(part / of_row) * row_bytes(sample, s, std::min(part, of_row));
    result.merged_bytes += row_bytes(sample, s, here);
  }
  return result;
}

}  // namespace graze::fuzz
