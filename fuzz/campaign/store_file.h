// SPDX-License-Identifier: Apache-2.0
// The campaign's database: the identity of the campaign, and rows with a checksum, one for a range of one source's
// pairs.
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
  Json spec, build;  // recorded, and compared when the campaign resumes
  std::vector<strata::PairSource> sources;
  std::vector<std::string> lanes;  // lane ids
  Shard shard;                     // the part in the store; recorded and compared unless it is the whole campaign
};

// A damaged database; what() is one line that names it.
struct DamagedStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class StoreFile {
 public:
  // Opens or creates the directory's database.
  // Throws: UsageError if it holds another campaign. This and all other members throw std::runtime_error, in one line
  // that names the file, for a foreign or damaged database.
  explicit StoreFile(const StoreSpec& spec);

  // Calls visit for every row after checking it: its checksum, its range within the source, and no overlap with other
  // rows.
  void for_each(const std::function<void(std::int64_t id, const PairRange&, const StoredCounts&)>& visit);

  StoredCounts counts(std::int64_t id);

  // Shrinks the file after rows were removed.
  void shrink();

  // Writes the log back, so that the file alone is the store. Closing does that too, but cannot say that it failed.
  void finish();

  // Replaces the rows `replaced` by a new one in one transaction.   Returns: the new row's id.
  std::int64_t put(const PairRange& range, const StoredCounts& counts, const std::vector<std::int64_t>& replaced);

 private:
  template <class Body>
  auto checked(const Body& body);

  const StoreSpec& spec_;
  std::filesystem::path file_;
  std::optional<SQLite::Database> database_;
  std::uint64_t campaign_;  // checksum of the campaign's identity
};

// The first place in which two specs differ, with both values: `seed 2, found 1`.
std::string first_difference(const Json& expected, const Json& found);

// Reads the spec of an existing store; its `sources` stay empty.
// Throws: std::runtime_error, as StoreFile; DamagedStore.
StoreSpec recorded_store(const std::filesystem::path& directory);

// Removes a store and the files that its run wrote beside it. Removes the folder too, unless it holds something else.
void remove_store(const std::filesystem::path& directory);

// Calls visit for every row of such a store, once its sources are known. Writes nothing, and needs no lock if the last
// run ended normally.   Throws: as recorded_store.
void for_each_row(const StoreSpec& spec, const std::function<void(const PairRange&, const StoredCounts&)>& visit);

// The rows that discard_damaged recovered from a damaged database.
struct Salvage {
  std::size_t batches = 0;
  std::uint64_t pairs = 0;
  std::filesystem::path damaged;  // where the old database is now; nothing was there before
};

// Keeps only the rows of a damaged database whose checksums are right. The pairs of the other rows are judged again
// when the campaign resumes.
// Returns: nothing if the database is not damaged.   Throws: as StoreFile, except for damage.
std::optional<Salvage> discard_damaged(const StoreSpec& spec);

}  // namespace graze::fuzz
