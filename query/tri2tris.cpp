// SPDX-License-Identifier: Apache-2.0
// The functions of the 2012 thesis, implemented with this library.
#include <atomic>
#include <bit>
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>

#include "query/include/graze/detect-tri2tris-intersection.h"
#include "query/include/graze/query.h"

namespace {

std::atomic<std::uint8_t> flags = 0;

std::int8_t detect(const triangle_t& ref, const triangle_t* triangles, int count, std::uint8_t* bytes, bool on_gpu) {
  static const std::unique_ptr<graze_context, void (*)(graze_context*)> context(graze_open(), graze_close);
  const std::uint8_t config = flags;
  const bool all = config & COMPUTE_ALL_INTERSECTION;
  const auto fail = [&](const char* what) -> std::int8_t {
    if (config & VERBOSE_MODE) std::fprintf(stderr, "tri2tris_intersection_detect: %s\n", what);
    return -1;
  };
  if (count < 0) return fail("expected an array size of at least 0, found a negative size");
  if (!bytes && count > 0) return fail("expected an array for the results, found NULL");
  const auto reference = std::bit_cast<graze::query::Triangle>(ref);
  const graze_triangles part = graze::query::rows_of(std::span(triangles, static_cast<std::size_t>(count)));
  graze_query query = graze::query::query_of(reference, part);
  if (!all) query.mode = GRAZE_ANY;
  query.executor = !on_gpu ? GRAZE_ALL_CORES : config & FORCE_SINGLE_GPU_COMPUTATION ? GRAZE_ONE_GPU : GRAZE_ALL_GPUS;
  if (all) query.bytes = bytes;
  if (config & NO_WDDM_TDR_WORKAROUND) query.launch_seconds = 1e9;
  graze_answer answer;
  if (graze_run(context.get(), &query, &answer) != GRAZE_OK) return fail(answer.message);
  if (!all && count > 0) {
    std::memset(bytes, 0, static_cast<std::size_t>(count));
    if (answer.hits) bytes[answer.first] = 1;
  }
  if (answer.hits) return 1;
  return answer.declined ? fail("expected finite coordinates, found infinity or NaN") : std::int8_t{0};
}

}  // namespace

extern "C" {

void config_set(uint8_t config) { flags |= config; }

void config_reset(void) { flags = 0; }

int8_t tri2tris_intersection_detect_cpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]) {
  return detect(ref, tri_array, array_sz, result_array, false);
}

int8_t tri2tris_intersection_detect_gpu(triangle_t ref, triangle_t tri_array[], int array_sz, uint8_t result_array[]) {
  return detect(ref, tri_array, array_sz, result_array, true);
}
}
