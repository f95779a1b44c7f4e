// SPDX-License-Identifier: Apache-2.0
// The search behind `graze query --self` and `--between`: finds all pairs of triangles that intersect, within one mesh
// or between two, with their contact and kind. Boxes give blocks of candidates (strata/mesh_slabs.h). A decider finds
// the candidates that intersect, and the exact relation tells how they meet. The result does not depend on the decider
// or the threads.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/pair.h"
#include "core/verdict.h"
#include "strata/mesh.h"
#include "strata/mesh_slabs.h"

namespace graze::cli {

// How two triangles meet. common_vertex, common_edge: like neighbours in a mesh, they share only that. pierces:
// no tiny translation separates them, or they are coplanar and share an area. touches: all others that intersect.
enum class Kind : std::uint8_t { apart, common_vertex, common_edge, touches, pierces };
inline constexpr std::size_t kKinds = 5;
std::string_view name(Kind kind);

// Indices count from 0. Within one mesh, i < j.
struct FoundPair {
  std::uint32_t i, j;
  Contact contact;
  Kind kind;
  friend auto operator<=>(const FoundPair&, const FoundPair&) = default;
};

inline constexpr std::size_t kMostListed = 100'000;  // hits in one JSON object

// Returns how triangle i of the first mesh meets triangle j of the second.   Requires: finite coordinates.   Exact:
// always.
FoundPair related(std::uint32_t i, std::uint32_t j, const Pair& pair);
FoundPair related(std::uint32_t i, std::uint32_t j, const DoublePair& pair);

// Returns the text of a CSV file: a header, and a row for each pair.
std::string csv_of(std::span<const FoundPair> pairs);

// One mesh against itself, or two meshes against each other.
struct TwoMeshes {
  strata::MeshPairs a;
  std::optional<strata::MeshPairs> b;

  // Whether a coordinate has more digits than float32 holds; if so, the triangles are decided as doubles.
  bool are_doubles() const { return a.rounding.beyond > 0 || (b && b->rounding.beyond > 0); }
  Pair pair(std::uint32_t i, std::uint32_t j) const;
  DoublePair pair_of_doubles(std::uint32_t i, std::uint32_t j) const;
};

// Candidates, as floats or as doubles, and which of them intersect: bit k % 64 of word k / 64.
struct Candidates {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> indices;
  std::vector<Pair> pairs;
  std::vector<DoublePair> pairs_of_doubles;
  std::vector<std::uint64_t> intersect;
};

struct Decider {
  std::string executor;
  int threads = 1;
  std::size_t block = 1;                    // candidates decided together
  std::function<void(Candidates&)> decide;  // sets `intersect`; called by several threads at once
};

// executor: auto, one-core, all-cores or one-gpu. auto: all cores.
// Throws: std::runtime_error if there is no device.
Decider exact_decider(const std::string& executor);

// Which pairs to keep: the first `most` ordered by (i, j), of all kinds or only those that pierce.
struct Kept {
  std::size_t most;
  bool only_piercing = false;
};

struct FoundPairs {
  std::array<std::uint64_t, kKinds> count{};  // by kind; 0 for apart
  std::uint64_t candidates = 0;               // pairs whose boxes overlap
  std::uint64_t declined = 0;                 // triangles that are not finite; they are in no pair
  std::vector<FoundPair> pairs;               // sorted
  double seconds = 0, processor_seconds = 0;  // elapsed time; processor time of all threads together

  std::uint64_t of(Kind kind) const { return count[static_cast<std::size_t>(kind)]; }
  std::uint64_t all() const;
};

// Uses the boxes of the triangles in float32. Rounding keeps the order of coordinates, so these boxes miss no pair of
// doubles.   told: called with the number of triangles of `a` that are done, by one thread at a time.
// Throws: Stopped, soon after a request to stop (core/stop.h).
FoundPairs find_pairs(
    const TwoMeshes& meshes, const Decider& decider, const Kept& kept,
    const std::function<void(std::size_t)>& told = [](std::size_t) {});

}  // namespace graze::cli
