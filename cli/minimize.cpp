// SPDX-License-Identifier: Apache-2.0
// `graze minimize`: shrinks a case, or all cases of a campaign, to pairs that a person can read.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <iostream>
#include <mutex>
#include <optional>
#include <sstream>

#include "cli/case_maps.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "core/error.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/carded_signatures.h"
#include "fuzz/minimise/case_facts.h"
#include "fuzz/minimise/minimised_cases.h"
#include "reports/terminal.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct MinimizeOptions {
  std::string name, out;
  int threads = 0;
  bool again = false;
  LaneOptions lanes;
};

// Of this thread, so that it does not depend on what else the machine does.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void print(const fuzz::MinimisedCase& found, const std::string& name) {
  const oracle::Truth t = oracle::truth(found.result.pair);
  const std::string from = found.from.empty() ? name : found.from;
  fmt::print("{}, {}\n", from, found.failure.lanes.front()->info->id);
  std::fflush(stdout);
  reports::print_pair(std::cout, found.result.pair, t, found.failure.lanes, found.failure.verdicts);
  std::cout << fmt::format(
      "  signature: {}\n  magnitudes other than 0 and 1: {}, before {}\n"
      "  cause: {}, as before\n"
      "  {}\n"
      "  worst on the way: {} ulps\n",
      analysis::key(fuzz::signature_of(found.failure, found.result.pair)),
      fuzz::nontrivial_magnitudes(found.result.pair), fuzz::nontrivial_magnitudes(found.original),
      analysis::name(found.result.reason.cause),
      found.result.one_minimal
          ? fmt::format("1-minimal: none of the {} single moves to a simpler pair keeps the failure and its cause",
                        reports::grouped(found.result.single_moves))
          : fmt::format("perhaps not 1-minimal: stopped after {} moves", reports::grouped(fuzz::kMostMoved)),
      found.result.worst_ulps);
  std::cout.flush();
}

int minimize_case(const MinimizeOptions& options) {
  const fuzz::LanesUnderTest under_test = fuzz::select_lanes(options.lanes.globs, options.lanes.executor);
  std::vector<corpus::Entry> entries = read_cases(options.name);
  std::string text;
  if (entries.front().line != 0) {
    text = fuzz::read_whole(options.name);
  } else {
    std::ostringstream out;
    corpus::write_header(out);
    corpus::write_entry(out, entries.front());
    text = out.str();
    entries.front().line = 2;
  }
  const std::atomic<bool>& interrupted = catch_interrupts();
  std::size_t looked_at = 0;
  const std::vector<fuzz::MinimisedCase> results =
      fuzz::minimise_cases(under_test, entries, [&] { return interrupted ? true : (++looked_at, false); });
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; minimised {} of {} cases and wrote nothing\n", looked_at, entries.size());
    return kInterrupted;
  }
  if (results.empty())
    throw std::runtime_error(options.name + ": expected a case on which a lane is wrong, found none");
  for (const fuzz::MinimisedCase& found : results) print(found, options.name);
  if (!options.out.empty()) fuzz::write_whole(options.out, fuzz::with_results(text, entries, results));
  return 0;
}

// What became of a signature of a campaign.
struct Done {
  bool minimised = false;   // now or before; otherwise no selected lane is wrong on it
  int magnitudes = 0;       // of the first result
  double milliseconds = 0;  // of each case; 0 where it was done before
  double seconds = 0;       // of the file; 0 where it was done before
  double map_seconds = 0;   // 0 without a map, and where it was done before
  double processor = 0;     // seconds of one core for the file's cases
};

Done minimize_file(const fuzz::LanesUnderTest& under_test, const fs::path& file, bool again) {
  const auto start = Clock::now();
  const double before = processor_seconds();
  std::vector<corpus::Entry> entries = corpus::read_pairs(file);
  if (entries.empty()) throw std::runtime_error(file.string() + ": expected at least one case, found none");
  if (!again && has_result(under_test, entries)) return {true, fuzz::nontrivial_magnitudes(entries.front().pair), 0};
  const std::vector<fuzz::MinimisedCase> results = fuzz::minimise_cases(under_test, entries);
  if (results.empty()) return {};
  const std::string text = fuzz::read_whole(file), after = fuzz::with_results(text, entries, results);
  if (after != text) fuzz::write_whole(file, after);
  const auto cases =
      std::count_if(entries.begin(), entries.end(), [](const corpus::Entry& e) { return !corpus::field(e, "kind"); });
  const double seconds = seconds_since(start);
  return {true,
          fuzz::nontrivial_magnitudes(results.front().result.pair),
          1e3 * seconds / static_cast<double>(std::max<std::ptrdiff_t>(cases, 1)),
          seconds,
          0,
          processor_seconds() - before};
}

// An estimate by what the files and maps made so far took.
class TimeLeft {
 public:
  TimeLeft(std::size_t files, std::size_t maps, int threads) : files_{files}, maps_{maps}, threads_(threads) {}

  void add(const Done& done, bool has_map) {
    files_.add(done.seconds);
    if (has_map) maps_.add(done.map_seconds);
  }

  std::optional<double> seconds() const {
    if (files_.made == 0) return {};
    return (files_.seconds_left() + maps_.seconds_left()) / static_cast<double>(threads_);
  }

 private:
  struct Work {
    std::size_t left, made = 0;
    double seconds = 0;

    void add(double took) {
      --left;
      made += took > 0;  // not what was there before
      seconds += took;
    }
    double seconds_left() const {
      return made == 0 ? 0 : seconds / static_cast<double>(made) * static_cast<double>(left);
    }
  };
  Work files_, maps_;
  int threads_;
};

void print_directory(const std::string& directory, const std::vector<Done>& all) {
  std::vector<int> magnitudes;
  for (const Done& done : all) {
    if (done.minimised) magnitudes.push_back(done.magnitudes);
  }
  fmt::print("{} of {} signatures minimised", reports::grouped(magnitudes.size()), reports::grouped(all.size()));
  fmt::print("{}\n", magnitudes.size() < all.size() ? "; no selected lane is wrong on the others" : "");
  if (magnitudes.empty()) return;
  std::sort(magnitudes.begin(), magnitudes.end());
  fmt::print("magnitudes other than 0 and 1, and how many signatures have so many (median {}):\n ",
             magnitudes[magnitudes.size() / 2]);
  for (int n = 0; n <= magnitudes.back(); ++n)
    fmt::print(" {}: {}{}", n,
               reports::grouped(static_cast<std::uint64_t>(std::count(magnitudes.begin(), magnitudes.end(), n))),
               n == magnitudes.back() ? "\n" : ",");
  fmt::print(
      "Wrote {}/cases/: the minimised pair first, then the worst one met, then the originals\n"
      "and, for the signatures that `graze report` shows on cards, explanations and ulp maps\n",
      directory);
}

int minimize_directory(MinimizeOptions options) {
  const fs::path directory = options.name;
  if (!options.out.empty()) throw UsageError("expected --out only with one case, found a campaign's directory");
  const fuzz::FolderLock alone(directory, fuzz::FolderLock::WhenTaken::refuse);
  const Json summary = Json::parse(fuzz::read_whole(directory / "summary.json"), nullptr, false);
  const bool is_summary = summary.is_object() && summary.value("signatures", Json()).is_array() &&
                          summary.value("spec", Json()).contains("lanes");
  if (!is_summary)
    throw std::runtime_error(options.name + ": expected a campaign's directory with summary.json, found none");
  if (options.lanes.globs.empty()) options.lanes.globs = summary["spec"]["lanes"].get<std::vector<std::string>>();
  const fuzz::LanesUnderTest under_test = fuzz::select_lanes(options.lanes.globs, options.lanes.executor);
  std::vector<fs::path> files;
  std::size_t maps_to_make = 0;
  std::vector<std::string> to_map;  // of each, the signature whose card shows a map; empty for others
  const std::vector<std::size_t> cards = fuzz::carded_signatures(summary);
  for (std::size_t place = 0; place < summary["signatures"].size(); ++place) {
    const Json& row = summary["signatures"][place];
    // Pairs on which a device and its twin differ are kept too; they are nobody's failure.
    const std::string key = row.at("key");
    files.push_back(fuzz::case_file(directory, row));
    to_map.push_back(std::binary_search(cards.begin(), cards.end(), place) ? key : "");
    maps_to_make += !to_map.back().empty();
  }

  const int threads = options.threads > 0 ? options.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const std::atomic<bool>& interrupted = catch_interrupts();
  Progress progress("signatures", files.size(), isatty(STDERR_FILENO));
  TimeLeft time_left(files.size(), maps_to_make, threads);
  const auto start = Clock::now();
  std::vector<Done> all(files.size());
  std::size_t count = 0;
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    if (interrupted) return;
    all[i] = minimize_file(under_test, files[i], options.again);
    const auto mapping = Clock::now();
    if (!to_map[i].empty()) fuzz::store_facts(under_test, files[i]);
    if (all[i].minimised && !to_map[i].empty() && map_case(under_test, files[i], to_map[i], options.again))
      all[i].map_seconds = seconds_since(mapping);
    const std::lock_guard lock(mutex);
    ++count;
    time_left.add(all[i], !to_map[i].empty());
    if (const auto line = progress.line(count, seconds_since(start), time_left.seconds()))
      fmt::print(stderr, "{}", *line);
  });
  fmt::print(stderr, "{}", progress.end());
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; minimised {} of {} signatures; run the same command to go on\n",
               reports::grouped(count), reports::grouped(files.size()));
    return kInterrupted;
  }
  print_directory(options.name, all);

  std::vector<double> times;
  int maps = 0;
  double map_seconds = 0, processor = 0, worst = 0;
  for (const Done& done : all) {
    processor += done.processor;
    worst = std::max(worst, done.processor);
    if (done.milliseconds > 0) times.push_back(done.milliseconds);
    maps += done.map_seconds > 0;
    map_seconds += done.map_seconds;
  }
  std::sort(times.begin(), times.end());
  fuzz::append_timing(directory, {{"minimised", times.size()},
                                  {"milliseconds_a_case", times.empty() ? 0 : times[times.size() / 2]},
                                  {"processor_seconds", processor},
                                  {"processor_seconds_worst", worst},
                                  {"mapped", maps},
                                  {"milliseconds_a_map", maps == 0 ? 0 : 1e3 * map_seconds / maps},
                                  {"seconds", seconds_since(start)},
                                  {"threads", threads}});
  return 0;
}

}  // namespace

void add_minimize(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand(
      "minimize", "Shrink a case, or all of a campaign, to the simplest pair that fails in the same way");
  command->footer("Example: graze minimize campaign");
  auto options = std::make_shared<MinimizeOptions>();
  command
      ->add_option("case", options->name,
                   "A campaign's directory, a file of its cases/, or STRATUM:SEED:INDEX; a directory's results go into "
                   "its cases/")
      ->required();
  command->add_option("--out", options->out, "Write the results, and the originals behind them, to this file")
      ->check(not_empty());
  command->add_flag("--again", options->again, "Of a directory, also what is minimised already");
  command->add_option("--threads", options->threads, "Threads; 0 for one on each core; results do not depend on it")
      ->check(whole_number(0, 4096))
      ->capture_default_str();
  add_lane_options(*command, options->lanes);
  command->callback([options, &status] {
    if (!fs::is_directory(options->name)) {
      status = minimize_case(*options);
      return;
    }
    try {
      status = minimize_directory(*options);
    } catch (const Json::exception&) {
      throw std::runtime_error(options->name + "/summary.json: expected a campaign's summary, found something else");
    }
  });
}

}  // namespace graze::cli
