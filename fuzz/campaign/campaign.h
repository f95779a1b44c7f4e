// SPDX-License-Identifier: Apache-2.0
// The campaign: every pair of every source through all lanes and the oracle; tallies, signatures and kept cases in
// a directory. The results are a function of the spec and the build alone: not of threads, batches or interruptions.
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
  const SelectedLanes* under_test = nullptr;  // the lanes, and what runs them
  int threads = 0;                            // 0: one on each core
  std::vector<std::unique_ptr<cuda::DeviceEngine>>
      engines;        // the devices' engines, which share it; none: the CPU engine
  DecideBlock exact;  // decides what is true for the CPU engine, confirmed by the oracle; null: the oracle does
  std::uint64_t engine_batch = std::uint64_t{1}
                               << 32;  // pairs of an engine in a transaction: a second or so on a device
  std::filesystem::path directory;
  std::filesystem::path scratch;  // where the store lives while it runs, where not in the directory; see scratch.h
  Shard shard;                    // what of it is run
  Json spec;                      // what makes this campaign another one; see campaign_spec
  Json build;
  // Where set, the batches to take, one after the other, from what several processes share; nothing at the end.
  std::function<std::optional<PairRange>()> take;
};

struct Progress {
  std::uint64_t done = 0, total = 0;                // pairs
  std::uint64_t done_here = 0;                      // by this process
  double seconds = 0;                               // of this process
  std::optional<double> seconds_left;               // by what the pairs of each source cost; see CostEstimate
  std::uint64_t disagreements = 0, signatures = 0;  // so far; disagreements by this process only
  std::uint64_t all_disagreements = 0;
  std::vector<std::uint64_t> disagreements_of_source;
};

// {"seed", "pairs", "strata", "lanes"}: recorded with the results and compared when a campaign goes on.
Json campaign_spec(const Campaign& campaign);

// Version, commit, compiler, type and flags of the build, toolkit, device, and for each CUDA lane what ran it.
Json build_info(const SelectedLanes& under_test);

// The processor's name and the architecture, for timings.
std::string machine_name();

// What judges the pairs. automatic: the devices where they can, which is where all lanes are theirs; else the CPU.
enum class EngineChoice { automatic, cpu, gpu };

// The engines that take the campaign; none for the CPU engine.
// Throws: UsageError when the GPU engine is asked for and cannot take it; std::runtime_error without a device.
std::vector<std::unique_ptr<cuda::DeviceEngine>> choose_engines(const Campaign& campaign, EngineChoice choice);

// What the campaign's store is of.
StoreSpec store_spec(const Campaign& campaign);

struct Outcome {
  bool complete;  // all that was to be done here is done
  Json summary;   // of a whole campaign; of a shard {"shard", "complete", "pairs", "disagreements", "signatures"}
  Json oracle;    // {"cgal", "gmp", "exact", "apart"}: pairs that each exact decision saw; depends on the engine
};

// Runs or goes on with the campaign until done or `stop`, then writes timings.json and, of a whole one, summary.json
// and cases/; status.json meanwhile. Throws: OracleMismatch, UsageError, std::runtime_error; committed batches stay in
// any case.
Outcome run_campaign(const Campaign& campaign, const std::atomic<bool>& stop,
                     const std::function<void(const Progress&)>& report);

}  // namespace graze::fuzz
