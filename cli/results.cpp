// SPDX-License-Identifier: Apache-2.0
#include "cli/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/cannot.h"
#include "core/error.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/own_files.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

void refuse_folder(const fs::path& out, const std::string& own) {
  throw UsageError(
      cannot("write into", out, "it holds other files; choose a new or an empty folder, " + own + ", or add --force"));
}

[[noreturn]] void refuse_unwritable(const fs::path& out, std::error_code error) {
  throw std::runtime_error(cannot("write into", out, error.message()));
}

}  // namespace

void add_force_flag(CLI::App& verb) {
  verb.add_flag("--force", fuzz::may_replace_foreign,
                "Replace files that graze did not write, and write into folders that hold other files");
}

void add_force(CLI::App& app) {
  for (CLI::App* verb : app.get_subcommands([](const CLI::App* v) { return v->get_name() != "merge"; })) {
    add_force(*verb);  // `corpus` has its own verbs
    const char* const places[] = {"--out", "--plot", "--obj", "--prometheus", "--junit", "--json"};
    const auto is_place = [&](const char* name) {
      const CLI::Option* const option = verb->get_option_no_throw(name);
      return option && option->get_type_size() > 0;  // --json is a flag in most verbs
    };
    if (std::any_of(std::begin(places), std::end(places), is_place)) add_force_flag(*verb);
  }
}

void add_junit(CLI::App& command, std::string& file, const std::string& tests) {
  command.add_option("--junit", file, "Write the result as JUnit XML too: " + tests)->option_text("FILE");
}

fs::path made_folder(const fs::path& out, const char* own) {
  if (!fuzz::may_replace_foreign && !fuzz::may_fill(out, {own}) && !fuzz::may_hold_campaign(out))
    refuse_folder(out, fmt::format("one with {} or a campaign", own));
  std::error_code error;
  fs::create_directories(out, error);
  if (error) refuse_unwritable(out, error);
  expect_writable(out);
  return out;
}

void expect_replaceable(const fs::path& file, const std::string& text) {
  if (!fuzz::may_replace_foreign && !fuzz::may_replace(file, text))
    throw UsageError(cannot("replace", file, fuzz::kForeign));
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw std::runtime_error(cannot("write", file, EISDIR));
}

void write_result(const fs::path& file, const std::string& text, fuzz::NamedBy named_by) {
  expect_replaceable(file, text);
  fuzz::write_whole(file, text, named_by);
}

void write_results(const fs::path& folder, const std::vector<Result>& results) {
  for (const Result& result : results) {
    fuzz::expect_file(folder / result.name);
    expect_replaceable(folder / result.name, result.text);
  }
  for (const Result& result : results) fuzz::write_whole(folder / result.name, result.text);
}

void remove_result(const fs::path& file, const std::string& text) {
  if (fs::is_regular_file(file) && fuzz::may_replace(file, text)) fs::remove(file);
}

void expect_writable(const fs::path& folder) {
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse_unwritable(folder, {errno, std::generic_category()});
}

void expect_campaign_folder(const fs::path& out) {
  if (!fuzz::may_replace_foreign && !fuzz::may_hold_campaign(out)) refuse_folder(out, "a campaign directory");
}

ResultFolder::ResultFolder(const std::string& out, const char* own)
    : path(made_folder(out, own)), alone(path, fuzz::FolderLock::WhenTaken::refuse) {}

}  // namespace graze::cli
