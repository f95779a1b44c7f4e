/* SPDX-License-Identifier: Apache-2.0
   The tools of the 2012 thesis that its test program calls (docs/query.md). */
#ifndef GRAZE_GEOMETRIC_TOOLS_H
#define GRAZE_GEOMETRIC_TOOLS_H

#include "geometric-types.h"

static inline void triangle_from_triangle(triangle_t from, triangle_t* to) { *to = from; }

/* Sets *mn to the vector from m to n, and returns it. */
static inline vector_t vector_from_points(coord_t m, coord_t n, vector_t* mn) {
  mn->x = n.x - m.x;
  mn->y = n.y - m.y;
  mn->z = n.z - m.z;
  return *mn;
}

#endif
