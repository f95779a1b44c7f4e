// SPDX-License-Identifier: Apache-2.0
// Lists of pairs of a block that one step leaves to another, and how a pair is read; on host and device alike.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/pair.h"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {

// Places of pairs in a block.
struct Places {
  std::uint32_t* at;
  std::uint32_t* count;

  // On a device: one atomic operation for all threads of a warp that add to this list, for they all meet at one
  // address. On the host: one thread at a time.
  GRAZE_HD void add(std::uint32_t place) const {
#ifdef __CUDA_ARCH__
    const unsigned together = __match_any_sync(__activemask(), reinterpret_cast<unsigned long long>(count));
    const unsigned thread = threadIdx.x % 32, leader = static_cast<unsigned>(__ffs(static_cast<int>(together)) - 1);
    std::uint32_t first = 0;
    if (thread == leader) first = atomicAdd(count, static_cast<unsigned>(__popc(together)));
    first = __shfl_sync(together, first, static_cast<int>(leader));
    at[first + static_cast<unsigned>(__popc(together & ((1u << thread) - 1)))] = place;
#else
    at[(*count)++] = place;
#endif
  }
};

// The coordinates of pair i.
GRAZE_HD inline void load(const DevicePairs& pairs, std::uint32_t i, float* c) {
  for (std::uint32_t k = 0; k < kCoordinates; ++k) c[k] = pairs.coordinates[std::size_t{k} * pairs.stride + i];
}

}  // namespace graze::cuda
