/* SPDX-License-Identifier: Apache-2.0
   The two functions of the thesis of 2012 (docs/query.md), for its callers: with this folder on the include path they
   compile as they are. New callers have <graze/query_c.h>. Decided exactly. */
#ifndef GRAZE_DETECT_TRI2TRIS_INTERSECTION_H
#define GRAZE_DETECT_TRI2TRIS_INTERSECTION_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define COMPUTE_ALL_INTERSECTION 0x01     /* do not stop at the first hit */
#define VERBOSE_MODE 0x02                 /* say on the error stream what is wrong */
#define NO_WDDM_TDR_WORKAROUND 0x04       /* let kernels run as long as they take */
#define FORCE_SINGLE_GPU_COMPUTATION 0x08 /* use the first device alone */

typedef struct {
  float x, y, z;
} coord_t;

typedef struct {
  coord_t p1, p2, p3;
} triangle_t;

void config_set(uint8_t config);
void config_reset(void);

/* Returns: 1 when a triangle meets ref, 0 when none does, -1 on an error, or when none does but some are not finite.
   In result_array a byte for each triangle: 1 meets it, 0 does not, 2 is not finite; where the search stops at a hit,
   1 for that one and 0 for all others. */
int8_t tri2tris_intersection_detect_cpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]);
int8_t tri2tris_intersection_detect_gpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]);

#ifdef __cplusplus
}
#endif
#endif
