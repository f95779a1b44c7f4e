// SPDX-License-Identifier: Apache-2.0
#include "strata/scene/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <type_traits>

#include "core/cannot.h"
#include "core/error.h"
#include "core/lanes/lanes.h"
#include "strata/mesh.h"
#include "strata/scene/envelope.h"

namespace graze::strata {
namespace {

constexpr std::string_view kMesh = "mesh", kMeshUlps = "mesh_ulps", kMeshMoved = "mesh_moved";
constexpr std::string_view kMeshSources[] = {kMesh, kMeshUlps, kMeshMoved};

// A scene's meshes, and the scene for pairs of one coordinate type.
struct Meshes {
  Scene scene;
  std::shared_ptr<const MeshPairs> pairs;
  std::uint64_t stride;  // coprime to the number of pairs, to visit all in scattered order
};

template <class D>
using DrawnPair = BasicPair<typename D::Real>;

template <class D>
DrawnPair<D> pair_at(const Meshes& meshes, std::size_t index) {
  if constexpr (std::is_same_v<DrawnPair<D>, Pair>) {
    return meshes.pairs->pair(index);
  } else {
    return meshes.pairs->double_pair(index);
  }
}

// The mesh's pair for this index. All pairs occur once before any repeats.
template <class D>
DrawnPair<D> own_pair(const Meshes& meshes, std::uint64_t index) {
  const std::uint64_t size = meshes.pairs->size();
  return pair_at<D>(meshes, static_cast<std::size_t>(index % size * meshes.stride % size));
}

template <class D>
DrawnPair<D> draw_own(D& draws, const Meshes& meshes) {
  return pair_at<D>(meshes, draws.below(static_cast<std::uint32_t>(meshes.pairs->size())));
}

// Moves B by up to 8 grid steps or ulps on each axis, or one of its vertices along one axis.
template <class D>
DrawnPair<D> pair_by_ulps(const Meshes& meshes, std::uint64_t seed, std::uint64_t index) {
  D draws(seed, 0x201, index);
  DrawnPair<D> pair = draw_own(draws, meshes);
  if (draws.coin()) {
    for (int axis = 0; axis < 3; ++axis) {
      const int steps = draws.integer(8);
      for (auto& vertex : pair.b) vertex = in_scene::pushed(meshes.scene, vertex, axis, steps);
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

// Rotates the pair at random and moves it to a random place. Omits the rotation if the rotated pair does not fit into
// the extent.
template <class D>
DrawnPair<D> pair_by_motion(const Meshes& meshes, std::uint64_t seed, std::uint64_t index) {
  D draws(seed, 0x202, index);
  const DrawnPair<D> pair = draw_own(draws, meshes);
  double w = draws.real();
  Vec q = draws.reals();
  const double squared = w * w + dot(q, q);
  const double one = squared > 0 ? 1 / std::sqrt(squared) : 0;
  w = one > 0 ? w * one : 1;
  q = q * one;
  const auto wide = [](const auto& v) { return Vec{double{v.x}, double{v.y}, double{v.z}}; };
  const Vec from = wide(pair.a[0]);
  Draft still, turns;
  for (int i = 0; i < 6; ++i) {
    const Vec to = wide(i < 3 ? pair.a[i] : pair.b[i - 3]) - from;
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

std::shared_ptr<const MeshPairs> read_meshes(const SceneFile& scene, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const std::string& file : scene.meshes.files) files.push_back(folder / file);
  auto pairs = std::make_shared<MeshPairs>(
      read_bodies(files, scene.meshes.poses.empty() ? std::filesystem::path() : folder / scene.meshes.poses));
  if (pairs->content_hash != scene.meshes.content)
    throw std::runtime_error(cannot("use", files[0],
                                    fmt::format("the mesh has changed since the scene was measured: its hash is "
                                                "{:016x}, not {:016x}; run `graze scene` again",
                                                pairs->content_hash, scene.meshes.content)));
  return pairs;
}

template <class Triangles>
void expect_within(const SceneFile& scene, const std::filesystem::path& folder, const Triangles& triangles) {
  for (const auto& triangle : triangles) {
    for (const auto& v : triangle) {
      for (int axis = 0; axis < 3; ++axis) {
        const double x = static_cast<double>(component(v, axis));
        const auto& [low, high] = scene.extent[static_cast<std::size_t>(axis)];
        if (as_stored(scene, low) <= x && x <= as_stored(scene, high)) continue;
        throw std::runtime_error(
            cannot("use", folder / scene.meshes.files[0],
                   fmt::format("{} = {} is outside the scene's extent, {} to {}", "xyz"[axis], x, low, high)));
      }
    }
  }
}

std::shared_ptr<const Meshes> meshes_of(const SceneFile& scene, const std::filesystem::path& folder,
                                        const std::shared_ptr<const MeshPairs>& pairs) {
  if (scene.in_doubles && !pairs->in_doubles.empty()) {
    expect_within(scene, folder, pairs->in_doubles);
  } else {
    expect_within(scene, folder, pairs->triangles);
  }
  const std::uint64_t size = pairs->size();
  std::uint64_t stride = size * 2 / 5 + 1;
  while (std::gcd(stride, size) != 1) ++stride;
  return std::make_shared<Meshes>(Meshes{resolved(scene), pairs, stride});
}

// A source whose pairs have the type that draw(index) returns.
template <class Draw>
PairSource source_of(std::string_view id, const Draw& draw) {
  if constexpr (std::is_same_v<decltype(draw(0)), Pair>) {
    return {std::string(id), 0, draw};
  } else {
    PairSource source{std::string(id) + std::string(kInDoubles), 0, nullptr};
    source.double_pair = draw;
    return source;
  }
}

template <class D>
PairSource source_of(std::string_view id, const std::shared_ptr<const Meshes>& meshes, std::uint64_t seed) {
  if (id == kMesh) return source_of(id, [meshes](std::uint64_t index) { return own_pair<D>(*meshes, index); });
  if (id == kMeshUlps)
    return source_of(id, [meshes, seed](std::uint64_t index) { return pair_by_ulps<D>(*meshes, seed, index); });
  return source_of(id, [meshes, seed](std::uint64_t index) { return pair_by_motion<D>(*meshes, seed, index); });
}

PairSource source_of(const StratumInfo& row, const std::shared_ptr<const Scene>& scene, bool in_doubles,
                     std::uint64_t seed) {
  PairSource source;
  if (in_doubles) {
    source = source_of(row.id, [seed, stratum = row.stratum, scene](std::uint64_t index) {
      return generate_doubles(seed, stratum, *scene, index);
    });
  } else {
    source = source_of(row.id, [seed, stratum = row.stratum, scene](std::uint64_t index) {
      return generate(seed, stratum, *scene, index);
    });
  }
  source.stratum = static_cast<int>(row.stratum);
  source.scene = scene;
  source.seed = seed;
  return source;
}

std::string name_of(std::string_view id, bool in_doubles) {
  return std::string(id) + std::string(in_doubles ? kInDoubles : "");
}

// The coordinate types to draw, float32 (false) before doubles (true).
std::vector<bool> types_of(const SceneFile& scene, std::optional<PairTypes> types) {
  if (!types) return {scene.in_doubles};
  if (*types == PairTypes::both) return {false, true};
  return {*types == PairTypes::f64};
}

// The patterns that select the scene's sources.
std::vector<std::string> patterns_of(const std::vector<std::string>& globs, const std::vector<bool>& types) {
  std::vector<std::string> ids;
  for (const bool in_doubles : types) {
    for (const StratumInfo& row : strata_of(in_doubles)) ids.push_back(name_of(row.id, in_doubles));
    for (const std::string_view id : kMeshSources) ids.push_back(name_of(id, in_doubles));
  }
  return source_patterns(globs, ids, ", and a scene has mesh, mesh_ulps and mesh_moved");
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

// is_wanted(id): selects sources.   are_named: whether the user named sources; then a missing mesh source is reported.
SceneSources sources_of(const SceneFile& file, const std::filesystem::path& folder, std::uint64_t seed,
                        std::uint64_t pairs, const std::vector<bool>& types, bool are_named,
                        const std::function<bool(const std::string&)>& is_wanted) {
  SceneSources result;
  std::vector<double> weights;
  std::vector<Kind> kinds;
  std::array<double, kKinds> of_kind{};
  for (const bool in_doubles : types) {
    const SceneFile typed = with_type(file, in_doubles);
    const auto scene = std::make_shared<const Scene>(resolved(typed));
    for (const StratumInfo& row : strata_of(in_doubles)) {
      const std::string id = name_of(row.id, in_doubles);
      if (!is_wanted(id)) continue;
      if (auto why = left_out(typed, row.stratum)) {
        result.left_out.push_back({id, std::move(*why)});
        continue;
      }
      result.sources.push_back(source_of(row, scene, in_doubles, seed));
      kinds.push_back(row.kind);
      ++of_kind[static_cast<std::size_t>(kinds.back())];
    }
  }
  for (const Kind kind : kinds)
    weights.push_back(file.mix[static_cast<std::size_t>(kind)] / of_kind[static_cast<std::size_t>(kind)]);
  const double of_strata = std::accumulate(weights.begin(), weights.end(), 0.0);
  const std::size_t strata = weights.size();
  std::shared_ptr<const MeshPairs> mesh;
  for (const bool in_doubles : types) {
    std::shared_ptr<const Meshes> meshes;
    for (const std::string_view source : kMeshSources) {
      const std::string id = name_of(source, in_doubles);
      if (!is_wanted(id)) continue;
      if (file.meshes.files.empty()) {
        if (are_named) result.left_out.push_back({id, "your scene names no mesh"});
        continue;
      }
      if (!mesh) mesh = read_meshes(file, folder);
      if (!meshes) meshes = meshes_of(with_type(file, in_doubles), folder, mesh);
      result.sources.push_back(in_doubles ? source_of<DoubleDraws>(source, meshes, seed)
                                          : source_of<Draws>(source, meshes, seed));
      weights.push_back(0);
    }
  }
  if (mesh) {
    result.notes = types.front() ? mesh->notes_of_doubles : mesh->notes;
    result.rounding = mesh->rounding;
  }
  for (std::size_t s = strata; s < weights.size(); ++s)
    weights[s] = (of_strata > 0 ? of_strata : 1) / static_cast<double>(weights.size() - strata);
  if (result.sources.empty())
    throw UsageError(fmt::format("the scene cannot contain {}: {}; choose other --strata", result.left_out[0].id,
                                 result.left_out[0].why));
  share(result.sources, weights, pairs);
  std::uint64_t run = pairs, of_mesh = 0;
  for (PairSource& source : result.sources) {
    if (stratum_in_doubles(source.id).value_or(source.id) != kMesh || source.pairs <= mesh->size()) continue;
    of_mesh = source.pairs;
    run -= source.pairs - mesh->size();
    source.pairs = mesh->size();
  }
  if (run < pairs)
    result.notes.push_back(
        fmt::format("{} of the {} pairs are drawn: the scene's meshes have only {} pairs of triangles whose boxes "
                    "overlap, fewer than their share of {}",
                    run, pairs, mesh->size(), of_mesh));
  return result;
}

}  // namespace

SceneSources scene_sources(const SceneFile& file, const std::filesystem::path& folder, std::uint64_t seed,
                           std::uint64_t pairs, const std::vector<std::string>& globs,
                           std::optional<PairTypes> wanted) {
  const std::vector<bool> types = types_of(file, wanted);
  const std::vector<std::string> patterns = patterns_of(globs, types);
  return sources_of(file, folder, seed, pairs, types, !globs.empty(),
                    [&](const std::string& id) { return matches_any(patterns, id); });
}

SceneSources named_scene_sources(const SceneFile& file, const std::filesystem::path& folder, std::uint64_t seed,
                                 std::uint64_t pairs, const std::vector<std::string>& names) {
  std::vector<bool> types;
  for (const bool in_doubles : {false, true}) {
    if (std::any_of(names.begin(), names.end(),
                    [&](const std::string& name) { return stratum_in_doubles(name).has_value() == in_doubles; }))
      types.push_back(in_doubles);
  }
  patterns_of(names, types);  // throws if a name is unknown
  return sources_of(file, folder, seed, pairs, types, true,
                    [&](const std::string& id) { return std::find(names.begin(), names.end(), id) != names.end(); });
}

}  // namespace graze::strata
