// SPDX-License-Identifier: Apache-2.0
// The `graze` command. Exit status: 0 done, 1 a failed run or a failed check, 2 wrong use, 130 interrupted.
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <iostream>

#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"

namespace {

// The first word is a verb, or one of the flags that stand without one.
void expect_verb(const CLI::App& app, const std::string& word) {
  if (word == "--help" || word == "-h" || word == "--version") return;
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (std::find(verbs.begin(), verbs.end(), word) != verbs.end()) return;
  throw graze::UsageError(
      "expected a verb (see `graze --help`), found " +
      (word.empty() ? "none" : "'" + graze::printable(word) + "'" + graze::did_you_mean(word, verbs)));
}

// One line, whatever is in the names and texts that it quotes.
int fail(std::string what, int status) {
  for (char& c : what) c = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  // Where even this cannot be written, the exit status says it all.
  std::fputs(fmt::format("{} {}\n", graze::reports::red(graze::cli::error_screen(), "graze:"), what).c_str(), stderr);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Graze finds where a triangle-triangle intersection test stops being right, and proves it.", "graze"};
  app.set_version_flag("--version", GRAZE_VERSION);
  app.require_subcommand(1);
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit shows as a failed write, as a full disk does
  int status = 0;
  graze::cli::add_fuzz(app, status);
  graze::cli::add_merge(app, status);
  graze::cli::add_status(app, status);
  graze::cli::add_plan(app, status);
  graze::cli::add_hunt(app, status);
  graze::cli::add_check(app, status);
  graze::cli::add_repro(app, status);
  graze::cli::add_minimize(app, status);
  graze::cli::add_corpus(app, status);
  graze::cli::add_explain(app, status);
  graze::cli::add_kinds(app, status);
  graze::cli::add_league(app, status);
  graze::cli::add_map(app, status);
  graze::cli::add_view(app, status);
  graze::cli::add_dump(app, status);
  graze::cli::add_report(app, status);
  graze::cli::add_scene(app, status);
  graze::cli::add_lanes(app, status);
  graze::cli::add_strata(app, status);
  graze::cli::add_laws(app, status);
  graze::cli::add_trade(app, status);
  graze::cli::add_tune(app, status);
  graze::cli::add_prove_twin(app, status);
  graze::cli::add_query(app, status);
  graze::cli::add_bench(app, status);
  graze::cli::add_force(app);
  try {
    expect_verb(app, argc > 1 ? argv[1] : "");
    app.parse(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout.flush())
      throw std::runtime_error("standard output: expected room for the output, found none");
    return status;
  } catch (const CLI::Success& help) {
    app.exit(help);
    return std::cout.flush() ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    return fail(fmt::format("{} (see `graze --help`)", error.what()), 2);
  } catch (const graze::Stopped&) {
    return fail("interrupted", graze::cli::kInterrupted);
  } catch (const graze::UsageError& error) {
    return fail(error.what(), 2);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}
