// SPDX-License-Identifier: Apache-2.0
// `graze try`: from a source file to the answer. The verb builds the code as a subject, runs a campaign, minimises the
// failures that matter most, and prints one screen. The output folder is a campaign directory, which all other verbs
// accept.
#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>

#include "analysis/over_threads.h"
#include "cli/commands.h"
#include "cli/emit.h"
#include "cli/fuzz.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "cli/tried_code.h"
#include "cli/try_answer.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/programs/run_program.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimised_cases.h"
#include "fuzz/own_files.h"
#include "reports/junit.h"
#include "reports/own_code.h"
#include "reports/report.h"
#include "strata/mesh.h"
#include "subjects/source_build.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTold = 3;  // failures on the screen
// Number of signatures to minimise for each kind of failure, in compiled code and in a program. Signatures with the
// simplest pairs come first.
constexpr std::size_t kMostOfKind = 4, kMostOfProgram = 1;
constexpr int kThreadsForPrograms = 4;          // for each core, because Graze mostly waits for the answers
constexpr std::uint64_t kPairsOfCode = 40'000;  // for compiled code
constexpr double kProgramsTimeout = 10;         // seconds; a program may take some to start
constexpr const char* kOut = "try";

struct TryOptions {
  std::string source, where;
  std::uint64_t pairs = 0;  // 0: the default for the kind of code
  double timeout = 0;       // seconds; 0: the default for the kind of code
  bool names_coordinates = false;
  FuzzOptions fuzz;
  bool json = false;
};

// Returns the folder's name without a trailing /, so that other names can be derived from it.
std::string folder_named(const std::string& out) {
  fs::path folder = fs::path(out).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (folder == "." || folder.filename() == "..") folder = fs::weakly_canonical(folder);
  return folder.string();
}

// The options of the campaign, except the scene.
FuzzOptions campaign_options(const TryOptions& options, const TriedCode& code) {
  FuzzOptions fuzz = options.fuzz;
  fuzz.out = folder_named(options.fuzz.out);
  fuzz.pairs = options.pairs > 0 ? options.pairs : code.is_program ? kPairsOfProgram : kPairsOfCode;
  fuzz.lanes.subjects = {code.name + '=' + code.what};
  fuzz.lanes.globs = {code.name + "/*", "exact/*/cpu"};
  fuzz.lanes.timeout = options.timeout > 0 ? options.timeout : code.is_program ? kProgramsTimeout : 1;
  return fuzz;
}

// The command with ten times the pairs, quoted for a shell.
std::string with_more_pairs(const TryOptions& options, const FuzzOptions& fuzz) {
  std::string command =
      fmt::format("graze try {}{} --pairs {}", path_word(options.source),
                  options.where.empty() ? "" : ' ' + path_word(options.where), std::min(10 * fuzz.pairs, kMostWhole));
  if (fuzz.seed != FuzzOptions().seed) command += fmt::format(" --seed {}", fuzz.seed);
  for (const std::string& flags : fuzz.lanes.flags) command += ' ' + shell_word("--flags=" + flags);
  if (options.timeout > 0) command += fmt::format(" --subject-timeout {}", options.timeout);
  if (options.names_coordinates)
    command += fmt::format(" --coordinates {}", fuzz.coordinates == PairTypes::f64 ? "f64" : "f32");
  if (fuzz.out != kOut) command += " --out " + path_word(fuzz.out);
  if (fuzz::may_replace_foreign) command += " --force";
  return command;
}

bool is_scene(const std::string& file) { return fs::path(file).extension() == ".toml"; }

void expect_mesh_or_scene(const std::string& where) {
  if (where.empty() || strata::is_mesh(where) || is_scene(where)) return;
  throw UsageError(fmt::format("graze try: expected a mesh ({}) or a scene (.toml), found {}", strata::mesh_formats(),
                               shown_path(where)));
}

// Renames the directory if it holds an earlier run on the same code or file, so that a run after an edit can use the
// same name.   Returns: the new name; empty if there was nothing to rename.
std::string put_aside(const std::string& out, const Json& spec) {
  if (!fuzz::has_database(out) || fuzz::is_empty_store(out)) return "";
  const Json earlier = fuzz::recorded_spec(out);
  const auto source_of = [](const Json& of) {
    const Json rows = of.value("subjects", Json::array());
    return rows.size() == 1 ? rows[0].at("what") : Json();
  };
  if (!earlier.is_object() || earlier == spec || source_of(earlier) != source_of(spec)) return "";
  const fuzz::FolderLock held(out, fuzz::FolderLock::WhenTaken::refuse);
  for (int n = 1;; ++n) {
    const std::string name = fmt::format("{}.{}", out, n);
    if (fs::exists(fs::symlink_status(name))) continue;
    fs::rename(out, name);
    return name;
  }
}

// Minimises signatures of the kinds to report until each of these kinds has a minimised pair.   Returns: the kinds;
// null if the user interrupts the minimiser.
Json minimised_kinds(const fuzz::SelectedLanes& under_test, const fs::path& directory, const Json& summary,
                     const reports::ReportLane& lane, std::size_t most_of_kind) {
  const std::atomic<bool>& interrupted = catch_interrupts();
  const auto stop = [&] { return interrupted.load(); };
  const Json& rows = summary["signatures"];
  std::set<std::size_t> done;
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    Json kinds = fuzz::find_kinds(under_test, directory, summary, stop);
    if (interrupted) return nullptr;
    std::set<std::size_t> next;
    for (const Json& kind : reports::first_kinds(kinds, lane, kMostTold)) {
      std::vector<std::pair<Simplicity, std::size_t>> of_kind;
      std::size_t left = most_of_kind;
      for (const std::size_t place : kind.at("places").get<std::vector<std::size_t>>()) {
        if (done.contains(place)) {
          left -= left > 0;
        } else {
          const corpus::Entry simplest = fuzz::read_cases(directory, summary["spec"], rows[place]).front();
          of_kind.emplace_back(visit(simplest, [](const auto& pair) { return simplicity(pair); }), place);
        }
      }
      std::sort(of_kind.begin(), of_kind.end());
      for (std::size_t i = 0; i < std::min(left, of_kind.size()); ++i) next.insert(of_kind[i].second);
    }
    if (next.empty()) return kinds;
    const bool on_terminal = isatty(STDERR_FILENO);
    Progress progress("failures", next.size(), on_terminal, error_screen());
    const std::vector<std::size_t> places(next.begin(), next.end());
    std::mutex telling;
    std::size_t minimised = 0;
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
      if (interrupted) return;
      const Json& row = rows[places[i]];
      const std::vector<corpus::Entry> entries = fuzz::checked_cases(under_test, summary["spec"], directory, row);
      if (!fuzz::has_result(under_test, entries))
        fuzz::minimise_file(under_test, fuzz::case_file(directory, row), entries);
      const std::lock_guard lock(telling);
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
      if (const auto line = progress.line(++minimised, taken.count(), std::nullopt, {"minimising"});
          line && on_terminal)
        fmt::print(stderr, "{}", *line);
    });
    done.insert(places.begin(), places.end());
    fmt::print(stderr, "{}", progress.end());
    if (interrupted) return nullptr;
  }
}

// Writes the first failure as a test. The test includes a source by its path relative to the folder.
// Returns: the file; empty if no program can show the failure.
std::string write_test(const Answer& answer, const fuzz::SelectedLanes& under_test) {
  if (answer.told.empty()) return "";
  const std::string file = case_of(answer, answer.told[0]), test = answer.directory + "/case.cpp";
  try {
    std::string program =
        emit(reports::SnippetKind::gtest, file, corpus::read_pairs(file, PairTypes::both), under_test);
    const fs::path source = subjects::opened(answer.code.name)->file;
    const std::string absolute = "#include \"" + source.string();
    if (const std::size_t at = program.find(absolute); at != program.npos)
      program.replace(at, absolute.size(), "#include \"" + fs::proximate(source, answer.directory).string());
    write_result(test, program);
  } catch (const UsageError&) {  // another file is in the way
    throw;
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "graze: no test of the first failure: {}\n", error.what());
    return "";
  }
  return test;
}

int interrupted() {
  fmt::print(stderr, "graze: interrupted; finished work is kept, and the same command resumes the run\n");
  return kInterrupted;
}

// Returns a shell command that runs a program on a pair.
std::string by_hand(const TriedCode& code, const std::string& pair) {
  return fmt::format("echo {} | {}", pair, code.what.substr(kCommand.size()));
}

// Returns the last line that the program prints on stderr when it fails on the pair. Empty if the program does not fail
// this time, or prints nothing.
std::string last_words(const TriedCode& code, const std::string& pair, double seconds) {
  const Scratch scratch(subjects::cache_folder());
  int status = 0;
  std::string said;
  try {
    const std::string run = "sh -c " + shell_word(code.what.substr(kCommand.size()));
    said = shell_output(fmt::format("echo {} | {} 2>&1 > /dev/null", pair, run), scratch.path(), status, seconds);
  } catch (const std::runtime_error&) {  // it takes too long
    return "";
  }
  said.erase(said.find_last_not_of(" \r\n") + 1);
  return status == 0 ? "" : printable(said.substr(said.rfind('\n') + 1));
}

// Prints once, on stderr, why a program crashes on one of the pairs.
void tell_crash(const Answer& answer, const std::string& lane, double seconds) {
  if (!answer.code.is_program) return;
  for (const Json& kind : answer.kinds) {
    const Json& simplest = kind.at("simplest");
    if (simplest.at("verdicts").value(lane, "") != name(Verdict::crashed)) continue;
    const std::string pair = simplest.at("pair"), words = last_words(answer.code, pair, seconds);
    if (words.empty()) continue;
    return fmt::print(stderr, "graze: {} crashes on some pairs: {}; to see its whole output: {}\n", lane, words,
                      by_hand(answer.code, pair));
  }
}

// Runs the code on a few pairs first. If the code fails on all of them, like a program that does not start, a campaign
// would find nothing and would start the program again for each pair.   Throws: std::runtime_error.
void expect_answers(const TriedCode& code, const fuzz::SelectedLanes& under_test, const strata::PairSource& source,
                    double seconds) {
  constexpr std::uint64_t kAsked = 3;
  const auto own = std::find_if(under_test.lanes.begin(), under_test.lanes.end(),
                                [&](const Lane* lane) { return lane->lane_name().subject == code.name; });
  if (own == under_test.lanes.end()) return;
  const DecideBlock& decide = under_test.on_host[static_cast<std::size_t>(own - under_test.lanes.begin())];
  if (!decide) return;
  std::string failed;
  bool all_crashed = true, unstable = false;
  for (std::uint64_t i = 0; i < std::min(kAsked, source.pairs); ++i) {
    const AnyPair pair = source.any_pair(i);
    const bool as_it_is = !pair.floats && decide.decides_doubles();
    const Verdict verdict = as_it_is ? decide_one(decide, pair.doubles) : decide_one(decide, pair.in_float32());
    if (!is_failure(verdict)) return;
    all_crashed &= verdict == Verdict::crashed;
    unstable |= verdict == Verdict::unstable;
    failed += fmt::format("{}{}", failed.empty() ? "" : ", ", name(verdict));
  }
  std::string hint = "call it by hand to see why";
  if (code.is_program) {
    const std::string pair = fuzz::pair_text(source.any_pair(0).in_float32()),
                      words = all_crashed ? last_words(code, pair, seconds) : "";
    hint = fmt::format("{}; to see {}: {}",
                       words.empty() ? "a program must answer each line of 18 numbers with one line, 1, 0 or ?; a "
                                       "Python function is given as mine.py:meet (docs/your_own_code.md)"
                                     : "it says: " + words,
                       words.empty() ? "why" : "all of it", by_hand(code, pair));
  } else if (unstable && subjects::opened(code.name)->kind == "library") {
    hint += "; a function of a shared object must return int, not bool";
  }
  throw std::runtime_error(
      cannot("try", code.what, fmt::format("it fails on each of the first pairs ({}); {}", failed, hint)));
}

int try_source(const TryOptions& options) {
  const std::string out = folder_named(options.fuzz.out);
  expect_campaign_folder(out);
  if (!options.fuzz.junit.empty()) expect_replaceable(options.fuzz.junit, reports::junit({}));
  expect_mesh_or_scene(options.where);
  Answer answer;
  answer.code = code_of(options.source, out);
  FuzzOptions fuzz = campaign_options(options, answer.code);
  fuzz::SelectedLanes under_test = lanes_of_campaign(fuzz);
  const bool in_double = std::any_of(under_test.lanes.begin(), under_test.lanes.end(), [&](const Lane* lane) {
    return lane->lane_name().subject == answer.code.name && lane->scalar == Scalar::f64;
  });
  if (is_scene(options.where)) {
    fuzz.scene = options.where;
  } else if (!options.where.empty()) {
    fuzz.scene = answer.scene = fuzz.out + ".toml";
    write_scene_of(options.where, fuzz.scene,
                   options.names_coordinates ? std::optional(fuzz.coordinates)
                   : in_double               ? std::nullopt
                                             : std::optional(PairTypes::f32));
  }
  if (!fuzz.scene.empty() && !options.names_coordinates) fuzz.coordinates = type_of_scene(fuzz.scene);
  if (fuzz.coordinates == PairTypes::f64) take_doubles(under_test);
  const fuzz::Campaign campaign = campaign_of(fuzz, under_test, answer.left_out);
  catch_interrupts();
  expect_answers(answer.code, under_test, campaign.sources.front(), fuzz.lanes.timeout);
  answer.directory = fuzz.out;
  answer.earlier = put_aside(fuzz.out, campaign.spec);
  const fuzz::Outcome outcome = run_with_progress(campaign);
  if (!outcome.complete) return interrupted();
  answer.summary = outcome.summary;
  const reports::CampaignCounts counts = reports::counts_of(outcome.summary);
  const std::size_t index = reports::own_lanes(counts).front();
  const reports::ReportLane& lane = counts.lanes[index];
  const Lane& own = *find_lane(lane.id);
  {
    const fuzz::FolderLock held(campaign.directory, fuzz::FolderLock::WhenTaken::refuse);
    if (fuzz::read_whole(campaign.directory / "summary.json") != outcome.summary.dump(1) + "\n")
      throw std::runtime_error(
          cannot("minimise", fuzz.out, "another process has just changed it; run the command again"));
    fuzz::write_whole(campaign.directory / "margins.svg", reports::margin_figure(outcome.summary));
    const bool is_program = answer.code.is_program;
    const int threads = (is_program ? kThreadsForPrograms : 1) * tbb::info::default_concurrency();
    const tbb::global_control limit = analysis::thread_limit(threads);
    tbb::task_arena(threads).execute([&] {
      answer.kinds = minimised_kinds(under_test, campaign.directory, outcome.summary, lane,
                                     is_program ? kMostOfProgram : kMostOfKind);
    });
    if (answer.kinds.is_null()) return interrupted();
    fuzz::write_kinds(campaign.directory, under_test, answer.kinds);
    tell_crash(answer, own.id, fuzz.lanes.timeout);
    answer.told = reports::first_kinds(answer.kinds, lane, kMostTold);
    answer.test = write_test(answer, under_test);
  }
  write_report(fuzz.out);
  write_junit(fuzz, under_test, outcome.summary);
  answer.costs = call_costs(own, campaign.sources);
  answer.epsilon = epsilon_of_code(own, campaign.sources, counts.total.wrong(index) > 0, fuzz.out);
  answer.effect = epsilon_effect(own, campaign.sources);
  answer.again = with_more_pairs(options, fuzz);
  fmt::print("{}", options.json ? to_json(answer, under_test).dump(1) + '\n' : text_of(answer, output_screen()));
  return 0;
}

}  // namespace

void add_try(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "try", "Test your own code: build it, find where it is wrong, and print the failures that matter most");
  command->footer("Example: graze try mine.cpp:geometry::meet arm.off");
  auto options = std::make_shared<TryOptions>();
  options->fuzz.out = kOut;
  command
      ->add_option(
          "SOURCE", options->source,
          "Your code, as FILE or NAME=FILE: a C, C++ or CUDA source or a shared object, with :FUNCTION if it "
          "is not `intersects`, a Python function (mine.py:meet), a Python or JavaScript program, or cmd:COMMAND; see "
          "docs/your_own_code.md")
      ->required();
  add_valued(*command, "WHERE", options->where, "MESH|SCENE",
             "Mesh or scene to draw the pairs in (default: all strata)");
  add_valued(*command, "--pairs", options->pairs, "N", "Number of pairs (default: 40000, or 2000 for a program)")
      ->transform(whole_number(1, kMostWhole));
  add_count(*command, "--seed", options->fuzz.seed, 0, kMostWhole, "Seed of the pairs");
  add_coordinates_option(*command, options->fuzz.coordinates, OfBothTypes::no);
  command->get_option("--coordinates")
      ->default_str("f32, those of the scene, or f64 for a mesh that needs it and code in double");
  add_threads_option(*command, options->fuzz.threads);
  add_valued(*command, "--flags", options->fuzz.lanes.flags, "TEXT",
             "Compiler flags for a source, such as --flags='-O3 -Iinclude'")
      ->allow_extra_args(false);
  add_valued(*command, "--subject-timeout", options->timeout, "SECONDS",
             "Time limit for one pair, in seconds (default: 1, or 10 for a program)")
      ->check(number(0.001, 86400.0));
  add_valued(*command, "--out", options->fuzz.out, "DIR",
             "Campaign directory; an earlier run on the same file is renamed to DIR.1, DIR.2, …")
      ->capture_default_str();
  command->add_flag("--json", options->json, "Print the answer as JSON");
  add_junit(*command, options->fuzz.junit, "one test for each build and stratum");
  command->callback([options, command, &status] {
    options->names_coordinates = command->count("--coordinates") > 0;
    status = try_source(*options);
  });
}

}  // namespace graze::cli
