// SPDX-License-Identifier: Apache-2.0
// What the exact decision tells of a pair.
#pragma once

#include <cstdint>

namespace graze::exact {

// Which numbers decided; bounded also where the triangles share a vertex.
enum class Stage : std::uint8_t { bounded, doubles, int128, wide };
inline constexpr int kStages = 4;

// What two triangles have to do with each other.
struct Relation {
  bool intersects = false;
  int contact = -1;     // dimension of the common set: 0 point, 1 segment, 2 area; -1: none
  int margin_sign = 1;  // 1: disjoint; -1: they intersect, and a translation small enough does not part them; else 0
  int dimension_a = 2;  // of the hull: 0 point, 1 segment, 2 triangle
  int dimension_b = 2;
  bool coplanar = false;  // one plane holds all six points
  friend bool operator==(const Relation&, const Relation&) = default;
};

}  // namespace graze::exact
