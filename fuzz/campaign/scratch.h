// SPDX-License-Identifier: Apache-2.0
// Keeps a running shard's store on a local disk, and copies it as one file to the shard's directory, which may be on a
// network file system. The database is never opened on the network file system, so no locks are needed there.
#pragma once

#include <filesystem>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

// The folder on the local disk for results whose final place is `directory`.
std::filesystem::path scratch_of(const std::filesystem::path& disk, const std::filesystem::path& directory);

// Copies an earlier run's results from the directory, unless that run's scratch still exists.
// Throws: std::runtime_error, including if another process on this machine runs the same shard.
void fetch_from_directory(const Campaign& campaign);

// Copies the store to the directory and removes the scratch.   Requires: the store is closed.
void bring_to_directory(const Campaign& campaign);

}  // namespace graze::fuzz
