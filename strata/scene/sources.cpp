// SPDX-License-Identifier: Apache-2.0
#include "strata/scene/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "core/cannot.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "core/text.h"
#include "strata/mesh.h"
#include "strata/scene/envelope.h"

namespace graze::strata {
namespace {

enum MeshSource { as_it_is, by_ulps, by_motions };
struct MeshSourceInfo {
  MeshSource source;
  std::string_view id;
};
constexpr MeshSourceInfo kMeshSources[] = {{as_it_is, "mesh"}, {by_ulps, "mesh_ulps"}, {by_motions, "mesh_moved"}};

struct Meshes {
  Scene scene;
  MeshPairs pairs;
  std::uint64_t stride;  // coprime to the number of pairs: visits all pairs, in scattered order
};

// Visits every pair once before it repeats any.
Pair own_pair(const Meshes& meshes, std::uint64_t index) {
  const std::uint64_t size = meshes.pairs.size();
  return meshes.pairs.pair(static_cast<std::size_t>(index % size * meshes.stride % size));
}

Pair draw_own(Draws& draws, const Meshes& meshes) {
  return meshes.pairs.pair(draws.below(static_cast<std::uint32_t>(meshes.pairs.size())));
}

// Moves B by up to 8 grid steps or ulps on each axis, or one of its vertices along one axis.
Pair pair_by_ulps(const Meshes& meshes, std::uint64_t seed, std::uint64_t index) {
  Draws draws(seed, 0x201, index);
  Pair pair = draw_own(draws, meshes);
  if (draws.coin()) {
    for (int axis = 0; axis < 3; ++axis) {
      const int steps = draws.integer(8);
      for (Vec3<float>& vertex : pair.b) vertex = in_scene::pushed(meshes.scene, vertex, axis, steps);
    }
  } else {
    const std::uint32_t vertex = draws.below(3);
    const int axis = draws.between(0, 2);
    const int steps = draws.integer(8);
    pair.b[vertex] = in_scene::pushed(meshes.scene, pair.b[vertex], axis, steps);
  }
  return shuffled(draws, pair);
}

// Rotates v by the unit quaternion (w, q).
Vec turned(double w, const Vec& q, const Vec& v) {
  const Vec t = cross(q, v) * 2.0;
  return v + t * w + cross(q, t);
}

// Rotates the pair at random and puts it at a random place. It is not rotated if the rotated pair does not fit the
// extent.
Pair pair_by_motion(const Meshes& meshes, std::uint64_t seed, std::uint64_t index) {
  Draws draws(seed, 0x202, index);
  const Pair pair = draw_own(draws, meshes);
  double w = draws.real();
  Vec q = draws.reals();
  const double squared = w * w + dot(q, q);
  const double one = squared > 0 ? 1 / std::sqrt(squared) : 0;
  w = one > 0 ? w * one : 1;
  q = q * one;
  const Vec from{double{pair.a[0].x}, double{pair.a[0].y}, double{pair.a[0].z}};
  Draft still, turns;
  for (int i = 0; i < 6; ++i) {
    const Vec3<float>& v = i < 3 ? pair.a[i] : pair.b[i - 3];
    const Vec to = Vec{double{v.x}, double{v.y}, double{v.z}} - from;
    (i < 3 ? still.a[i] : still.b[i - 3]) = to;
    (i < 3 ? turns.a[i] : turns.b[i - 3]) = turned(w, q, to);
  }
  bool fits = true;
  for (int axis = 0; axis < 3; ++axis) {
    const in_scene::Interval span = in_scene::span_of(turns, axis);
    fits = fits && span.high - span.low <= component(meshes.scene.high, axis) - component(meshes.scene.low, axis);
  }
  return in_scene::finished(draws, meshes.scene, fits ? turns : still, {});
}

std::shared_ptr<const Meshes> open_meshes(const SceneFile& scene, const std::filesystem::path& folder) {
  const auto meshes = std::make_shared<Meshes>();
  meshes->scene = resolved(scene);
  std::vector<std::filesystem::path> files;
  for (const std::string& file : scene.meshes.files) files.push_back(folder / file);
  meshes->pairs =
      read_bodies(files, scene.meshes.poses.empty() ? std::filesystem::path() : folder / scene.meshes.poses);
  if (meshes->pairs.content_hash != scene.meshes.content)
    throw std::runtime_error(cannot("use", files[0],
                                    fmt::format("the mesh has changed since the scene was measured: its hash is "
                                                "{:016x}, not {:016x}; run `graze scene` again",
                                                meshes->pairs.content_hash, scene.meshes.content)));
  for (const auto& triangle : meshes->pairs.triangles) {
    for (const Vec3<float>& v : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        const double x = static_cast<double>(component(v, axis));
        const auto& [low, high] = scene.extent[static_cast<std::size_t>(axis)];
        if (as_float32(low) <= x && x <= as_float32(high)) continue;
        throw std::runtime_error(
            cannot("use", files[0],
                   fmt::format("{} = {} is outside the scene's extent, {} to {}", "xyz"[axis], x, low, high)));
      }
    }
  }
  const std::uint64_t size = meshes->pairs.size();
  meshes->stride = size * 2 / 5 + 1;
  while (std::gcd(meshes->stride, size) != 1) ++meshes->stride;
  return meshes;
}

std::function<Pair(std::uint64_t)> drawn_from(const std::shared_ptr<const Meshes>& meshes, MeshSource source,
                                              std::uint64_t seed) {
  if (source == as_it_is) return [meshes](std::uint64_t index) { return own_pair(*meshes, index); };
  if (source == by_ulps) return [meshes, seed](std::uint64_t index) { return pair_by_ulps(*meshes, seed, index); };
  return [meshes, seed](std::uint64_t index) { return pair_by_motion(*meshes, seed, index); };
}

void expect_names(const std::vector<std::string>& globs) {
  std::vector<std::string> ids;
  for (const StratumInfo& row : kStrata) ids.emplace_back(row.id);
  for (const MeshSourceInfo& row : kMeshSources) ids.emplace_back(row.id);
  for (const std::string& glob : globs) {
    if (std::none_of(ids.begin(), ids.end(), [&](const std::string& id) { return matches_any({glob}, id); }))
      throw UsageError("no stratum matches '" + printable(glob) +
                       "'; `graze strata` lists them, and a scene has mesh, mesh_ulps and mesh_moved" +
                       did_you_mean(glob, ids));
  }
}

// Divides `pairs` among the sources by weight; the shares add up to `pairs`.
void share(std::vector<PairSource>& sources, const std::vector<double>& weights, std::uint64_t pairs) {
  const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
  double sum = 0;
  std::uint64_t given = 0;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    sum += weights[s];
    const bool last = s + 1 == sources.size();
    const std::uint64_t until =
        last ? pairs : std::min(pairs, static_cast<std::uint64_t>(static_cast<double>(pairs) * (sum / all)));
    sources[s].pairs = until - given;
    given = until;
  }
}

}  // namespace

SceneSources scene_sources(const SceneFile& file, const std::filesystem::path& folder, std::uint64_t seed,
                           std::uint64_t pairs, const std::vector<std::string>& globs) {
  expect_names(globs);
  SceneSources result;
  std::vector<double> weights;
  const auto scene = std::make_shared<const Scene>(resolved(file));
  std::array<double, kKinds> of_kind{};
  for (const StratumInfo& row : kStrata) {
    if (!matches_any(globs, row.id)) continue;
    if (auto why = left_out(file, row.stratum)) {
      result.left_out.push_back({std::string(row.id), std::move(*why)});
      continue;
    }
    result.sources.push_back(
        {std::string(row.id), 0,
         [seed, stratum = row.stratum, scene](std::uint64_t index) { return generate(seed, stratum, *scene, index); },
         static_cast<int>(row.stratum), Axis::none, seed, scene});
    ++of_kind[static_cast<std::size_t>(kind_of(row.stratum))];
    weights.push_back(static_cast<double>(static_cast<int>(kind_of(row.stratum))));
  }
  for (double& weight : weights) {
    const auto kind = static_cast<std::size_t>(weight);
    weight = file.mix[kind] / of_kind[kind];
  }
  const double of_strata = std::accumulate(weights.begin(), weights.end(), 0.0);
  const std::size_t strata = weights.size();
  std::shared_ptr<const Meshes> meshes;
  for (const MeshSourceInfo& row : kMeshSources) {
    if (!matches_any(globs, row.id)) continue;
    if (file.meshes.files.empty()) {
      if (globs.empty()) continue;
      result.left_out.push_back({std::string(row.id), "your scene names no mesh"});
      continue;
    }
    if (!meshes) {
      meshes = open_meshes(file, folder);
      result.notes = meshes->pairs.notes;
      result.rounding = meshes->pairs.rounding;
    }
    result.sources.push_back({std::string(row.id), 0, drawn_from(meshes, row.source, seed)});
    weights.push_back(0);
  }
  for (std::size_t s = strata; s < weights.size(); ++s)
    weights[s] = (of_strata > 0 ? of_strata : 1) / static_cast<double>(weights.size() - strata);
  if (result.sources.empty())
    throw UsageError(fmt::format("the scene cannot contain {}: {}; choose other --strata", result.left_out[0].id,
                                 result.left_out[0].why));
  share(result.sources, weights, pairs);
  for (PairSource& source : result.sources) {
    if (source.id != "mesh" || source.pairs <= meshes->pairs.size()) continue;
    result.notes.push_back(
        fmt::format("{} of the {} pairs run: the scene's meshes have only {} pairs of triangles whose boxes overlap, "
                    "and their share is {}",
                    pairs - source.pairs + meshes->pairs.size(), pairs, meshes->pairs.size(), source.pairs));
    source.pairs = meshes->pairs.size();
  }
  return result;
}

}  // namespace graze::strata
