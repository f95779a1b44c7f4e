// SPDX-License-Identifier: Apache-2.0
// `graze tune`: finds the best epsilon policy for a lane on given pairs, and reports problems that its error counts do
// not show.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>

#include "analysis/epsilon_sweep.h"
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
#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/files.h"
#include "fuzz/minimise/minimise.h"
#include "fuzz/sealed.h"
#include "reports/cost_words.h"
#include "reports/recorded_code.h"
#include "reports/snippet.h"
#include "reports/terminal.h"
#include "reports/tuning.h"
#include "subjects/subjects.h"

namespace graze::cli {

namespace fs = std::filesystem;

namespace {

// A mesh's own pairs do not depend on the seed, so they can serve to choose or to verify the choice, but not both.
std::vector<strata::PairSource> without_meshes(std::vector<strata::PairSource> sources, const char* use) {
  std::erase_if(sources, [](const strata::PairSource& source) { return fuzz::is_of_mesh(source.id); });
  if (sources.empty())
    throw UsageError(fmt::format("the pairs of a mesh do not depend on the seed, so none are left to {}", use));
  return sources;
}

// Returns the campaign's own pairs to choose on, and fresh pairs to verify the choice on.
TunePairs pairs_from(const TuneOptions& options) {
  CampaignPairs campaign = pairs_of_campaign(options.from, 0, "tune on");
  if (!campaign.summary.at("complete"))
    throw UsageError(cannot("tune on", options.from, "it is not finished; finish it with `graze fuzz`"));
  fuzz::Json spec = campaign.summary["spec"];
  spec["seed"] = campaign.seed + 1;
  std::vector<strata::PairSource> others = without_meshes(fuzz::recorded_sources(spec), "verify the choice");
  if (options.pairs > 0) {  // divided among the sources as in the campaign
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
  DrawOptions draw = options;
  if (draw.pairs == 0) draw.pairs = DrawOptions().pairs;
  draw.seed = options.seed + 1;
  strata::SceneSources others = drawn(draw);
  draw.pairs = std::max<std::uint64_t>(draw.pairs / 10, 1);
  draw.seed = options.seed;
  return {nullptr, without_meshes(drawn(draw).sources, "choose on; add --strata"), std::move(others.sources),
          left_out_text(others.left_out)};
}

bool TunePairs::in_doubles() const { return analysis::any_in_doubles(others); }

void expect_takes(const Lane& lane, const TunePairs& pairs) {
  if (!pairs.in_doubles()) return;
  if (!fuzz::takes(lane, DoublePair{})) throw UsageError(cannot("run", lane.id, "it takes only pairs of float32"));
  if (lane.algorithm >= 0 && !fuzz::takes(lane_under(lane, "abs:1e-6"), DoublePair{}))
    throw UsageError(cannot("tune", lane.id, "under a tolerance it takes only pairs of float32"));
}

const Lane& exact_on(const TunePairs& pairs, const Lane& lane) {
  return pairs.in_doubles() ? *find_lane(fuzz::kExactDoubles) : backends::exact_beside(lane);
}

AnyPair pair_at(const std::vector<strata::PairSource>& sources, const analysis::PairPlace& place) {
  return sources[static_cast<std::size_t>(place.source)].any_pair(place.index);
}

std::string file_of_pair(const AnyPair& pair, const std::string& lanes) {
  std::ostringstream text;
  corpus::write_header(text);
  corpus::write_entry(text, corpus::entry_of(pair, {{"lanes", lanes}}));
  return text.str();
}

std::string smallest(const Lane& first, const Lane& second, const AnyPair& pair) {
  fuzz::SelectedLanes both;
  both.lanes = {&first, &second};
  both.on_host = {backends::on_host(first), backends::on_host(second)};
  AnyPair small = pair;
  if (both.on_host[0] && both.on_host[1]) small = fuzz::minimise(fuzz::failures_of(both, pair).at(0), pair).pair;
  return file_of_pair(small, first.id + "," + second.id);
}

void write_listed(const fs::path& out, const std::vector<Result>& results, std::initializer_list<Result> optional) {
  write_results(out, results);
  std::vector<std::string> written;
  for (const Result& result : results) written.push_back(result.name);
  for (const auto& [name, kind] : optional) {
    if (std::find(written.begin(), written.end(), name) == written.end()) remove_result(out / name, kind);
  }
  fmt::print("Wrote {}/{{{}}}\n", printable(out.string()), fmt::join(written, ","));
}

std::string next_command(const fs::path& out, const Result& last, const std::string& lanes) {
  const std::string own_code = subject_words(lanes.substr(0, lanes.find('/')));
  if (!last.name.ends_with(".pairs")) return fmt::format("Next: graze pareto{}\n", own_code);
  return fmt::format("Next: graze check {} --lanes {}{}\n", path_word((out / last.name).string()), shell_word(lanes),
                     own_code);
}

std::vector<std::string> cost_sentences(std::span<const Lane* const> lanes,
                                        const std::vector<strata::PairSource>& sources) {
  std::vector<const Lane*> on_host, on_device;
  for (const Lane* lane : lanes) (backends::backend_of(*lane).has_device ? on_device : on_host).push_back(lane);
  const auto sentence = [](const std::string& where, const std::vector<const Lane*>& of, const auto& cost) {
    std::vector<std::string> parts;
    for (std::size_t l = 0; l < of.size(); ++l)
      parts.push_back(
          fmt::format("{} {}{}", of[l]->id, reports::cost_words(cost(l)), of[l]->exact ? ", never wrong" : ""));
    return fmt::format("Cost of a pair{}: {}.", where, fmt::join(parts, "; "));
  };
  std::vector<std::string> sentences;
  constexpr std::size_t kTimed = 8192;
  constexpr int kPasses = 9;
  const strata::PairBlock pairs = analysis::first_pairs(sources, kTimed);
  const std::vector<std::optional<analysis::Cost>> host_costs = analysis::costs_of(on_host, pairs, kPasses);
  std::vector<const Lane*> timed;
  std::vector<analysis::Cost> costs;
  for (std::size_t l = 0; l < on_host.size(); ++l) {
    if (host_costs[l]) {
      timed.push_back(on_host[l]);
      costs.push_back(*host_costs[l]);
    } else {
      const std::string why = analysis::why_not_timed(*on_host[l]);
      sentences.push_back(fmt::format("Cost of {}: not measured, because {}.", on_host[l]->id,
                                      why.empty() ? "it failed on some pairs" : why));
    }
  }
  if (!timed.empty()) {
    sentences.push_back(sentence("", timed, [&](std::size_t l) { return costs[l]; }));
    sentences.push_back(reports::costs_sentence(analysis::Calls::of_blocks,
                                                fmt::format("{} of the fresh pairs", reports::grouped(pairs.size())),
                                                fuzz::machine_name(), kPasses));
  }
  std::string why_not;
  if (!on_device.empty() && !cuda::open_device(why_not)) {
    sentences.push_back("Cost of the CUDA lanes: not measured, because they run as twins here (" + why_not + ").");
  } else if (!on_device.empty()) {
    const cuda::DeviceCosts there =
        cuda::measure_on_device(on_device, analysis::first_pairs(sources, std::size_t{1} << 20), 9);
    sentences.push_back(sentence(" on " + there.device + ", with 2^20 pairs per call that are already in its memory",
                                 on_device, [&](std::size_t l) { return analysis::quartiles(there.of[l].resident); }));
  }
  return sentences;
}

namespace {

// Returns the unit of the scene's coordinates; empty without a scene that names one.
std::string units_of(const TuneOptions& options, const fuzz::Json& campaign) {
  std::string units;
  if (!options.scene.empty()) units = strata::read_scene(options.scene).units;
  if (campaign.is_object() && campaign["spec"].contains("scene"))
    units = fuzz::recorded_scene(campaign["spec"]["scene"]).scene.units;
  return units == strata::SceneFile().units ? "" : units;
}

const Lane& lane_to_tune(const TuneOptions& options) {
  open_subjects(options.own_code);
  if (!options.from.empty()) open_subjects_of(options.from, options.own_code.resubject);
  const Lane& lane = named_lane(options.lanes.front());
  expect_own_code_among(options.own_code, {lane.id}, "LANE");
  if (!lane.foreign && !options.epsilon.empty())
    throw UsageError("--epsilon names a constant of your own code, and " + lane.id + " is a published lane");
  return lane;
}

int tune(const TuneOptions& options) {
  const Lane* const lane = &lane_to_tune(options);
  TunePairs pairs = tune_pairs(options);
  expect_takes(*lane, pairs);
  std::string why_not;
  const bool on_device = backends::backend_of(*lane).has_device && cuda::open_device(why_not);
  if (const std::string why = backends::why_not_on_host(*lane); !on_device && !why.empty())
    throw UsageError(cannot("run", lane->id, why));
  std::optional<subjects::TunableSource> source;  // of the user's code
  std::optional<analysis::UnderEpsilon> under;
  analysis::TuneSpec spec;
  if (lane->foreign) {
    source = subjects::tunable_source(*lane, options.epsilon);
    under.emplace(*lane, *source);
    spec.sweep = analysis::epsilon_sweep(*under, options.threads);
  } else if (on_device) {
    spec.sweep = analysis::device_sweep(
        [lane](const std::string& policy) { return policy.empty() ? *lane : lane_under(*lane, policy); });
  } else {
    spec.sweep = analysis::host_sweep(*lane, options.threads);
  }
  const Lane& exact = exact_on(pairs, *lane);
  spec.sources = std::move(pairs.sources);
  spec.others = std::move(pairs.others);
  spec.by_value = source.has_value();
  if (!source) spec.sites = analysis::sites_asked(*lane, spec.sources);
  spec.forbid = static_cast<analysis::Forbid>(options.forbid);
  spec.max_rate = options.max_rate;
  spec.max_other = options.max_other;
  if (!options.from.empty() && !options.own_code.resubject)
    expect_errors_of(options.from, pairs.campaign, spec, lane->id);
  const ResultFolder folder(options.out.empty() ? "tuned" : options.out, "tune.json");
  const analysis::Tuned tuned = analysis::tune(spec);

  const reports::TuneQuestion question{lane->id,
                                       spec.forbid,
                                       spec.max_rate,
                                       spec.max_other,
                                       source ? &*source : nullptr,
                                       units_of(options, pairs.campaign)};
  const fs::path& out = folder.path;
  const reports::Screen screen = output_screen();
  print_wrapped(reports::tuning_sentences(question, tuned));
  fmt::print("\n{}", reports::tuning_table(question, tuned, screen));
  std::string changes;
  if (!options.from.empty() && backends::why_not_on_host(*lane).empty()) {
    std::optional<analysis::EpsilonDeciders> deciders;
    if (under) deciders.emplace(*under);
    changes = changes_csv(*lane, deciders ? analysis::DecideUnder(std::ref(*deciders)) : nullptr, spec, tuned,
                          pairs.campaign["spec"]["seed"], options.threads);
  }
  fmt::print("\n{}", pairs.left_out);
  const Lane chosen = tuned.chosen.empty() || source ? *lane : lane_under(*lane, tuned.chosen);
  const Lane* const costly[] = {&chosen, &exact};
  print_wrapped(cost_sentences(costly, spec.others));
  fuzz::Json json = reports::tuning_json(question, tuned);
  if (lane->foreign) json["subjects"] = reports::code_json(subjects::record({lane->id}));
  std::vector<Result> results = {{"tune.json", fuzz::sealed(json).dump(1) + "\n"},
                                 {"curves.svg", reports::tuning_figure(question, tuned)}};
  if (!source) results.push_back({"policy.h", reports::policy_header(chosen)});
  if (!changes.empty()) results.push_back({"changes.csv", changes});
  for (const auto& [place, name] :
       {std::pair{tuned.confirmed.first_fixed, "fixed.pairs"}, {tuned.confirmed.first_broken, "broken.pairs"}}) {
    if (!place) continue;
    const AnyPair pair = pair_at(spec.others, *place);
    results.push_back({name, source ? file_of_pair(pair, lane->id) : smallest(*lane, chosen, pair)});
  }
  write_listed(out, results,
               {{"fixed.pairs", kPairs},
                {"broken.pairs", kPairs},
                {"changes.csv", kChangesHeader},
                {"policy.h", reports::policy_header(published_lanes().front())}});
  fmt::print("{}", next_command(out, results.back(), source ? lane->id : lane->id + "," + chosen.id));
  return 0;
}

}  // namespace

void add_tune(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("tune",
                                         "Find the best tolerance for a lane, or epsilon for your own code: sweep "
                                         "values on some pairs, and judge the best "
                                         "on others");
  command->footer(
      "Example: graze tune moller_1997/f32/cpu --forbid false-negative --pairs 20k\n"
      "Example: graze tune mine/f32/cpu --subject mine=./mine.cpp --pairs 2k\n"
      "Example: graze tune moller_1997/f32/cpu moller_1997/f32/cuda-fma --agree");
  const auto options = std::make_shared<TuneOptions>();
  add_valued(*command, "LANE", options->lanes, "LANE [LANE]",
             "Lane without a policy; with --agree, two published lanes of one algorithm and scalar")
      ->required();
  command->add_flag("--agree", options->agree,
                    "Find the smallest tolerance under which two lanes give the same verdicts, right or wrong");
  add_subject_options(*command, options->own_code);
  add_resubject_option(*command, options->own_code);
  add_valued(*command, "--epsilon", options->epsilon, "NAME",
             "Epsilon of your own C, C++ or CUDA source: the name of a constant, or a number as the source writes it. "
             "The source is built again with other values")
      ->default_str("the obvious one");
  for (const char* of_own_code : {"--resubject", "--epsilon"}) command->get_option("--agree")->excludes(of_own_code);
  add_draw_options(*command, *options);
  add_valued(*command, "--from", options->from, "DIR",
             "Campaign on whose pairs the choice is made, including the disagreements that it counted")
      ->excludes("--strata")
      ->excludes("--coordinates")
      ->excludes("--scene");
  add_count(*command, "--pairs", options->pairs, 10, kMostWhole,
            "Number of pairs on which the choice is tested; without --from, the choice is made on other pairs, a tenth "
            "as many")
      ->default_str("1000000; with --from as many as the campaign drew");
  add_count(*command, "--seed", options->seed, 0, kMostWhole - 1,
            "Seed of the pairs on which the choice is made; the pairs on which it is tested have the next seed")
      ->excludes("--from");
  CLI::Option* const forbid = command->add_option(
      "--forbid", options->forbid, "Errors to avoid: false negatives, false positives, or any wrong verdict");
  forbid->transform(one_of({"false-negative", "false-positive", "any"}, Chosen::place))
      ->option_text("false-negative|false-positive|any")
      ->default_str("any");
  add_valued(*command, "--max-rate", options->max_rate, "RATE",
             "Highest rate of the forbidden errors; with --agree, of differing verdicts")
      ->check(number(1e-15, 1.0))
      ->capture_default_str();
  CLI::Option* const max_other = command->add_option(
      "--max-other", options->max_other,
      "If --forbid names one kind of error: highest rate of the other kind at which a tolerance is still useful");
  max_other->check(number(0.0, 1.0))->capture_default_str()->option_text("RATE");
  add_threads_option(*command, options->threads);
  add_valued(*command, "--out", options->out, "DIR",
             "Folder for the JSON file, curves.svg, policy.h (without --agree) and the smallest cases")
      ->default_str("tuned; with --agree: agreed");
  command->callback([options, command, forbid, max_other, &status] {
    if (options->agree != (options->lanes.size() == 2) || options->lanes.size() > 2)
      throw UsageError(fmt::format("give one lane, or two lanes with --agree; got {} lane{} {} --agree",
                                   options->lanes.size(), options->lanes.size() == 1 ? "" : "s",
                                   options->agree ? "with" : "without"));
    if (options->agree && forbid->count() > 0)
      throw UsageError("--forbid does not work with --agree, which only forbids differing verdicts; leave it out");
    if (max_other->count() > 0 &&
        (options->agree || static_cast<analysis::Forbid>(options->forbid) == analysis::Forbid::any))
      throw UsageError(
          "--max-other limits the other kind of error; it needs --forbid false-negative or false-positive");
    take_type_of_scene(*command, *options);
    status = options->agree ? agree(*options) : tune(*options);
  });
}

}  // namespace graze::cli
