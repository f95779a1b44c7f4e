// SPDX-License-Identifier: Apache-2.0
// Runs a campaign: every pair of every source through all lanes and the oracle. Writes tallies, signatures and kept
// cases to a directory. The results depend only on the spec and the build, not on threads, batches or interruptions.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cuda/engine/engine.h"
#include "fuzz/campaign/store.h"
#include "fuzz/selected_lanes.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

struct Campaign {
  std::uint64_t seed = 1;
  std::vector<strata::PairSource> sources;
  const SelectedLanes* under_test = nullptr;  // the lanes and their executors
  int threads = 0;                            // 0: one for each core
  std::vector<std::unique_ptr<cuda::DeviceEngine>>
      engines;        // one for each device; they share the work; empty: the CPU engine
  DecideBlock exact;  // decides the truth for the CPU engine, confirmed by the oracle; null: the oracle decides
  std::uint64_t engine_batch = std::uint64_t{1} << 32;  // pairs per engine and transaction: about a second on a device
  std::filesystem::path directory;
  std::filesystem::path scratch;  // folder of the store during the run, if not `directory`; see scratch.h
  Shard shard;                    // the part of the campaign to run
  Json spec;                      // identifies the campaign; see campaign_spec
  Json build;
  // If set, returns the next batch from a pool that several processes share, or nothing once the pool is empty.
  std::function<std::optional<PairRange>()> take;
};

struct Progress {
  std::uint64_t done = 0, total = 0;                // pairs
  std::uint64_t done_here = 0;                      // pairs done by this process
  double seconds = 0;                               // of this process
  std::optional<double> seconds_left;               // estimated from the cost of each source's pairs; see CostEstimate
  std::uint64_t disagreements = 0, signatures = 0;  // so far; disagreements only by this process
  std::uint64_t all_disagreements = 0;
  std::vector<std::uint64_t> disagreements_of_source;
};

// {"seed", "pairs", "strata", "lanes"}: recorded with the results, and compared when the campaign resumes.
Json campaign_spec(const Campaign& campaign);

// The commit of this build's sources, with "-dirty" if they were changed, or "unknown".
std::string commit_of_build();

// The build's version, commit, compiler, type and flags, the CUDA toolkit, the device, and each CUDA lane's executor.
Json build_info(const SelectedLanes& under_test);

// The processor's name and the architecture, for timings.
std::string machine_name();

// The engine that judges the pairs. automatic: gpu if all lanes run only on devices, otherwise cpu.
enum class EngineChoice { automatic, cpu, gpu };

// Returns the engines that run the campaign; an empty list means the CPU engine.
// Throws: UsageError if the GPU engine is requested but cannot run the campaign; std::runtime_error without a device.
std::vector<std::unique_ptr<cuda::DeviceEngine>> choose_engines(const Campaign& campaign, EngineChoice choice);

StoreSpec store_spec(const Campaign& campaign);

struct Outcome {
  bool complete;  // whether all of this run's work is done
  Json summary;   // for a shard: {"shard", "complete", "pairs", "disagreements", "signatures"}
  Json oracle;    // {"cgal", "gmp", "exact", "apart"}: pairs that each exact decision judged; depends on the engine
};

// Runs or resumes the campaign until it is done or `stop` is set. Updates status.json as it runs. At the end it writes
// timings.json and, for a whole campaign, summary.json and cases/.
// Throws: OracleMismatch, UsageError, std::runtime_error. After an error, committed batches are kept.
Outcome run_campaign(const Campaign& campaign, const std::atomic<bool>& stop,
                     const std::function<void(const Progress&)>& report);

}  // namespace graze::fuzz
