// SPDX-License-Identifier: Apache-2.0
// Reconstructs a campaign from its recorded spec: its sources, its lanes, and the command that runs a part of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// A hunt's source has no pairs of its own; its kept pairs are in its rounds (fuzz/hunt/hunt_rounds.h).
// Throws: std::runtime_error if a mesh has changed; nlohmann's exceptions for another shape.
std::vector<strata::PairSource> recorded_sources(const Json& spec);

bool is_of_mesh(std::string_view source);  // whether a source of this name draws from a mesh as it is

bool has_doubles(const Json& spec);  // some of the campaign's pairs are pairs of doubles

// Returns the lanes in the spec's order, without executors. Opens the campaign's subjects.
// Throws: std::runtime_error for a lane that this build does not have.
SelectedLanes recorded_lanes(const Json& spec);

// The command that starts or resumes the shard in the directory `out`, from "graze" on. With a campaign's summary it
// also asks for the executor that ran, and reads no mesh.
std::vector<std::string> command_words(const Json& spec, const Shard& shard, const std::filesystem::path& out,
                                       const Json& summary = Json::object());

// The same for a shell, after the variables that chose the compiler of a subject.
std::string command_of(const Json& spec, const Shard& shard, const std::filesystem::path& out,
                       const Json& summary = Json::object());

}  // namespace graze::fuzz
