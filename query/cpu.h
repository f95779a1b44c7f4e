// SPDX-License-Identifier: Apache-2.0
// Queries on the cores of this machine.
#pragma once

#include <span>

#include "core/lanes/lanes.h"
#include "cuda/query/device_query.h"

namespace graze::query {

struct CpuQuestion {
  bool in_doubles = false;           // the coordinates of references and triangles; otherwise in floats
  const void* references = nullptr;  // nine coordinates each
  std::uint64_t reference_count = 0;
  std::span<const cuda::TriangleArray> parts;
  const Lane* lane = nullptr;  // a host lane; the exact one for doubles
  bool any = false;
};

// Runs on `threads` threads until no range is left. This thread takes the first ranges alone, because starting threads
// takes longer than finding a hit among the first triangles.
// Throws: std::bad_alloc, and what the progress callback throws.
void run_on_cpu(const CpuQuestion& question, int threads, cuda::QueryWork& work);

}  // namespace graze::query
