/* SPDX-License-Identifier: Apache-2.0
   A console program for the library of the 2012 thesis, with the headers and calls of the thesis's listing. It decides
   the special cases, then random triangles, on the GPU and on the CPU. Usage: console_of_2012 [TRIANGLES]
   Exits with 1 if a special case does not intersect, or if GPU and CPU differ. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "detect-tri2tris-intersection.h"
#include "geometric-tools.h"
#include "test-tools.h"

static void print_results(const char* which, const uint8_t* results, int count) {
  printf("%s results:", which);
  for (int i = 0; i < count; ++i) printf(" %d", results[i]);
  printf("\n");
}

static void print_ends(const char* executor, int ticks, const uint8_t* results, int count) {
  const int shown = count < 25 ? count : 25;
  printf("%s: %d clock ticks\n", executor, ticks);
  print_results("first", results, shown);
  print_results("last", results + count - shown, shown);
}

/* Returns: the number of triangles that intersect; -1 on a failure. */
static int start_benchmark(uint32_t size) {
  const int count = tri_generator(size);
  uint8_t* gpu_results = count < 0 ? NULL : calloc((size_t)count, 1);
  if (!gpu_results) {
    printf("not enough memory\n");
    return -1;
  }
  config_set(COMPUTE_ALL_INTERSECTION | VERBOSE_MODE);
  chrono();
  const int on_gpu = tri2tris_intersection_detect_gpu(ref, tri_array, count, gpu_results) != -1;
  const int gpu_ticks = chrono();
  if (on_gpu)
    print_ends("GPU", gpu_ticks, gpu_results, count);
  else
    printf("GPU: failed\n"); /* there may be no GPU */
  chrono();
  const int on_cpu = tri2tris_intersection_detect_cpu(ref, tri_array, count, tri_result_array) != -1;
  const int cpu_ticks = chrono();
  int hits = -1;
  if (on_cpu && !(on_gpu && memcmp(gpu_results, tri_result_array, (size_t)count))) {
    print_ends("CPU", cpu_ticks, tri_result_array, count);
    hits = 0;
    for (int i = 0; i < count; ++i) hits += tri_result_array[i];
  }
  free(gpu_results);
  free_memory();
  return hits;
}

int main(int argc, char** argv) {
  if (start_benchmark(0) != 10) return EXIT_FAILURE;
  const int hits = start_benchmark(argc > 1 ? (uint32_t)atoi(argv[1]) : 1000);
  return hits > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
