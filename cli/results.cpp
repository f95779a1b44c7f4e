// SPDX-License-Identifier: Apache-2.0
#include "cli/results.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/error.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/own_files.h"

namespace graze::cli {
namespace {

namespace fs = std::filesystem;

void refuse_folder(const fs::path& out, const std::string& own) {
  throw UsageError(
      fmt::format("{}: expected a new or an empty folder, or {}, found other things; choose another --out, or --force",
                  out.string(), own));
}

[[noreturn]] void refuse_unwritable(const fs::path& out, std::error_code error) {
  throw std::runtime_error(out.string() + ": expected a folder that can be written, found: " + error.message());
}

fs::path made(const fs::path& out, const char* own) {
  if (!fuzz::may_replace_foreign && !fuzz::may_fill(out, {own}) && !fuzz::may_hold_campaign(out))
    refuse_folder(out, fmt::format("one with {} or a campaign", own));
  std::error_code error;
  fs::create_directories(out, error);
  if (error) refuse_unwritable(out, error);
  expect_writable(out);
  return out;
}

}  // namespace

void add_force(CLI::App& app) {
  for (CLI::App* verb : app.get_subcommands([](const CLI::App* v) { return v->get_name() != "merge"; })) {
    const char* const places[] = {"--out", "--plot", "--obj", "--prometheus"};
    if (std::any_of(std::begin(places), std::end(places),
                    [&](const char* name) { return verb->get_option_no_throw(name); }))
      verb->add_flag("--force", fuzz::may_replace_foreign,
                     "Replace files that graze did not write, and use folders with other things");
  }
}

void expect_replaceable(const fs::path& file, const std::string& text) {
  if (!fuzz::may_replace_foreign && !fuzz::may_replace(file, text))
    throw UsageError(file.string() + ": expected no file, or one that graze wrote, found another; --force replaces it");
}

void write_result(const fs::path& file, const std::string& text) {
  expect_replaceable(file, text);
  fuzz::write_whole(file, text);
}

void remove_result(const fs::path& file, const std::string& text) {
  if (fs::is_regular_file(file) && fuzz::may_replace(file, text)) fs::remove(file);
}

void expect_writable(const fs::path& folder) {
  if (access(folder.c_str(), W_OK | X_OK) != 0) refuse_unwritable(folder, {errno, std::generic_category()});
}

void expect_campaign_folder(const fs::path& out) {
  if (!fuzz::may_replace_foreign && !fuzz::may_hold_campaign(out)) refuse_folder(out, "a campaign's");
}

ResultFolder::ResultFolder(const std::string& out, const char* own)
    : path(made(out, own)), alone(path, fuzz::FolderLock::WhenTaken::refuse) {}

}  // namespace graze::cli
