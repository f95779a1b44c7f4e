// SPDX-License-Identifier: Apache-2.0
// The campaign's database. It holds the campaign's identity, and one row with a checksum for each stored range of a
// source's pairs.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/stored_counts.h"
#include "strata/pair_source.h"

namespace graze::fuzz {

using Json = nlohmann::ordered_json;

inline constexpr const char* kDatabase = "campaign.sqlite";  // in the campaign's directory

// The campaign to which a store belongs.
struct StoreSpec {
  std::filesystem::path directory;
  Json spec, build;  // recorded, and compared when the campaign resumes
  std::vector<strata::PairSource> sources;
  std::vector<std::string> lanes;  // lane ids
  Shard shard;                     // the part in the store; recorded and compared, unless it is the whole campaign
};

// Thrown for a damaged database; what() is one line that names it.
struct DamagedStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Thrown if the database that a run opened was moved, removed or replaced. Another run may use the folder now.
struct MovedStore : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class StoreFile {
 public:
  // Opens or creates the database in the spec's directory.
  // Throws: UsageError if the database holds another campaign. All members, including this one, throw
  // std::runtime_error, in one line that names the file, for a database that is damaged or not Graze's.
  explicit StoreFile(const StoreSpec& spec);

  // Calls visit for every row, after checking the row's checksum, that its range is within the source, and that it
  // overlaps no other row.
  void for_each(const std::function<void(std::int64_t id, const PairRange&, const StoredCounts&)>& visit);

  StoredCounts counts(std::int64_t id);

  // Shrinks the file after rows were removed.
  void shrink();

  // Writes the log back, so that the store is a single file. The destructor does so too, but cannot report a failure.
  void finish();

  // Throws: MovedStore.
  void expect_in_place() const;

  // Replaces the rows `replaced` with one new row, in one transaction.
  // Returns: the new row's id.   Throws: MovedStore.
  std::int64_t put(const PairRange& range, const StoredCounts& counts, const std::vector<std::int64_t>& replaced);

 private:
  template <class Body>
  auto checked(const Body& body);

  const StoreSpec& spec_;
  std::filesystem::path file_;
  std::optional<SQLite::Database> database_;
  std::uint64_t campaign_;  // checksum of the campaign's identity
};

std::string file_bytes(SQLite::Database& database);

// The first place in which two specs differ, with both values: `seed is 1, not 2`.
std::string first_difference(const Json& expected, const Json& found);

// Whether the existing store holds no campaign yet.   Throws: as recorded_store.
bool is_empty_store(const std::filesystem::path& directory);

// Reads the spec of an existing store; its `sources` are empty.
// Throws: DamagedStore; std::runtime_error in the same cases as StoreFile.
StoreSpec recorded_store(const std::filesystem::path& directory);

// Removes a store and the files that its run wrote beside it. Also removes the folder, unless it holds other files.
void remove_store(const std::filesystem::path& directory);

// Calls visit for every row of a recorded store. The spec's `sources` must be filled in. If the last run ended
// normally, this writes nothing and needs no lock.   Throws: the errors of recorded_store.
void for_each_row(const StoreSpec& spec, const std::function<void(const PairRange&, const StoredCounts&)>& visit);

// The rows that discard_damaged recovered from a damaged database.
struct Salvage {
  std::size_t batches = 0;
  std::uint64_t pairs = 0;
  std::filesystem::path damaged;  // the old database's new name
};

// Keeps only the rows of a damaged database whose checksums are correct. The pairs of the other rows are judged again
// when the campaign resumes.
// Returns: nothing if the database is not damaged.   Throws: the errors of StoreFile, except for damage.
std::optional<Salvage> discard_damaged(const StoreSpec& spec);

}  // namespace graze::fuzz
