// SPDX-License-Identifier: Apache-2.0
// `graze tune`: finds the best epsilon policy for a lane on given pairs, and problems with epsilons that error counts
// hide.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "analysis/pareto.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "cuda/lanes/device.h"
#include "cuda/lanes/device_costs.h"
#include "cuda/twin/twin.h"
#include "fuzz/files.h"
#include "fuzz/minimise/minimise.h"
#include "fuzz/sealed.h"
#include "reports/snippet.h"
#include "reports/terminal.h"
#include "reports/tuning.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

struct TuneOptions {
  std::string lane, scene, out = "tuned";
  std::vector<std::string> strata;
  std::uint64_t pairs = 1'000'000, seed = 1;
  int threads = 0;
  int forbid = 2;
  double max_rate = 1e-6;
};

// Minimises a pair that the policy fixes or breaks, keeping the verdicts of both lanes. Without twins, returns the pair
// itself.
std::string smallest(const Lane& zero, const Lane& under, const Pair& pair) {
  fuzz::SelectedLanes both;
  both.lanes = {&zero, &under};
  both.on_host = {cuda::block_on_host(zero), cuda::block_on_host(under)};
  Pair small = pair;
  if (both.on_host[0] && both.on_host[1]) small = fuzz::minimise(fuzz::failures_of(both, pair).at(0), pair).pair;
  std::ostringstream text;
  corpus::write_header(text);
  corpus::write_entry(text, {small, {{"lanes", zero.id + "," + under.id}}});
  return text.str();
}

// Empty if the lane runs as a twin, because a twin's time is not the time of the code.
std::string cost_sentence(const Lane& zero, const Lane& chosen, const std::vector<strata::PairSource>& sources,
                          bool on_device) {
  if (!zero.is_cuda()) {
    const std::vector<analysis::Cost> costs = analysis::costs_of(
        std::vector{chosen.decide, find_lane("exact/f32/cpu")->decide}, analysis::first_pairs(sources, 8192), 9);
    return fmt::format("Cost: {:.0f} ns a pair on one core here; the exact lane, which is never wrong, {:.0f} ns.",
                       costs[0].middle, costs[1].middle);
  }
  if (!on_device) return "";
  const Lane* lanes[] = {&chosen, find_lane("exact/f32/cuda")};
  const cuda::DeviceCosts costs =
      cuda::measure_on_device(lanes, analysis::first_pairs(sources, std::size_t{1} << 20), 9);
  return fmt::format("Cost: {:.4f} ns a pair on {}, pairs there; the exact lane, which is never wrong, {:.4f} ns.",
                     analysis::quartiles(costs.of[0].resident).middle, costs.device,
                     analysis::quartiles(costs.of[1].resident).middle);
}

int tune(const TuneOptions& options) {
  const Lane* lane = find_lane(options.lane);
  if (!lane || lane->algorithm < 0) {
    std::vector<std::string> ids;
    for (const Lane& row : published_lanes()) ids.push_back(row.id);
    throw UsageError("there is no published lane '" + printable(options.lane) + "'; `graze lanes` lists them" +
                     did_you_mean(options.lane, ids));
  }
  std::string why_not;
  const bool on_device = lane->is_cuda() && cuda::open_device(why_not);
  if (!on_device && (!cuda::block_on_host(*lane) || (!lane->is_cuda() && !runs_on_this_cpu(*lane))))
    throw UsageError("cannot run " + lane->id + " here: there is no such processor or device, and it has no twin");
  analysis::TuneSpec spec;
  spec.sweep = on_device ? analysis::device_sweep([lane](const std::string& policy) {
    return policy.empty() ? *lane : lane_under(*lane, policy);
  })
                         : analysis::host_sweep(*lane, options.threads);
  // Chooses on a tenth of the pairs, and verifies on all pairs of the next seed.
  strata::SceneSources others = drawn(options.scene, options.seed + 1, options.pairs, options.strata);
  spec.others = std::move(others.sources);
  spec.sources =
      drawn(options.scene, options.seed, std::max<std::uint64_t>(options.pairs / 10, 1), options.strata).sources;
  // A mesh's own pairs do not depend on the seed, so they only serve to verify the choice.
  std::erase_if(spec.sources, [](const strata::PairSource& source) { return source.id == "mesh"; });
  if (spec.sources.empty())
    throw UsageError("the pairs of a mesh do not depend on the seed, so none are left to choose on; add --strata");
  spec.sites = analysis::sites_asked(*lane, spec.sources);
  spec.forbid = static_cast<analysis::Forbid>(options.forbid);
  spec.max_rate = options.max_rate;
  const ResultFolder folder(options.out, "tune.json");
  const analysis::Tuned tuned = analysis::tune(spec);

  const reports::TuneQuestion question{lane->id, spec.forbid, spec.max_rate};
  const fs::path& out = folder.path;
  const reports::Screen screen = output_screen();
  for (const std::string& sentence : reports::tuning_sentences(question, tuned))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("{}", left_out_text(others.left_out));
  const Lane chosen = tuned.chosen.empty() ? *lane : lane_under(*lane, tuned.chosen);
  if (const std::string cost = cost_sentence(*lane, chosen, spec.others, on_device); !cost.empty())
    fmt::print("{}", reports::wrapped(cost, screen.columns));
  std::vector<Result> results = {{"tune.json", fuzz::sealed(reports::tuning_json(question, tuned)).dump(1) + "\n"},
                                 {"curves.svg", reports::tuning_figure(question, tuned)},
                                 {"policy.h", reports::policy_header(chosen)}};
  for (const auto& [place, name] :
       {std::pair{tuned.confirmed.first_fixed, "fixed.pairs"}, {tuned.confirmed.first_broken, "broken.pairs"}}) {
    if (!place) continue;
    const Pair pair = spec.others[static_cast<std::size_t>(place->source)].pair(place->index);
    results.push_back({name, smallest(*lane, chosen, pair)});
  }
  write_results(out, results);
  std::vector<std::string> written;
  for (const Result& result : results) written.push_back(result.name);
  for (const char* name : {"fixed.pairs", "broken.pairs"}) {
    if (std::find(written.begin(), written.end(), name) == written.end()) remove_result(out / name, kPairs);
  }
  fmt::print("Wrote {}/{{{}}}\n", out.string(), fmt::join(written, ","));
  if (written.back().ends_with(".pairs")) {
    fmt::print("Next: graze check {} --lanes {}\n", path_word((out / written.back()).string()),
               shell_word(lane->id + "," + chosen.id));
  } else {
    fmt::print("Next: graze pareto\n");
  }
  return 0;
}

}  // namespace

void add_tune(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "tune", "Find the best tolerance for a lane: sweep tolerances on some pairs, and judge the best on others");
  command->footer("Example: graze tune moller_1997/f32/cpu --forbid false-negative --pairs 20k");
  const auto options = std::make_shared<TuneOptions>();
  command->add_option("LANE", options->lane, "Lane, without a policy")->required();
  add_globs(*command, "--strata", options->strata, "Patterns of the strata to draw from");
  add_scene_option(*command, options->scene);
  add_count(*command, "--pairs", options->pairs, 10, kMostWhole,
            "Number of pairs that judge the choice; it is made on a tenth as many others");
  add_count(*command, "--seed", options->seed, 0, kMostWhole - 1,
            "Seed of the pairs that the choice is made on; those that judge it have the next seed");
  command
      ->add_option("--forbid", options->forbid,
                   "Errors to avoid: false negatives, false positives, or any wrong verdict")
      ->transform(one_of({"false-negative", "false-positive", "any"}, Chosen::place))
      ->option_text("false-negative|false-positive|any")
      ->default_str("any");
  command->add_option("--max-rate", options->max_rate, "Highest rate of such errors")
      ->check(number(1e-15, 1.0))
      ->capture_default_str()
      ->option_text("RATE");
  add_threads_option(*command, options->threads);
  command->add_option("--out", options->out, "Folder for tune.json, curves.svg, policy.h and the smallest cases")
      ->check(not_empty())
      ->capture_default_str()
      ->option_text("DIR");
  command->callback([options, &status] { status = tune(*options); });
}

}  // namespace graze::cli
