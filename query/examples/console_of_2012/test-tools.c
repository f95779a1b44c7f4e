/* SPDX-License-Identifier: Apache-2.0 */
#include "test-tools.h"

#include <stdlib.h>
#include <time.h>

#include "geometric-tools.h"

triangle_t* tri_array = NULL;
uint8_t* tri_result_array = NULL;
triangle_t ref;

static const triangle_t random_reference = {{2, -2, 4}, {1, 5, -2}, {1, -3, -3}};
static const triangle_t special_reference = {{0, -2, 6}, {0, 5, 0}, {0, -3, 0}};
static const triangle_t special_cases[] = {
    {{-2, -2, 0}, {2, -3, 0}, {3, -1, 0}},       {{2, -1, 0}, {-2, -1.5f, 0}, {-3, 0, 0}},
    {{0, 0, 0}, {-2, 0.5f, 0}, {-3, 2, 0}},      {{0, 0.5f, 0}, {2, 0, 0}, {3, 1, 0}},
    {{3, 1.5f, 0}, {0, 1, 0}, {0, 2, 0}},        {{-3, 3, 0}, {0, 2.5f, 0}, {0, 3.5f, 0}},
    {{-2, 4.7f, 0}, {0, 3.7f, 0}, {2, 4.7f, 0}}, {{1.5f, -3, 5.5f}, {-2, -2, 5.5f}, {1.5f, 0, 5.5f}},
    {{2, 0, 0.5f}, {-2, 0, 1.5f}, {1, 0, 4}},    {{0, 3, 1}, {0, 1, 1.5f}, {0, 4, 3}},
};

int chrono(void) {
  static clock_t start;
  static int running;
  running = !running;
  if (!running) return (int)(clock() - start);
  start = clock();
  return 0;
}

static coord_t near(coord_t base) {
  base.x += (float)(rand() % 5);
  base.y += (float)(rand() % 5);
  base.z += (float)(rand() % 5);
  return base;
}

int tri_generator(uint32_t size) {
  const uint32_t special = sizeof special_cases / sizeof special_cases[0];
  const uint32_t count = size ? size : special;
  free_memory();
  tri_array = malloc(count * sizeof *tri_array);
  tri_result_array = calloc(count, sizeof *tri_result_array);
  if (!tri_array || !tri_result_array) return -1;
  triangle_from_triangle(size ? random_reference : special_reference, &ref);
  for (uint32_t i = 0; i < count; ++i) {
    if (!size) {
      triangle_from_triangle(special_cases[i], &tri_array[i]);
      continue;
    }
    const coord_t base = {(float)(rand() % 80 - 40) / 10, (float)(rand() % 80 - 40) / 10,
                          (float)(rand() % 80 - 40) / 10};
    tri_array[i].p1 = near(base);
    tri_array[i].p2 = near(base);
    tri_array[i].p3 = near(base);
  }
  return (int)count;
}

void free_memory(void) {
  free(tri_array);
  free(tri_result_array);
  tri_array = NULL;
  tri_result_array = NULL;
}
