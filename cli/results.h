// SPDX-License-Identifier: Apache-2.0
// Where results go, by one rule for all verbs: they replace only what Graze wrote (fuzz/own_files.h), or --force is
// given.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/files.h"

namespace graze::cli {

inline constexpr const char* kPairs = "graze-pairs 1\n";  // how files of pairs begin

// --force, of every verb that writes results where it is told to; but `merge`, whose folder is new.
void add_force(CLI::App& app);

// Throws: UsageError for a file that a result with this text may not replace.
void expect_replaceable(const std::filesystem::path& file, const std::string& text);

// Throws: as expect_replaceable and fuzz::write_whole.
void write_result(const std::filesystem::path& file, const std::string& text,
                  fuzz::NamedBy named_by = fuzz::NamedBy::graze);

struct Result {
  std::string name, text;
};

// Writes all of them into the folder, or none where one may not be replaced.   Throws: as write_result.
void write_results(const std::filesystem::path& folder, const std::vector<Result>& results);

// Removes what another run left, unless it is not of the kind of this text.
void remove_result(const std::filesystem::path& file, const std::string& text);

// Throws: UsageError for a folder that a campaign may not go into.
void expect_campaign_folder(const std::filesystem::path& out);

// Throws: std::runtime_error, with the system's reason, for a folder that cannot be written to.
void expect_writable(const std::filesystem::path& folder);

// A folder for a verb's results: made where it is missing, and locked, so that two runs at once do not mix theirs.
struct ResultFolder {
  // own: the file by which the folder is known as this verb's; a campaign's folder will do as well.
  // Throws: UsageError for another folder that is not empty; std::runtime_error for one that cannot be made or written
  // to, or in which another process is at work.
  ResultFolder(const std::string& out, const char* own);

  std::filesystem::path path;
  fuzz::FolderLock alone;
};

}  // namespace graze::cli
