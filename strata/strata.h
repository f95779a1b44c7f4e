// SPDX-License-Identifier: Apache-2.0
// Strata: named generators of pairs, each a pure function of (seed, stratum, index) with the same bits on host and
// device. Random bits come from Random123's Philox4x32-10 (Salmon et al. 2011); the integer-to-float maps are ours.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/margin/axis.h"
#include "core/pair.h"

namespace graze::strata {

enum class Stratum : std::uint8_t {
#define GRAZE_STRATUM(name, ...) name,
#include "strata/strata.inc"
  last_of_both = 63,  // not a stratum; the next number is 64
#include "strata/double_strata.inc"
#undef GRAZE_STRATUM
};

// Reports count a stratum's results in its group; see strata/groups.h.
enum class Group : std::uint8_t { general, coplanar, degenerate, extreme, mesh };

// The kind of a pair in a scene: the first of the following that applies. degenerate: a triangle has no area.
// shared_edge: the triangles have two vertices in common, bit for bit. shared_vertex: they have one. coplanar: all six
// points lie in one plane. general: any other pair.
enum class Kind : std::uint8_t { general, shared_vertex, shared_edge, coplanar, degenerate };

// A row of strata/strata.inc, which explains the columns, or of strata/double_strata.inc.
struct StratumInfo {
  Stratum stratum;
  std::string_view id;
  std::string_view what;
  Axis axis;
  Group group;
  Kind kind;
};

// The strata of float32 pairs.
inline constexpr StratumInfo kStrata[] = {
#define GRAZE_BY_TYPE(float32, doubles) float32
#define GRAZE_STRATUM(name, group, kind, axis, draw, what) \
  {Stratum::name, #name, what, Axis::axis, Group::group, Kind::kind},
#include "strata/strata.inc"
#undef GRAZE_STRATUM
#undef GRAZE_BY_TYPE
};
inline constexpr int kStrataCount = sizeof kStrata / sizeof kStrata[0];

inline constexpr StratumInfo kDoubleStrata[] = {
#define GRAZE_BY_TYPE(float32, doubles) doubles
#define GRAZE_STRATUM(name, group, kind, axis, draw, what) \
  {Stratum::name, #name, what, Axis::axis, Group::group, Kind::kind},
#include "strata/strata.inc"

#include "strata/double_strata.inc"
#undef GRAZE_STRATUM
#undef GRAZE_BY_TYPE
};
inline constexpr int kDoubleStrataCount = sizeof kDoubleStrata / sizeof kDoubleStrata[0];

inline std::span<const StratumInfo> strata_of(bool in_doubles) {
  return in_doubles ? std::span<const StratumInfo>(kDoubleStrata) : std::span<const StratumInfo>(kStrata);
}

// Whether device code can draw the stratum. `stored` uses the exact decision, and device compilers need minutes to
// compile that.
constexpr bool is_drawn_on_devices(Stratum stratum) { return stratum != Stratum::stored; }

inline namespace GRAZE_FP {

// The pair with this index, with finite coordinates.
// Requires: a stratum of kStrata; compiled without contraction, on both host and device.
GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, std::uint64_t index);

// Like generate, but for the strata of kDoubleStrata: in doubles, with the bits, gaps and scales of doubles.
GRAZE_HD inline DoublePair generate_doubles(std::uint64_t seed, Stratum stratum, std::uint64_t index);

}  // namespace GRAZE_FP
}  // namespace graze::strata

#include "strata/strata.inl"
