// SPDX-License-Identifier: Apache-2.0
// Reconstructs a campaign's sources, lanes and commands from its recorded spec.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/campaign/shard.h"
#include "fuzz/campaign/store_file.h"
#include "fuzz/selected_lanes.h"

namespace graze::fuzz {

// The sources of a recorded spec. A hunt's source cannot draw pairs; the hunt's rounds hold its kept pairs
// (fuzz/hunt/hunt_rounds.h).
// Throws: std::runtime_error if a mesh has changed; nlohmann's exceptions if keys or types are wrong.
std::vector<strata::PairSource> recorded_sources(const Json& spec);

bool is_of_mesh(std::string_view source);  // whether this source's pairs are a mesh's, unchanged

bool has_doubles(const Json& spec);  // whether the campaign has pairs of doubles

// Returns the lanes in the spec's order, without executors. Opens the campaign's subjects.
// Throws: std::runtime_error for a lane that this build does not have.
SelectedLanes recorded_lanes(const Json& spec);

// The words of the command that starts or resumes the shard in the directory `out`; the first is "graze". If the
// campaign's summary is given, the command includes the executor that ran, and no mesh is read.
std::vector<std::string> command_words(const Json& spec, const Shard& shard, const std::filesystem::path& out,
                                       const Json& summary = Json::object());

// The same words as a shell command, preceded by the environment variables that chose a subject's compiler.
std::string command_of(const Json& spec, const Shard& shard, const std::filesystem::path& out,
                       const Json& summary = Json::object());

}  // namespace graze::fuzz
