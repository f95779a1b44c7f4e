// SPDX-License-Identifier: Apache-2.0
// `graze plan`: estimates the time and disk space of a campaign.
#include <fmt/format.h>

#include <iostream>

#include "backends/backends.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "core/error.h"
#include "fuzz/campaign/plan.h"
#include "reports/terminal.h"

namespace graze::cli {

using fuzz::Json;
namespace {

struct PlanOptions : DrawOptions {
  std::uint64_t gpus = 0, cores = 1;
  double rate = 0;
  LaneOptions lanes;
  bool json = false;
};

std::string time_of(double seconds) {
  if (seconds < 2 * 86400.0) return duration(seconds);
  if (seconds < 2 * 365.25 * 86400.0) return fmt::format("{:.1f} days", seconds / 86400);
  return fmt::format("{:.3g} years", seconds / (365.25 * 86400));
}

std::string size_of(double bytes) {
  for (const char* unit : {"B", "KiB", "MiB", "GiB"}) {
    if (bytes < 1000) return fmt::format("{:.3g} {}", bytes, unit);
    bytes /= 1024;
  }
  return fmt::format("{:.3g} TiB", bytes);
}

int plan(const PlanOptions& options) {
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes);
  if (options.coordinates != PairTypes::f32) take_doubles(under_test);
  fuzz::Campaign campaign;
  campaign.under_test = &under_test;
  Json scene;
  const strata::SceneSources from = drawn(options, &scene);
  campaign.sources = from.sources;
  campaign.spec = fuzz::campaign_spec(campaign);
  if (!scene.is_null()) campaign.spec["scene"] = scene;
  const bool gpu = options.gpus > 0;
  if (gpu) {
    for (const Lane* lane : under_test.lanes) {
      if (!backends::backend_of(*lane).has_device)
        throw UsageError("--gpus runs lanes only on GPUs, but " + lane->id +
                         " runs on cores; choose other --lanes, or give --cores");
    }
  }
  // If the rate is given, no device is needed; the size of the store's rows is then measured on the CPU.
  if (gpu && options.rate == 0) campaign.engines = fuzz::choose_engines(campaign, fuzz::EngineChoice::gpu);
  if (campaign.engines.size() > 1) campaign.engines.resize(1);
  const fuzz::Sample sample = fuzz::measure(campaign);
  fuzz::Workers given{gpu ? options.gpus : options.cores, gpu, {}};
  if (options.rate > 0) given.rate = options.rate;
  const std::uint64_t workers = given.count;
  const fuzz::Plan found = fuzz::plan(campaign, sample, given);
  if (options.json) {
    Json json = {{"pairs", found.pairs},
                 {gpu ? "gpus" : "cores", workers},
                 {"rate", found.rate},
                 {"measured", options.rate == 0},
                 {"seconds", found.seconds},
                 {"shards", found.shards},
                 {"shard_seconds", found.shard_seconds},
                 {"shard_bytes", found.shard_bytes},
                 {"merged_bytes", found.merged_bytes}};
    for (const strata::LeftOut& row : from.left_out)
      json["strata_left_out"].push_back({{"stratum", row.id}, {"why", row.why}});
    fuzz::add_left_out(json, under_test);
    std::cout << json.dump(1) << '\n';
    return 0;
  }
  const char* worker = gpu ? "GPU" : "core";
  std::cout << fmt::format(
      "{} pairs of {} strata through {} lanes\n"
      "rate    {} pairs/s on one {}, {}\n"
      "time    {} on {} {}{}\n"
      "shards  {} of {} each: --shard K/{}\n"
      "disk    about {} per shard, {} in total, {} merged, plus the cases\n",
      reports::grouped(found.pairs), campaign.sources.size(), under_test.lanes.size(),
      reports::grouped(static_cast<std::uint64_t>(found.rate)), worker,
      options.rate > 0 ? "as given" : fmt::format("measured here on {} pairs", reports::grouped(sample.pairs)),
      time_of(found.seconds), reports::grouped(workers), worker, workers == 1 ? "" : "s",
      reports::grouped(found.shards), time_of(found.shard_seconds), found.shards, size_of(found.shard_bytes),
      size_of(found.shard_bytes * static_cast<double>(found.shards)), size_of(found.merged_bytes));
  std::cout << left_out_text(from.left_out);
  return 0;
}

}  // namespace

void add_plan(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("plan", "Estimate the time and disk space of a campaign from a measurement on this machine");
  command->footer("Example: graze plan --pairs 1e10 --lanes '*/f32/cpu' --cores 64");
  auto options = std::make_shared<PlanOptions>();
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole, "Number of pairs in total");
  add_draw_options(*command, *options);
  add_lane_options(*command, options->lanes);
  CLI::Option* cores =
      add_count(*command, "--cores", options->cores, 1, 10'000'000, "Number of cores that run the campaign");
  add_valued(*command, "--gpus", options->gpus, "N",
             "Number of GPUs that run the campaign; the rate is measured on one GPU, or given by --rate")
      ->transform(whole_number(1, 10'000'000))
      ->excludes(cores);
  add_valued(*command, "--rate", options->rate, "PAIRS", "Pairs per second of one core or GPU; measured by default")
      ->check(number(1e-3, 1e15));
  command->add_flag("--json", options->json, "Print one JSON object");
  run_drawing(*command, options, status, plan);
}

}  // namespace graze::cli
