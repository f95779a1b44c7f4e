// SPDX-License-Identifier: Apache-2.0
// Tests a mesh against itself. CGAL finds the pairs whose boxes overlap. The exact relation of each pair tells whether
// the triangles pierce each other, are neighbours that share only their common vertex or edge, or touch otherwise. Two
// triangles pierce if no tiny translation separates them. Coplanar ones that share an area count as piercing too.
#include "cli/query_self.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "cli/query_input.h"
#include "cli/results.h"
#include "core/relation_of.h"
#include "corpus/pair_format.h"
#include "fuzz/files.h"
#include "reports/terminal.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

enum Kind : std::uint8_t { kApart, kVertex, kEdge, kTouching, kPiercing };

bool same(const Vec3<float>& p, const Vec3<float>& q) { return p.x == q.x && p.y == q.y && p.z == q.z; }

// The number of distinct points that are vertices of both.
int common_vertices(const Pair& pair) {
  int common = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3<float>& p = pair.a[i];
    const auto is_p = [&](const Vec3<float>& q) { return same(p, q); };
    common += std::any_of(pair.b, pair.b + 3, is_p) && std::none_of(pair.a, pair.a + i, is_p);
  }
  return common;
}

Kind kind_of(const Pair& pair) {
  const Relation relation = relation_of(pair);
  if (!relation.intersects()) return kApart;
  const int common = common_vertices(pair);
  if (common == 1 && relation.contact == Contact::point) return kVertex;
  if (common == 2 && relation.contact == Contact::segment) return kEdge;
  return relation.touches() && relation.contact != Contact::area ? kTouching : kPiercing;
}

}  // namespace

void query_self(const SelfOptions& options) {
  const strata::MeshPairs mesh = strata::read_self_pairs(options.mesh);
  const auto start = std::chrono::steady_clock::now();
  std::vector<Kind> kinds(mesh.size());
  tbb::parallel_for(std::size_t{0}, mesh.size(), [&](std::size_t i) { kinds[i] = kind_of(mesh.pair(i)); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto count = [&](Kind kind) {
    return static_cast<std::uint64_t>(std::count(kinds.begin(), kinds.end(), kind));
  };
  std::ostringstream pairs;
  corpus::write_header(pairs);
  ObjGroup piercing{"piercing", {}};
  nlohmann::ordered_json first = nullptr;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] != kPiercing) continue;
    const auto [a, b] = mesh.candidates[i];
    if (first.is_null()) first = {a, b};
    const Pair pair = mesh.pair(i);
    corpus::write_entry(pairs, {pair, {{"name", fmt::format("triangles_{}_{}", a, b)}}});
    for (const float* from : {&pair.a[0].x, &pair.b[0].x}) {
      piercing.triangles.emplace_back();
      std::copy_n(from, 9, piercing.triangles.back().begin());
    }
  }
  if (!options.pairs.empty()) write_result(options.pairs, pairs.str(), fuzz::NamedBy::user);
  if (!options.obj.empty()) write_result(options.obj, obj_of({piercing}), fuzz::NamedBy::user);
  if (options.json) {
    const nlohmann::ordered_json json = {{"triangles", mesh.triangles.size()},
                                         {"hits", count(kPiercing)},
                                         {"first", first},
                                         {"declined", 0},
                                         {"seconds", seconds},
                                         {"touching", count(kTouching)},
                                         {"common_edge", count(kEdge)},
                                         {"common_vertex", count(kVertex)}};
    fmt::print("{}\n", json.dump());
    return;
  }
  using reports::grouped;
  const std::string one = count(kPiercing) == 1 ? " pierces" : "s pierce";
  fmt::print("{} triangles: {} pair{} each other, {} touch{} otherwise\n", grouped(mesh.triangles.size()),
             grouped(count(kPiercing)), one, grouped(count(kTouching)), count(kTouching) == 1 ? "es" : "");
  fmt::print("neighbours that share nothing more: {} an edge, {} a vertex\n", grouped(count(kEdge)),
             grouped(count(kVertex)));
  if (!first.is_null())
    fmt::print("the first pair that pierces: triangles {} and {}\n", first[0].get<int>(), first[1].get<int>());
}

}  // namespace graze::cli
