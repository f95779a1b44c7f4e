// SPDX-License-Identifier: Apache-2.0
// Reads a campaign's summary.json and checks its counts.
#pragma once

#include <filesystem>

#include "fuzz/campaign/store_file.h"

namespace graze::fuzz {

// Returns the summary.json in a campaign's directory, which must agree with the database; without a database, its
// counts must be possible.
// Throws: std::runtime_error, in one line, if the summary is missing, contradicts the database or is impossible;
// FormatError if keys or types are wrong; and the errors of recorded_store.
Json checked_summary(const std::filesystem::path& directory);

// Returns: the campaign's recorded "spec", from its database, or from its summary if there is no database; null if
// there is neither.   Throws: the errors of recorded_store.
Json recorded_spec(const std::filesystem::path& directory);

// The sums over the rows of a campaign's database.
struct DatabaseCounts {
  StoreSpec store;
  std::vector<StoredCounts> of_source;  // in the order of spec.strata
  std::uint64_t pairs = 0;              // pairs judged
};

// Throws: the errors of recorded_store.
DatabaseCounts counts_of_database(const std::filesystem::path& directory);

bool has_database(const std::filesystem::path& directory);

}  // namespace graze::fuzz
