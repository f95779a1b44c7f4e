// SPDX-License-Identifier: Apache-2.0
// Lists of pairs that one step leaves to a later step, and access to a pair's coordinates, for host and device.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/pair.h"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {

// Indices of pairs in a block.
struct PairList {
  std::uint32_t* at;
  std::uint32_t* count;

  // Adds an index. On a device, threads of a warp that add to the same list together need only one atomic operation.
  // Not thread-safe on the host.
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

#ifdef __CUDACC__
// Adds the indices of a thread block to two lists. `which` is 0 or 1, the list for this thread's index, or -1 for
// neither. All threads of the block must call this function. It uses one atomic operation per block and list, because a
// device performs an atomic operation on a counter only every 0.7 ns.
__device__ inline void add_of_block(const PairList& first, const PairList& second, int which, std::uint32_t place) {
  __shared__ std::uint32_t begins[2][32];
  if (!__syncthreads_or(which >= 0)) return;
  const unsigned in_first = __ballot_sync(0xffffffffu, which == 0), in_second = __ballot_sync(0xffffffffu, which == 1);
  const unsigned thread = threadIdx.x % 32, warp = threadIdx.x / 32;
  if (thread == 0) begins[0][warp] = static_cast<unsigned>(__popc(in_first) | __popc(in_second) << 16);
  __syncthreads();
  if (warp == 0) {  // each word has both counts
    const unsigned added = thread < blockDim.x / 32 ? begins[0][thread] : 0;
    unsigned end = added;
    for (unsigned step = 1; step < 32; step *= 2) {
      const unsigned before = __shfl_up_sync(0xffffffffu, end, step);
      if (thread >= step) end += before;
    }
    const unsigned all = __shfl_sync(0xffffffffu, end, 31), mine = thread == 0 ? all & 0xffffu : all >> 16;
    const unsigned at = thread < 2 && mine != 0 ? atomicAdd(thread == 0 ? first.count : second.count, mine) : 0;
    begins[0][thread] = __shfl_sync(0xffffffffu, at, 0) + ((end - added) & 0xffffu);
    begins[1][thread] = __shfl_sync(0xffffffffu, at, 1) + ((end - added) >> 16);
  }
  __syncthreads();
  if (which < 0) return;
  const unsigned before = (which == 0 ? in_first : in_second) & ((1u << thread) - 1);
  (which == 0 ? first : second).at[begins[which][warp] + static_cast<unsigned>(__popc(before))] = place;
}
#endif

// Reads the coordinates of pair i.
template <class Pairs, class Real>
GRAZE_HD void load(const Pairs& pairs, std::uint32_t i, Real* c) {
  for (std::uint32_t k = 0; k < kCoordinates; ++k) c[k] = pairs.coordinates[std::size_t{k} * pairs.stride + i];
}

}  // namespace graze::cuda
