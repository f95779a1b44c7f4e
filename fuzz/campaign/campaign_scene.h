// SPDX-License-Identifier: Apache-2.0
// A scene in campaigns and cases: its file name and its contents, which are recorded with the results.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "strata/scene/sources.h"

namespace graze::fuzz {

struct NamedScene {
  std::string file;
  strata::SceneFile scene;

  std::string name() const { return strata::scene_name(file, scene); }  // arm.toml#0123456789abcdef
};

// Like strata::scene_sources, but looks for meshes beside the scene's file.
strata::SceneSources sources_of(const NamedScene& scene, std::uint64_t seed, std::uint64_t pairs,
                                const std::vector<std::string>& globs, std::optional<PairTypes> types = std::nullopt);

// The value of "scene" in a campaign's spec: {"file", "name", "pairs" (requested), "text", "left_out": {stratum: why}}.
nlohmann::ordered_json scene_spec(const NamedScene& scene, std::uint64_t pairs, const strata::SceneSources& drawn);

// The inverse of scene_spec.   Throws: std::runtime_error; nlohmann's exceptions if keys or types are wrong.
NamedScene recorded_scene(const nlohmann::ordered_json& recorded);

// The parts of ID@SCENE:SEED:INDEX. SCENE is a scene's file, with or without #HASH, or a campaign's directory.
struct SceneCase {
  std::string id, scene;
  std::uint64_t seed, index;
};

// Draws the named pair. For a pair of doubles, ID ends in "/f64".   Throws: UsageError; std::runtime_error if the
// scene's file has changed.
AnyPair draw_again(const SceneCase& named);

}  // namespace graze::fuzz
