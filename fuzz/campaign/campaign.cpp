// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/campaign.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <tbb/info.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>

#include "analysis/over_threads.h"
#include "build_info.h"
#include "core/error.h"
#include "core/stop.h"
#include "fuzz/campaign/cpu_engine.h"
#include "fuzz/campaign/gpu_engine.h"
#include "fuzz/campaign/lane_costs.h"
#include "fuzz/campaign/rank_stores.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/campaign/scratch.h"
#include "fuzz/cost_estimate.h"

namespace graze::fuzz {
namespace {

constexpr std::uint64_t kBatchPairs = 65536;  // pairs per transaction of the CPU engine
// Batch limit for pairs that the cores draw for a device. The same limit applies to doubles, because a device leaves
// many pairs of doubles to the cores.
constexpr std::uint64_t kOfCores = std::uint64_t{1} << 25;

// Chooses the next batch from the source with the fewest pairs done, so that an interrupted campaign has covered all
// sources. A large source of unknown cost first gets a small batch, to estimate the remaining time early. If an earlier
// run judged some of this source's pairs, the small batch waits until this process has done a whole batch; otherwise a
// campaign that is interrupted again and again would never end.
std::optional<PairRange> next_batch(const Campaign& campaign, const Store& store,
                                    const std::vector<std::uint64_t>& done, const CostEstimate& costs,
                                    std::uint64_t done_here, int threads) {
  constexpr std::uint64_t kLarge = 8192;
  std::optional<std::size_t> next, unknown;
  for (std::size_t s = 0; s < done.size(); ++s) {
    const std::uint64_t pairs = share_of(campaign.shard, static_cast<int>(s), campaign.sources[s].pairs).pairs;
    if (done[s] >= pairs) continue;
    if (!next || done[s] < done[*next]) next = s;
    const bool measure = campaign.engines.empty() && pairs - done[s] >= kLarge && !costs.measured(s);
    if (measure && (done[s] == 0 || done_here >= kBatchPairs) && !unknown) unknown = s;
  }
  if (!next) return {};
  if (unknown) {
    const std::uint64_t few = std::uint64_t{256} * static_cast<unsigned>(threads);
    return store.missing(static_cast<int>(*unknown), std::min(few, kLarge / 4));
  }
  std::uint64_t most = campaign.engines.empty() ? kBatchPairs : campaign.engine_batch * campaign.engines.size();
  const strata::PairSource& source = campaign.sources[*next];
  if (source.stratum < 0 || source.in_doubles()) most = std::min(most, kOfCores);
  return store.missing(static_cast<int>(*next), most);
}

}  // namespace

std::string machine_name() {
  utsname system{};
  uname(&system);
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t value = line.find(": ");
    if (line.starts_with("model name") && value != line.npos)
      return fmt::format("{}, {}", line.substr(value + 2), system.machine);
  }
  return system.machine;
}

Json campaign_spec(const Campaign& campaign) {
  Json strata = Json::array(), lane_ids = Json::array();
  std::uint64_t pairs = 0;
  for (const strata::PairSource& source : campaign.sources) {
    strata.push_back(source.id);
    pairs += source.pairs;
  }
  for (const Lane* lane : campaign.under_test->lanes) lane_ids.push_back(lane->id);
  Json spec{{"seed", campaign.seed}, {"pairs", pairs}, {"strata", strata}, {"lanes", lane_ids}};
  add_left_out(spec, *campaign.under_test);
  return spec;
}

std::string commit_of_build() { return GRAZE_COMMIT; }

Json build_info(const SelectedLanes& under_test) {
  Json info = {{"version", GRAZE_VERSION}, {"commit", GRAZE_COMMIT}, {"compiler", GRAZE_COMPILER},
               {"type", GRAZE_BUILD_TYPE}, {"flags", GRAZE_FLAGS},   {"cuda", nullptr},
               {"device", nullptr}};
  if (*GRAZE_NVCC) info["cuda"] = std::string("nvcc ") + GRAZE_NVCC;
  if (under_test.device) info["device"] = under_test.device->name + ", driver " + under_test.device->driver;
  info["executors"] = Json::object();
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    if (const std::string by = under_test.evidence(l); !by.empty()) info["executors"][under_test.lanes[l]->id] = by;
  }
  return info;
}

StoreSpec store_spec(const Campaign& campaign) {
  StoreSpec spec{campaign.scratch.empty() ? campaign.directory : campaign.scratch,
                 campaign.spec,
                 campaign.build,
                 campaign.sources,
                 {},
                 campaign.shard};
  for (const Lane* lane : campaign.under_test->lanes) spec.lanes.push_back(lane->id);
  return spec;
}

std::vector<std::unique_ptr<cuda::DeviceEngine>> choose_engines(const Campaign& campaign, EngineChoice choice) {
  if (choice == EngineChoice::cpu || (choice == EngineChoice::automatic && !campaign.under_test->device)) return {};
  if (!campaign.under_test->device)
    throw std::runtime_error("--engine gpu needs a CUDA device, but there is none; use --engine cpu");
  std::string hindrance;
  for (std::size_t l = 0; l < campaign.under_test->lanes.size(); ++l) {
    if (!campaign.under_test->on_device(l) || campaign.under_test->on_both(l))
      hindrance = campaign.under_test->lanes[l]->id;
  }
  if (hindrance.empty()) return cuda::open_engines(campaign.under_test->lanes);
  if (choice == EngineChoice::automatic) return {};
  throw UsageError("--engine gpu runs every lane only on the device, but " + hindrance +
                   " runs elsewhere; choose other --lanes");
}

namespace {

Outcome run(const Campaign& campaign, const std::atomic<bool>& stop, RunStatus& status,
            const std::function<void(const Progress&)>& report) {
  const auto start = std::chrono::steady_clock::now();
  const int threads = campaign.threads > 0 ? campaign.threads : tbb::info::default_concurrency();
  const tbb::global_control limit = analysis::thread_limit(threads);

  Store store(store_spec(campaign));
  expect_usable_records(campaign.directory);
  take_in_ranks(campaign, store);
  Confirmation confirmation(campaign);
  const auto judged = [&](const PairRange& batch) {
    if (!campaign.engines.empty()) return judge_on_devices(campaign, batch, confirmation);
    BatchResult result = judge(
        campaign, batch.source, batch.pairs, [&](std::size_t i) { return batch.first + i; }, campaign.exact);
    if (campaign.exact) confirmation.confirm(batch.source, result);
    return result;
  };
  Progress progress;
  progress.disagreements_of_source.resize(campaign.sources.size());
  std::vector<std::uint64_t> done, left;
  for (const strata::PairSource& source : campaign.sources) {
    done.push_back(store.done(static_cast<int>(done.size())));
    const std::uint64_t share = share_of(campaign.shard, static_cast<int>(left.size()), source.pairs).pairs;
    left.push_back(share - done.back());
    progress.total += share;
    progress.done += done.back();
  }
  const auto tell = [&](bool last = false) {
    progress.signatures = store.signatures().size();
    progress.all_disagreements = store.disagreements();
    status.tell(progress, store.signatures(), last);
  };
  tell();
  CostEstimate costs(left);
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  while (!stop) {
    const std::optional<PairRange> batch =
        campaign.take ? campaign.take() : next_batch(campaign, store, done, costs, progress.done_here, threads);
    if (!batch) break;
    const double before = seconds();
    std::optional<BatchResult> judged_batch;
    try {
      judged_batch = judged(*batch);
    } catch (const Stopped&) {  // foreign code was interrupted; the next run repeats the batch
      break;
    }
    const BatchResult& result = *judged_batch;
    costs.add(static_cast<std::size_t>(batch->source), batch->pairs, seconds() - before);
    store.commit(*batch, result);
    done[static_cast<std::size_t>(batch->source)] += batch->pairs;
    progress.done += batch->pairs;
    progress.done_here += batch->pairs;
    progress.seconds = seconds();
    progress.seconds_left = costs.seconds_left();
    progress.disagreements += result.disagreements;
    progress.disagreements_of_source[static_cast<std::size_t>(batch->source)] += result.disagreements;
    tell();
    report(progress);
  }
  const bool complete = progress.done == progress.total;
  if (!complete) tell(true);
  Outcome outcome{complete, write_own_summary(campaign, store, complete, progress.done), store.oracle()};
  store.finish();
  Json run = {{"pairs", progress.done_here},
              {"seconds", seconds()},
              {"threads", threads},
              {"machine", machine_name()},
              {"engine", campaign.engines.empty() ? "cpu" : "gpu"}};
  try {
    if (complete && campaign.shard.number == 1) run["costs"] = measure_costs(campaign);  // one shard measures them
  } catch (const Stopped&) {                                                             // the costs are not recorded
  }
  append_timing(campaign.directory, run, outcome.oracle);
  return outcome;
}

}  // namespace

Outcome run_campaign(const Campaign& campaign, const std::atomic<bool>& stop,
                     const std::function<void(const Progress&)>& report) {
  RunStatus status(campaign);
  if (!campaign.scratch.empty()) fetch_from_directory(campaign);
  try {
    Outcome outcome = run(campaign, stop, status, report);
    if (!campaign.scratch.empty()) bring_to_directory(campaign);
    status.end(outcome.complete ? "done" : "stopped");
    if (outcome.complete) seal(campaign.directory);
    return outcome;
  } catch (const MovedStore&) {  // the folder's status file may belong to another run
    throw;
  } catch (const std::exception& error) {
    status.end("failed", error.what());
    throw;
  }
}

}  // namespace graze::fuzz
