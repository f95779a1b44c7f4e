// SPDX-License-Identifier: Apache-2.0
// The campaign's database: who it is of, and a row for a range of one source's pairs, each with a checksum.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/campaign/stored_counts.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

using Json = nlohmann::ordered_json;

// Which campaign a store holds.
struct StoreSpec {
  std::filesystem::path directory;
  Json spec, build;  // recorded, and compared when the campaign goes on
  std::vector<strata::PairSource> sources;
  std::vector<std::string> lanes;  // their ids
};

class StoreFile {
 public:
  // Opens the directory's database, or begins it.
  // Throws: UsageError when it is of another campaign; std::runtime_error, in one line that names the file, for a
  // foreign or damaged one, here and in all that follows.
  explicit StoreFile(const StoreSpec& spec);

  // Calls visit for every row, all of which have been checked: within its source, apart from the others, and whole.
  void for_each(const std::function<void(std::int64_t id, const PairRange&, const StoredCounts&)>& visit);

  StoredCounts counts(std::int64_t id);

  // One transaction: a new row in place of those.   Returns: its id.
  std::int64_t put(const PairRange& range, const StoredCounts& counts, const std::vector<std::int64_t>& replaced);

 private:
  const StoreSpec& spec_;
  std::filesystem::path file_;
  std::optional<SQLite::Database> database_;
  std::uint64_t campaign_;  // the checksum of what it is of
};

// What discard_damaged kept of a damaged database.
struct Salvage {
  std::size_t batches = 0;
  std::uint64_t pairs = 0;
  std::filesystem::path damaged;  // where the old database is now
};

// Keeps of a damaged database the rows that check; what the others held is judged again when the campaign goes on.
// Returns: nothing when all is well.   Throws: as StoreFile, but for damage.
std::optional<Salvage> discard_damaged(const StoreSpec& spec);

}  // namespace graze::fuzz
