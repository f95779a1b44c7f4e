// SPDX-License-Identifier: Apache-2.0
// One rule for all verbs: results replace only files that Graze wrote (fuzz/own_files.h), unless --force is given.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/files.h"

namespace graze::cli {

inline constexpr const char* kPairs = "graze-pairs 1\n";  // the first line of a file of pairs

// Adds --force to one verb, or to all verbs that write results to a place that the user names, except `merge`, whose
// folder must be new.
void add_force_flag(CLI::App& verb);
void add_force(CLI::App& app);

// Adds --junit. tests: words for the help, such as "one test for each case".
void add_junit(CLI::App& command, std::string& file, const std::string& tests);

// Throws: UsageError for a file that a result with this text may not replace; std::runtime_error for a folder.
void expect_replaceable(const std::filesystem::path& file, const std::string& text);

// Throws: what expect_replaceable and fuzz::write_whole throw.
void write_result(const std::filesystem::path& file, const std::string& text,
                  fuzz::NamedBy named_by = fuzz::NamedBy::graze);

struct Result {
  std::string name, text;
};

// Writes all results into the folder, or none if a file may not be replaced.   Throws: what write_result throws.
void write_results(const std::filesystem::path& folder, const std::vector<Result>& results);

// Removes an earlier run's file, but keeps a file that is not of the same kind as this text.
void remove_result(const std::filesystem::path& file, const std::string& text);

// Throws: UsageError for a folder that may not hold a campaign.
void expect_campaign_folder(const std::filesystem::path& out);

// Throws: std::runtime_error, with the system's reason, for a folder that cannot be written to.
void expect_writable(const std::filesystem::path& folder);

// Creates the folder if it is missing.   Throws: what ResultFolder throws if the folder may not hold results of the
// verb that writes `own`.
std::filesystem::path made_folder(const std::filesystem::path& out, const char* own);

// A folder for a verb's results: created if missing, and locked so that two runs do not mix their results.
struct ResultFolder {
  // own: the file that identifies the folder as this verb's; a campaign's folder is accepted too.
  // Throws: UsageError for another folder that is not empty; std::runtime_error for one that cannot be created or
  // written to, or that another process uses.
  ResultFolder(const std::string& out, const char* own);

  std::filesystem::path path;
  fuzz::FolderLock alone;
};

}  // namespace graze::cli
