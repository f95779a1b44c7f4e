// SPDX-License-Identifier: Apache-2.0
// `graze tune`: finds the best epsilon policy for a lane on given pairs, and problems with epsilons that error counts
// hide.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "analysis/pareto.h"
#include "backends/backends.h"
#include "cli/screen.h"
#include "cli/tune.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "cuda/lanes/device.h"
#include "cuda/lanes/device_costs.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/counts_json.h"
#include "fuzz/files.h"
#include "fuzz/minimise/minimise.h"
#include "fuzz/sealed.h"
#include "reports/snippet.h"
#include "reports/terminal.h"
#include "reports/tuning.h"

namespace graze::cli {

namespace fs = std::filesystem;

namespace {

// A mesh's own pairs do not depend on the seed, so they serve only to choose, or only to verify the choice.
std::vector<strata::PairSource> without_meshes(std::vector<strata::PairSource> sources, const char* use) {
  std::erase_if(sources, [](const strata::PairSource& source) { return source.id == "mesh"; });
  if (sources.empty())
    throw UsageError(fmt::format("the pairs of a mesh do not depend on the seed, so none are left to {}", use));
  return sources;
}

// The campaign's own pairs to choose on, which show the disagreements that it counted.
TunePairs pairs_from(const TuneOptions& options) {
  CampaignPairs campaign = pairs_of_campaign(options.from, 0, "tune on");
  if (!campaign.summary.at("complete"))
    throw UsageError(cannot("tune on", options.from, "it is not finished; finish it with `graze fuzz`"));
  fuzz::Json spec = campaign.summary["spec"];
  spec["seed"] = campaign.seed + 1;
  std::vector<strata::PairSource> others = without_meshes(fuzz::recorded_sources(spec), "verify the choice");
  if (options.pairs > 0) {  // in the campaign's shares
    double before = 0, all = 0, rounded = 0;
    for (const strata::PairSource& source : others) all += static_cast<double>(source.pairs);
    for (strata::PairSource& source : others) {
      before += static_cast<double>(source.pairs);
      const double end = std::round(static_cast<double>(options.pairs) * (before / all));
      source.pairs = static_cast<std::uint64_t>(end - std::exchange(rounded, end));
    }
  }
  return {std::move(campaign.summary), std::move(campaign.sources), std::move(others), ""};
}

}  // namespace

TunePairs tune_pairs(const TuneOptions& options) {
  if (!options.from.empty()) return pairs_from(options);
  const std::uint64_t pairs = options.pairs > 0 ? options.pairs : 1'000'000;
  strata::SceneSources others = drawn(options.scene, options.seed + 1, pairs, options.strata);
  std::vector<strata::PairSource> sources =
      drawn(options.scene, options.seed, std::max<std::uint64_t>(pairs / 10, 1), options.strata).sources;
  return {nullptr, without_meshes(std::move(sources), "choose on; add --strata"), std::move(others.sources),
          left_out_text(others.left_out)};
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

void write_listed(const fs::path& out, const std::vector<Result>& results, std::initializer_list<Result> optional) {
  write_results(out, results);
  std::vector<std::string> written;
  for (const Result& result : results) written.push_back(result.name);
  for (const auto& [name, kind] : optional) {
    if (std::find(written.begin(), written.end(), name) == written.end()) remove_result(out / name, kind);
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

// Throws: UsageError if the campaign did not run the lane; std::runtime_error unless the lane's errors are those that
// the campaign counted.
void expect_errors_of(const std::string& directory, const fuzz::Json& campaign, const analysis::TuneSpec& spec,
                      const std::string& lane) {
  const fuzz::Json& strata = campaign.at("strata");
  for (const strata::PairSource& source : spec.sources) {
    const fuzz::Json& lanes = strata.at(source.id).at("lanes");
    if (!lanes.contains(lane)) throw UsageError(cannot("tune on", directory, "it did not run " + lane));
    const Counts counted = fuzz::counts_of(lanes[lane]),
                 now = spec.sweep(std::vector<std::string>{""}, {&source, 1}).front();
    if (!(counted == now))
      throw std::runtime_error(cannot(
          "tune on", directory,
          fmt::format("it counted {} wrong verdicts of {} in {}, but these pairs now show {}; its code differs from "
                      "this build's",
                      reports::grouped(counted.wrong()), lane, source.id, reports::grouped(now.wrong()))));
  }
}

constexpr const char* kChangesHeader = "stratum,seed,index,truth,tolerance,change\n";

// A row for each pair of the choice on which the lane is wrong without a tolerance ("wrong"), and for each pair that
// the best tolerance of a curve fixes or breaks.
std::string changes_csv(const Lane& lane, const analysis::TuneSpec& spec, const analysis::Tuned& tuned,
                        std::uint64_t seed, int threads) {
  std::vector<std::string> policies = {""};
  for (const analysis::PolicyErrors* best : analysis::best_of_curves(tuned.curves, spec.forbid, spec.max_rate)) {
    if (!best->changes_nothing() && backends::on_host(lane_under(lane, best->policy))) policies.push_back(best->policy);
  }
  const analysis::NotRightPairs found = analysis::not_right_pairs(lane, policies, spec.sources, threads);
  std::string csv = kChangesHeader;
  for (const analysis::NotRightPair& pair : found.first) {
    const Verdict truth = pair.intersects ? Verdict::intersects : Verdict::disjoint;
    const std::string place = fmt::format("{},{},{},{}", spec.sources[static_cast<std::size_t>(pair.place.source)].id,
                                          seed, pair.place.index, name(truth));
    const bool was_right = pair.verdicts[0] == truth;
    if (!was_right) csv += place + ",none,wrong\n";
    for (std::size_t p = 1; p < policies.size(); ++p) {
      const bool right = pair.verdicts[p] == truth;
      if (right != was_right) csv += fmt::format("{},{},{}\n", place, policies[p], right ? "fixes" : "breaks");
    }
  }
  if (found.first.size() < found.count)
    fmt::print("changes.csv lists the first {} of {} such pairs.\n", reports::grouped(found.first.size()),
               reports::grouped(found.count));
  return csv;
}

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
  spec.max_other = options.max_other;
  if (!options.from.empty()) expect_errors_of(options.from, pairs.campaign, spec, lane->id);
  const ResultFolder folder(options.out.empty() ? "tuned" : options.out, "tune.json");
  const analysis::Tuned tuned = analysis::tune(spec);

  const reports::TuneQuestion question{lane->id, spec.forbid, spec.max_rate, spec.max_other};
  const fs::path& out = folder.path;
  const reports::Screen screen = output_screen();
  for (const std::string& sentence : reports::tuning_sentences(question, tuned))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("\n{}", reports::tuning_table(question, tuned, screen));
  std::string changes;
  if (!options.from.empty() && backends::why_not_on_host(*lane).empty())
    changes = changes_csv(*lane, spec, tuned, pairs.campaign["spec"]["seed"], options.threads);
  fmt::print("\n{}", pairs.left_out);
  const Lane chosen = tuned.chosen.empty() ? *lane : lane_under(*lane, tuned.chosen);
  const Lane* const costly[] = {&chosen, &backends::exact_beside(*lane)};
  for (const std::string& sentence : cost_sentences(costly, spec.others))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  std::vector<Result> results = {{"tune.json", fuzz::sealed(reports::tuning_json(question, tuned)).dump(1) + "\n"},
                                 {"curves.svg", reports::tuning_figure(question, tuned)},
                                 {"policy.h", reports::policy_header(chosen)}};
  if (!changes.empty()) results.push_back({"changes.csv", changes});
  for (const auto& [place, name] :
       {std::pair{tuned.confirmed.first_fixed, "fixed.pairs"}, {tuned.confirmed.first_broken, "broken.pairs"}}) {
    if (!place) continue;
    results.push_back({name, smallest(*lane, chosen, pair_at(spec.others, *place))});
  }
  write_listed(out, results, {{"fixed.pairs", kPairs}, {"broken.pairs", kPairs}, {"changes.csv", kChangesHeader}});
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
  command
      ->add_option("--from", options->from,
                   "Campaign whose own pairs, with the disagreements that it counted, the choice is made on")
      ->excludes("--strata")
      ->excludes("--scene")
      ->option_text("DIR");
  add_count(*command, "--pairs", options->pairs, 10, kMostWhole,
            "Number of pairs that judge the choice; without --from it is made on a tenth as many others")
      ->default_str("1000000; with --from as many as the campaign drew");
  add_count(*command, "--seed", options->seed, 0, kMostWhole - 1,
            "Seed of the pairs that the choice is made on; those that judge it have the next seed")
      ->excludes("--from");
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
  command
      ->add_option("--max-other", options->max_other,
                   "With --forbid of one kind: highest rate of the other kind at which a tolerance is useful")
      ->check(number(0.0, 1.0))
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
