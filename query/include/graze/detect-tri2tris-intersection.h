/* SPDX-License-Identifier: Apache-2.0
   The two functions of the 2012 thesis. With this folder on the include path, the thesis's console program
   compiles; docs/query.md lists deliberate differences. New code should use <graze/query_c.h>. Verdicts are exact. */
#ifndef GRAZE_DETECT_TRI2TRIS_INTERSECTION_H
#define GRAZE_DETECT_TRI2TRIS_INTERSECTION_H

#include "geometric-types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define COMPUTE_ALL_INTERSECTION 0x01     /* do not stop at the first hit */
#define VERBOSE_MODE 0x02                 /* write errors to the error stream */
#define NO_WDDM_TDR_WORKAROUND 0x04       /* do not limit the time of a kernel */
#define FORCE_SINGLE_GPU_COMPUTATION 0x08 /* use only the first device */

void config_set(uint8_t config); /* adds flags to those that are set */
void config_reset(void);         /* clears all flags */

/* Returns: 1 if a triangle meets ref; 0 if none does; -1 on an error, or if none does and some are not finite.
   result_array receives a byte for each triangle: 1 if it meets ref, 0 if not, 2 if it is not finite. If the search
   stops at a hit, the byte is 1 for that triangle and 0 for all others. */
int8_t tri2tris_intersection_detect_cpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]);
int8_t tri2tris_intersection_detect_gpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]);

#ifdef __cplusplus
}
#endif
#endif
