// SPDX-License-Identifier: Apache-2.0
// status.json: what a run says of itself now and then, for `graze status` and for merge. Nothing that a campaign counts
// comes from it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

class RunStatus {
 public:
  // Nothing is written before the first tell: the directory may be another's.
  explicit RunStatus(const Campaign& campaign);

  // Says how far it is, and what was seen so far, every few seconds at most. What cannot be written is left out: it is
  // for those who watch.
  void tell(const Progress& progress, const std::map<std::string, SignatureCount>& signatures);

  // Says how it ended: "done", "stopped" or "failed", and then why. Nothing of a run that told nothing.
  void end(const std::string& state, const std::string& why = {});

 private:
  void write();

  std::filesystem::path file_;
  Json status_;
  double written_ = -1;  // seconds, as Progress counts them
};

// The hash of a file's bytes, 16 hex digits.   Throws: std::runtime_error.
std::string file_hash(const std::filesystem::path& file);

// Adds the hash of the directory's database, which no run uses any more, to its status; merge compares it.
void seal(const std::filesystem::path& directory);

// Removes a status that is damaged or counts what cannot be: by its name in a campaign's folder it is Graze's.
// Throws: std::runtime_error for one that is no file, or lies behind a link.
void remove_damaged_status(const std::filesystem::path& directory);

// The directory's status; null where there is none.
// Throws: std::runtime_error that names the file where it is damaged, or counts what cannot be.
Json read_status(const std::filesystem::path& directory);

}  // namespace graze::fuzz
