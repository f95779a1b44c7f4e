// SPDX-License-Identifier: Apache-2.0
// Queries on the cores of this machine.
#pragma once

#include <span>

#include "core/lanes/lanes.h"
#include "cuda/query/device_query.h"

namespace graze::query {

struct CpuQuestion {
  std::span<const float> references;  // nine each
  std::span<const cuda::TriangleArray> parts;
  const Lane* lane = nullptr;  // of the host
  bool any = false;
};

// Works until there is no range left, on so many threads; the first ranges on this one alone, since threads take longer
// to start than a hit among the first triangles takes to find.
// Throws: std::bad_alloc, and what the progress callback throws.
void run_on_cpu(const CpuQuestion& question, int threads, cuda::QueryWork& work);

}  // namespace graze::query
