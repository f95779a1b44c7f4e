// SPDX-License-Identifier: Apache-2.0
// The `graze` command. Exit status: 0 done, 1 a failed run or a failed check, 2 wrong use, 130 interrupted.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/help.h"
#include "cli/interrupt.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/campaign.h"

namespace {

// Adds all verbs, in groups for `graze --help`.
void add_verbs(CLI::App& app, int& status) {
  std::string task;
  const auto add = [&](void (*verb)(CLI::App&, int&)) {
    verb(app, status);
    app.get_subcommands([](const CLI::App*) { return true; }).back()->group(task);
  };
#define GRAZE_TASK(name) task = name;
#define GRAZE_VERB(name, build) add(graze::cli::add_##name);
#include "cli/verbs.inc"
#undef GRAZE_VERB
#undef GRAZE_TASK
}

// Rejects values that are empty or options, as if the value were forgotten. Only compiler flags may be either.
void refuse_empty_texts(CLI::App& app) {
  const CLI::Validator not_empty(
      [](std::string& text) {
        return text.empty() || text.starts_with("--") ? fmt::format("expected a value, found '{}'", text) : "";
      },
      "");
  for (CLI::Option* option : app.get_options()) {
    if (option->get_type_size_max() > 0 && option->get_name() != "--flags") option->check(not_empty);
  }
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) refuse_empty_texts(*verb);
}

// Expects a verb as the first word, or a flag that needs no verb.
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

// "; did you mean '--lanes'?" for the first option that the verb does not have; empty if no option is similar.
std::string option_meant(const CLI::App& app, int argc, char** argv) {
  const auto verb_of = [](const CLI::App& of, const std::string& name) {
    const auto found = of.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
    return found.empty() ? nullptr : found.front();
  };
  const CLI::App* verb = argc > 1 ? verb_of(app, argv[1]) : nullptr;
  for (int a = 2; verb && a < argc; ++a) {
    if (const CLI::App* inner = verb_of(*verb, argv[a])) {
      verb = inner;
      continue;
    }
    const std::string_view word = argv[a], name = word.substr(0, word.find('='));
    if (!name.starts_with("--")) continue;
    std::vector<std::string> options;
    for (const CLI::Option* option : verb->get_options()) {
      for (const std::string& of_option : option->get_lnames()) options.push_back("--" + of_option);
    }
    if (std::find(options.begin(), options.end(), name) == options.end()) return graze::did_you_mean(name, options);
  }
  return "";
}

// Prints one line, even if the quoted names and texts contain control characters.
int fail(std::string what, int status) {
  for (char& c : what) c = static_cast<unsigned char>(c) < ' ' || c == '\x7f' ? ' ' : c;
  // If this line cannot be written either, only the exit status shows the failure.
  std::fputs(fmt::format("{} {}\n", graze::reports::red(graze::cli::error_screen(), "graze:"), what).c_str(), stderr);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Find the pairs of triangles on which an intersection test is wrong, and prove each with exact arithmetic.",
      "graze"};
  graze::cli::format_help(app);
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag(
      "--version", [] { return fmt::format("{} (commit {})", GRAZE_VERSION, graze::fuzz::commit_of_build()); },
      "Print the version and the commit");
  app.require_subcommand(1);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond a file-size limit then fails, as on a full disk
  int status = 0;
  add_verbs(app, status);
  app.footer("Run `graze VERB --help` for the options of a verb.");  // verbs that exist already keep their own footers
  graze::cli::add_force(app);
  refuse_empty_texts(app);
  try {
    std::cout.exceptions(std::ios_base::badbit);
    expect_verb(app, argc > 1 ? argv[1] : "");
    // "[a,b]" is a file name here, but CLI11 would parse it as a list. For "--out=" it would take the next word.
    std::vector<std::string> words;
    for (std::string word : std::vector<std::string>(argv + 1, argv + argc)) {
      const bool is_empty = word.starts_with("--") && word.find('=') == word.size() - 1;
      if (word.starts_with('[') && word.ends_with(']')) word.insert(0, "./");
      words.push_back(is_empty ? word.substr(0, word.size() - 1) : std::move(word));
      if (is_empty) words.emplace_back();
    }
    std::reverse(words.begin(), words.end());
    app.parse(std::move(words));
    errno = 0;
    if (std::fflush(stdout) != 0 || std::ferror(stdout) || !std::cout.flush())
      throw std::runtime_error(graze::cannot("write", "standard output", errno != 0 ? errno : EIO));
    return status;
  } catch (const CLI::Success& help) {
    std::cout.exceptions(std::ios_base::goodbit);
    app.exit(help);
    if (std::cout.flush()) return 0;
    return fail(graze::cannot("write", "standard output", errno != 0 ? errno : EIO), 1);
  } catch (const CLI::ParseError& error) {
    return fail(
        fmt::format("{}; see `graze{} --help`{}", error.what(),
                    argc > 1 && *argv[1] != '-' ? std::string(" ") + argv[1] : "", option_meant(app, argc, argv)),
        2);
  } catch (const graze::Stopped&) {
    return fail("interrupted", graze::cli::kInterrupted);
  } catch (const graze::UsageError& error) {
    return fail(error.what(), 2);
  } catch (const nlohmann::json::exception& error) {
    return fail(fmt::format("a JSON file does not have the form that this build writes ({})", error.what()), 1);
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory", 1);
  } catch (const std::ios_base::failure&) {  // only std::cout throws it
    return fail(graze::cannot("write", "standard output", errno != 0 ? errno : EIO), 1);
  } catch (const std::exception& error) {
    constexpr std::string_view kByFmt = "cannot write to file";  // fmt does not know that this is standard output
    std::string what = error.what();
    if (what.starts_with(kByFmt)) what.replace(0, kByFmt.size(), "cannot write standard output");
    return fail(what, 1);
  }
}
