// SPDX-License-Identifier: Apache-2.0
// Geometric changes to a pair, which the guided search tries on the pairs that it keeps.
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
  fresh,        // draws another pair from the strata or the scene
  ulps,         // moves one coordinate, or one vertex, by a few ulps
  onto_vertex,  // moves a vertex, alone or with its triangle, onto a vertex of the other triangle
  onto_edge,    // moves a vertex, or a point on an edge, onto an edge of the other triangle
  onto_plane,   // moves a vertex onto the other triangle's plane
  coplanar,     // moves a triangle into the other's plane
  collinear,    // moves a vertex onto the line through the two others
  shared_edge,  // makes an edge equal to an edge of the other triangle
  scaled,       // scales both triangles, one of them, or one axis by a power of two
  moved,        // moves both triangles away from the origin, or back
  on_grid,      // rounds all coordinates to a coarser grid
  mirrored,     // makes a triangle the other's mirror image
  reordered,    // chooses another of the 72 vertex orders
  crossed,      // takes one triangle from each of two pairs
};
inline constexpr std::array<std::string_view, 14> kMutationIds{
    "fresh",       "ulps",   "onto_vertex", "onto_edge", "onto_plane", "coplanar",  "collinear",
    "shared_edge", "scaled", "moved",       "on_grid",   "mirrored",   "reordered", "crossed"};
inline constexpr int kMutationCount = static_cast<int>(kMutationIds.size());

// The sources from which pairs are drawn, all of one coordinate type.   scene: the scene's envelope for that type,
// within which pairs must stay; null without a scene.
struct Drawn {
  std::vector<strata::PairSource> sources;
  const strata::Scene* scene = nullptr;

  bool in_doubles() const { return sources.front().in_doubles(); }
};

// For float32 pairs, Draws is strata::Draws; for pairs of doubles, it is strata::DoubleDraws.
template <class Draws>
using DrawnPair = BasicPair<typename Draws::Real>;

// Applies the mutation to the pair; `crossed` takes a triangle from `other`. The result is not finite if coordinates
// overflow.
template <class Draws>
DrawnPair<Draws> mutated(Mutation mutation, const DrawnPair<Draws>& pair, const DrawnPair<Draws>& other, Draws& draws);

template <class Draws>
DrawnPair<Draws> fresh_pair(const Drawn& drawn, Draws& draws);

// Rounds the pair to the scene's grid, and moves it into the scene's extent.
// Returns: false if a triangle is larger than the scene allows, or if it is too thin but not degenerate.
template <class Real>
bool fit(const strata::Scene& scene, BasicPair<Real>& pair);

// Applies one mutation, and stores its kind in `mutation`. An attempt fails if the result is not finite, does not fit
// the scene, or equals the pair. After four failed attempts a fresh pair is drawn. `other`: null if no pair is
// available for crossing.
template <class Draws>
DrawnPair<Draws> next_pair(const Drawn& drawn, const DrawnPair<Draws>& pair, const DrawnPair<Draws>* other,
                           Draws& draws, Mutation& mutation);

}  // namespace graze::fuzz
