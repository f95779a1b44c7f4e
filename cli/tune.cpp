// SPDX-License-Identifier: Apache-2.0
// `graze tune`: finds the best epsilon policy for a lane on given pairs, and problems with epsilons that error counts
// hide.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "analysis/pareto.h"
#include "backends/backends.h"
#include "cli/screen.h"
#include "cli/tune.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "cuda/lanes/device.h"
#include "cuda/lanes/device_costs.h"
#include "fuzz/files.h"
#include "fuzz/minimise/minimise.h"
#include "fuzz/sealed.h"
#include "reports/snippet.h"
#include "reports/terminal.h"
#include "reports/tuning.h"

namespace graze::cli {

namespace fs = std::filesystem;

TunePairs tune_pairs(const TuneOptions& options) {
  strata::SceneSources others = drawn(options.scene, options.seed + 1, options.pairs, options.strata);
  std::vector<strata::PairSource> sources =
      drawn(options.scene, options.seed, std::max<std::uint64_t>(options.pairs / 10, 1), options.strata).sources;
  // A mesh's own pairs do not depend on the seed, so they only serve to verify the choice.
  std::erase_if(sources, [](const strata::PairSource& source) { return source.id == "mesh"; });
  if (sources.empty())
    throw UsageError("the pairs of a mesh do not depend on the seed, so none are left to choose on; add --strata");
  return {std::move(sources), std::move(others.sources), left_out_text(others.left_out)};
}

Pair pair_at(const std::vector<strata::PairSource>& sources, const analysis::PairPlace& place) {
  return sources[static_cast<std::size_t>(place.source)].pair(place.index);
}

std::string smallest(const Lane& first, const Lane& second, const Pair& pair) {
  fuzz::SelectedLanes both;
  both.lanes = {&first, &second};
  both.on_host = {backends::on_host(first), backends::on_host(second)};
  Pair small = pair;
  if (both.on_host[0] && both.on_host[1]) small = fuzz::minimise(fuzz::failures_of(both, pair).at(0), pair).pair;
  std::ostringstream text;
  corpus::write_header(text);
  corpus::write_entry(text, {small, {{"lanes", first.id + "," + second.id}}});
  return text.str();
}

void write_listed(const fs::path& out, const std::vector<Result>& results, std::initializer_list<const char*> cases) {
  write_results(out, results);
  std::vector<std::string> written;
  for (const Result& result : results) written.push_back(result.name);
  for (const char* name : cases) {
    if (std::find(written.begin(), written.end(), name) == written.end()) remove_result(out / name, kPairs);
  }
  fmt::print("Wrote {}/{{{}}}\n", out.string(), fmt::join(written, ","));
}

std::string next_command(const fs::path& out, const Result& last, const std::string& lanes) {
  if (!last.name.ends_with(".pairs")) return "Next: graze pareto\n";
  return fmt::format("Next: graze check {} --lanes {}\n", path_word((out / last.name).string()), shell_word(lanes));
}

std::vector<std::string> cost_sentences(std::span<const Lane* const> lanes,
                                        const std::vector<strata::PairSource>& sources) {
  std::vector<const Lane*> on_host, on_device;
  for (const Lane* lane : lanes) (backends::backend_of(*lane).has_device ? on_device : on_host).push_back(lane);
  const auto sentence = [](const std::string& where, const std::vector<const Lane*>& of, const auto& nanoseconds) {
    std::vector<std::string> parts;
    for (std::size_t l = 0; l < of.size(); ++l)
      parts.push_back(fmt::format("{} {} ns{}", of[l]->id, nanoseconds(l), of[l]->exact ? ", never wrong" : ""));
    return fmt::format("Cost of a pair on {}: {}.", where, fmt::join(parts, "; "));
  };
  std::vector<std::string> sentences;
  if (!on_host.empty()) {
    std::vector<DecideBlock> blocks;
    for (const Lane* lane : on_host) blocks.push_back(lane->decide);
    const std::vector<analysis::Cost> costs = analysis::costs_of(blocks, analysis::first_pairs(sources, 8192), 9);
    sentences.push_back(
        sentence("one core here", on_host, [&](std::size_t l) { return fmt::format("{:.0f}", costs[l].middle); }));
  }
  std::string why_not;
  if (!on_device.empty() && !cuda::open_device(why_not)) {
    sentences.push_back("Cost of the CUDA lanes: not measured, because they run as twins here (" + why_not + ").");
  } else if (!on_device.empty()) {
    const cuda::DeviceCosts costs =
        cuda::measure_on_device(on_device, analysis::first_pairs(sources, std::size_t{1} << 20), 9);
    sentences.push_back(sentence(costs.device + ", pairs there", on_device, [&](std::size_t l) {
      return fmt::format("{:.4f}", analysis::quartiles(costs.of[l].resident).middle);
    }));
  }
  return sentences;
}

namespace {

int tune(const TuneOptions& options) {
  const Lane* const lane = &published_lane(options.lanes.front());
  std::string why_not;
  const bool on_device = backends::backend_of(*lane).has_device && cuda::open_device(why_not);
  if (!on_device && !backends::why_not_on_host(*lane).empty())
    throw UsageError("cannot run " + lane->id + " here: there is no such processor or device, and it has no twin");
  analysis::TuneSpec spec;
  spec.sweep = on_device ? analysis::device_sweep([lane](const std::string& policy) {
    return policy.empty() ? *lane : lane_under(*lane, policy);
  })
                         : analysis::host_sweep(*lane, options.threads);
  TunePairs pairs = tune_pairs(options);
  spec.sources = std::move(pairs.sources);
  spec.others = std::move(pairs.others);
  spec.sites = analysis::sites_asked(*lane, spec.sources);
  spec.forbid = static_cast<analysis::Forbid>(options.forbid);
  spec.max_rate = options.max_rate;
  const ResultFolder folder(options.out.empty() ? "tuned" : options.out, "tune.json");
  const analysis::Tuned tuned = analysis::tune(spec);

  const reports::TuneQuestion question{lane->id, spec.forbid, spec.max_rate};
  const fs::path& out = folder.path;
  const reports::Screen screen = output_screen();
  for (const std::string& sentence : reports::tuning_sentences(question, tuned))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("{}", pairs.left_out);
  const Lane chosen = tuned.chosen.empty() ? *lane : lane_under(*lane, tuned.chosen);
  const Lane* const costly[] = {&chosen, &backends::exact_beside(*lane)};
  for (const std::string& sentence : cost_sentences(costly, spec.others))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  std::vector<Result> results = {{"tune.json", fuzz::sealed(reports::tuning_json(question, tuned)).dump(1) + "\n"},
                                 {"curves.svg", reports::tuning_figure(question, tuned)},
                                 {"policy.h", reports::policy_header(chosen)}};
  for (const auto& [place, name] :
       {std::pair{tuned.confirmed.first_fixed, "fixed.pairs"}, {tuned.confirmed.first_broken, "broken.pairs"}}) {
    if (!place) continue;
    results.push_back({name, smallest(*lane, chosen, pair_at(spec.others, *place))});
  }
  write_listed(out, results, {"fixed.pairs", "broken.pairs"});
  fmt::print("{}", next_command(out, results.back(), lane->id + "," + chosen.id));
  return 0;
}

}  // namespace

void add_tune(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "tune", "Find the best tolerance for a lane: sweep tolerances on some pairs, and judge the best on others");
  command->footer(
      "Example: graze tune moller_1997/f32/cpu --forbid false-negative --pairs 20k\n"
      "Example: graze tune moller_1997/f32/cpu moller_1997/f32/cuda-fma --agree");
  const auto options = std::make_shared<TuneOptions>();
  command->add_option("LANE", options->lanes, "Lane, without a policy; with --agree two of one algorithm and scalar")
      ->required()
      ->option_text("LANE [LANE]");
  command->add_flag("--agree", options->agree,
                    "Find the smallest tolerance under which two lanes give the same verdicts, right or wrong");
  add_globs(*command, "--strata", options->strata, "Patterns of the strata to draw from");
  add_scene_option(*command, options->scene);
  add_count(*command, "--pairs", options->pairs, 10, kMostWhole,
            "Number of pairs that judge the choice; it is made on a tenth as many others");
  add_count(*command, "--seed", options->seed, 0, kMostWhole - 1,
            "Seed of the pairs that the choice is made on; those that judge it have the next seed");
  CLI::Option* const forbid = command->add_option(
      "--forbid", options->forbid, "Errors to avoid: false negatives, false positives, or any wrong verdict");
  forbid->transform(one_of({"false-negative", "false-positive", "any"}, Chosen::place))
      ->option_text("false-negative|false-positive|any")
      ->default_str("any");
  command
      ->add_option("--max-rate", options->max_rate, "Highest rate of such errors; with --agree, of differing verdicts")
      ->check(number(1e-15, 1.0))
      ->capture_default_str()
      ->option_text("RATE");
  add_threads_option(*command, options->threads);
  command
      ->add_option("--out", options->out,
                   "Folder for the JSON file, curves.svg, policy.h (without --agree) and the smallest cases")
      ->check(not_empty())
      ->default_str("tuned; with --agree: agreed")
      ->option_text("DIR");
  command->callback([options, forbid, &status] {
    if (options->agree != (options->lanes.size() == 2) || options->lanes.size() > 2)
      throw UsageError(fmt::format("give one lane, or two lanes with --agree; got {} lane{} {} --agree",
                                   options->lanes.size(), options->lanes.size() == 1 ? "" : "s",
                                   options->agree ? "with" : "without"));
    if (options->agree && forbid->count() > 0)
      throw UsageError("--forbid does not work with --agree, which only forbids differing verdicts; leave it out");
    status = options->agree ? agree(*options) : tune(*options);
  });
}

}  // namespace graze::cli
