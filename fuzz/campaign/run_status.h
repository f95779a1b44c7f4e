// SPDX-License-Identifier: Apache-2.0
// status.json: a run's progress, updated every few seconds for `graze status` and `graze merge`. Graze never takes a
// campaign's counts from this file.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

class RunStatus {
 public:
  // Writes nothing until `tell` is called, because the directory may belong to another campaign.
  explicit RunStatus(const Campaign& campaign);

  // Records the progress and the signatures so far, at most once every few seconds unless `last`. Write errors are
  // ignored, because only observers use the file.
  void tell(const Progress& progress, const std::map<std::string, SignatureCount>& signatures, bool last = false);

  // Records how the run ended: "done", "stopped" or "failed", and why it failed. Does nothing if `tell` was never
  // called.
  void end(const std::string& state, const std::string& why = {});

 private:
  void write();

  std::filesystem::path file_;
  Json status_;
  double written_ = -1;  // Progress's seconds at the last write
};

// The hash of a file's bytes, as 16 hex digits.   Throws: std::runtime_error.
std::string file_hash(const std::filesystem::path& file);

// Adds the database's hash to the directory's status; merge compares it.   Requires: no run uses the database any more.
void seal(const std::filesystem::path& directory);

// Removes a status that is damaged or has impossible counts. In a campaign's folder, a file named status.json belongs
// to Graze.
// Throws: std::runtime_error if status.json is not a regular file; UsageError if it is a link.
void remove_damaged_status(const std::filesystem::path& directory);

// Returns the directory's status; null if there is none.
// Throws: std::runtime_error that names the file if it is damaged or its counts are impossible.
Json read_status(const std::filesystem::path& directory);

}  // namespace graze::fuzz
