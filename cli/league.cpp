// SPDX-License-Identifier: Apache-2.0
// `graze league`: compares libraries and our algorithms on the same pairs.
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <iostream>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/files.h"
#include "fuzz/league/league.h"
#include "reports/league.h"
#include "reports/terminal.h"
#include "subjects/subjects.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

// The shortest time limit for a program's pair, in seconds: the first pair's time includes the program's start-up.
constexpr double kStartOfAProgram = 10;

struct LeagueOptions : DrawOptions {
  LeagueOptions() : DrawOptions{100'000} {}
  std::string subjects, out = "league";
  double timeout = 0.1;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t\r");
  return first == text.npos ? "" : text.substr(first, last - first + 1);
}

// Reads lines NAME=WHAT, below which indented lines `version: …`, `source: …` or `convention: …` may give facts that
// the code does not report. `pairs: N` limits the pairs of a slow subject. # begins a comment.
// Throws: std::runtime_error with file and line.
std::vector<reports::LeagueSubject> read_subjects(const fs::path& file, fuzz::MostPairs& most) {
  std::vector<reports::LeagueSubject> subjects;
  if (!fs::exists(file)) throw std::runtime_error(cannot("read", file, ENOENT));
  std::istringstream in(fuzz::read_whole(file, fuzz::NamedBy::user));
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string text = trimmed(line);
    if (text.empty() || text[0] == '#') continue;
    const auto refuse = [&](const char* expected) {
      return std::runtime_error(
          fmt::format("{}:{}: expected {}, found {}", file.string(), number, expected, shown(text)));
    };
    if (line[0] != ' ' && line[0] != '\t') {
      const std::size_t equals = text.find('=');
      if (equals == text.npos || equals == 0 || equals + 1 == text.size()) throw refuse("NAME=WHAT");
      subjects.push_back({text.substr(0, equals), text.substr(equals + 1), "", "", ""});
      continue;
    }
    const std::size_t colon = text.find(": ");
    const std::string key = text.substr(0, colon);
    if (key == "pairs" && colon != text.npos && !subjects.empty()) {
      const std::optional<std::uint64_t> pairs = parse_whole(text.substr(colon + 2));
      if (!pairs || *pairs == 0) throw refuse("a number of pairs");
      most[subjects.back().name] = *pairs;
      continue;
    }
    std::string reports::LeagueSubject::*field = key == "version"      ? &reports::LeagueSubject::version
                                                 : key == "source"     ? &reports::LeagueSubject::source
                                                 : key == "convention" ? &reports::LeagueSubject::convention
                                                                       : nullptr;
    if (colon == text.npos || !field || subjects.empty())
      throw refuse("'version: ', 'source: ', 'convention: ' or 'pairs: ' below a subject");
    subjects.back().*field = text.substr(colon + 2);
  }
  if (subjects.empty()) throw std::runtime_error("there is no line NAME=WHAT in " + file.string());
  return subjects;
}

// The code's own description takes precedence over the facts in the file.
void open(reports::LeagueSubject& subject, double timeout) {
  subjects::Wanted wanted = subjects::parse_subject(subject.name + '=' + subject.what);
  wanted.timeout = wanted.what.starts_with("cmd:") ? std::max(timeout, kStartOfAProgram) : timeout;
  subjects::open(wanted);
  const subjects::Description& said = subjects::opened(subject.name)->description;
  if (!said.version.empty()) subject.version = said.version;
  if (!said.source.empty()) subject.source = said.source;
  if (!said.convention.empty()) subject.convention = said.convention;
}

// Removes the drawings of an earlier run.
void remove_other_drawings(const fs::path& folder, const std::map<std::string, std::string>& drawings) {
  if (drawings.empty()) return;
  for (const auto& there : std::vector<fs::directory_entry>(fs::directory_iterator(folder), fs::directory_iterator())) {
    if (!drawings.contains(there.path().filename().string())) remove_result(there.path(), drawings.begin()->second);
  }
}

int league(const LeagueOptions& options) {
  if (options.coordinates == PairTypes::both)
    throw UsageError(
        "graze league: --coordinates both: a table has pairs of one type; make two tables, one with f32 and one with "
        "f64");
  fuzz::MostPairs most;
  std::vector<reports::LeagueSubject> subjects = read_subjects(options.subjects, most);
  for (reports::LeagueSubject& subject : subjects) open(subject, options.timeout);
  const bool in_doubles = options.coordinates == PairTypes::f64;
  fuzz::SelectedLanes lanes =
      in_doubles ? fuzz::league_lanes({"*/f64/cpu", "*/f64/cpu-fma"}) : fuzz::league_lanes({"*/cpu", "*/cpu-fma"});
  if (in_doubles) take_doubles(lanes);
  say_left_out(lanes.left_out);
  std::erase_if(subjects, [&](const reports::LeagueSubject& subject) {
    const bool has_lane = std::any_of(lanes.lanes.begin(), lanes.lanes.end(),
                                      [&](const Lane* lane) { return lane->info->id == subject.name; });
    if (!has_lane && !in_doubles)
      throw std::runtime_error(
          fmt::format("{} of {} has no lane that runs on this processor", subject.name, options.subjects));
    if (!has_lane) fmt::print(stderr, "graze: left out {}: it does not take doubles\n", subject.name);
    return !has_lane;
  });
  const std::vector<strata::PairSource> sources = drawn(options).sources;
  const ResultFolder folder(options.out, "league.json");
  const std::atomic<bool>& interrupted = catch_interrupts();
  const auto start = std::chrono::steady_clock::now();
  Progress progress("pairs", options.pairs, isatty(STDERR_FILENO), error_screen());
  const fuzz::League found = fuzz::run_league(lanes, sources, options.seed, most, [&](std::uint64_t done) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    if (const auto line = progress.line(done, passed.count(), std::nullopt)) fmt::print(stderr, "{}", *line);
    return interrupted.load();
  });
  fmt::print(stderr, "{}", progress.end());
  if (interrupted) {
    fmt::print(stderr, "graze: interrupted; wrote nothing\n");
    return kInterrupted;
  }
  fuzz::Json json = reports::league_json(found, subjects, fuzz::league_costs(found), fuzz::machine_name(),
                                         fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))));
  fuzz::add_left_out(json, lanes);
  std::string command = fmt::format("graze league --subjects {} --pairs {} --seed {}", path_word(options.subjects),
                                    options.pairs, options.seed);
  if (!options.scene.empty()) command += " --scene " + path_word(options.scene);
  for (const std::string& glob : options.strata) command += " --strata " + shell_word(glob);
  if (in_doubles) command += " --coordinates f64";
  const fs::path& out = folder.path;
  fs::create_directories(out / "league");
  write_result(out / "league.json", json.dump(1) + "\n");
  write_result(out / "league.md", reports::league_page(json, command));
  const std::map<std::string, std::string> drawings = reports::league_drawings(json);
  for (const auto& [file, svg] : drawings) write_result(out / "league" / file, svg);
  remove_other_drawings(out / "league", drawings);
  std::cout << reports::league_table(json, output_screen());
  fmt::print("\nWrote {0}/league.json, {0}/league.md, {0}/league/\n", printable(options.out));
  return 0;
}

}  // namespace

void add_league(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("league", "Compare libraries and the published algorithms on the same pairs");
  command->footer("Example: graze league --subjects build-league/subjects.txt --pairs 1M");
  auto options = std::make_shared<LeagueOptions>();
  add_valued(*command, "--subjects", options->subjects, "FILE",
             "File of libraries, one NAME=WHAT per line as for --subject; `scripts/league` writes one")
      ->required();
  add_count(*command, "--pairs", options->pairs, 1, kMostWhole,
            "Number of pairs in total, shared evenly by the strata");
  add_count(*command, "--seed", options->seed, 0, kMostWhole, "Seed of all strata");
  add_valued(*command, "--subject-timeout", options->timeout, "SECONDS",
             "Time limit of a library for one pair, in seconds; a pair that exceeds it is tried once more")
      ->check(number(0.001, 86400.0))
      ->capture_default_str();
  add_draw_options(*command, *options);
  add_valued(*command, "--out", options->out, "DIR", "Directory for league.json, league.md and drawings")
      ->capture_default_str();
  run_drawing(*command, options, status, league);
}

}  // namespace graze::cli
