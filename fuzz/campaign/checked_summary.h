// SPDX-License-Identifier: Apache-2.0
// Reads a campaign's summary.json and checks its counts.
#pragma once

#include <filesystem>

#include "fuzz/campaign/store_file.h"

namespace graze::fuzz {

// Returns the summary.json in a campaign's directory. It must agree with the database; without a database, its counts
// must be possible.
// Throws: std::runtime_error, in one line, if it is missing, contradicts the database or is impossible; FormatError for
// JSON of another shape; and what recorded_store throws.
Json checked_summary(const std::filesystem::path& directory);

// Returns: the campaign's recorded "spec", from its database, or from its summary if there is no database; null if
// there is neither.   Throws: what recorded_store throws.
Json recorded_spec(const std::filesystem::path& directory);

// The sums of what a campaign's database records.
struct DatabaseCounts {
  StoreSpec store;
  std::vector<StoredCounts> of_source;  // in the order of spec.strata
  std::uint64_t pairs = 0;              // pairs judged
};

// Throws: what recorded_store throws.
DatabaseCounts counts_of_database(const std::filesystem::path& directory);

// Whether the campaign's database is in the directory.
bool has_database(const std::filesystem::path& directory);

}  // namespace graze::fuzz
