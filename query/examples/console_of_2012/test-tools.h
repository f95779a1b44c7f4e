/* SPDX-License-Identifier: Apache-2.0
   Triangles for console.c, with the names from the 2012 thesis. */
#ifndef TEST_TOOLS_H
#define TEST_TOOLS_H

#include "geometric-types.h"

extern triangle_t* tri_array;
extern uint8_t* tri_result_array;
extern triangle_t ref;

/* Starts a stopwatch and returns 0. The next call stops it and returns the clock ticks in between. */
int chrono(void);

/* Sets ref, and fills tri_array with random triangles; for size 0, with the special cases.
   Returns: the number of triangles; -1 if there is not enough memory. */
int tri_generator(uint32_t size);

void free_memory(void);

#endif
