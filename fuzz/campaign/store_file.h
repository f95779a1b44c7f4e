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

#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/stored_counts.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

using Json = nlohmann::ordered_json;

inline constexpr const char* kDatabase = "campaign.sqlite";  // in its directory

// Which campaign a store holds.
struct StoreSpec {
  std::filesystem::path directory;
  Json spec, build;  // recorded, and compared when the campaign goes on
  std::vector<strata::PairSource> sources;
  std::vector<std::string> lanes;  // their ids
  Shard shard;                     // of the campaign, which the store holds; recorded and compared unless it is all
};

// A database that does not check; what() is one line that names it.
struct DamagedStore : std::runtime_error {
  using std::runtime_error::runtime_error;
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

  // Gives back the room of rows that are gone.
  void shrink();

  // One transaction: a new row in place of those.   Returns: its id.
  std::int64_t put(const PairRange& range, const StoredCounts& counts, const std::vector<std::int64_t>& replaced);

 private:
  template <class Body>
  auto checked(const Body& body);

  const StoreSpec& spec_;
  std::filesystem::path file_;
  std::optional<SQLite::Database> database_;
  std::uint64_t campaign_;  // the checksum of what it is of
};

// The first place in which two specs differ, with both values: `seed 2, found 1`.
std::string first_difference(const Json& expected, const Json& found);

// A store as it is found, without its sources.
// Throws: std::runtime_error, as StoreFile; DamagedStore.
StoreSpec recorded_store(const std::filesystem::path& directory);

// Removes a store, and what its run wrote beside it; the folder as well, unless something else is in it.
void remove_store(const std::filesystem::path& directory);

// Calls visit for every row of such a store, once its sources are known; writes nothing, and needs no lock where the
// last run ended well.   Throws: as recorded_store.
void for_each_row(const StoreSpec& spec, const std::function<void(const PairRange&, const StoredCounts&)>& visit);

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
