// SPDX-License-Identifier: Apache-2.0
// `graze corpus`: maintains the regression corpus. `add` adds failures, `list` shows them, `verify` replays them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>

#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/regression/found_failure.h"
#include "reports/junit.h"
#include "reports/terminal.h"

namespace graze::cli {

using fuzz::Json;
namespace {

struct CorpusOptions {
  std::string folder = "corpus/regression";
  std::vector<std::string> names;  // cases and campaigns
  std::vector<std::string> signatures;
  std::size_t most = std::numeric_limits<std::size_t>::max();
  LaneOptions lanes;
  bool update = false;
  bool exact_input = false;
  std::string junit;

  std::filesystem::path file() const { return std::filesystem::path(folder) / "cases.pairs"; }
};

fuzz::RegressionCorpus read_corpus(const CorpusOptions& options) {
  if (!std::filesystem::exists(options.file())) {
    throw std::runtime_error(cannot("read", options.file(), "there is no such corpus; `graze corpus add` makes one"));
  }
  fuzz::RegressionCorpus corpus = fuzz::read_regressions(options.file());
  if (corpus.empty())
    throw std::runtime_error("there is no case in " + options.file().string() + "; `graze corpus add` adds one");
  return corpus;
}

fuzz::DecideLanes decide_by(const fuzz::SelectedLanes& under_test) {
  return
      [&under_test](const AnyPair& pair, std::vector<const Lane*>& apart) { return decide(under_test, pair, apart); };
}

void print_next(const CorpusOptions& options, const char* verb) {
  const bool usual = options.folder == CorpusOptions().folder;
  fmt::print("Next: graze corpus {}{}\n", verb, usual ? "" : " --corpus " + path_word(options.folder));
}

// Throws: UsageError if two of the named campaigns recorded different code under one name.
void expect_same_code(const std::vector<std::string>& names) {
  std::map<std::string, std::pair<std::string, Json>> known;  // by subject: the campaign, and what it recorded
  for (const std::string& name : names) {
    for (const Json& row : recorded_spec_of(name).value("subjects", Json::array())) {
      const auto& [other, before] = known.try_emplace(row.at("name"), name, row).first->second;
      if (before.at("hash") == row.at("hash")) continue;
      throw UsageError(
          fmt::format("cannot add {} together with {}: they ran different code under the name {} ({} and {}); add them "
                      "one at a time",
                      printable(other), printable(name), printable(row["name"].get<std::string>()),
                      printable(before["what"].get<std::string>()), printable(row["what"].get<std::string>())));
    }
  }
}

void add(const CorpusOptions& options) {
  expect_same_code(options.names);
  for (const std::string& name : options.names) open_subjects_of(name, options.lanes.resubject);
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes);
  const fuzz::DecideLanes by_bench = decide_by(under_test);
  const Json build = fuzz::build_info(under_test);
  std::vector<std::pair<std::string, std::vector<fuzz::FoundFailure>>> found;
  for (const std::string& name : options.names) {
    if (!std::filesystem::is_directory(name) && (!options.signatures.empty() || options.most != CorpusOptions().most))
      throw UsageError("--signatures and --top choose signatures of campaigns, and " + name +
                       " is a file of cases; leave these options out");
    found.emplace_back(name, std::filesystem::is_directory(name)
                                 ? fuzz::found_in_campaign(name, options.signatures, options.most)
                                 : fuzz::found_in_cases(read_noted_cases(name, options.exact_input), build,
                                                        under_test.lanes, by_bench));
    if (found.back().second.empty())
      throw std::runtime_error(
          "there is nothing to add in " + name +
          (std::filesystem::is_directory(name) ? ": no signature matches" : ": no lane is wrong on any of its cases"));
  }

  made_folder(options.folder, "cases.pairs");
  // The lock is held from reading the corpus to writing it, so that two concurrent commands lose nothing.
  const fuzz::FolderLock lock(options.folder, fuzz::FolderLock::WhenTaken::wait);
  fuzz::RegressionCorpus corpus;
  if (std::filesystem::exists(options.file())) corpus = fuzz::read_regressions(options.file());
  std::array<std::size_t, 4> count{};
  const std::size_t& not_run = count[3];
  std::vector<std::string> with_not_run;
  for (const auto& [name, failures] : found) {
    if (std::any_of(failures.begin(), failures.end(), [](const auto& failure) { return bool(failure.entry.doubles); }))
      fuzz::add_exact_on_doubles(under_test);
  }
  for (const auto& [name, failures] : found) {
    const std::size_t before = not_run;
    for (const fuzz::FoundFailure& failure : failures) {
      try {
        ++count[static_cast<std::size_t>(fuzz::add(corpus, failure, under_test.lanes, by_bench))];
      } catch (const std::runtime_error& error) {
        throw std::runtime_error((failure.file.empty() ? name : failure.file) + ": " + error.what());
      }
    }
    if (not_run > before) with_not_run.push_back(printable(name));
  }
  if (not_run > 0) {
    const std::string why =
        fmt::format("{}: {} not added: no lane that was wrong on {} runs here; choose other --lanes",
                    fmt::join(with_not_run, ", "), reports::counted(not_run, "failure"), not_run == 1 ? "it" : "them");
    if (not_run == std::accumulate(count.begin(), count.end(), std::size_t{0})) throw std::runtime_error(why);
    fmt::print(stderr, "graze: {}\n", why);
  }
  fuzz::write_regressions(options.file(), corpus);
  fmt::print("{} new, {} seen again, {} known already; {} holds {}\n", reports::grouped(count[0]),
             reports::grouped(count[1]), reports::grouped(count[2]), printable(options.file().string()),
             reports::grouped(corpus.size()));
  print_next(options, "verify");
}

void list(const CorpusOptions& options) {
  for (const auto& [signature, c] : read_corpus(options)) {
    fmt::print("{:<8}{:>11}  {}\n{:21}{}\n{:21}first: {}\n{:21}last:  {}\n", name(c.state), reports::grouped(c.count),
               printable(c.name), "", printable(signature), "", printable(c.first), "", printable(c.last));
  }
  print_next(options, "verify");
}

// Returns lines such as "Not run: mine. …", which name the subjects and lanes that have recorded verdicts but did not
// run: subjects that need --subject, and lanes of published algorithms that this build does not have.
std::string not_run(const fuzz::RegressionCorpus& corpus) {
  std::set<std::string> subjects, unknown;
  for (const auto& [signature, c] : corpus) {
    for (const auto& [id, mark] : c.marks) {
      if (find_lane(id)) continue;
      const std::string subject = parse_lane_name(id).value().subject;
      const bool published = std::any_of(lanes().begin(), lanes().end(),
                                         [&](const Lane& lane) { return lane.info->id == subject && !lane.foreign; });
      published ? unknown.insert(id) : subjects.insert(subject);
    }
  }
  std::string text;
  if (!subjects.empty())
    text += fmt::format("Not run: {}. Give your own code with --subject NAME=WHAT.\n",
                        printable(fmt::format("{}", fmt::join(subjects, ", "))));
  if (!unknown.empty())
    text += fmt::format("Not run: {}. There is no such lane here; --toolchains adds lanes of other compilers.\n",
                        printable(fmt::format("{}", fmt::join(unknown, ", "))));
  return text;
}

bool has_doubles(const fuzz::RegressionCorpus& corpus) {
  return std::any_of(corpus.begin(), corpus.end(), [](const auto& row) { return !row.second.pair.floats; });
}

// Returns "Not run on pairs of doubles: …", which lists the lanes that decide only float32 pairs; empty for none.
std::string not_run_on_doubles(const fuzz::RegressionCorpus& corpus, const fuzz::SelectedLanes& under_test) {
  std::vector<std::string> ids;
  if (has_doubles(corpus)) {
    for (const Lane* lane : under_test.lanes) {
      if (!fuzz::takes(*lane, DoublePair{})) ids.push_back(lane->id);
    }
  }
  return ids.empty() ? "" : printable(fmt::format("Not run on pairs of doubles: {}.", fmt::join(ids, ", "))) + '\n';
}

// One test per case: it fails if a verdict differs from the record.
std::vector<reports::JunitCase> tests_of(const std::string& file, const fuzz::RegressionCorpus& corpus,
                                         const fuzz::Verified& result) {
  std::vector<reports::JunitCase> tests;
  for (const auto& [signature, c] : corpus) {
    reports::JunitCase& test = tests.emplace_back(reports::JunitCase{file, c.name, "", ""});
    for (const fuzz::Change& change : result.changes) {
      if (change.name == c.name) test.failure += (test.failure.empty() ? "" : "\n") + change.what;
    }
    if (!test.failure.empty()) test.failure += "\n" + fuzz::pair_text(c.pair);
  }
  return tests;
}

int verify(const CorpusOptions& options) {
  fuzz::SelectedLanes under_test = selected_lanes(options.lanes);
  std::optional<fuzz::FolderLock> lock;
  if (options.update && std::filesystem::exists(options.folder))
    lock.emplace(options.folder, fuzz::FolderLock::WhenTaken::wait);
  fuzz::RegressionCorpus corpus = read_corpus(options);
  if (has_doubles(corpus)) fuzz::add_exact_on_doubles(under_test);
  const fuzz::Verified result = graze::fuzz::verify(corpus, under_test.lanes, decide_by(under_test));
  std::array<std::size_t, 3> states{};
  for (const auto& [signature, c] : corpus) ++states[static_cast<std::size_t>(c.state)];
  for (const fuzz::Change& change : result.changes)
    fmt::print("{}: {}\n", printable(change.name), printable(change.what));
  if (options.update) fuzz::write_regressions(options.file(), corpus);
  fmt::print("{} cases on {} lanes: {} failing, {} fixed, {} flaky; {} verdicts compared, {} changes{}\n",
             reports::grouped(corpus.size()), under_test.lanes.size(), states[0], states[1], states[2],
             reports::grouped(result.compared), result.changes.size(), options.update ? ", recorded" : "");
  if (const std::string evidence = cuda_evidence(under_test); !evidence.empty())
    fmt::print("CUDA lanes: {}\n", evidence);
  fmt::print("{}{}", not_run(corpus), not_run_on_doubles(corpus, under_test));
  if (options.update) return 0;
  if (result.compared == 0)
    throw std::runtime_error(options.file().string() +
                             " has no verdict of these lanes to compare with; choose other --lanes");
  if (!options.junit.empty())
    write_result(options.junit, reports::junit(tests_of(options.file().string(), corpus, result)), fuzz::NamedBy::user);
  if (!result.changes.empty()) print_next(options, "verify --update");
  return result.changes.empty() ? 0 : 1;
}

CLI::App* add_verb(CLI::App& corpus, const char* name, const char* what, const char* example,
                   const std::shared_ptr<CorpusOptions>& options) {
  CLI::App* command = corpus.add_subcommand(name, what)->group("Verbs");
  command->footer(example);
  add_valued(*command, "--corpus", options->folder, "DIR", "Folder of the corpus")->capture_default_str();
  return command;
}

}  // namespace

void add_corpus(CLI::App& app, int& status) {
  CLI::App* corpus = app.add_subcommand("corpus", "Add failures to a regression corpus, list them, and replay them");
  corpus->require_subcommand(1);
  corpus->footer("Example: graze corpus list");
  auto options = std::make_shared<CorpusOptions>();

  CLI::App* command = add_verb(
      *corpus, "add", "Add failures to the corpus, one case per signature, and record where it was first and last seen",
      "Example: graze corpus add near_edge_edge:1:42 --corpus regression", options);
  command
      ->add_option(
          "CASE", options->names,
          "Campaign directories (the first case of each signature is added), files of cases, or STRATUM:SEED:INDEX")
      ->required();
  add_globs(*command, "--signatures", options->signatures, "Patterns of the campaign's signatures to add");
  add_valued(*command, "--top", options->most, "N", "Number of signatures to add per algorithm, most frequent first")
      ->transform(whole_number(1, 1'000'000'000))
      ->default_str("all");
  add_exact_input(*command, options->exact_input);
  add_lane_options(*command, options->lanes);
  add_resubject_option(*command, options->lanes);
  add_force_flag(*command);
  command->callback([options] { add(*options); });

  command = add_verb(*corpus, "list", "List the cases: state, count, name, signature, first and last failure",
                     "Example: graze corpus list --corpus regression", options);
  command->callback([options] { list(*options); });

  command = add_verb(*corpus, "verify",
                     "Replay every case on every lane; exit with 1 if a verdict differs from the recorded one",
                     "Example: graze corpus verify --corpus regression", options);
  add_lane_options(*command, options->lanes);
  command->add_flag("--update", options->update,
                    "Record this run in the corpus: verdicts, and whether a case is failing, fixed or flaky");
  add_junit(*command, options->junit, "one test for each case");
  command->callback([options, &status] { status = verify(*options); });
}

}  // namespace graze::cli
