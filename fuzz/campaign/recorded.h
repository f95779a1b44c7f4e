// SPDX-License-Identifier: Apache-2.0
// A campaign again, from the spec that it recorded: its sources, its lanes, and the command that runs a part of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// The source of a hunt has no pairs: what it kept of them is in its rounds (fuzz/hunt/hunt_rounds.h).
// Throws: std::runtime_error where a mesh is not what it was; nlohmann's for another shape.
std::vector<strata::PairSource> recorded_sources(const Json& spec);

// The lanes, in the spec's order, with nothing that runs them. Opens the campaign's subjects.
// Throws: std::runtime_error for a lane that this build does not know.
SelectedLanes recorded_lanes(const Json& spec);

// The command that begins the shard there, or goes on with it.
std::string command_of(const Json& spec, const Shard& shard, const std::filesystem::path& out);

}  // namespace graze::fuzz
