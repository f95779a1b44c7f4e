/* SPDX-License-Identifier: Apache-2.0
   The types of the 2012 thesis (docs/query.md). */
#ifndef GRAZE_GEOMETRIC_TYPES_H
#define GRAZE_GEOMETRIC_TYPES_H

#include <stdint.h>

typedef struct {
  float x, y, z;
} coord_t;

typedef struct {
  float x, y, z;
} vector_t;

typedef struct {
  coord_t p1, p2, p3;
} triangle_t;

typedef struct {
  vector_t direction;
  coord_t p; /* a point of the line */
} line_t;

typedef struct {
  coord_t p;       /* a point of the plane */
  vector_t normal; /* of any length */
  float d;         /* signed distance of the origin from the plane, times the length of the normal */
} plane_t;

#endif
