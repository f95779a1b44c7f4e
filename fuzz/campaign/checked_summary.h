// SPDX-License-Identifier: Apache-2.0
// A campaign's summary.json, believed only where it checks.
#pragma once

#include <filesystem>

#include "fuzz/campaign/store_file.h"

namespace graze::fuzz {

// summary.json of a campaign's directory: what its database says, or, where that is not beside it, counts that can be.
// Throws: std::runtime_error, in one line, without a summary, for one that disagrees with the database or cannot be,
// and as recorded_store; FormatError for another shape.
Json checked_summary(const std::filesystem::path& directory);

// What the campaign recorded of itself under "spec": by its database, or by its summary where there is no database.
// Returns: null where there is neither.   Throws: as recorded_store.
Json recorded_spec(const std::filesystem::path& directory);

// Whether the campaign's database is in the directory.
bool has_database(const std::filesystem::path& directory);

}  // namespace graze::fuzz
