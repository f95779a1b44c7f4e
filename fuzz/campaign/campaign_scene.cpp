// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/campaign_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "core/cannot.h"
#include "core/error.h"
#include "fuzz/campaign/checked_summary.h"

namespace graze::fuzz {

using Json = nlohmann::ordered_json;
namespace {

namespace fs = std::filesystem;

NamedScene scene_of_campaign(const fs::path& directory) {
  const Json spec = recorded_spec(directory);
  if (!spec.contains("scene")) throw std::runtime_error(cannot("draw from", directory, "its campaign has no scene"));
  return recorded_scene(spec["scene"]);
}

}  // namespace

strata::SceneSources sources_of(const NamedScene& scene, std::uint64_t seed, std::uint64_t pairs,
                                const std::vector<std::string>& globs, std::optional<PairTypes> types) {
  return strata::scene_sources(scene.scene, fs::path(scene.file).parent_path(), seed, pairs, globs, types);
}

Json scene_spec(const NamedScene& scene, std::uint64_t pairs, const strata::SceneSources& drawn) {
  Json left_out = Json::object();
  for (const strata::LeftOut& row : drawn.left_out) left_out[row.id] = row.why;
  return {{"file", scene.file},
          {"name", scene.name()},
          {"pairs", pairs},
          {"text", strata::scene_text(scene.scene)},
          {"left_out", left_out}};
}

NamedScene recorded_scene(const Json& recorded) {
  const std::string file = recorded.at("file");
  return {file, strata::parse_scene(file, recorded.at("text").get<std::string>())};
}

AnyPair draw_again(const SceneCase& named) {
  const std::size_t hash = named.scene.rfind('#');
  const bool whole = hash == std::string::npos || fs::exists(named.scene);
  const std::string file = whole ? named.scene : named.scene.substr(0, hash);
  const NamedScene scene =
      fs::is_directory(file) ? scene_of_campaign(file) : NamedScene{file, strata::read_scene(file)};
  if (!whole && scene.name().substr(scene.name().rfind('#')) != named.scene.substr(hash))
    throw std::runtime_error(cannot(
        "draw from", file,
        fmt::format("the scene has changed: it is {}, not {}; a campaign directory keeps its scene: {}@DIR:{}:{}",
                    scene.name(), named.scene, named.id, named.seed, named.index)));
  const bool in_doubles = strata::stratum_in_doubles(named.id).has_value();
  const strata::SceneSources drawn =
      sources_of(scene, named.seed, 1, {named.id}, in_doubles ? PairTypes::f64 : PairTypes::f32);
  if (drawn.sources.size() != 1) throw UsageError(named.id + " matches several strata of the scene; name one");
  return drawn.sources.front().any_pair(named.index);
}

}  // namespace graze::fuzz
