// SPDX-License-Identifier: Apache-2.0
// `graze discrepancy`: by how much the values behind the verdicts of two lanes differ.
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "cuda/lanes/device.h"
#include "fuzz/minimise/simplicity.h"
#include "fuzz/sealed.h"
#include "reports/discrepancy.h"
#include "reports/discrepancy_page.h"

namespace graze::cli {
namespace {

constexpr int kDevice = 1, kTwin = 2;   // of --executor
constexpr std::size_t kMostTables = 2;  // of more comparisons only the sentences are printed

struct DiscrepancyOptions {
  std::vector<std::string> lanes;  // first and second in turn
  std::vector<std::string> compare;
  std::vector<std::string> strata;
  std::uint64_t pairs = 20'000, seed = 1;
  int threads = 0, executor = 0;
  std::string scene, campaign, out;
};

// The pairs of lanes that the user named. By default `cpu` is compared with both CUDA builds, for each algorithm and
// scalar.
std::vector<analysis::LanesCompared> lanes_of(const DiscrepancyOptions& options) {
  std::vector<analysis::LanesCompared> lanes;
  if (options.lanes.size() % 2 != 0) throw UsageError("lanes are compared two by two: name an even number of them");
  for (std::size_t i = 0; i < options.lanes.size(); i += 2)
    lanes.emplace_back(published_lane(options.lanes[i]), published_lane(options.lanes[i + 1]));
  if (!lanes.empty()) return lanes;
  for (const Variant second : {Variant::cuda_fma, Variant::cuda_nofma}) {
    for (const Lane& lane : published_lanes()) {
      if (lane.variant == Variant::cpu) lanes.emplace_back(lane, *counterpart(lane, second));
    }
  }
  return lanes;
}

constexpr std::uint64_t kOriginPairs = 40'000;  // shared by the sources

// Finds where the values start to differ, for each comparison of a contracted CUDA lane with a lane that rounds every
// operation.
std::vector<std::optional<analysis::Origins>> origins_of(const analysis::DiscrepancySpec& spec) {
  const auto simpler = [](const Pair& l, const Pair& r) { return fuzz::simplicity(l) < fuzz::simplicity(r); };
  const auto is_rounded = [](const Lane& lane) { return info_of(lane.variant).arithmetic == Arithmetic::rounded; };
  std::vector<std::optional<analysis::Origins>> origins;
  for (const auto& [first, second] : spec.lanes) {
    const Lane* fused = is_rounded(*first) ? second : is_rounded(*second) ? first : nullptr;
    origins.emplace_back();
    if (fused && analysis::has_origins(*fused))
      origins.back() =
          analysis::origins(*fused, spec.sources, kOriginPairs / spec.sources.size(), spec.threads, simpler);
  }
  return origins;
}

// Reads a result of this verb. name: the file, or its folder.
fuzz::Json results_of(const std::string& name) {
  const std::filesystem::path file = std::filesystem::is_directory(name)
                                         ? std::filesystem::path(name) / "discrepancy.json"
                                         : std::filesystem::path(name);
  const fuzz::Json found = fuzz::read_sealed(file, "make it again");
  if (found.is_null()) throw std::runtime_error(cannot("read", file, "there is no such file"));
  reports::expect_possible_discrepancy(found);
  return found;
}

int compare(const std::vector<std::string>& names) {
  const fuzz::Json before = results_of(names[0]), after = results_of(names[1]);
  for (const char* spec : {"pairs", "seed"}) {
    if (before.at(spec) != after.at(spec))
      throw UsageError(fmt::format("{} and {} do not have the same pairs: their {} differ", names[0], names[1], spec));
  }
  fmt::print("{}", reports::discrepancy_changes(before, after, output_screen()));
  return 0;
}

int discrepancy(const DiscrepancyOptions& options) {
  if (!options.compare.empty()) return compare(options.compare);
  analysis::DiscrepancySpec spec;
  spec.lanes = lanes_of(options);
  std::uint64_t seed = options.seed;
  std::string left_out;
  if (options.campaign.empty()) {
    strata::SceneSources all = drawn(options.scene, seed, options.pairs, options.strata);
    spec.sources = std::move(all.sources);
    left_out = left_out_text(all.left_out);
  } else {
    CampaignPairs of_campaign = pairs_of_campaign(options.campaign, options.pairs, "compare lanes on");
    spec.sources = std::move(of_campaign.sources);
    seed = of_campaign.seed;
  }
  spec.threads = options.threads;
  std::string why_not;
  spec.on_device = options.executor != kTwin && cuda::open_device(why_not);
  if (options.executor == kDevice && !spec.on_device)
    throw std::runtime_error("cannot compare on a device: " + why_not);
  const std::string out = !options.out.empty()        ? options.out
                          : !options.campaign.empty() ? options.campaign
                                                      : "discrepancy";
  const ResultFolder folder(out, "discrepancy.json");
  const reports::DiscrepancyResults found{spec, analysis::discrepancies(spec), origins_of(spec)};

  const reports::Screen screen = output_screen();
  if (spec.lanes.size() <= kMostTables) fmt::print("{}", reports::discrepancy_tables(found, screen));
  for (const std::string& sentence : reports::discrepancy_sentences(found))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("{}", left_out);
  std::uint64_t pairs = 0;
  for (const strata::PairSource& source : spec.sources) pairs += source.pairs;
  nlohmann::ordered_json json = {{"pairs", pairs}, {"seed", seed}};
  if (!options.scene.empty()) json["scene"] = options.scene;
  json.update(reports::discrepancy_json(found));
  for (const std::string& sentence : reports::discrepancy_answer(json))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  write_results(folder.path, {{"discrepancy.json", fuzz::sealed(json).dump(1) + "\n"},
                              {"discrepancy.csv", reports::discrepancy_csv(found)},
                              {"discrepancy.html", reports::discrepancy_page(json)}});
  fmt::print("Wrote {0}/discrepancy.html, {0}/discrepancy.json, {0}/discrepancy.csv\n", folder.path.string());
  if (!options.campaign.empty()) fmt::print("Next: graze report {}\n", path_word(options.campaign));
  return 0;
}

}  // namespace

void add_discrepancy(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "discrepancy", "Count by how much the values of two lanes differ, and when that decides a comparison");
  command->footer("Example: graze discrepancy moller_1997/f32/cpu moller_1997/f32/cuda-fma");
  const auto options = std::make_shared<DiscrepancyOptions>();
  command
      ->add_option("lanes", options->lanes,
                   "Lanes to compare, two by two (default: cpu with cuda-fma and with cuda-nofma, of all algorithms)")
      ->option_text("LANE LANE");
  command
      ->add_option("--compare", options->compare,
                   "Compare two results of this verb on the same pairs, such as those of two drivers or GPUs")
      ->expected(2)
      ->excludes("lanes")
      ->option_text("DIR DIR");
  add_globs(*command, "--strata", options->strata, "Patterns of the strata to draw from");
  add_scene_option(*command, options->scene);
  command
      ->add_option("--campaign", options->campaign,
                   "Compare on the first pairs of this campaign; its report shows the results then")
      ->check(not_empty())
      ->excludes("--strata")
      ->excludes("--scene")
      ->option_text("DIR");
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole,
            "Number of pairs in total, shared evenly by the strata");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of the pairs");
  add_threads_option(*command, options->threads);
  command
      ->add_option(
          "--executor", options->executor,
          "Where values are compared. auto: on a device if there is one, else on the host by twins; the counts "
          "are the same")
      ->transform(one_of({"auto", "device", "twin"}, Chosen::place))
      ->option_text("auto|device|twin");
  command
      ->add_option("--out", options->out,
                   "Folder for discrepancy.html, .json and .csv (default: the campaign's, else discrepancy)")
      ->check(not_empty())
      ->option_text("DIR");
  for (const char* silenced :
       {"--strata", "--scene", "--campaign", "--pairs", "--seed", "--threads", "--executor", "--out"})
    command->get_option("--compare")->excludes(silenced);
  command->get_option("--campaign")->excludes("--seed");
  command->callback([options, &status] { status = discrepancy(*options); });
}

}  // namespace graze::cli
