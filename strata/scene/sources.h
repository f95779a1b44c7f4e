// SPDX-License-Identifier: Apache-2.0
// What a campaign draws from a scene: the strata that it can contain, in the shares of its mix, and its meshes' own
// pairs, as they are, moved by ulps, and moved as rigid bodies within the extent.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "strata/pair_source.h"
#include "strata/scene/file.h"

namespace graze::strata {

struct LeftOut {
  std::string id;   // of a stratum, or mesh…
  std::string why;  // "your coordinates stay within 0.003 … 410 mm"
};

struct SceneSources {
  std::vector<PairSource> sources;
  std::vector<LeftOut> left_out;   // of those that match
  std::vector<std::string> notes;  // of the meshes, see MeshPairs
};

// Half of the pairs from strata, in the shares of the mix, alike within a kind; half from the meshes, where there are
// some. Only sources whose names match (all for an empty list).
// folder: that of the scene's file, for its meshes.
// Throws: UsageError when a pattern matches none, or none is left; std::runtime_error for a mesh that cannot be read,
// is another than the scene's, or lies outside of it.
SceneSources scene_sources(const SceneFile& scene, const std::filesystem::path& folder, std::uint64_t seed,
                           std::uint64_t pairs, const std::vector<std::string>& globs);

}  // namespace graze::strata
