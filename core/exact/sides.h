// SPDX-License-Identifier: Apache-2.0
// Finds on which side of the other triangle's plane each vertex lies, and which vertex is alone on its side.
#pragma once

#include "core/exact/host_device.h"

namespace graze::exact::detail {

// The result of testing the sides and two orientations. crosses: the triangles intersect and are in general position.
// coplanar: all vertices lie in the plane of a proper triangle. unsure: none of these is certain.
enum class Finding { disjoint, intersects, crosses, coplanar, unsure };

// A triangle's vertices above, below and in a plane: bit i is vertex i. A vertex in no mask has an unknown side.
struct Sides {
  unsigned above = 0, below = 0, in = 0;

  GRAZE_HD bool one_side() const { return above == 7 || below == 7; }
  GRAZE_HD bool known() const { return (above | below | in) == 7; }

  // The vertex that is alone on its side; the others are on the other side or in the plane. Bit tables replace
  // branches, which would be mispredicted.
  // Requires: known; not one_side; not all in the plane.   Returns: the vertex's index. over: 1 if its side is below.
  GRAZE_HD constexpr unsigned alone(unsigned& over) const {
    if (in == 0) {  // tables with two bits, or one, for each of the eight values of `above`
      over = 0x68u >> above & 1;
      return 0x690u >> 2 * above & 3;
    }
    constexpr unsigned kOneBit = 1u << 1 | 1u << 2 | 1u << 4;
    const unsigned one_above = kOneBit >> above & 1, one_below = kOneBit >> below & 1 & ~one_above;
    over = (one_below | unsigned{above != 0}) & ~one_above & 1;
    return (one_above * above + one_below * below + (1 - one_above - one_below) * in) >> 1;
  }
};

// The vertex orders that put each triangle's lone vertex first and above the other triangle.
struct Turn {
  unsigned a[3], b[3];
};

GRAZE_HD constexpr void turn_to(unsigned first, unsigned over, unsigned (&order)[3]) {
  const unsigned next = 0b001001u >> 2 * first & 3, last = 3 - first - next;
  order[0] = first;
  order[1] = next ^ ((next ^ last) & (0u - over));  // over ? last : next
  order[2] = 3 - first - order[1];
}

GRAZE_HD constexpr Turn lone_vertices(const Sides& of_a, const Sides& of_b) {
  unsigned over_a, over_b;
  const unsigned alone_a = of_a.alone(over_b), alone_b = of_b.alone(over_a);
  Turn turn;
  turn_to(alone_a, over_a, turn.a);
  turn_to(alone_b, over_b, turn.b);
  return turn;
}

}  // namespace graze::exact::detail
