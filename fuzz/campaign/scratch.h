// SPDX-License-Identifier: Apache-2.0
// Keeps a running shard's store on a local disk, and copies it as one file to its directory, which may be on a network.
// The database is never opened there, so it needs no locks.
#pragma once

#include <filesystem>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// The folder on the local disk for results that go to `directory`.
std::filesystem::path scratch_of(const std::filesystem::path& disk, const std::filesystem::path& directory);

// Copies the results of an earlier run from the directory, unless its scratch still exists.
// Throws: std::runtime_error, also if another process on this machine runs the same shard.
void fetch_from_directory(const Campaign& campaign);

// Copies the store to the directory and removes the scratch.   Requires: the store is closed.
void bring_to_directory(const Campaign& campaign);

}  // namespace graze::fuzz
