// SPDX-License-Identifier: Apache-2.0
// A scene as campaigns and cases name it: the file it came from, and what it says, which is recorded with the results.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "strata/scene/sources.h"

namespace graze::fuzz {

struct NamedScene {
  std::string file;
  strata::SceneFile scene;

  std::string name() const { return strata::scene_name(file, scene); }  // arm.toml#0123456789abcdef
};

// Throws: as strata::read_scene.
NamedScene open_scene(const std::string& file);

// As strata::scene_sources; meshes are looked for beside the scene's file.
strata::SceneSources sources_of(const NamedScene& scene, std::uint64_t seed, std::uint64_t pairs,
                                const std::vector<std::string>& globs);

// What a campaign's spec records under "scene": {"file", "name", "pairs" asked for, "text", "left_out": {stratum:
// why}}.
nlohmann::ordered_json scene_spec(const NamedScene& scene, std::uint64_t pairs, const strata::SceneSources& drawn);

// Of what scene_spec recorded.   Throws: std::runtime_error, or nlohmann's for another shape.
NamedScene recorded_scene(const nlohmann::ordered_json& recorded);

// Of ID@SCENE:SEED:INDEX, where SCENE is a scene's file, with #HASH or without, or a campaign's directory.
struct SceneCase {
  std::string id, scene;
  std::uint64_t seed, index;
};

// The pair that it names.   Throws: UsageError; std::runtime_error where the file now says something else.
Pair draw_again(const SceneCase& named);

}  // namespace graze::fuzz
