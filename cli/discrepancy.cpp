// SPDX-License-Identifier: Apache-2.0
// `graze discrepancy`: by how much the values behind the verdicts of two lanes differ.
#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "cuda/lanes/device.h"
#include "fuzz/minimise/simplicity.h"
#include "reports/discrepancy.h"
#include "reports/discrepancy_page.h"

namespace graze::cli {
namespace {

constexpr int kDevice = 1, kTwin = 2;  // of --executor

struct DiscrepancyOptions {
  std::vector<std::string> lanes;  // first and second in turn
  std::vector<std::string> strata;
  std::uint64_t pairs = 20'000, seed = 1;
  int threads = 0, executor = 0;
  std::string scene, out = "discrepancy";
};

const Lane& lane_of(const std::string& id) {
  const Lane* lane = find_lane(id);
  if (!lane) throw UsageError("there is no lane " + id + "; `graze lanes` lists them");
  return *lane;
}

// Those that the user named; without any, `cpu` against both CUDA builds of each algorithm and scalar.
std::vector<analysis::LanesCompared> lanes_of(const DiscrepancyOptions& options) {
  std::vector<analysis::LanesCompared> lanes;
  if (options.lanes.size() % 2 != 0) throw UsageError("lanes are compared two by two: name an even number of them");
  for (std::size_t i = 0; i < options.lanes.size(); i += 2)
    lanes.emplace_back(lane_of(options.lanes[i]), lane_of(options.lanes[i + 1]));
  if (!lanes.empty()) return lanes;
  for (const Variant second : {Variant::cuda_fma, Variant::cuda_nofma}) {
    for (const Lane& lane : published_lanes()) {
      if (lane.variant == Variant::cpu) lanes.emplace_back(lane, *counterpart(lane, second));
    }
  }
  return lanes;
}

constexpr std::uint64_t kOriginPairs = 2000;  // of each source

// Where the values start to differ, of each comparison of a contracted CUDA lane with one that rounds every operation.
std::vector<std::optional<analysis::Origins>> origins_of(const analysis::DiscrepancySpec& spec) {
  const auto simpler = [](const Pair& l, const Pair& r) { return fuzz::simplicity(l) < fuzz::simplicity(r); };
  const auto is_rounded = [](const Lane& lane) { return info_of(lane.variant).arithmetic == Arithmetic::rounded; };
  std::vector<std::optional<analysis::Origins>> origins;
  for (const auto& [first, second] : spec.lanes) {
    const Lane* fused = is_rounded(*first) ? second : is_rounded(*second) ? first : nullptr;
    origins.emplace_back();
    if (fused && analysis::has_origins(*fused))
      origins.back() = analysis::origins(*fused, spec.sources, kOriginPairs, spec.threads, simpler);
  }
  return origins;
}

int discrepancy(const DiscrepancyOptions& options) {
  analysis::DiscrepancySpec spec;
  spec.lanes = lanes_of(options);
  strata::SceneSources all = drawn(options.scene, options.seed, options.pairs, options.strata);
  spec.sources = std::move(all.sources);
  spec.threads = options.threads;
  std::string why_not;
  spec.on_device = options.executor != kTwin && cuda::open_device(why_not);
  if (options.executor == kDevice && !spec.on_device)
    throw std::runtime_error("cannot compare on a device: " + why_not);
  const ResultFolder folder(options.out, "discrepancy.json");
  const reports::DiscrepancyResults found{spec, analysis::discrepancies(spec), origins_of(spec)};

  const reports::Screen screen = output_screen();
  fmt::print("{}", reports::discrepancy_tables(found, screen));
  for (const std::string& sentence : reports::discrepancy_sentences(found))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  fmt::print("{}", left_out_text(all.left_out));
  nlohmann::ordered_json json = {{"pairs", options.pairs}, {"seed", options.seed}};
  if (!options.scene.empty()) json["scene"] = options.scene;
  json.update(reports::discrepancy_json(found));
  for (const std::string& sentence : reports::discrepancy_answer(json))
    fmt::print("{}", reports::wrapped(sentence, screen.columns));
  write_results(folder.path, {{"discrepancy.json", json.dump(1) + "\n"},
                              {"discrepancy.csv", reports::discrepancy_csv(found)},
                              {"discrepancy.html", reports::discrepancy_page(json)}});
  fmt::print("Wrote {0}/discrepancy.html, {0}/discrepancy.json, {0}/discrepancy.csv\n", folder.path.string());
  return 0;
}

}  // namespace

void add_discrepancy(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "discrepancy", "Count by how much the values of two lanes differ, and when that decides a comparison");
  command->footer(
      "Example: graze discrepancy interval_overlap/f32/cpu interval_overlap/f32/cuda-fma --strata thesis --pairs 1e5");
  const auto options = std::make_shared<DiscrepancyOptions>();
  command
      ->add_option("lanes", options->lanes,
                   "Lanes to compare, two by two (default: cpu with cuda-fma and with cuda-nofma, of all algorithms)")
      ->option_text("LANE LANE");
  add_globs(*command, "--strata", options->strata, "Patterns of the strata to draw from");
  add_scene_option(*command, options->scene);
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
  command->add_option("--out", options->out, "Folder for discrepancy.json and discrepancy.csv")
      ->check(not_empty())
      ->capture_default_str()
      ->option_text("DIR");
  command->callback([options, &status] { status = discrepancy(*options); });
}

}  // namespace graze::cli
