// SPDX-License-Identifier: Apache-2.0
// A scene's sources for a campaign, in float32 or doubles: the strata that the scene can contain, in the shares of its
// mix, and the pairs of its meshes. Mesh pairs are drawn unchanged, moved by ulps, and moved rigidly within the extent.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "strata/mesh_readers/soup.h"
#include "strata/pair_source.h"
#include "strata/scene/file.h"

namespace graze::strata {

struct LeftOut {
  std::string id;   // a stratum, or mesh, mesh_ulps or mesh_moved
  std::string why;  // "your coordinates stay within 0.003 … 410 mm"
};

struct SceneSources {
  std::vector<PairSource> sources;
  std::vector<LeftOut> left_out;   // sources that match but cannot be drawn
  std::vector<std::string> notes;  // about the meshes; see MeshPairs
  Rounding rounding;               // how float32 rounded the meshes' coordinates
};

// Half of the pairs come from strata: each kind gets its share of the mix, divided evenly among its strata. The other
// half come from the meshes, if there are any. Only sources whose names match are used; an empty list matches all.
// Sources of doubles match with or without "/f64".
// types: the coordinate types to draw; nothing means the scene's own type.
// folder: the folder of the scene's file, for its meshes.
// Throws: UsageError if a pattern matches nothing or no source is left; std::runtime_error for a mesh that cannot be
// read, is not the one that the scene describes, or lies outside the scene; and the errors of with_type.
SceneSources scene_sources(const SceneFile& scene, const std::filesystem::path& folder, std::uint64_t seed,
                           std::uint64_t pairs, const std::vector<std::string>& globs,
                           std::optional<PairTypes> types = std::nullopt);

// Like scene_sources, for the sources with exactly these names, of both types.
SceneSources named_scene_sources(const SceneFile& scene, const std::filesystem::path& folder, std::uint64_t seed,
                                 std::uint64_t pairs, const std::vector<std::string>& names);

}  // namespace graze::strata
