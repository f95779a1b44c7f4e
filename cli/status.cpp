// SPDX-License-Identifier: Apache-2.0
// `graze status`: shows the progress of shards, ranks and campaigns from their status.json files.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <iostream>
#include <set>
#include <thread>

#include "cli/commands.h"
#include "cli/progress.h"
#include "cli/results.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/rank_stores.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/files.h"
#include "fuzz/sealed.h"
#include "reports/terminal.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

struct StatusOptions {
  std::vector<std::string> directories;
  std::string prometheus;
  std::uint64_t stalled = 600;
  bool json = false;
};

// Returns the state of a run. A run without a recorded end was killed if its process no longer exists on this machine,
// and has stalled if it has not reported for a long time.
std::string state_of(const Json& status, std::int64_t silent, std::uint64_t stalled) {
  const std::string state = status.at("state");
  if (state != "running") return state;
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const auto process = status.at("process").get<pid_t>();
  if (status.at("host").get<std::string>() == host && process > 0 && kill(process, 0) != 0 && errno == ESRCH)
    return "killed";
  return silent > static_cast<std::int64_t>(stalled) ? "stalled" : "running";
}

// Throws: std::runtime_error if the status does not have the campaign's number of pairs (for a shard, about its share),
// or has more signatures than the campaign can have: one for each lane and disagreement, or as many as its summary has.
void expect_own_counts(const fs::path& directory, const Json& status) {
  const std::uint64_t pairs = status.at("pairs");
  std::uint64_t most = status.at("disagreements"), disagreements = most, least_pairs = pairs, most_pairs = pairs;
  try {
    const fuzz::StoreSpec store = fuzz::recorded_store(directory);
    most *= store.lanes.size();
    // A shard has its share of each stratum, rounded down or up.
    const std::uint64_t all = store.spec.at("pairs"), share = all / store.shard.of,
                        slack = store.shard.whole() ? 0 : store.spec.at("strata").size();
    least_pairs = share - std::min(share, slack);
    most_pairs = share + slack;
    if (const fs::path file = directory / "summary.json"; status.at("state") == "done" && fs::exists(file)) {
      const Json summary = fuzz::parse_shallow(fuzz::read_whole(file));
      most = summary.at("signatures").size();
      disagreements = summary.at("disagreements");
    }
  } catch (const std::exception&) {  // a damaged database or summary is reported by the commands that read it
  }
  if (pairs < least_pairs || pairs > most_pairs)
    throw std::runtime_error(
        cannot("use", directory,
               fmt::format("status.json has {} pairs, but the campaign beside it has {}", pairs,
                           least_pairs == most_pairs ? fmt::format("{}", most_pairs)
                                                     : fmt::format("{} to {}", least_pairs, most_pairs))));
  const std::uint64_t found = status.at("signatures");
  if (found > most || status.at("disagreements") != disagreements)
    throw std::runtime_error(cannot(
        "use", directory,
        fmt::format("status.json has {} disagreements and {} signatures, but summary.json or the database beside it "
                    "has {} and at most {}",
                    status.at("disagreements").get<std::uint64_t>(), found, disagreements, most)));
}

// known: the signatures of earlier rows, without margins; the function adds this row's signatures.
Json row_of(const fs::path& directory, std::uint64_t stalled, std::set<std::string>& known) {
  Json row = {{"directory", directory.string()},
              {"shard", nullptr},
              {"state", "not begun"},
              {"pairs", 0},
              {"done", 0},
              {"rate", 0.0},
              {"seconds_left", nullptr},
              {"disagreements", 0},
              {"signatures", 0},
              {"new", 0}};
  Json status = fuzz::read_status(directory);
  // A run creates its database before its status.
  for (int wait = 0; status.is_null() && wait < 40 && fuzz::has_database(directory); ++wait) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    status = fuzz::read_status(directory);
  }
  if (status.is_null()) {
    if (fuzz::has_database(directory))
      throw std::runtime_error(
          cannot("open", directory / "status.json",
                 "it is missing although the folder has a database (a campaign from `graze merge` has no status)"));
    return row;
  }
  // At least 0, even if this machine's clock is behind the writer's.
  const auto silent = [&] {
    return std::max<std::int64_t>(0, std::time(nullptr) - status.at("updated").get<std::int64_t>());
  };
  row["state"] = state_of(status, silent(), stalled);
  if (row["state"] == "killed") {  // or it ended after its status was read
    if (Json now = fuzz::read_status(directory); !now.is_null()) status = std::move(now);
    row["state"] = state_of(status, silent(), stalled);
  }
  if (fuzz::has_database(directory)) expect_own_counts(directory, status);
  for (const char* field : {"shard", "pairs", "done", "disagreements", "signatures"}) row[field] = status.at(field);
  std::size_t fresh = 0;
  for (const std::string way : status.at("ways")) fresh += known.insert(way).second;
  row["new"] = fresh;
  if (row["state"] == "running") {
    row["rate"] = status.at("rate");
    row["seconds_left"] = status.at("seconds_left");
  }
  row["silent"] = silent();
  if (status.contains("why")) row["why"] = status["why"];
  return row;
}

// Returns {"shards": [row, …], "pairs", "done", "rate", "seconds_left", "disagreements", "states": {state: shards}},
// with rows in the order of the directories.
Json status_of(const StatusOptions& options) {
  Json shards = Json::array(), states = Json::object(), seconds_left = nullptr;
  std::uint64_t pairs = 0, done = 0, disagreements = 0;
  std::set<std::string> known;
  double rate = 0;
  std::set<fs::path> named;
  for (const std::string& name : options.directories) {
    if (!named.insert(fs::weakly_canonical(name)).second) throw UsageError(printable(name) + " is named twice");
    std::vector<fs::path> places = fuzz::rank_directories(name);
    if (places.empty()) places.emplace_back(name);
    std::uint64_t of_ranks = 0;
    for (const fs::path& place : places) {
      const Json row = row_of(place, options.stalled, known);
      // Each rank reports the pairs of all ranks.
      of_ranks = std::max(of_ranks, row["pairs"].get<std::uint64_t>());
      done += row["done"].get<std::uint64_t>();
      disagreements += row["disagreements"].get<std::uint64_t>();
      rate += row["rate"].get<double>();
      Json& count = states[row["state"].get<std::string>()];
      count = count.is_null() ? 1 : count.get<int>() + 1;
      shards.push_back(row);
    }
    pairs += of_ranks;
  }
  if (rate > 0 && done < pairs) seconds_left = static_cast<double>(pairs - done) / rate;
  return {{"shards", shards},
          {"pairs", pairs},
          {"done", done},
          {"rate", rate},
          {"seconds_left", seconds_left},
          {"disagreements", disagreements},
          {"states", states}};
}

std::string table(const Json& all) {
  std::string text = fmt::format("{:<24} {:>12} {:<9} {:>22} {:>11} {:>9} {:>13} {:>10} {:>6}\n", "directory", "shard",
                                 "state", "pairs done", "pairs/s", "left", "disagreements", "signatures", "new");
  for (const Json& row : all["shards"]) {
    const std::uint64_t pairs = row["pairs"], done = row["done"];
    text += fmt::format(
        "{:<24} {:>12} {:<9} {:>22} {:>11} {:>9} {:>13} {:>10} {:>6}\n", printable(row["directory"].get<std::string>()),
        row["shard"].is_null() ? "-" : row["shard"].get<std::string>(), row["state"].get<std::string>(),
        fmt::format("{} ({}%)", reports::grouped(done), pairs == 0 ? 0 : 100 * done / pairs),
        reports::grouped(static_cast<std::uint64_t>(row["rate"].get<double>())),
        row["seconds_left"].is_null() ? "-" : duration(row["seconds_left"].get<double>()),
        reports::grouped(row["disagreements"]), reports::grouped(row["signatures"]), reports::grouped(row["new"]));
    if (row.contains("why")) text += "  " + printable(row["why"].get<std::string>()) + '\n';
  }
  std::vector<std::string> states;
  for (const auto& [state, count] : all["states"].items())
    states.push_back(fmt::format("{} {}", count.get<int>(), state));
  const std::string left =
      all["seconds_left"].is_null() ? "" : ", " + duration(all["seconds_left"].get<double>()) + " left at this rate";
  text += fmt::format(
      "{} of {} pairs, {} pairs/s{}; {}\n", reports::grouped(all["done"]), reports::grouped(all["pairs"]),
      reports::grouped(static_cast<std::uint64_t>(all["rate"].get<double>())), left, fmt::join(states, ", "));
  return text;
}

// Returns the figures in Prometheus' text format. Prometheus' node exporter reads such text from a folder of *.prom
// files.
std::string prometheus(const Json& all) {
  const auto label = [](const std::string& text) {
    std::string escaped;
    for (const char c : printable(text)) escaped += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return escaped;
  };
  std::string text;
  for (const auto& [name, help] : {std::pair{"pairs", "Pairs that the shard has."},
                                   {"done", "Pairs that are judged."},
                                   {"rate", "Pairs judged per second; 0 if the shard is not running."},
                                   {"disagreements", "Pairs on which some lane is wrong."},
                                   {"signatures", "Signatures seen."},
                                   {"new", "Signatures, ignoring margins, that no earlier shard in the list has."}}) {
    text += fmt::format("# HELP graze_{0} {1}\n# TYPE graze_{0} gauge\n", name, help);
    for (const Json& row : all["shards"]) {
      text += fmt::format("graze_{}{{directory=\"{}\",shard=\"{}\",state=\"{}\"}} {}\n", name, label(row["directory"]),
                          row["shard"].is_null() ? "" : row["shard"].get<std::string>(),
                          row["state"].get<std::string>(), row[name].dump());
    }
  }
  return text;
}

int status_command(const StatusOptions& options) {
  const Json all = status_of(options);
  if (!options.prometheus.empty()) write_result(options.prometheus, prometheus(all), fuzz::NamedBy::user);
  std::cout << (options.json ? all.dump(1, ' ', false, Json::error_handler_t::replace) + '\n' : table(all));
  for (const char* bad : {"failed", "killed", "stalled"}) {
    if (all["states"].contains(bad)) return 1;
  }
  return 0;
}

}  // namespace

void add_status(CLI::App& app, int& status) {
  CLI::App* command =
      app.add_subcommand("status", "Show how far shards are; exit with 1 if one has failed, was killed or has stalled");
  command->footer("Example: graze status shard-*");
  auto options = std::make_shared<StatusOptions>();
  command
      ->add_option("DIR", options->directories,
                   "Directories of shards or campaigns, including those that mpirun started")
      ->required();
  add_valued(*command, "--stalled", options->stalled, "SECONDS",
             "Time without an update after which a run counts as stalled, in seconds")
      ->transform(whole_number(1, 1'000'000'000))
      ->capture_default_str();
  add_valued(*command, "--prometheus", options->prometheus, "FILE",
             "File to write the figures to, in Prometheus' text format");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &status] { status = status_command(*options); });
}

}  // namespace graze::cli
