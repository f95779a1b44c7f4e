// SPDX-License-Identifier: Apache-2.0
// `graze pareto`: measures each lane's errors and cost, and how extreme pairs may become before it fails.
#include <fmt/format.h>

#include "analysis/pareto.h"
#include "backends/backends.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/text.h"
#include "cuda/lanes/device.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/files.h"
#include "fuzz/minimise/minimise.h"
#include "fuzz/sealed.h"
#include "reports/pareto.h"
#include "reports/recorded_code.h"
#include "subjects/subjects.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

// Enough pairs that a processor cannot learn which branches they take; it can with 256 pairs.
constexpr std::size_t kPairsInCache = 4096, kPairsFromMemory = std::size_t{1} << 19;  // 295 kB, 38 MB
// With 95 % confidence, a lane that is wrong on none of these pairs errs on at most 0.1 %.
constexpr std::uint64_t kFewestAtAnExtreme = 4000;
constexpr std::size_t kPairsOnDevice = std::size_t{1} << 22;  // 302 MB

struct ParetoOptions : DrawOptions {
  ParetoOptions() : DrawOptions{200'000} {}
  LaneOptions lanes;
  std::string out = "pareto";
  bool device = false;
};

// Returns why the lane is left out; empty if it is kept. A twin's time is not that of the CUDA code. A user's code is
// kept even if it cannot be timed.
std::string why_left_out(const Lane& lane, bool device) {
  if (!device) return lane.foreign ? "" : analysis::why_not_timed(lane);
  return backends::backend_of(lane).has_device ? "" : "--device times only CUDA lanes of published algorithms";
}

// Returns the function that counts the errors of lanes, given their names.
analysis::Sweep sweep_of(const ParetoOptions& options) {
  const Lane* exact = find_lane(options.device                          ? "exact/f32/cuda"
                                : options.coordinates == PairTypes::f32 ? fuzz::kExactLane
                                                                        : fuzz::kExactDoubles);
  const auto lane_of = [exact](const std::string& id) { return id.empty() ? exact : find_lane(id); };
  if (options.device) return analysis::device_sweep([=](const std::string& id) { return *lane_of(id); });
  return analysis::host_sweep([=](const std::string& id) { return analysis::decider_of(*lane_of(id)); });
}

// Minimises the first pair on which the lane is wrong; without a twin, returns that pair itself.
std::optional<AnyPair> smallest_failure(const Lane& lane, const analysis::PolicyErrors& errors,
                                        const std::vector<strata::PairSource>& sources) {
  if (!errors.first_broken) return std::nullopt;
  const AnyPair pair =
      sources[static_cast<std::size_t>(errors.first_broken->source)].any_pair(errors.first_broken->index);
  if (!backends::on_host(lane)) return pair;
  const auto failures = fuzz::failures_of(fuzz::select_lanes({lane.id}, fuzz::Executor::twin), pair);
  if (failures.empty()) return std::nullopt;
  return fuzz::minimise(failures[0], pair).pair;
}

// all: the errors of each lane on the sources.
analysis::Pareto offers_of(const ParetoOptions& options, const std::vector<const Lane*>& lanes,
                           const std::vector<analysis::PolicyErrors>& all,
                           const std::vector<strata::PairSource>& sources) {
  analysis::Pareto pareto{fuzz::machine_name(), options.device, 0, {}, {}};
  for (const analysis::PolicyErrors& errors : all) {
    pareto.offers.push_back({errors.policy, errors});
    pareto.offers.back().failure = smallest_failure(*lanes[pareto.offers.size() - 1], errors, sources);
  }
  if (options.device) {
    const cuda::DeviceCosts costs = cuda::measure_on_device(lanes, analysis::first_pairs(sources, kPairsOnDevice), 21);
    pareto.machine = costs.device;
    pareto.threads_at_once = costs.threads_at_once;
    for (std::size_t l = 0; l < costs.of.size(); ++l) {
      pareto.offers[l].near = analysis::quartiles(costs.of[l].resident);
      pareto.offers[l].far = analysis::quartiles(costs.of[l].with_copies);
      pareto.offers[l].needs = costs.of[l].needs;
    }
  } else {
    const auto costs = [&](std::size_t pairs, int passes, analysis::Calls calls = analysis::Calls::of_blocks) {
      return analysis::costs_of(lanes, analysis::first_pairs(sources, pairs), passes, calls);
    };
    const auto in_cache = costs(kPairsInCache, 201), from_memory = costs(kPairsFromMemory, 3),
               alone = costs(kPairsInCache, 201, analysis::Calls::of_one);
    for (std::size_t l = 0; l < lanes.size(); ++l) {
      analysis::Offer& offer = pareto.offers[l];
      offer.why_not_timed = analysis::why_not_timed(*lanes[l]);
      if (offer.why_not_timed.empty() && !(in_cache[l] && from_memory[l]))
        offer.why_not_timed = "it failed on some of the pairs";
      if (!offer.why_not_timed.empty()) continue;
      offer.near = in_cache[l];
      offer.far = from_memory[l];
      offer.alone = alone[l];
    }
  }
  analysis::mark_dominated(pareto.offers);
  return pareto;
}

int pareto(ParetoOptions options) {
  if (options.lanes.globs.empty() && options.device) {
    options.lanes.globs = {"*/cuda-fma", "exact/f32/cuda", "moller_1997/*/cuda-fma/paper",
                           "guigue_devillers_2003/*/cuda-fma/filtered"};
  } else if (options.lanes.globs.empty()) {
    options.lanes.globs = with_subjects(
        {"*/cpu", "exact/f32/cpu", "moller_1997/*/cpu/paper", "guigue_devillers_2003/*/cpu/filtered"}, options.lanes);
  }
  options.lanes.executor = options.device ? fuzz::Executor::device : fuzz::Executor::twin;
  if (std::string why_not; options.device && !cuda::open_device(why_not))
    throw std::runtime_error("--device needs a CUDA device: " + why_not);
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes);
  if (options.coordinates != PairTypes::f32) take_doubles(under_test);
  say_left_out(leave_out(under_test, [&](const Lane& lane) { return why_left_out(lane, options.device); }));
  std::vector<std::string> ids;
  for (const Lane* lane : under_test.lanes) ids.push_back(lane->id);
  const analysis::Sweep sweep = sweep_of(options);
  const strata::SceneSources all = drawn(options);
  const ResultFolder folder(options.out, "pareto.json");
  analysis::Pareto pareto = offers_of(options, under_test.lanes, sweep(ids, all.sources), all.sources);
  options.pairs = std::max(options.pairs / 10, std::min(options.pairs, kFewestAtAnExtreme));
  const auto some = drawn(options).sources;
  for (const analysis::Extreme extreme : analysis::kExtremes) {
    const std::size_t first = pareto.curves.size();
    for (const std::string& id : ids) pareto.curves.push_back({id, extreme, {}});
    for (const int k : analysis::exponents(extreme)) {
      const auto found = sweep(ids, analysis::made_extreme(some, extreme, k));
      for (std::size_t l = 0; l < found.size(); ++l) pareto.curves[first + l].points.emplace_back(k, found[l]);
    }
  }

  const fs::path& out = folder.path;
  const reports::Screen screen = output_screen();
  fmt::print("{}", reports::pareto_table(pareto, screen));
  if (options.device) {
    print_wrapped({fmt::format(
        "Registers and local bytes are per thread. Threads: how many a multiprocessor of {} holds at once; "
        "it can hold at most {}.",
        pareto.machine, pareto.threads_at_once)});
  }
  print_wrapped(reports::pareto_sentences(pareto));
  fmt::print("{}", reports::extremes_text(pareto, screen));
  fmt::print("{}", left_out_text(all.left_out));
  nlohmann::ordered_json json = {{"pairs", pareto.offers.front().errors.pairs}, {"seed", options.seed}};
  fuzz::add_left_out(json, under_test);
  if (const fuzz::Json code = subjects::record(ids); !code.is_null()) json["subjects"] = reports::code_json(code);
  json.update(reports::pareto_json(pareto));
  std::vector<Result> results = {{"pareto.json", fuzz::sealed(json).dump(1) + "\n"},
                                 {"front.svg", reports::pareto_figure(pareto)}};
  for (const analysis::Extreme extreme : analysis::kExtremes)
    results.push_back({std::string(name(extreme)) + ".svg", reports::extreme_figure(pareto.curves, extreme)});
  write_results(out, results);
  fmt::print("Wrote {}/{{pareto.json,front.svg,scale.svg,offset.svg,flatness.svg,aspect.svg}}\n",
             printable(out.string()));
  if (fs::exists(out / "campaign.sqlite")) fmt::print("Next: graze report {}\n", path_word(out.string()));
  return 0;
}

}  // namespace

void add_pareto(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "pareto", "Measure errors against nanoseconds per pair, and how extreme pairs may be before a lane fails");
  command->footer("Example: graze pareto --strata 'near_*' --pairs 20k");
  const auto options = std::make_shared<ParetoOptions>();
  add_globs(*command, "--lanes", options->lanes.globs, "Patterns of the lanes to run");
  command->get_option("--lanes")->default_str("common CPU lanes and those of --subject; with --device CUDA lanes");
  add_subject_options(*command, options->lanes);
  add_draw_options(*command, *options);
  add_count(*command, "--pairs", options->pairs, 1000, kMostWhole, "Number of pairs on which errors are counted");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of the pairs");
  command
      ->add_flag("--device", options->device,
                 "Measure the CUDA lanes on the first device, with pairs in its memory and with copies")
      ->excludes("--coordinates")
      ->excludes("--subject");
  add_valued(*command, "--out", options->out, "DIR", "Folder for pareto.json and the pictures")->capture_default_str();
  run_drawing(*command, options, status, pareto);
}

}  // namespace graze::cli
