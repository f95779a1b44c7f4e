// SPDX-License-Identifier: Apache-2.0
// What the viewer draws besides the two triangles, constructed with 113 bits and rounded to double.
#pragma once

#include <cstdint>

#include "core/pair.h"

namespace graze::reports::wasm {

struct Drawing {
  static constexpr int kMost = 9;  // extreme points of a common set
  std::int32_t contact_count, line_count, section_a_count, section_b_count;
  Vec3<double> contact[kMost];              // the common set's extreme points, in order around it
  Vec3<double> line[2];                     // the line of both planes, as far as the box around the pair, wider by half
  Vec3<double> section_a[2], section_b[2];  // of that line by each triangle
  // What the margin is: of a disjoint pair the nearest points, in a and in b; of one that intersects the shortest push
  // of b that parts them, from the middle of the contact. None where any push does, or where 113 bits see no gap.
  Vec3<double> witness[2];
  // Along it a and b reach from here to there, seen from a's end: 0 is high_a, low_b the gap, or minus the depth.
  double low_a, high_a, low_b, high_b;
  std::int32_t witness_count;
  std::int32_t feature_a,
      feature_b;  // nearest, or that give the push its direction: 0 vertex 0, 3 edge 01, 6 face, -1 none
};

// Requires: finite coordinates.
Drawing drawing_of(const Pair& pair);

}  // namespace graze::reports::wasm
