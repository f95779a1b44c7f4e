/* SPDX-License-Identifier: Apache-2.0
   A caller of the thesis of 2012, as it was written then: three of its special cases. */
#include "detect-tri2tris-intersection.h"

#include <stdio.h>

int main(void) {
  triangle_t ref = {{0, -2, 6}, {0, 5, 0}, {0, -3, 0}};
  triangle_t array[3] = {{{-2, -2, 0}, {2, -3, 0}, {3, -1, 0}},
                         {{1.5f, -3, 5.5f}, {-2, -2, 5.5f}, {1.5f, 0, 5.5f}},
                         {{9, 9, 9}, {9, 8, 9}, {9, 9, 8}}};
  uint8_t result[3];
  config_set(COMPUTE_ALL_INTERSECTION | VERBOSE_MODE);
  int8_t cpu = tri2tris_intersection_detect_cpu(ref, array, 3, result);
  printf("cpu %d: %d %d %d\n", cpu, result[0], result[1], result[2]);
  printf("gpu %d\n", tri2tris_intersection_detect_gpu(ref, array, 3, result));
  return cpu == 1 && result[0] == 1 && result[1] == 1 && result[2] == 0 ? 0 : 1;
}
