// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/recorded.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "core/cannot.h"
#include "core/error.h"
#include "core/text.h"
#include "fuzz/campaign/campaign_scene.h"
#include "strata/mesh.h"
#include "strata/pair_source.h"
#include "subjects/subjects.h"

namespace graze::fuzz {

std::vector<strata::PairSource> recorded_sources(const Json& spec) {
  const std::uint64_t seed = spec.at("seed");
  std::vector<std::string> strata = spec.at("strata");
  if (spec.contains("hunt")) return {{strata.at(0), spec.at("pairs"), nullptr}};
  if (spec.contains("scene")) {
    const NamedScene scene = recorded_scene(spec["scene"]);
    const std::filesystem::path folder = std::filesystem::path(scene.file).parent_path();  // meshes are beside the file
    return strata::named_scene_sources(scene.scene, folder, seed, spec["scene"].at("pairs"), strata).sources;
  }
  std::uint64_t pairs = spec.at("pairs");
  std::vector<strata::PairSource> of_mesh;
  if (spec.contains("mesh")) {
    const std::vector<std::string> files = spec["mesh"].at("files");
    const auto mesh = std::make_shared<strata::MeshPairs>(files.size() > 1 ? strata::read_bodies({files[0], files[1]})
                                                                           : strata::read_bodies({files.at(0)}));
    if (fmt::format("{:016x}", mesh->content_hash) != spec["mesh"].at("content").get<std::string>())
      throw std::runtime_error(
          cannot("draw the campaign's pairs from", files[0], "the mesh has changed since the campaign ran"));
    for (const strata::PairSource& source : strata::mesh_sources(mesh, PairTypes::both)) {
      if (std::erase(strata, source.id) == 0) continue;
      of_mesh.push_back(source);
      pairs -= std::min(pairs, source.pairs);
    }
  }
  std::vector<strata::PairSource> sources;
  if (!strata.empty()) sources = strata::named_sources(seed, pairs, strata);
  sources.insert(sources.end(), of_mesh.begin(), of_mesh.end());
  return sources;
}

bool has_doubles(const Json& spec) {
  const Json strata = spec.value("strata", Json::array());
  return std::any_of(strata.begin(), strata.end(), [](const Json& id) {
    return id.is_string() && strata::stratum_in_doubles(id.get_ref<const std::string&>());
  });
}

SelectedLanes recorded_lanes(const Json& spec) {
  subjects::open_recorded(spec);
  SelectedLanes under_test;
  for (const std::string id : spec.at("lanes")) {
    add_policy_lanes(id);
    const Lane* lane = find_lane(id);
    if (!lane)
      throw std::runtime_error("the campaign ran the lane " + printable(id) + ", which this build does not have");
    under_test.lanes.push_back(lane);
    under_test.on_host.push_back(nullptr);
  }
  return under_test;
}

bool is_of_mesh(std::string_view source) { return strata::stratum_in_doubles(source).value_or(source) == "mesh"; }

namespace {

// The mesh's number of pairs, from the summary if it has one, otherwise from the mesh itself.
std::uint64_t mesh_pairs(const Json& spec, const Json& summary) {
  std::uint64_t found = 0;
  const Json strata = summary.value("strata", Json::object());
  for (const auto& [id, counts] : strata.items()) {
    if (is_of_mesh(id)) found += counts.at("pairs").get<std::uint64_t>();
  }
  if (summary.value("complete", false) && found > 0) return found;
  try {
    std::uint64_t pairs = 0;
    for (const strata::PairSource& source : recorded_sources(spec)) pairs += is_of_mesh(source.id) ? source.pairs : 0;
    return pairs;
  } catch (const std::runtime_error&) {  // the mesh is gone
    return found;
  }
}

// The --executor implied by the recorded executors of the CUDA lanes; empty for the default.
std::string executor_of(const Json& spec, const Json& summary) {
  // With --executor twin, Graze does not look for a device, so the reason for leaving out a lane is just "no twin".
  const Json why = spec.value("lanes_left_out", Json::object()).value("why", Json::object());
  bool both = false, twin = std::any_of(why.begin(), why.end(), [](const Json&reason) { return reason == "no twin"; });
  for (const Json& by : summary.value("build", Json::object()).value("executors", Json::object())) {
    both |= by.get_ref<const std::string&>().starts_with("device and ");
    twin |= by.get_ref<const std::string&>().starts_with("twin");
  }
  return both ? "both" : twin ? "twin" : "";
}

}  // namespace

std::vector<std::string> command_words(const Json& spec, const Shard& shard, const std::filesystem::path& out,
                                       const Json& summary) {
  const bool scene = spec.contains("scene"), mesh = spec.contains("mesh"), hunt = spec.contains("hunt");
  std::vector<std::string> strata = (hunt ? spec["hunt"] : spec).at("strata"), lanes = spec.at("lanes"), all_strata,
                           all_lanes, words = {"graze", hunt ? "hunt" : "fuzz"};
  std::uint64_t pairs = scene ? spec["scene"].at("pairs") : spec.at("pairs");
  const auto add = [&](const std::string& name, const std::string& value) {
    if (value.starts_with('-')) {  // a separate word would be read as an option
      words.push_back(name + '=' + value);
    } else {
      words.insert(words.end(), {name, value});
    }
  };
  if (scene) add("--scene", spec["scene"].at("file"));
  if (mesh) {
    for (const std::string file : spec["mesh"].at("files")) add("--mesh", file);
    pairs -= std::min(pairs, mesh_pairs(spec, summary));
  }
  const auto of_doubles =
      std::count_if(strata.begin(), strata.end(), [](const std::string& id) { return strata::stratum_in_doubles(id); });
  const PairTypes coordinates = of_doubles == 0                    ? PairTypes::f32
                                : of_doubles == std::ssize(strata) ? PairTypes::f64
                                                                   : PairTypes::both;
  if (mesh) std::erase_if(strata, is_of_mesh);
  if (!mesh || !strata.empty()) add(hunt ? "--runs" : "--pairs", std::to_string(pairs));
  add("--seed", std::to_string(spec.at("seed").get<std::uint64_t>()));
  for (const strata::PairSource& source : strata::stratum_sources(0, 0, {}, coordinates))
    all_strata.push_back(source.id);
  if (scene) {  // the user also requested strata that the scene excludes
    for (const auto& [id, unused] : spec["scene"].at("left_out").items()) strata.push_back(id);
    if (std::all_of(all_strata.begin(), all_strata.end(),
                    [&](const std::string& id) { return std::find(strata.begin(), strata.end(), id) != strata.end(); }))
      strata = all_strata;
  }
  if (of_doubles > 0 || (scene && recorded_scene(spec["scene"]).scene.in_doubles))
    add("--coordinates", of_doubles == 0 ? "f32" : coordinates == PairTypes::f64 ? "f64" : "both");
  if (!strata.empty() && (mesh || strata != all_strata)) add("--strata", fmt::format("{}", fmt::join(strata, ",")));
  std::vector<subjects::Toolchain> toolchains;
  for (const Json& row : spec.value("subjects", Json::array())) {
    const std::string what = row.at("what");
    if (what != "published") add("--subject", row.at("name").get<std::string>() + '=' + what);
    if (what.ends_with(".cl") || what.find(".cl:") != what.npos) continue;  // OpenCL code: lanes need no toolchain list
    for (const Json& toolchain : row.value("toolchains", Json::array()))
      toolchains.push_back(subjects::toolchain_of_json(toolchain));
  }
  if (!toolchains.empty()) add("--toolchains", subjects::list_of(toolchains));
  if (spec.contains("subjects")) {  // flags and timeout are the same for all subjects
    const Json& first = spec["subjects"].at(0);
    for (const std::string flag : first.at("flags")) words.push_back("--flags=" + flag);
    if (first.at("timeout") != 1) add("--subject-timeout", fmt::format("{}", first["timeout"].get<double>()));
  }
  for (const Lane* lane : select_lanes({}, Executor::twin).lanes) all_lanes.push_back(lane->id);
  // The user also requested the lanes that were left out, perhaps with a pattern that matched other lanes too.
  if (spec.contains("lanes_left_out")) lanes = spec["lanes_left_out"].at("patterns");
  if (spec.contains("subjects") && with_exact_lane(lanes) != lanes)
    lanes.push_back(kLeaveOut + std::string(kExactLane));
  if (!lanes.empty() && lanes != all_lanes) add("--lanes", fmt::format("{}", fmt::join(lanes, ",")));
  if (const std::string executor = executor_of(spec, summary); !executor.empty()) add("--executor", executor);
  if (!shard.whole()) add("--shard", shard.name());
  add("--out", out.string());
  return words;
}

std::string command_of(const Json& spec, const Shard& shard, const std::filesystem::path& out, const Json& summary) {
  std::map<std::string, std::string> environment;  // the variables that chose the compiler
  for (const Json& row : spec.value("subjects", Json::array())) {
    const Json set = row.value("environment", Json::object());
    for (const auto& [name, value] : set.items()) environment[name] = value;
  }
  std::string command;
  for (const auto& [name, value] : environment) command += fmt::format("{}={} ", name, shell_word(value));
  const std::vector<std::string> words = command_words(spec, shard, out, summary);
  for (std::size_t w = 0; w < words.size(); ++w)
    command += fmt::format("{}{}", w == 0 ? "" : " ", shell_word(words[w]));
  return command;
}

}  // namespace graze::fuzz
