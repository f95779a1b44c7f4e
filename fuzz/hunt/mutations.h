// SPDX-License-Identifier: Apache-2.0
// Changes of a pair that know geometry: what guided search tries on the pairs that it keeps.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/pair.h"
#include "strata/draws.h"
#include "strata/pair_source.h"
#include "strata/scene/scene.h"

namespace graze::fuzz {

enum class Mutation : std::uint8_t {
  fresh,        // another pair of the strata, or of the scene
  ulps,         // one coordinate, or one vertex, by a few ulps
  onto_vertex,  // a vertex onto one of the other triangle, alone or with its triangle
  onto_edge,    // a vertex, or a point of an edge, onto an edge of the other triangle
  onto_plane,   // a vertex onto the other triangle's plane
  coplanar,     // a triangle into the other's plane
  collinear,    // a vertex onto the line through the two others
  shared_edge,  // an edge becomes one of the other triangle's
  scaled,       // both triangles, one of them, or one axis, by a power of two
  moved,        // both triangles away from the origin, or back
  on_grid,      // all coordinates onto a coarser grid
  mirrored,     // a triangle becomes the other's mirror image
  reordered,    // another of the 72 orders
  crossed,      // one triangle of each of two pairs
};
inline constexpr std::array<std::string_view, 14> kMutationIds{
    "fresh",       "ulps",   "onto_vertex", "onto_edge", "onto_plane", "coplanar",  "collinear",
    "shared_edge", "scaled", "moved",       "on_grid",   "mirrored",   "reordered", "crossed"};
inline constexpr int kMutationCount = static_cast<int>(kMutationIds.size());

// What pairs are drawn from, and in a scene the envelope that they must stay in.
struct Drawn {
  std::vector<strata::PairSource> sources;
  const strata::Scene* scene = nullptr;
};

// The pair changed in this way; for `crossed` with triangles of the other. Not finite where numbers overflow.
Pair mutated(Mutation mutation, const Pair& pair, const Pair& other, strata::Draws& draws);

// A pair of one of the sources.
Pair fresh_pair(const Drawn& drawn, strata::Draws& draws);

// Rounds the pair into the scene: onto its grid, within its extent.
// Returns: false where a triangle is larger, or a proper one thinner, than any of the scene.
bool fit(const strata::Scene& scene, Pair& pair);

// The pair after one mutation, which is said in `mutation`; a fresh one where the mutation leads to what is not finite,
// to what the scene cannot contain, or four times to the same pair. `other`: null for no crossing.
Pair next_pair(const Drawn& drawn, const Pair& pair, const Pair* other, strata::Draws& draws, Mutation& mutation);

}  // namespace graze::fuzz
