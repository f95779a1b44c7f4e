// SPDX-License-Identifier: Apache-2.0
// `graze minimize`: reduces a case, or all cases of a campaign, to pairs that are easy to read.
#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <iostream>
#include <mutex>
#include <set>
#include <sstream>

#include "analysis/over_threads.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/cost_estimate.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/minimise/minimised_cases.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"
#include "reports/terminal.h"
#include "reports/ulp_map_picture.h"
#include "subjects/subjects.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct MinimizeOptions {
  std::string name, out;
  int threads = 0;
  bool again = false;
  bool exact_input = false;
  fuzz::Shard shard;
  LaneOptions lanes;
};

// Processor time of this thread, which does not depend on other load on the machine.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void print(const fuzz::MinimisedCase& found, const std::string& name) {
  const oracle::Truth t = oracle::truth(found.result.pair);
  const std::string from = found.from.empty() ? name : found.from;
  fmt::print("{}, {}\n", printable(from), found.failure.lanes.front()->info->id);
  std::fflush(stdout);
  const reports::Screen screen = output_screen();
  reports::print_pair(std::cout, found.result.pair, t, found.failure.lanes, found.failure.verdicts, screen);
  const std::string minimal =
      found.result.one_minimal
          ? fmt::format("1-minimal: none of the {} single moves to a simpler pair keeps the failure and its cause",
                        reports::grouped(found.result.single_moves))
      : fuzz::can_shrink(found.failure) ? fmt::format("perhaps not 1-minimal: stopped after {} moves",
                                                      reports::grouped(fuzz::most_moved(found.failure)))
                                        : "not shrunk: a lane times out, or its verdict changes";
  std::cout << fmt::format(
      "  signature: {}\n  magnitudes other than 0 and 1: {}, before {}\n"
      "  cause: {}, {}\n"
      "{}"
      "  largest margin found: {:.7g} ulps\n",
      analysis::key(fuzz::signature_of(found.failure, found.result.pair)), nontrivial_magnitudes(found.result.pair),
      nontrivial_magnitudes(found.original), analysis::name(found.result.reason.cause),
      found.result.reason.cause == found.result.first_cause
          ? "as before"
          : fmt::format("before only guessed as {}", analysis::name(found.result.first_cause)),
      reports::wrapped(minimal, screen.columns, 2, 4), found.result.worst_ulps);
  std::cout.flush();
}

// Adds the first line by which graze recognises its own files.
std::string with_header(const std::string& text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";  // UTF-8 byte order mark, allowed only at the start
  const std::string plain = text.starts_with(kMark) ? text.substr(kMark.size()) : text;
  return plain.starts_with(std::string_view(kPairs).substr(0, 11)) ? plain : kPairs + plain;
}

int minimize_case(const MinimizeOptions& options) {
  if (!options.out.empty()) expect_replaceable(options.out, kPairs);
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes, options.name);
  std::vector<corpus::Entry> entries = read_noted_cases(options.name, options.exact_input);
  take_doubles_of(entries, under_test);
  std::string text;
  if (std::all_of(entries.begin(), entries.end(), [](auto& entry) { return entry.line != 0 && entry.lines == 1; })) {
    text = fuzz::read_whole(options.name, fuzz::NamedBy::user);
  } else {  // a stratum's pair or pasted numbers become a file of pairs
    std::ostringstream out;
    corpus::write_header(out);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      corpus::write_entry(out, entries[i]);
      entries[i].line = i + 2;
    }
    text = out.str();
  }
  const std::atomic<bool>& interrupted = catch_interrupts();
  Progress progress("cases", entries.size(), isatty(STDERR_FILENO), error_screen());
  fuzz::CostEstimate work({entries.size()});
  const auto start = Clock::now();
  double before = 0;
  std::size_t asked = 0;
  const std::vector<fuzz::MinimisedCase> results = fuzz::minimise_cases(under_test, entries, [&] {
    const double now = seconds_since(start);
    if (asked > 0) work.add(0, 1, now - before);
    before = now;
    if (const auto line = progress.line(asked, now, work.seconds_left())) fmt::print(stderr, "{}", *line);
    if (!interrupted) ++asked;
    return interrupted.load();
  });
  fmt::print(stderr, "{}", progress.end());
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; minimised {} of {} cases and wrote nothing\n", asked, entries.size());
    return kInterrupted;
  }
  if (results.empty())
    throw std::runtime_error("there is nothing to minimise in " + options.name +
                             ": no lane is wrong on any of its pairs");
  for (const fuzz::MinimisedCase& found : results) print(found, options.name);
  if (!options.out.empty())
    write_result(options.out, with_header(fuzz::with_results(text, entries, results)), fuzz::NamedBy::user);
  // A pipe or a device cannot be read again, and a link may lead to standard output.
  if (options.out.empty() || fs::is_regular_file(fs::symlink_status(options.out)))
    fmt::print("Next: graze explain {}{}\n", path_word(options.out.empty() ? options.name : options.out),
               own_words(options.lanes));
  return 0;
}

// The result for one signature of a campaign.
struct Done {
  bool minimised = false;   // now or earlier; if false, no selected lane is wrong on it
  int magnitudes = 0;       // of the first result
  double milliseconds = 0;  // per case; 0 if it was done earlier
  double seconds = 0;       // for the file; 0 if it was done earlier
  double processor = 0;     // seconds of one core for the file's cases
};

Done minimize_file(const fuzz::SelectedLanes& under_test, const Json& spec, const fs::path& directory, const Json& row,
                   bool again) {
  const auto start = Clock::now();
  const double before = processor_seconds();
  const fs::path file = fuzz::case_file(directory, row);
  const std::vector<corpus::Entry> entries = fuzz::checked_cases(under_test, spec, directory, row);
  if (!again && has_result(under_test, entries))
    return {true, nontrivial_magnitudes(corpus::pair_of(entries.front())), 0};
  const std::vector<fuzz::MinimisedCase> results = fuzz::minimise_file(under_test, file, entries);
  if (results.empty()) return {};
  const auto cases =
      std::count_if(entries.begin(), entries.end(), [](const corpus::Entry& e) { return !corpus::field(e, "kind"); });
  const double seconds = seconds_since(start);
  return {true, nontrivial_magnitudes(results.front().result.pair),
          1e3 * seconds / static_cast<double>(std::max<std::ptrdiff_t>(cases, 1)), seconds,
          processor_seconds() - before};
}

// Returns the maps in the file, or null if they are missing or damaged; the caller then draws new maps.
Json stored(const fs::path& file) {
  try {
    return fuzz::read_sealed(file, "");
  } catch (const corpus::FormatError&) {
    return nullptr;
  }
}

// Whether the stored maps belong to this pair and these lanes.
bool is_current(const Json& maps, const AnyPair& pair, const std::vector<const Lane*>& lanes) {
  std::vector<std::string> ids;
  for (const Lane* lane : lanes) ids.push_back(lane->id);
  if (!reports::is_map_of(maps, pair, ids) || maps["panels"].size() != lanes.size() + 1) return false;
  for (std::size_t l = 0; l < lanes.size(); ++l) {
    if (maps["panels"][l + 1]["name"] != ids[l]) return false;
  }
  return true;
}

// Draws ulp maps of the file's first case, along analysis::liveliest_coordinates, for those lanes under test that
// belong to the subject, and stores them beside the case as HASH.maps.json for the report. Does nothing if current maps
// exist, unless `again` is true.   Returns: whether this call drew maps.
bool map_case(const fuzz::SelectedLanes& under_test, const fs::path& case_file, const std::string& subject,
              bool again) {
  const fs::path file = fs::path(case_file).replace_extension(".maps.json");
  const AnyPair pair = corpus::pair_of(corpus::read_pairs(case_file, PairTypes::both).at(0));
  std::vector<const Lane*> lanes;
  std::copy_if(under_test.lanes.begin(), under_test.lanes.end(), std::back_inserter(lanes),
               [&](const Lane* lane) { return lane->info->id == subject; });
  if (!again && is_current(stored(file), pair, lanes)) return false;
  const analysis::UlpMap map = analysis::ulp_map(pair, lanes, analysis::liveliest_coordinates(pair, lanes));
  fuzz::write_whole(file, fuzz::sealed(reports::to_json(map)).dump(1) + "\n");
  return true;
}

void print_directory(const std::string& directory, const std::vector<Done>& all) {
  std::vector<int> magnitudes;
  for (const Done& done : all) {
    if (done.minimised) magnitudes.push_back(done.magnitudes);
  }
  fmt::print("{} of {} signatures minimised", reports::grouped(magnitudes.size()), reports::grouped(all.size()));
  fmt::print("{}\n", magnitudes.size() < all.size() ? "; no selected lane is wrong on the others" : "");
  if (magnitudes.empty()) return;
  std::sort(magnitudes.begin(), magnitudes.end());
  std::string counts;
  for (int n = 0; n <= magnitudes.back(); ++n)
    counts +=
        fmt::format("{}{}: {}", n == 0 ? "" : ", ", n,
                    reports::grouped(static_cast<std::uint64_t>(std::count(magnitudes.begin(), magnitudes.end(), n))));
  fmt::print("number of magnitudes other than 0 and 1: signatures with that number (median {}):\n{}",
             magnitudes[magnitudes.size() / 2], reports::wrapped(counts, output_screen().columns, 2, 2));
  fmt::print(
      "Wrote {}/cases/: the minimised pair first, then the worst pair found, then the originals\n"
      "and, for each kind of failure, an explanation and the ulp maps of its simplest case\n",
      printable(directory));
}

int minimize_directory(MinimizeOptions options) {
  const fs::path directory = options.name;
  if (!options.out.empty()) throw UsageError("--out is only for cases; the results of a campaign go into its cases/");
  if (options.exact_input) throw UsageError("--exact-input is only for cases; a campaign's pairs are stored exactly");
  if (options.lanes.resubject)
    throw UsageError("--resubject is only for cases; a campaign's results must come from the code that it ran");
  const bool whole = options.shard.whole();
  // Reads the summary before taking the lock, because reading a killed run's database takes the lock itself.
  const std::string text = fuzz::read_whole(directory / "summary.json");
  const Json summary = fuzz::checked_summary(directory);
  if (options.lanes.globs.empty()) options.lanes.globs = summary["spec"]["lanes"].get<std::vector<std::string>>();
  open_subjects(options.lanes);
  if (!subjects::open_recorded(summary["spec"]).empty())
    throw UsageError(
        cannot("minimise", options.name,
               "the campaign ran different code, and its results must come from that code; leave out --subject"));
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes, options.name);
  if (fuzz::has_doubles(summary["spec"])) take_doubles(under_test);
  const auto ran = summary["spec"]["lanes"].get<std::set<std::string>>();
  leave_out(under_test, [&](const Lane& lane) { return ran.contains(lane.id) ? "" : "the campaign did not run it"; });
  const fuzz::FolderLock held(directory,
                              whole ? fuzz::FolderLock::WhenTaken::refuse : fuzz::FolderLock::WhenTaken::share);
  if (fuzz::read_whole(directory / "summary.json") != text)
    throw std::runtime_error(
        cannot("minimise", options.name, "another process has just changed it; run the command again"));
  std::vector<Json> rows;
  for (std::size_t i = 0; i < summary["signatures"].size(); ++i) {  // most frequent first, dealt to the shards in turn
    if (i % options.shard.of == options.shard.number - 1) rows.push_back(summary["signatures"][i]);
  }
  expect_writable(directory);
  fuzz::read_timings(directory);  // fails now if damaged, not after the work, which adds to the file
  fuzz::expect_file(directory / "failures.json");
  if (whole) fuzz::expect_own(directory / "failures.json", Json{{"summary", ""}, {"cases", ""}}.dump(1));
  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit = analysis::thread_limit(threads);
  const std::atomic<bool>& interrupted = catch_interrupts();
  Progress progress("signatures", rows.size(), isatty(STDERR_FILENO), error_screen());
  fuzz::CostEstimate work({rows.size()});
  const auto start = Clock::now();
  std::vector<Done> all(rows.size());
  std::size_t count = 0;
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
    if (interrupted) return;
    all[i] = minimize_file(under_test, summary["spec"], directory, rows[i], options.again);
    const std::lock_guard lock(mutex);
    ++count;
    all[i].seconds > 0 ? work.add(0, 1, all[i].seconds) : work.skip(0, 1);  // 0: done earlier
    auto left = work.seconds_left();
    if (left) left = *left / threads;
    if (const auto line = progress.line(count, seconds_since(start), left)) fmt::print(stderr, "{}", *line);
  });
  fmt::print(stderr, "{}", progress.end());
  const Json kinds = interrupted || !whole
                         ? Json()
                         : fuzz::find_kinds(under_test, directory, summary, [&] { return interrupted.load(); });
  const auto mapping = Clock::now();
  std::atomic<std::size_t> maps = 0;
  tbb::parallel_for(std::size_t{0}, std::min(kinds.size(), fuzz::kMostShown), [&](std::size_t i) {
    if (interrupted) return;
    const Json& kind = kinds.at(i);
    maps += map_case(under_test, fuzz::case_file(directory, kind.at("simplest")), kind.at("subject"), options.again);
  });
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; minimised {} of {} signatures; run the same command to resume\n",
               reports::grouped(count), reports::grouped(rows.size()));
    return kInterrupted;
  }
  if (!whole) {
    fmt::print("shard {}: {} of {} signatures done\nNext, when all shards are done: graze minimize {}\n",
               options.shard.name(), reports::grouped(rows.size()), reports::grouped(summary["signatures"].size()),
               path_word(options.name));
    return 0;
  }
  const double map_seconds = seconds_since(mapping);
  fuzz::write_kinds(directory, under_test, kinds);
  print_directory(options.name, all);
  fmt::print("{} kinds of failure, listed by: graze failures {}\nNext: graze report {}\n",
             reports::grouped(kinds.size()), path_word(options.name), path_word(options.name));

  std::vector<double> times;
  double processor = 0, worst = 0;
  for (const Done& done : all) {
    processor += done.processor;
    worst = std::max(worst, done.processor);
    if (done.milliseconds > 0) times.push_back(done.milliseconds);
  }
  std::sort(times.begin(), times.end());
  fuzz::append_timing(directory,
                      {{"minimised", times.size()},
                       {"milliseconds_a_case", times.empty() ? 0 : times[times.size() / 2]},
                       {"processor_seconds", processor},
                       {"processor_seconds_worst", worst},
                       {"mapped", maps.load()},
                       {"milliseconds_a_map", maps == 0 ? 0 : 1e3 * map_seconds / static_cast<double>(maps.load())},
                       {"seconds", seconds_since(start)},
                       {"threads", threads}});
  return 0;
}

}  // namespace

void add_minimize(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "minimize", "Shrink a case, or every case of a campaign, to the simplest pair that fails in the same way");
  command->footer("Example: graze minimize campaign");
  auto options = std::make_shared<MinimizeOptions>();
  command
      ->add_option(
          "CASE", options->name,
          "Campaign directory, file of pairs, or STRATUM:SEED:INDEX; the results of a campaign go into its cases/")
      ->required();
  add_valued(*command, "--out", options->out, "FILE", "File for the minimised pairs, each followed by its original");
  add_exact_input(*command, options->exact_input);
  command->add_flag("--again", options->again, "Minimise every case again, even those that have a result");
  add_threads_option(*command, options->threads);
  add_shard_option(
      *command, options->shard,
      "Part of a campaign's signatures to minimise: the K-th of N. When all parts are done, run once without --shard");
  add_lane_options(*command, options->lanes);
  command->get_option("--lanes")->default_str("those of the campaign, else all");
  add_resubject_option(*command, options->lanes);
  command->callback([options, &status] {
    if (!fs::is_directory(options->name)) {
      if (!options->shard.whole())
        throw UsageError("--shard is only for campaign directories, and " + options->name + " is not one");
      if (options->again)
        throw UsageError("--again is only for campaign directories; " + options->name + " is minimised each time");
      status = minimize_case(*options);
      return;
    }
    try {
      status = minimize_directory(*options);
    } catch (const Json::exception&) {
      throw std::runtime_error(cannot("use", options->name + "/summary.json", "it is not the summary of a campaign"));
    }
  });
}

}  // namespace graze::cli
