// SPDX-License-Identifier: Apache-2.0
// A pack is one file with a campaign and everything needed to run it again: pack.json (see docs/formats.md), the
// results in campaign/, and the subjects' sources, meshes and the scene in files/.
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

// Throws: FormatError if the pack is damaged or hostile.
Pack read_pack(const std::filesystem::path& file);

// A campaign's spec with the pack's subjects, meshes and scene, under their names within files/.
// Throws: std::runtime_error if the pack's inputs are not the spec's; nlohmann's exceptions if keys or types are wrong.
Json spec_of_pack(Json spec, const Json& manifest);

}  // namespace graze::fuzz
