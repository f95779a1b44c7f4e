// SPDX-License-Identifier: Apache-2.0
// `graze hunt`: starts or resumes a guided search for pairs on which lanes are wrong.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <optional>

#include "cli/fuzz.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/text.h"
#include "fuzz/files.h"
#include "fuzz/hunt/hunt.h"
#include "fuzz/hunt/round.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "strata/scene/envelope.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

struct HuntOptions : DrawOptions {
  std::uint64_t minutes = 0;
  int threads = 0;
  std::string out = "hunt";
  LaneOptions lanes;
  fuzz::Shard shard;
  bool json = false;
};

std::vector<std::string> details(const fuzz::HuntProgress& progress) {
  const double rate = static_cast<double>(progress.done_here) / std::max(progress.seconds, 1e-9);
  return {reports::grouped(static_cast<std::uint64_t>(rate)) + " pairs/s",
          fmt::format("{} kinds, {} of them new, the last {} ago", reports::grouped(progress.kinds),
                      reports::grouped(progress.new_kinds), duration(progress.seconds_since_kind)),
          reports::grouped(progress.signatures) + " signatures",
          reports::grouped(progress.units) + " pairs in the corpus"};
}

void print_mutations(const std::filesystem::path& directory) {
  const Json told = Json::parse(fuzz::read_whole(directory / "hunt.json"));
  reports::TextTable table(
      {{"mutation", reports::Align::left}, {"pairs"}, {"some lane is wrong"}, {"new in its round"}, {"new kinds"}});
  for (const Json& row : told.at("mutations")) {
    const auto count = [&](const char* what) { return reports::grouped(row.at(what).get<std::uint64_t>()); };
    table.add({row.at("mutation").get<std::string>(), count("pairs"), count("disagreements"), count("units"),
               count("kinds")});
  }
  fmt::print("\n{}\nThe guided search kept {} pairs to continue from, and met at least {} kinds of failure.\n",
             table.text(output_screen()), reports::grouped(told.at("units").get<std::uint64_t>()),
             reports::grouped(told.at("kinds").size()));
}

int hunt(const HuntOptions& options) {
  if (!fuzz::has_libfuzzer()) {
    throw std::runtime_error(
        "graze hunt is not in this build, because clang's libFuzzer was not found; install libclang-rt-14-dev and "
        "build again");
  }
  LaneOptions lanes = options.lanes;
  lanes.executor = fuzz::Executor::twin;
  fuzz::SelectedLanes under_test = selected_lanes(lanes);
  if (options.coordinates == PairTypes::f64) take_doubles(under_test);
  fuzz::Hunt hunt;
  hunt.pairs = options.pairs;
  hunt.seconds = 60 * static_cast<double>(options.minutes);
  hunt.campaign.seed = options.seed;
  hunt.campaign.under_test = &under_test;
  hunt.campaign.threads = options.threads;
  hunt.campaign.directory = options.out;
  hunt.campaign.shard = options.shard;
  Json scene_spec;
  strata::SceneSources drawn = cli::drawn(options, &scene_spec);
  hunt.drawn.sources = std::move(drawn.sources);
  std::optional<strata::Scene> scene;
  if (!options.scene.empty()) {
    hunt.drawn.scene = &scene.emplace(
        strata::resolved(strata::with_type(strata::read_scene(options.scene), options.coordinates == PairTypes::f64)));
  }
  hunt.campaign.spec = fuzz::hunt_spec(hunt);
  if (!scene_spec.is_null()) hunt.campaign.spec["scene"] = scene_spec;
  if (const Json subjects = subjects::record(hunt.campaign.spec["lanes"].get<std::vector<std::string>>());
      !subjects.is_null())
    hunt.campaign.spec["subjects"] = subjects;
  hunt.campaign.build = fuzz::build_info(under_test);
  expect_campaign_folder(options.out);

  const std::atomic<bool>& interrupted = catch_interrupts();
  const bool on_terminal = isatty(STDERR_FILENO);
  std::optional<Progress> live;
  const auto [complete, summary, oracle] = fuzz::run_hunt(hunt, interrupted, [&](const fuzz::HuntProgress& progress) {
    if (!on_terminal) return;
    if (!live) live.emplace("pairs", progress.total, on_terminal, error_screen());
    const double each = progress.seconds / static_cast<double>(std::max<std::uint64_t>(progress.done_here, 1));
    if (const auto line = live->line(progress.done, progress.seconds,
                                     each * static_cast<double>(progress.total - progress.done), details(progress)))
      fmt::print(stderr, "{}", *line);
  });
  if (live) fmt::print(stderr, "{}", live->end());
  if (!complete) {
    fmt::print(stderr, "graze: {}; finished work is kept, and the same command resumes the hunt\n",
               interrupted ? "interrupted" : "the time limit is reached");
    if (interrupted) return kInterrupted;
  }
  if (!options.shard.whole()) {
    if (complete || options.json) print_shard(options.out, hunt.campaign.spec, summary, options.json);
    return 0;
  }
  if (options.json) {
    std::cout << summary.dump(1) << '\n';
    return 0;
  }
  reports::print_summary(std::cout, summary, oracle, output_screen());
  std::cout << left_out_text(drawn.left_out) << not_covered_text(hunt.campaign.spec) << std::flush;
  print_mutations(options.out);
  fmt::print("\nWrote {0}/summary.json, {0}/hunt.json, {0}/cases/, {0}/timings.json, {0}/campaign.sqlite, {0}/hunt/\n",
             printable(options.out));
  if (!summary["signatures"].empty()) fmt::print("Next: graze minimize {}\n", path_word(options.out));
  return 0;
}

}  // namespace

void add_hunt(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("hunt",
                                         "Search for failures, or resume a search: mutate pairs, guided by what the "
                                         "lanes compute");
  command->footer("Example: graze hunt --runs 1000000 --seed 1 --lanes 'moller*' --out hunt");
  auto options = std::make_shared<HuntOptions>();
  add_count(*command, "--runs", options->pairs, 1, kMostWhole, "Number of pairs in total");
  add_valued(*command, "--minutes", options->minutes, "MINUTES",
             "Time limit in minutes, after which the same command resumes the search; 0 means none")
      ->transform(whole_number(0, 1'000'000))
      ->capture_default_str();
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of the search");
  add_count(*command, "--threads", options->threads, 0, kMostThreads,
            "Number of simultaneous rounds, at most four, which does not affect results; 0 means one per core");
  add_valued(*command, "--out", options->out, "DIR", "Directory of the search; an unfinished search in it is resumed")
      ->capture_default_str();
  add_shard_option(
      *command, options->shard,
      "Part of the search to run: the K-th of N, with its share of the runs, in its own directory. `graze merge` "
      "joins the parts by kind of failure");
  add_draw_options(*command, *options, OfBothTypes::no);
  command->get_option("--strata")->description("Patterns of the strata to start from");
  add_lane_options(*command, options->lanes, Executors::twins);
  command->add_flag("--json", options->json, "Print the summary as JSON");
  run_drawing(*command, options, status, hunt);
}

}  // namespace graze::cli
