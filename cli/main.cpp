// SPDX-License-Identifier: Apache-2.0
// The `graze` command. Exit status: 0 done, 1 a failed run or a failed check, 2 wrong use, 130 interrupted.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <iostream>

#include "cli/commands.h"
#include "cli/help.h"
#include "cli/interrupt.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"

namespace {

// A group of verbs in `graze --help`.
struct Task {
  const char* name;
  std::vector<void (*)(CLI::App& app, int& status)> verbs;
};
const Task kTasks[] = {
    {"Find failures",
     {graze::cli::add_fuzz, graze::cli::add_hunt, graze::cli::add_check, graze::cli::add_invariants,
      graze::cli::add_strata, graze::cli::add_scene}},
    {"Understand failures",
     {graze::cli::add_repro, graze::cli::add_minimize, graze::cli::add_explain, graze::cli::add_failures,
      graze::cli::add_map, graze::cli::add_discrepancy, graze::cli::add_view}},
    {"Choose algorithms and tolerances",
     {graze::cli::add_lanes, graze::cli::add_tune, graze::cli::add_pareto, graze::cli::add_league,
      graze::cli::add_query, graze::cli::add_bench}},
    {"Scale to many machines", {graze::cli::add_plan, graze::cli::add_status, graze::cli::add_merge}},
    {"Keep and publish results",
     {graze::cli::add_report, graze::cli::add_corpus, graze::cli::add_dump, graze::cli::add_prove_twin}}};

// Expects a verb as the first word, or one of the flags that stand without a verb.
void expect_verb(const CLI::App& app, const std::string& word) {
  if (word == "--help" || word == "-h" || word == "--version") return;
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (std::find(verbs.begin(), verbs.end(), word) != verbs.end()) return;
  throw graze::UsageError(word.empty() ? "no verb is given; `graze --help` lists them"
                                       : "there is no verb '" + graze::printable(word) +
                                             "'; `graze --help` lists them" + graze::did_you_mean(word, verbs));
}

// Prints one line, even if the quoted names and texts contain control characters.
int fail(std::string what, int status) {
  for (char& c : what) c = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  // If even this cannot be written, only the exit status tells of the failure.
  std::fputs(fmt::format("{} {}\n", graze::reports::red(graze::cli::error_screen(), "graze:"), what).c_str(), stderr);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Find the pairs of triangles on which an intersection test is wrong, and prove each by exact arithmetic.",
      "graze"};
  graze::cli::format_help(app);
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", GRAZE_VERSION, "Print the version");
  app.require_subcommand(1);
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a file-size limit then fails a write, like a full disk
  int status = 0;
  for (const Task& task : kTasks) {
    for (const auto add : task.verbs) {
      add(app, status);
      app.get_subcommands([](const CLI::App*) { return true; }).back()->group(task.name);
    }
  }
  app.footer("Run `graze VERB --help` for the options of a verb.");  // verbs that exist already keep their own footers
  graze::cli::add_force(app);
  try {
    expect_verb(app, argc > 1 ? argv[1] : "");
    app.parse(argc, argv);
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout.flush())
      throw std::runtime_error(graze::cannot("write", "standard output", errno != 0 ? errno : EIO));
    return status;
  } catch (const CLI::Success& help) {
    app.exit(help);
    return std::cout.flush() ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    return fail(fmt::format("{}; see `graze{} --help`", error.what(),
                            argc > 1 && *argv[1] != '-' ? std::string(" ") + argv[1] : ""),
                2);
  } catch (const graze::Stopped&) {
    return fail("interrupted", graze::cli::kInterrupted);
  } catch (const graze::UsageError& error) {
    return fail(error.what(), 2);
  } catch (const std::exception& error) {
    constexpr std::string_view kByFmt = "cannot write to file";  // fmt does not know that this is standard output
    std::string what = error.what();
    if (what.starts_with(kByFmt)) what.replace(0, kByFmt.size(), "cannot write standard output");
    return fail(what, 1);
  }
}
