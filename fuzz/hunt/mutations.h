// SPDX-License-Identifier: Apache-2.0
// Geometric changes of a pair, which guided search tries on the pairs that it keeps.
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

// The sources that pairs are drawn from, all of one coordinate type, and, in a scene, the envelope for that type, in
// which pairs must stay.
struct Drawn {
  std::vector<strata::PairSource> sources;
  const strata::Scene* scene = nullptr;

  bool in_doubles() const { return sources.front().in_doubles(); }
};

// For pairs of float32, Draws is strata::Draws; for pairs of doubles, strata::DoubleDraws.
template <class Draws>
using DrawnPair = BasicPair<typename Draws::Real>;

// Applies the mutation to the pair; `crossed` takes triangles from `other`. The result is not finite if numbers
// overflow.
template <class Draws>
DrawnPair<Draws> mutated(Mutation mutation, const DrawnPair<Draws>& pair, const DrawnPair<Draws>& other, Draws& draws);

// A pair of one of the sources.
template <class Draws>
DrawnPair<Draws> fresh_pair(const Drawn& drawn, Draws& draws);

// Rounds the pair into the scene: onto its grid, within its extent.
// Returns: false if a triangle is larger, or a proper triangle is thinner, than the scene allows.
template <class Real>
bool fit(const strata::Scene& scene, BasicPair<Real>& pair);

// Applies one mutation, and stores which one in `mutation`. An attempt fails if the result is not finite, does not fit
// the scene, or equals the pair. After four failed attempts it draws a fresh pair. `other`: null if no pair is
// available for crossing.
template <class Draws>
DrawnPair<Draws> next_pair(const Drawn& drawn, const DrawnPair<Draws>& pair, const DrawnPair<Draws>* other,
                           Draws& draws, Mutation& mutation);

}  // namespace graze::fuzz
