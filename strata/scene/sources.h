// SPDX-License-Identifier: Apache-2.0
// The sources that a campaign draws from a scene, of either type. They are the strata that the scene can contain, in
// the shares of its mix, and the pairs of its meshes: as they are, moved by ulps, and moved as rigid bodies within the
// extent.
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
  std::string id;   // a stratum, or mesh…
  std::string why;  // "your coordinates stay within 0.003 … 410 mm"
};

struct SceneSources {
  std::vector<PairSource> sources;
  std::vector<LeftOut> left_out;   // sources that match but cannot be drawn
  std::vector<std::string> notes;  // about the meshes, see MeshPairs
  Rounding rounding;               // of their coordinates
};

// Half of the pairs come from strata, in the shares of the mix, divided evenly among the strata of a kind. Half come
// from the meshes, if there are any. Only sources whose names match are used (all for an empty list); those of doubles
// match with or without "/f64".
// types: without them, the type of the scene.
// folder: the folder of the scene's file, for its meshes.
// Throws: UsageError if a pattern matches nothing or no source is left; std::runtime_error for a mesh that cannot be
// read, is not the one that the scene describes, or lies outside the scene; as with_type.
SceneSources scene_sources(const SceneFile& scene, const std::filesystem::path& folder, std::uint64_t seed,
                           std::uint64_t pairs, const std::vector<std::string>& globs,
                           std::optional<PairTypes> types = std::nullopt);

// The sources of exactly these names, of both types; as above.
SceneSources named_scene_sources(const SceneFile& scene, const std::filesystem::path& folder, std::uint64_t seed,
                                 std::uint64_t pairs, const std::vector<std::string>& names);

}  // namespace graze::strata
