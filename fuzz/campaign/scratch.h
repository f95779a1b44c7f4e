// SPDX-License-Identifier: Apache-2.0
// A shard whose store lives on a local disk while it runs, and comes to its directory, which may be far away, as one
// file: no database is ever open there, and no lock is needed.
#pragma once

#include <filesystem>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// The folder on the local disk for what goes to that directory.
std::filesystem::path scratch_of(const std::filesystem::path& disk, const std::filesystem::path& directory);

// Begins with what an earlier run brought to the directory, unless its scratch is still there.
// Throws: std::runtime_error, also where another process on this machine runs the same shard.
void fetch_from_directory(const Campaign& campaign);

// Brings the store to the directory, and removes the scratch.   Requires: the store is closed.
void bring_to_directory(const Campaign& campaign);

}  // namespace graze::fuzz
