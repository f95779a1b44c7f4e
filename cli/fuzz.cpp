// SPDX-License-Identifier: Apache-2.0
// `graze fuzz`: runs or resumes a campaign.
#include <fmt/format.h>
#include <sys/sysinfo.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "analysis/signature.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/fuzz.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/text.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/scratch.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimised_cases.h"
#include "fuzz/ranks/rank_campaign.h"
#include "reports/junit.h"
#include "reports/report.h"
#include "reports/terminal.h"
#include "strata/mesh.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

constexpr std::size_t kMostShrunk = 8;  // signatures that are minimised to find a subject's smallest case

// Further parts of the live line, shown if there is room.
std::vector<std::string> details(const fuzz::Progress& progress, const std::vector<strata::PairSource>& sources) {
  const double rate = static_cast<double>(progress.done_here) / std::max(progress.seconds, 1e-9);
  const auto& yields = progress.disagreements_of_source;
  const auto best = static_cast<std::size_t>(std::max_element(yields.begin(), yields.end()) - yields.begin());
  return {reports::grouped(progress.disagreements) + " disagreements",
          reports::grouped(progress.signatures) + " signatures",
          reports::grouped(static_cast<std::uint64_t>(rate)) + " pairs/s", "most in " + sources[best].id};
}

// Finds the subject's smallest case. Minimises, as `graze minimize` would, the kMostShrunk signatures whose first kept
// pair is simplest. Returns the simplest result and its file; among equal results, the one from the simpler kept pair.
std::pair<std::string, std::filesystem::path> smallest_case(const std::filesystem::path& campaign,
                                                            const fuzz::SelectedLanes& under_test, const Json& summary,
                                                            const std::string& subject) {
  std::vector<std::pair<Simplicity, std::filesystem::path>> kept;
  for (const Json& row : summary["signatures"]) {
    const auto signature = analysis::parse_signature(row["key"].get<std::string>());
    if (!signature || signature->subject != subject) continue;
    const std::vector<corpus::Entry> entries = fuzz::checked_cases(under_test, summary["spec"], campaign, row);
    kept.emplace_back(simplicity(corpus::pair_of(entries[0])), fuzz::case_file(campaign, row));
  }
  std::sort(kept.begin(), kept.end());
  if (kept.size() > kMostShrunk) kept.resize(kMostShrunk);
  std::optional<Simplicity> least;
  std::pair<std::string, std::filesystem::path> smallest;
  const auto take = [&](const AnyPair& pair, const std::filesystem::path& file) {
    const Simplicity how = simplicity(pair);
    if (least && how >= *least) return;
    least = how;
    smallest = {fuzz::pair_text(pair), file};
  };
  for (const auto& [how, file] : kept) {
    const std::vector<corpus::Entry> entries = corpus::read_pairs(file, PairTypes::both);
    const std::vector<fuzz::MinimisedCase> results = fuzz::minimise_file(under_test, file, entries);
    if (results.empty()) take(corpus::pair_of(entries[0]), file);
    for (const fuzz::MinimisedCase& result : results) take(result.result.pair, file);
  }
  return smallest;
}

// Prints one line for each given subject that is wrong on more pairs than allowed or, if no subject is given, for each
// such algorithm. The line names the simplest minimised case.
// Returns: the exit status.
int fail_above(const FuzzOptions& options, const fuzz::SelectedLanes& under_test, const Json& summary) {
  std::map<std::string, std::uint64_t> wrong;
  for (const Json& row : summary["signatures"]) {
    const auto signature = analysis::parse_signature(row["key"].get<std::string>());
    if (signature) wrong[signature->subject] += row["count"].get<std::uint64_t>();
  }
  int status = 0;
  for (const auto& [subject, count] : wrong) {
    const auto names_it = [&, &id = subject](const std::string& text) { return text.starts_with(id + '='); };
    const auto& given = options.lanes.subjects;
    if (count <= *options.fail_above || (!given.empty() && std::none_of(given.begin(), given.end(), names_it)))
      continue;
    const auto [pair, file] = smallest_case(options.out, under_test, summary, subject);
    fmt::print(stderr,
               "graze: {} is wrong on {} pairs, above the limit {} of --fail-above; the smallest is {}; to replay it: "
               "graze repro {}\n",
               subject, reports::grouped(count), reports::grouped(*options.fail_above), pair, path_word(file.string()));
    status = 1;
  }
  return status;
}

// Runs one of the processes that mpirun started.   Returns: the exit status.
int on_ranks(const FuzzOptions& options, fuzz::Campaign& campaign, const std::vector<strata::LeftOut>& left_out,
             fuzz::Ranks& ranks) {
  // If mpirun bound the ranks to cores, each rank already sees fewer cores than the machine has.
  const int cores = tbb::info::default_concurrency();
  if (campaign.threads == 0 && cores == get_nprocs()) campaign.threads = std::max(1, cores / ranks.local_size);
  const std::optional<fuzz::Outcome> outcome = fuzz::run_on_ranks(campaign, ranks, catch_interrupts());
  if (outcome) print_campaign(options.out, *outcome, options.json, left_out);
  const bool complete = ranks.from_root(outcome ? "complete" : "") == "complete";
  if (!complete && ranks.rank == 0)
    fmt::print(stderr, "graze: interrupted; finished work is kept, and the same command resumes the campaign\n");
  return complete ? 0 : kInterrupted;
}

}  // namespace

fuzz::SelectedLanes lanes_of_campaign(const FuzzOptions& options) {
  LaneOptions lanes = options.lanes;
  if (!lanes.subjects.empty()) lanes.globs = fuzz::with_exact_lane(std::move(lanes.globs));
  fuzz::SelectedLanes under_test = selected_lanes(lanes, {}, options.require_device);
  if (options.coordinates != PairTypes::f32) take_doubles(under_test);
  return under_test;
}

fuzz::Campaign campaign_of(const FuzzOptions& options, const fuzz::SelectedLanes& under_test,
                           std::vector<strata::LeftOut>& left_out) {
  fuzz::Campaign campaign;
  campaign.seed = options.seed;
  campaign.under_test = &under_test;
  campaign.threads = options.threads;
  campaign.directory = options.out;
  campaign.shard = options.shard;
  if (!options.scratch.empty()) campaign.scratch = fuzz::scratch_of(options.scratch, options.out);
  Json scene_spec;
  if (options.mesh.empty() || !options.strata.empty()) {  // with a mesh, strata are used only if the user asks for them
    strata::SceneSources drawn = cli::drawn(options, &scene_spec);
    say_notes(drawn.notes, drawn.rounding, options.exact_input);
    campaign.sources = std::move(drawn.sources);
    left_out = std::move(drawn.left_out);
  }
  Json mesh_spec;
  if (!options.mesh.empty()) {
    for (const std::string& file : options.mesh) expect_utf8("--mesh", file);
    const auto mesh = std::make_shared<strata::MeshPairs>(
        strata::read_bodies(std::vector<std::filesystem::path>(options.mesh.begin(), options.mesh.end())));
    const bool rounds = options.coordinates != PairTypes::f64 || options.exact_input;
    say_notes(rounds ? mesh->notes : mesh->notes_of_doubles, mesh->rounding, options.exact_input);
    for (strata::PairSource& source : strata::mesh_sources(mesh, options.coordinates))
      campaign.sources.push_back(std::move(source));
    mesh_spec = {{"files", options.mesh}, {"content", fmt::format("{:016x}", mesh->content_hash)}};
  }
  campaign.spec = fuzz::campaign_spec(campaign);
  if (!scene_spec.is_null()) campaign.spec["scene"] = scene_spec;
  if (!mesh_spec.is_null()) campaign.spec["mesh"] = mesh_spec;
  if (const Json subjects = subjects::record(campaign.spec["lanes"].get<std::vector<std::string>>());
      !subjects.is_null())
    campaign.spec["subjects"] = subjects;
  campaign.build = fuzz::build_info(under_test);
  campaign.engines = fuzz::choose_engines(campaign, options.engine);
  if (options.by_exact_lane) campaign.exact = find_lane(fuzz::kExactDoubles)->decide;
  return campaign;
}

void write_junit(const FuzzOptions& options, const fuzz::SelectedLanes& under_test, const Json& summary) {
  if (options.junit.empty()) return;
  const auto tests = reports::junit_of_campaign(options.out, summary, under_test.left_out);
  write_result(options.junit, reports::junit(tests), fuzz::NamedBy::user);
}

fuzz::Outcome run_with_progress(const fuzz::Campaign& campaign) {
  const bool on_terminal = isatty(STDERR_FILENO);
  std::optional<Progress> live;
  fuzz::Outcome outcome = fuzz::run_campaign(campaign, catch_interrupts(), [&](const fuzz::Progress& progress) {
    if (!on_terminal) return;
    if (!live) live.emplace("pairs", progress.total, on_terminal, error_screen());
    const auto line =
        live->line(progress.done, progress.seconds, progress.seconds_left, details(progress, campaign.sources));
    if (line) fmt::print(stderr, "{}", *line);
  });
  if (live) fmt::print(stderr, "{}", live->end());
  return outcome;
}

namespace {

int fuzz(const FuzzOptions& options, fuzz::Ranks* ranks) {
  const fuzz::SelectedLanes under_test = lanes_of_campaign(options);
  std::vector<strata::LeftOut> left_out;
  fuzz::Campaign campaign = campaign_of(options, under_test, left_out);
  expect_campaign_folder(options.out);
  if (!options.junit.empty()) expect_replaceable(options.junit, reports::junit({}));
  catch_interrupts();
  if (options.discard_damaged) {
    if (!campaign.scratch.empty()) fuzz::fetch_from_directory(campaign);
    if (const auto kept = fuzz::discard_damaged(fuzz::store_spec(campaign)))
      fmt::print(stderr, "graze: kept {} in {} batch{} whose checksum is correct; the damaged database is now {}\n",
                 reports::counted(kept->pairs, "pair"), reports::grouped(kept->batches), kept->batches == 1 ? "" : "es",
                 printable(kept->damaged.string()));
  }
  if (ranks) return on_ranks(options, campaign, left_out, *ranks);
  const fuzz::Outcome outcome = run_with_progress(campaign);
  if (!outcome.complete) {
    if (campaign.shard.whole())
      fuzz::write_whole(campaign.directory / "margins.svg", reports::margin_figure(outcome.summary));
    fmt::print(stderr, "graze: interrupted; finished work is kept, and the same command resumes the campaign\n");
    return kInterrupted;
  }
  // Foreign code can also write into the folder, so the files are read back before the results are reported.
  const bool foreign = campaign.spec.contains("subjects");
  if (foreign && campaign.shard.whole()) {
    fuzz::checked_summary(options.out);
  } else if (foreign) {
    fuzz::StoreSpec spec = fuzz::store_spec(campaign);
    spec.directory = options.out;
    fuzz::for_each_row(spec, [](const fuzz::PairRange&, const fuzz::StoredCounts&) {});
  }
  if (!campaign.shard.whole()) {
    print_shard(options.out, campaign.spec, outcome.summary, options.json);
    return 0;
  }
  print_campaign(options.out, outcome, options.json, left_out);
  std::cout.flush();
  write_junit(options, under_test, outcome.summary);
  return options.fail_above ? fail_above(options, under_test, outcome.summary) : 0;
}

// Runs alone, or as one of mpirun's processes. Under mpirun, a process that fails ends all of them.
int start(const FuzzOptions& options) {
  if (!options.junit.empty() && !options.shard.whole())
    throw UsageError("--junit is for whole campaigns; a shard has only a part of the pairs");
  if (!options.scratch.empty() && options.shard.whole())
    throw UsageError("--scratch is only for shards; add --shard K/N");
  if (!fuzz::started_by_mpirun()) return fuzz(options, nullptr);
  if (!options.shard.whole() || options.fail_above || options.discard_damaged || !options.junit.empty())
    throw UsageError("--shard, --fail-above, --junit and --discard-damaged do not work under mpirun; leave them out");
  const std::unique_ptr<fuzz::Ranks> ranks = fuzz::open_ranks();
  fuzz::take_one_device(ranks->local_rank);
  try {
    return fuzz(options, ranks.get());
  } catch (const std::exception& error) {
    // An error that all ranks find is reported only once, because the root aborts first.
    if (ranks->rank != 0) std::this_thread::sleep_for(std::chrono::seconds(1));
    fmt::print(stderr, "graze: {}\n", error.what());
    ranks->abort(1);
    return 1;
  }
}

}  // namespace

void print_shard(const std::string& out, const Json& spec, const Json& summary, bool json) {
  if (json) {
    std::cout << summary.dump(1) << '\n';
    return;
  }
  std::cout << fmt::format(
      "Shard {}: {}, {}, {}\nWrote {}/campaign.sqlite\n"
      "Next, when all shards are done: graze merge DIR… --out campaign\n",
      summary["shard"].get<std::string>(), reports::counted(summary["pairs"], "pair"),
      reports::counted(summary["disagreements"], "disagreement"), reports::counted(summary["signatures"], "signature"),
      printable(out));
  std::cout << not_covered_text(spec);
}

std::string not_covered_text(const Json& spec) {
  std::string text;
  for (const Json& subject : spec.value("subjects", Json::array())) {
    if (subject.contains("not_covered"))
      text += fmt::format("{}: Graze does not notice changes to {}.\n", subject["name"].get<std::string>(),
                          subject["not_covered"].get<std::string>());
  }
  return text;
}

void print_campaign(const std::string& out, const fuzz::Outcome& outcome, bool json,
                    const std::vector<strata::LeftOut>& left_out) {
  const Json& summary = outcome.summary;
  fuzz::write_whole(std::filesystem::path(out) / "margins.svg", reports::margin_figure(summary));
  if (json) {
    std::cout << summary.dump(1) << '\n';
    return;
  }
  reports::print_summary(std::cout, summary, outcome.oracle, output_screen());
  std::cout << left_out_text(left_out) << not_covered_text(summary["spec"]);
  std::cout << fmt::format(
      "\nWrote {0}/summary.json, {0}/margins.svg, {0}/cases/, {0}/timings.json, {0}/campaign.sqlite\n", printable(out));
  if (summary["signatures"].empty()) return;
  const std::string first = out + '/' + summary["signatures"][0]["case"].get<std::string>();
  std::cout << fmt::format("To replay the commonest disagreement: graze repro {}\n", path_word(first));
  std::cout << fmt::format("Next: graze minimize {}\n", path_word(out));
}

void add_fuzz(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "fuzz", "Run or resume a campaign: draw pairs, run every lane on them, and compare with the exact truth");
  command->footer("Example: graze fuzz --pairs 1M --strata 'near_*,coplanar_*' --out campaign");
  auto options = std::make_shared<FuzzOptions>();
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole,
            "Number of pairs in total, shared evenly by the strata; a mesh adds all its pairs");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of all strata");
  add_threads_option(*command, options->threads);
  add_valued(*command, "--out", options->out, "DIR",
             "Campaign directory; an unfinished campaign in it is resumed; the last --out counts")
      ->take_last()
      ->capture_default_str();
  add_shard_option(
      *command, options->shard,
      "Part of the campaign to run: the K-th of N, in its own directory. `graze merge` joins the parts; the "
      "result is the same as without shards");
  add_valued(*command, "--scratch", options->scratch, "DIR",
             "Folder on a local disk for a shard's database while it runs; it is then copied to --out");
  add_draw_options(*command, *options);
  add_lane_options(*command, options->lanes);
  add_valued(
      *command, "--mesh", options->mesh, "FILE [FILE2]",
      "Mesh, or two meshes, whose triangles are paired where their boxes overlap. Strata are drawn as well only if "
      "--strata is given")
      ->expected(1, 2)
      ->excludes("--scene");
  add_exact_input(*command, options->exact_input)->needs("--mesh");
  static_assert(static_cast<int>(fuzz::EngineChoice::automatic) == 0 &&
                static_cast<int>(fuzz::EngineChoice::cpu) == 1 && static_cast<int>(fuzz::EngineChoice::gpu) == 2);
  add_valued(*command, "--engine", options->engine, "auto|cpu|gpu",
             "Engine that judges the pairs. cpu: see --judge; gpu: runs every step on the device; only for CUDA lanes. "
             "auto: gpu where possible. The engine does not affect results")
      ->transform(one_of({"auto", "cpu", "gpu"}, Chosen::place))
      ->default_str("auto");
  add_valued(*command, "--judge", options->by_exact_lane, "oracle|exact",
             "Ground truth of the CPU engine. oracle: CGAL decides every pair, GMP confirms every disagreement; exact: "
             "the exact lane decides, CGAL and GMP confirm one pair in 1,000 and every kept case. "
             "The choice does not affect results")
      ->transform(one_of({"oracle", "exact"}, Chosen::place))
      ->default_str("oracle");
  command->add_flag("--discard-damaged", options->discard_damaged,
                    "Resume a damaged campaign; batches whose checksum fails are run again");
  add_valued(
      *command, "--fail-above", options->fail_above, "N",
      "Number of wrong pairs above which the exit status is 1. Pairs on which some build is wrong are counted for "
      "each subject of --subject, or else for each algorithm. Standard error then shows the simplest minimised "
      "case")
      ->transform(whole_number(0, kMostWhole))
      ->excludes("--shard");
  command->add_flag("--json", options->json, "Print the summary as JSON");
  add_junit(*command, options->junit, "one test for each lane and stratum");
  command->add_flag("--require-device", options->require_device, "Fail if there is no CUDA device");
  run_drawing(*command, options, status, start);
}

}  // namespace graze::cli
