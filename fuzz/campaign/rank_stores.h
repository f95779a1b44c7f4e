// SPDX-License-Identifier: Apache-2.0
// The stores DIR/rank-R in a campaign's directory. A rank keeps its store until the rows are in the campaign's store.
#pragma once

#include <filesystem>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

std::filesystem::path rank_directory(const std::filesystem::path& campaign, int rank);

// All rank directories, sorted by name. Rank directories are empty or hold a store; other folders are ignored.
std::vector<std::filesystem::path> rank_directories(const std::filesystem::path& campaign);

// Commits the rows that a killed run left in rank stores, then removes these stores.
// Throws: std::runtime_error, in one line, for a store that is damaged or belongs to another campaign.
void take_in_ranks(const Campaign& campaign, Store& store);

}  // namespace graze::fuzz
