/* SPDX-License-Identifier: Apache-2.0
   Triangles for console.c, with the names of the thesis of 2012. */
#ifndef TEST_TOOLS_H
#define TEST_TOOLS_H

#include "geometric-types.h"

extern triangle_t* tri_array;
extern uint8_t* tri_result_array;
extern triangle_t ref;

/* Returns: 0 at the first call, then the clock ticks since the call before. */
int chrono(void);

/* Sets ref, and fills tri_array with random triangles; for size 0, with the special cases.
   Returns: the number of triangles; -1 if there is not enough memory. */
int tri_generator(uint32_t size);

void free_memory(void);

#endif
