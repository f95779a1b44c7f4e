// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/plan.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "analysis/over_threads.h"
#include "analysis/sweep.h"
#include "fuzz/campaign/cpu_engine.h"
#include "fuzz/campaign/gpu_engine.h"
#include "fuzz/campaign/result_files.h"

namespace graze::fuzz {
namespace {

constexpr std::uint64_t kSample = 2048, kSampleOfDevice = std::uint64_t{1} << 22;
constexpr std::uint64_t kSampleOfDoubles = std::uint64_t{1} << 18;  // also on a device, because cores judge some
constexpr double kShardSeconds = 3600;    // an hour suits job schedulers; a killed shard can be resumed
constexpr double kRowPairs = 16777216;    // pairs per row of the CPU engine; see store.cpp
constexpr std::uint64_t kFewer = 8;       // an eighth of a sample is measured too, to find how the bytes grow
constexpr double kDatabaseBytes = 65536;  // without rows; includes the small files beside it

// Estimates the bytes for `pairs` pairs. The estimate tends to be too high, because new signatures become rarer.
double bytes_of(const Growing& growing, const Sample& sample, double pairs) {
  const double more = pairs / static_cast<double>(sample.pairs_of_row);
  return growing.bytes * std::pow(std::max(more, 1.0), growing.exponent);
}

Growing growing(double few, double bytes) {
  return {bytes, std::clamp(std::log(bytes / few) / std::log(kFewer), 0.0, 0.25)};
}

// The bytes of summary.json for the pairs of one source.
double summary_bytes(const StoreSpec& spec, const StoredCounts& counts) {
  const Json summary = summary_of(spec, {counts}, counts.signatures, counts.executor_mismatches, true);
  return static_cast<double>(summary["strata"].dump(1).size() + summary["signatures"].dump(1).size());
}

}  // namespace

Sample measure(const Campaign& campaign) {
  const tbb::global_control limit = analysis::thread_limit(1);
  Confirmation confirmation(campaign);
  Sample sample;
  const bool of_doubles = analysis::any_in_doubles(campaign.sources);
  sample.pairs_of_row = campaign.engines.empty() ? kSample : of_doubles ? kSampleOfDoubles : kSampleOfDevice;
  for (std::size_t s = 0; s < campaign.sources.size(); ++s) {
    const auto source = static_cast<int>(s);
    const auto judged = [&](std::uint64_t count) -> StoredCounts {
      sample.pairs += count;
      if (campaign.engines.empty()) return judge(campaign, source, count, [](std::size_t i) { return i; });
      return judge_on_devices(campaign, {source, 0, count}, confirmation);
    };
    const StoredCounts few = judged(sample.pairs_of_row / kFewer);
    const auto start = std::chrono::steady_clock::now();
    const StoredCounts all = judged(sample.pairs_of_row);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    sample.seconds_a_pair.push_back(seconds / static_cast<double>(sample.pairs_of_row));
    StoreSpec spec = store_spec(campaign);
    spec.sources = {spec.sources[s]};
    sample.row.push_back(growing(static_cast<double>(to_bytes(few).size()), static_cast<double>(to_bytes(all).size())));
    sample.summary.push_back(growing(summary_bytes(spec, few), summary_bytes(spec, all)));
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
    result.shard_bytes += std::ceil(part / of_row) * bytes_of(sample.row[s], sample, std::min(part, of_row));
    result.merged_bytes += bytes_of(sample.row[s], sample, here) + bytes_of(sample.summary[s], sample, here);
  }
  return result;
}

}  // namespace graze::fuzz
