// SPDX-License-Identifier: Apache-2.0
// `graze report`: writes a campaign as a page and as data.
#include "reports/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "cli/changed.h"
#include "cli/commands.h"
#include "cli/results.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/sealed.h"
#include "reports/comparison.h"
#include "reports/page.h"

namespace graze::cli {

using fuzz::Json;
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::string directory, from, out;
  std::vector<std::string> compare;
};

void say_what_the_page_is() {
  if (!reports::has_interactive_page())
    fmt::print("The page is plain: this build had no Node, or no npm packages (see reports/README.md)\n");
}

// Writes NAME.html, NAME.json, costs.json and tables to the directory.   Returns: the names of these files, the page
// first.
std::vector<std::string> write_report(const fs::path& directory, const Json& report, const char* name) {
  Json costs = reports::make_costs(directory);
  const Json kept = fuzz::sealed(report);
  if (!costs.is_null()) costs["report"] = kept.at("checksum");
  const std::string html = reports::page(report, costs, reports::make_choices(directory));
  const fuzz::FolderLock alone(directory, fuzz::FolderLock::WhenTaken::refuse);
  std::vector<Result> results = {{fmt::format("{}.json", name), reports::report_text(kept)},
                                 {fmt::format("{}.html", name), html}};
  if (!costs.is_null()) results.push_back({"costs.json", reports::report_text(fuzz::sealed(costs))});
  for (const reports::CsvTable& table : reports::csv_tables(directory, report))
    results.push_back({table.name, table.text});
  if (!fs::exists(directory / "margins.svg"))  // a merge that was killed at its end leaves no picture
    results.push_back({"margins.svg", reports::margin_figure(fuzz::checked_summary(directory))});
  write_results(directory, results);
  if (costs.is_null()) remove_result(directory / "costs.json", R"({"machine": "", "passes": 0})");
  std::vector<std::string> names;
  for (const Result& result : results) names.push_back(result.name);
  std::swap(names[0], names[1]);
  return names;
}

void say_report(const fs::path& directory, const Json& report, const std::vector<std::string>& names) {
  fmt::print("Wrote {}/{}\n", printable(directory.string()), fmt::join(names, ", "));
  if (!report["toolchains"].is_null()) {
    for (const Json& sentence : report["toolchains"]["sentences"]) fmt::print("{}\n", sentence.get<std::string>());
  }
  for (const Json& sentence : report["missing"]) {
    std::string text = sentence;  // the report itself names no folder
    const std::string placeholder = " DIR", named = ' ' + path_word(directory.string());
    for (std::size_t at = 0; (at = text.find(placeholder, at)) != text.npos; at += named.size())
      text.replace(at, placeholder.size(), named);
    fmt::print("{}\n", text);
  }
  say_what_the_page_is();
}

// Returns the page of a stored report. The page includes lane costs and the results of tune and pareto if they are in
// the same folder.
std::string page_of(const std::string& file) {
  try {
    const Json report = reports::read_report(file);
    const Json costs = reports::stored_costs(fs::path(file).replace_filename("costs.json"), report);
    return reports::page(report, costs, reports::make_choices(fs::path(file).parent_path()));
  } catch (const Json::exception&) {
    throw std::runtime_error(cannot("use", file, "it is not a report of `graze report`"));
  }
}

// Makes the campaign's report. Opens its foreign code, because the programs that show a failure need it.
Json make_report(const fs::path& directory) {
  const auto missing = open_unchanged_subjects(recorded_spec_of(directory));
  Json report = reports::make_report(directory);
  for (const auto& [subject, why] : missing)
    report["missing"].push_back(
        fmt::format("No program shows a failure of {}, because the code that the campaign ran cannot be opened: {}.",
                    printable(subject), why));
  return report;
}

void report(const ReportOptions& options) {
  const int named = !options.directory.empty() + !options.from.empty() + !options.compare.empty();
  if (named != 1)
    throw UsageError(fmt::format("graze report needs exactly one of DIR, --compare and --from, but got {}", named));
  if (options.from.empty() != options.out.empty())
    throw UsageError("--from and --out work only together; add the missing option");
  if (!options.from.empty()) {
    write_result(options.out, page_of(options.from), fuzz::NamedBy::user);
    fmt::print("Wrote {}\n", printable(options.out));
    say_what_the_page_is();
  } else if (!options.compare.empty()) {
    // The first campaign's report is made while no foreign code is open, because only its counts are needed, and both
    // campaigns may use the same name for different code.
    const Json before = reports::make_report(options.compare[0]);
    Json after = make_report(options.compare[1]);
    const Json rows =
        reports::same_pairs(before, after) ? changed_rows(options.compare[0], options.compare[1]) : Json();
    reports::add_comparison(after, before, fuzz::read_kinds(options.compare[1]), fuzz::read_kinds(options.compare[0]),
                            rows);
    print_comparison(after["compare"]);
    say_report(options.compare[1], after, write_report(options.compare[1], after, "compare"));
  } else {
    const Json made = make_report(options.directory);
    say_report(options.directory, made, write_report(options.directory, made, "report"));
    if (made["signature_count"] > 0) {
      const bool minimised = !fuzz::read_kinds(options.directory).is_null();
      // A minimised campaign with pairs of doubles has no next command.
      if (minimised && fuzz::has_doubles(fuzz::recorded_spec(options.directory))) return;
      fmt::print("Next: graze {} {}\n", minimised ? "corpus add" : "minimize", path_word(options.directory));
    }
  }
}

}  // namespace

void write_report(const std::string& directory) { write_report(directory, make_report(directory), "report"); }

void add_report(CLI::App& app, int&) {
  CLI::App* command =
      app.add_subcommand("report", "Write a campaign as one web page that works offline, and as JSON and CSV tables");
  command->footer("Example: graze report campaign");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("DIR", options->directory,
                      "Campaign directory; report.html, report.json and the tables are written into it");
  add_valued(*command, "--compare", options->compare, "DIR1 DIR2",
             "Two campaigns: writes a report on the second and on its changes since the first, as compare.html "
             "and compare.json in the second directory")
      ->expected(2);
  add_valued(*command, "--from", options->from, "FILE",
             "Existing report.json from which only the page is written, to the file given by --out");
  add_valued(*command, "--out", options->out, "FILE", "File for the page of --from");
  command->callback([options] { report(*options); });
}

}  // namespace graze::cli
