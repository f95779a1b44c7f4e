// SPDX-License-Identifier: Apache-2.0
// Strata: named generators of pairs. Each is a pure function of (seed, stratum, index) with the same bits on host and
// device. Random bits come from Random123's Philox4x32-10 (Salmon et al. 2011); the integer-to-float maps are ours.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/margin/axis.h"
#include "core/pair.h"

namespace graze::strata {

enum class Stratum : std::uint8_t {
  uniform,
  thesis,
  near_vertex_face,
  near_edge_edge,
  near_vertex_edge,
  near_vertex_vertex,
  coplanar_lattice,
  coplanar_wide,
  exact_contact,
  coplanar_rounded,
  parallel,
  sliver,
  degenerate,
  shared_vertex,
  shared_edge,
  far_from_origin,
  extreme_scale,
  mixed_scale,
  lattice,
};

struct StratumInfo {
  Stratum stratum;
  std::string_view id;
  std::string_view what;   // one line: what it draws, and its purpose
  Axis axis = Axis::none;  // what varies besides the margin; campaigns count by it too
};

// One row for each stratum, in the order of the enumeration.
inline constexpr StratumInfo kStrata[] = {
    {Stratum::uniform, "uniform", "six vertices uniform in a cube: the easy background, where errors are rare"},
    {Stratum::thesis, "thesis", "the 2012 thesis: its random triangles against its reference triangle"},
    {Stratum::near_vertex_face, "near_vertex_face",
     "a vertex on a face, pushed by 0…±8 ulps or a relative gap 2^-1…2^-40"},
    {Stratum::near_edge_edge, "near_edge_edge", "two edges that cross, pushed apart likewise"},
    {Stratum::near_vertex_edge, "near_vertex_edge", "a vertex on an edge, pushed likewise"},
    {Stratum::near_vertex_vertex, "near_vertex_vertex", "two vertices that meet, pushed likewise"},
    {Stratum::coplanar_lattice, "coplanar_lattice",
     "exactly coplanar on small integers, axis-aligned and tilted planes"},
    {Stratum::coplanar_wide, "coplanar_wide",
     "exactly coplanar in tilted planes, integers up to 2^24: defeats double precision"},
    {Stratum::exact_contact, "exact_contact",
     "contacts exact in 24-bit integers, and one unit to either side: defeats double precision"},
    {Stratum::coplanar_rounded, "coplanar_rounded", "coplanar before rounding to float32"},
    {Stratum::parallel, "parallel", "parallel planes, from far apart to an ulp apart"},
    {Stratum::sliver, "sliver", "needles and caps of aspect 1e3…1e7 near another triangle"},
    {Stratum::degenerate, "degenerate", "segments and points against segments, points and triangles"},
    {Stratum::shared_vertex, "shared_vertex", "mesh neighbours with one vertex in common"},
    {Stratum::shared_edge, "shared_edge", "mesh neighbours with an edge in common"},
    {Stratum::far_from_origin, "far_from_origin", "near contacts, offset by 1e2…1e7 times their size", Axis::offset},
    {Stratum::extreme_scale, "extreme_scale",
     "near and exact contacts scaled by 2^-149…2^126: overflow, underflow, subnormals", Axis::scale},
    {Stratum::mixed_scale, "mixed_scale",
     "a triangle against one smaller by up to 2^40, or coordinates of very different scales"},
    {Stratum::lattice, "lattice",
     "coordinates in {-1,0,1}: without rounding for algorithms that neither divide nor take roots"},
};
inline constexpr int kStrataCount = sizeof kStrata / sizeof kStrata[0];

inline namespace GRAZE_FP {

// The pair with this index. It is finite in every stratum.
// Requires: compiled without contraction, on host and device alike.
GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, std::uint64_t index);

}  // namespace GRAZE_FP
}  // namespace graze::strata

#include "strata/strata.inl"
