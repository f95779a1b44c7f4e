// SPDX-License-Identifier: Apache-2.0
// The stores that ranks leave in a campaign's directory, in DIR/rank-R, until their rows are in the campaign's own.
#pragma once

#include <filesystem>

#include "fuzz/campaign/campaign.h"

namespace graze::fuzz {

std::filesystem::path rank_directory(const std::filesystem::path& campaign, int rank);

// All there are, in order of their names: folders with a store, or with nothing. Others are not Graze's.
std::vector<std::filesystem::path> rank_directories(const std::filesystem::path& campaign);

// Commits what a run that was killed has left, and removes it.
// Throws: std::runtime_error, in one line, for a store that is damaged or of another campaign.
void take_in_ranks(const Campaign& campaign, Store& store);

void remove_ranks(const std::filesystem::path& campaign);

}  // namespace graze::fuzz
