// SPDX-License-Identifier: Apache-2.0
// `graze discrepancy`: measures how much the values behind the verdicts of two lanes differ.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "backends/backends.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/relation_of.h"
#include "core/simplify/simplicity.h"
#include "core/text.h"
#include "cuda/lanes/device.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/sealed.h"
#include "reports/discrepancy.h"
#include "reports/recorded_code.h"
#include "reports/verdicts_apart.h"
#include "subjects/subjects.h"

namespace graze::cli {
namespace {

constexpr int kDevice = 1, kTwin = 2;   // indices of the words of --executor
constexpr std::size_t kMostTables = 2;  // with more comparisons, only shares are printed

struct DiscrepancyOptions : DrawOptions {
  DiscrepancyOptions() : DrawOptions{20'000} {}
  std::vector<std::string> lanes;  // first, second, first, second, …
  LaneOptions subjects;
  std::vector<std::string> compare;
  int threads = 0, executor = 0;
  std::string campaign, out;
};

// What to compare: values, or verdicts for a user's code.
struct Comparisons {
  std::vector<analysis::LanesCompared> values;
  std::vector<analysis::TwoDeciders> verdicts;
  fuzz::SelectedLanes of_subjects;  // if the user named no lane: those of --subject, even if they do not run
};

// Returns the function that runs a lane of a user's code here.   Throws: UsageError if the lane does not run here.
DecideBlock on_host(const Lane& lane) {
  const fuzz::SelectedLanes selected = fuzz::select_lanes({lane.id});
  fuzz::expect_each_runs(selected);
  return selected.on_host.at(0);
}

// The subjects that the user named, and the campaign's subjects that have several lanes here.
std::vector<std::string> names_of_subjects(const DiscrepancyOptions& options) {
  std::vector<std::string> names = subject_names(options.subjects);
  if (options.campaign.empty()) return names;
  for (const fuzz::Json& row : recorded_spec_of(options.campaign).value("subjects", fuzz::Json::array())) {
    const std::string name = row.at("name");
    if (std::find(names.begin(), names.end(), name) == names.end() && subjects::opened(name) &&
        fuzz::select_lanes({name + "/*"}, options.subjects.executor).lanes.size() > 1)
      names.push_back(name);
  }
  return names;
}

// For each subject and scalar, pairs the first lane with the others.   Throws: UsageError for a subject with one lane.
Comparisons comparisons_of_subjects(const std::vector<std::string>& names, fuzz::Executor executor) {
  Comparisons comparisons;
  for (const std::string& name : names) {
    const std::size_t before = comparisons.verdicts.size();
    fuzz::SelectedLanes found = fuzz::select_lanes({name + "/*"}, executor);
    for (std::size_t l = 0; l < found.lanes.size(); ++l) {
      const Lane& lane = *found.lanes[l];
      const auto first = std::find_if(found.lanes.begin(), found.lanes.end(),
                                      [&](const Lane* other) { return other->scalar == lane.scalar; });
      if (*first != &lane) comparisons.verdicts.push_back({{*first, &lane}, {(*first)->decide, lane.decide}});
    }
    if (comparisons.verdicts.size() == before)
      throw UsageError(
          fmt::format("--subject {0}: only its lane {1} runs here; name the lanes to compare, such as {1} {2}", name,
                      found.lanes.front()->id, backends::exact_beside(*found.lanes.front()).id));
    say_left_out(found.left_out);
    fuzz::SelectedLanes& all = comparisons.of_subjects;
    all.asked.insert(all.asked.end(), found.asked.begin(), found.asked.end());
    all.left_out.insert(all.left_out.end(), found.left_out.begin(), found.left_out.end());
  }
  return comparisons;
}

// Returns the comparisons that the user named. If there are none, returns those of the subjects or, without subjects,
// for each algorithm and scalar those of `cpu` with both CUDA builds.
Comparisons comparisons_of(const DiscrepancyOptions& options) {
  if (const auto names = names_of_subjects(options); options.lanes.empty() && !names.empty())
    return comparisons_of_subjects(names, options.subjects.executor);
  expect_own_code_among(options.subjects, options.lanes, "LANE LANE");
  Comparisons comparisons;
  std::vector<analysis::LanesCompared>& lanes = comparisons.values;
  std::set<std::set<const Lane*>> named;
  if (options.lanes.size() % 2 != 0) throw UsageError("lanes are compared two at a time: name an even number of lanes");
  for (std::size_t i = 0; i < options.lanes.size(); i += 2) {
    const Lane *first = find_lane(options.lanes[i]), *second = find_lane(options.lanes[i + 1]);
    if (first && second && (first->foreign || second->foreign)) {
      if (first->scalar != second->scalar)
        throw UsageError(fmt::format("{} and {} cannot be compared: their scalars differ", first->id, second->id));
      comparisons.verdicts.push_back({{first, second}, {on_host(*first), on_host(*second)}});
    } else {
      lanes.emplace_back(published_lane(options.lanes[i]), published_lane(options.lanes[i + 1]));
    }
    if (!named.insert({first, second}).second)
      throw UsageError(fmt::format("{} and {} are named twice; name them once", first->id, second->id));
  }
  if (!options.lanes.empty()) return comparisons;
  for (const Variant second : {Variant::cuda_fma, Variant::cuda_nofma}) {
    for (const Lane& lane : published_lanes()) {
      if (lane.variant == Variant::cpu) lanes.emplace_back(lane, *counterpart(lane, second));
    }
  }
  return comparisons;
}

// Prefers two proper triangles, because an error is hard to see on a segment or a point. Then prefers the simpler pair.
bool shows_better(const AnyPair& l, const AnyPair& r) {
  const auto is_degenerate = [](const AnyPair& pair) {
    return fuzz::shape_name(visit(pair, [](const auto& own) { return relation_of(own).hulls; })) == "degenerate";
  };
  const bool of_l = is_degenerate(l), of_r = is_degenerate(r);
  return of_l != of_r ? of_r : is_simpler(l, r);
}

constexpr std::uint64_t kOriginPairs = 40'000;  // divided among the sources

// Finds where the values start to differ, for each comparison of a contracted CUDA lane with a lane that rounds every
// operation.
std::vector<std::optional<analysis::Origins>> origins_of(const analysis::DiscrepancySpec& spec) {
  std::vector<std::optional<analysis::Origins>> origins;
  for (const analysis::LanesCompared& lanes : spec.lanes) {
    const Lane* fused = analysis::fused_of(*lanes.first, *lanes.second);
    origins.emplace_back();
    if (fused && analysis::has_origins(*fused))
      origins.back() =
          analysis::origins(*fused, spec.sources, kOriginPairs / spec.sources.size(), spec.threads, is_simpler);
  }
  return origins;
}

// Reads a result of this verb. name: the file or its folder.
fuzz::Json results_of(const std::string& name) {
  const std::filesystem::path file = std::filesystem::is_directory(name)
                                         ? std::filesystem::path(name) / "discrepancy.json"
                                         : std::filesystem::path(name);
  const fuzz::Json found = reports::read_discrepancy(file);
  if (found.is_null()) throw std::runtime_error(cannot("read", file, "there is no such file"));
  return found;
}

std::set<std::string> strata_of(const fuzz::Json& result) {
  std::set<std::string> strata;
  for (const char* kind : {"lanes", "verdicts"}) {
    for (const fuzz::Json& of : result.value(kind, fuzz::Json::array())) {
      for (const auto& [id, counts] : of.at("strata").items()) strata.insert(id);
    }
  }
  return strata;
}

int compare(const std::vector<std::string>& names) {
  const fuzz::Json before = results_of(names[0]), after = results_of(names[1]);
  const auto expect_same = [&](const char* what, bool same) {
    if (!same)
      throw UsageError(fmt::format("{} and {} do not have the same pairs: their {} differ", names[0], names[1], what));
  };
  for (const char* spec : {"pairs", "seed", "scene"})
    expect_same(spec, before.value(spec, fuzz::Json()) == after.value(spec, fuzz::Json()));
  expect_same("strata", strata_of(before) == strata_of(after));
  fmt::print("{}", reports::discrepancy_changes(before, after, output_screen()));
  return 0;
}

constexpr const char* kFloat32Alone = "values of lanes in float are compared only on pairs of float32";

// Unless the user named the lanes, leaves out lanes whose values are not compared on doubles, and lists these lanes.
// Throws: UsageError if the user named a lane that takes only float32.
void keep_for_doubles(Comparisons& comparisons, bool named) {
  std::erase_if(comparisons.values, [&](const analysis::LanesCompared& lanes) {
    if (lanes.first->scalar == Scalar::f64) return false;
    if (named)
      throw UsageError(cannot("compare", lanes.first->id, fmt::format("{}; name lanes in double", kFloat32Alone)));
    std::vector<fuzz::LaneLeftOut>& left_out = comparisons.of_subjects.left_out;
    for (const Lane* lane : {lanes.first, lanes.second}) {
      if (std::none_of(left_out.begin(), left_out.end(), [&](const auto& row) { return row.id == lane->id; }))
        left_out.push_back({lane->id, kFloat32Alone});
    }
    return true;
  });
  if (!comparisons.values.empty()) say_left_out(comparisons.of_subjects.left_out);
  for (const analysis::TwoDeciders& deciders : comparisons.verdicts) {
    for (const Lane* lane : deciders.lanes) {
      if (!fuzz::takes(*lane, DoublePair{}))
        throw UsageError(cannot("compare", lane->id, "it takes only pairs of float32"));
    }
  }
}

int discrepancy(DiscrepancyOptions options) {
  options.subjects.executor = options.executor == kTwin ? fuzz::Executor::twin : fuzz::Executor::automatic;
  if (!options.compare.empty()) return compare(options.compare);
  open_subjects(options.subjects);
  if (!options.campaign.empty()) open_subjects_of(options.campaign, options.subjects.resubject);
  Comparisons comparisons = comparisons_of(options);
  analysis::DiscrepancySpec spec;
  std::uint64_t seed = options.seed;
  std::string scene;  // the scene's name in results
  std::string left_out;
  if (options.campaign.empty()) {
    fuzz::Json recorded;
    strata::SceneSources all = drawn(options, &recorded);
    spec.sources = std::move(all.sources);
    left_out = left_out_text(all.left_out);
    if (!recorded.is_null()) scene = recorded.at("name");
  } else {
    CampaignPairs of_campaign = pairs_of_campaign(options.campaign, options.pairs, "compare lanes on");
    spec.sources = std::move(of_campaign.sources);
    seed = of_campaign.seed;
    scene = of_campaign.scene;
  }
  const bool in_doubles = analysis::any_in_doubles(spec.sources);
  if (in_doubles) keep_for_doubles(comparisons, !options.lanes.empty());
  spec.lanes = comparisons.values;
  spec.threads = options.threads;
  std::string why_not;
  spec.on_device = options.executor != kTwin && cuda::open_device(why_not);
  if (options.executor == kDevice && !spec.on_device)
    throw std::runtime_error("cannot compare on a device: " + why_not);
  const std::string out = !options.out.empty()        ? options.out
                          : !options.campaign.empty() ? options.campaign
                                                      : "discrepancy";
  const ResultFolder folder(out, "discrepancy.json");
  const analysis::Discrepancies found = analysis::discrepancies(spec);
  const fuzz::Json values = reports::discrepancy_json(spec, found, origins_of(spec));

  fuzz::Json verdicts = fuzz::Json::array();
  std::optional<AnyPair> simplest;
  std::string next;
  for (const analysis::TwoDeciders& deciders : comparisons.verdicts) {
    const Lane &first = *deciders.lanes[0], &second = *deciders.lanes[1];
    std::optional<analysis::OperandsApart> operands;
    if (analysis::shows_operands(first, second))
      operands = analysis::operands_apart(second, spec.sources, kOriginPairs / spec.sources.size());
    const auto apart = analysis::verdicts_apart(deciders, spec.sources, options.threads, shows_better);
    verdicts.push_back(reports::verdicts_json(deciders, spec.sources, apart, operands ? &*operands : nullptr));
    for (std::size_t s = 0; s < apart.size() && scene.empty(); ++s) {
      if (!apart[s].simplest) continue;
      const strata::PairSource& source = spec.sources[s];
      const AnyPair pair = source.any_pair(apart[s].simplest->index);
      if (simplest && !shows_better(pair, *simplest)) continue;
      simplest = pair;
      next = fmt::format("Next: graze explain {}:{}:{} --lanes {},{}{}{}{}\n", source.id, source.seed,
                         apart[s].simplest->index, first.id, second.id, subject_words(first.lane_name().subject),
                         first.info == second.info ? "" : subject_words(second.lane_name().subject),
                         toolchain_words(options.subjects, {&first, &second}));
    }
  }

  const reports::Screen screen = output_screen();
  if (spec.lanes.size() <= kMostTables) fmt::print("{}", reports::discrepancy_tables(values, screen));
  if (spec.lanes.size() > 1) fmt::print("{}", reports::comparisons_table(values, screen));
  fmt::print("{}", left_out);
  fuzz::Json json = {{"pairs", analysis::pairs_in(spec.sources)}, {"seed", seed}};
  const fuzz::Json build = fuzz::build_info({});
  for (const char* key : {"version", "commit", "compiler", "cuda"}) json["build"][key] = build.at(key);
  if (!scene.empty()) json["scene"] = scene;
  if (in_doubles) {
    const bool all =
        std::all_of(spec.sources.begin(), spec.sources.end(), std::mem_fn(&strata::PairSource::in_doubles));
    json["coordinates"] = all ? "f64" : "both";
  }
  json.update(values);
  std::string csv = reports::discrepancy_csv(values);
  for (const fuzz::Json& of : verdicts) {
    fmt::print("{}", reports::verdicts_table(of, screen));
    csv += reports::verdicts_csv(of);
  }
  if (!verdicts.empty()) json["verdicts"] = verdicts;
  fuzz::add_left_out(json, comparisons.of_subjects);
  std::vector<std::string> foreign;
  for (const analysis::TwoDeciders& deciders : comparisons.verdicts) {
    for (const Lane* lane : deciders.lanes) foreign.push_back(lane->id);
  }
  if (const fuzz::Json code = reports::code_json(subjects::record(foreign)); !code.is_null()) json["subjects"] = code;
  print_wrapped(reports::discrepancy_answer(json));
  write_results(folder.path, {{"discrepancy.json", fuzz::sealed(json).dump(1) + "\n"},
                              {"discrepancy.csv", csv},
                              {"discrepancy.html", reports::discrepancy_page(json)}});
  fmt::print("Wrote {0}/discrepancy.html, {0}/discrepancy.json, {0}/discrepancy.csv\n",
             printable(folder.path.string()));
  if (!options.campaign.empty() && options.out.empty())
    next = fmt::format("Next: graze report {}\n", path_word(options.campaign));
  fmt::print("{}", next);
  return 0;
}

}  // namespace

void add_discrepancy(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "discrepancy", "Measure how much two lanes' values differ, and how often that changes a comparison's outcome");
  command->footer("Example: graze discrepancy moller_1997/f32/cpu moller_1997/f32/cuda-fma");
  const auto options = std::make_shared<DiscrepancyOptions>();
  add_valued(
      *command, "lanes", options->lanes, "LANE LANE",
      "Lanes to compare, two at a time. For your own code, only verdicts are compared. Between cuda-nofma and "
      "cuda-fma of a CUDA source, the operands of comparisons are compared too (default: the first lane of "
      "--subject with each of its other lanes; without --subject, cpu with cuda-fma and with cuda-nofma, for all "
      "algorithms)");
  add_valued(*command, "--compare", options->compare, "DIR DIR",
             "Compare two results of this verb on the same pairs, such as those of two drivers or GPUs")
      ->expected(2)
      ->excludes("lanes");
  add_subject_options(*command, options->subjects);
  add_resubject_option(*command, options->subjects);
  add_draw_options(*command, *options);
  add_valued(*command, "--campaign", options->campaign, "DIR",
             "Compare on the first pairs of this campaign; without --out, its report shows the results")
      ->excludes("--strata")
      ->excludes("--coordinates")
      ->excludes("--scene");
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole,
            "Number of pairs in total, shared evenly by the strata");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of the pairs");
  add_threads_option(*command, options->threads);
  add_valued(*command, "--executor", options->executor, "auto|device|twin",
             "Where values are compared. auto: on a device if there is one, else on the host with twins; the counts do "
             "not depend on this choice")
      ->transform(one_of({"auto", "device", "twin"}, Chosen::place));
  add_valued(*command, "--out", options->out, "DIR",
             "Folder for discrepancy.html, .json and .csv (default: the campaign's, else discrepancy)");
  for (const char* silenced : {"--strata", "--coordinates", "--scene", "--campaign", "--pairs", "--seed", "--threads",
                               "--executor", "--out", "--subject"})
    command->get_option("--compare")->excludes(silenced);
  command->get_option("--campaign")->excludes("--seed");
  run_drawing(*command, options, status, discrepancy);
}

}  // namespace graze::cli
