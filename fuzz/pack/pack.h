// SPDX-License-Identifier: Apache-2.0
// A campaign with everything that runs it again, in one file: pack.json, its results in campaign/, and in files/ the
// subjects' sources, meshes and scene. docs/formats.md describes pack.json.
#pragma once

#include <filesystem>
#include <vector>

#include "fuzz/campaign/store_file.h"
#include "fuzz/pack/archive.h"

namespace graze::fuzz {

struct Pack {
  std::vector<PackedFile> files;  // pack.json is one of them
  Json manifest;
};

// Requires: the campaign's subjects are open.
// Throws: std::runtime_error if the campaign is not complete, or a file that it needs is missing or changed.
Pack pack_campaign(const std::filesystem::path& directory);

// Throws: FormatError for a damaged or a hostile one.
Pack read_pack(const std::filesystem::path& file);

// A campaign's spec with the subjects, meshes and scene of a pack, as they are named within files/.
// Throws: std::runtime_error if these are not those of the spec; nlohmann's exceptions for another shape.
Json spec_of_pack(Json spec, const Json& manifest);

}  // namespace graze::fuzz
