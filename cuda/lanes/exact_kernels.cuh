// SPDX-License-Identifier: Apache-2.0
// The exact lane on the device. Device code only; see cuda/lanes/device.h.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "core/exact/exact.h"
#include "core/lanes.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {

// Places of pairs in a block, for another kernel.
struct Places {
  std::uint32_t* at;
  std::uint32_t* count;

  // One atomic operation for all threads of a warp that add to this list: they all meet at one address.
  __device__ void add(std::uint32_t place) const {
    const unsigned together = __match_any_sync(__activemask(), reinterpret_cast<unsigned long long>(count));
    const unsigned lane = threadIdx.x % 32, leader = static_cast<unsigned>(__ffs(static_cast<int>(together)) - 1);
    std::uint32_t first = 0;
    if (lane == leader) first = atomicAdd(count, static_cast<unsigned>(__popc(together)));
    first = __shfl_sync(together, first, static_cast<int>(leader));
    at[first + static_cast<unsigned>(__popc(together & ((1u << lane) - 1)))] = place;
  }
};

// The coordinates of pair i.
__device__ inline void load(const DevicePairs& pairs, std::uint32_t i, float* c) {
  for (std::uint32_t k = 0; k < kCoordinates; ++k) c[k] = pairs.coordinates[std::size_t{k} * pairs.stride + i];
}

// The exact decision of blocks of pairs, and the memory for what its stages leave to each other.
class DeviceExact {
 public:
  // Starts kernels that write bit i % 32 of word i / 32: intersects, declined. Words of whole thread blocks are
  // written. Adds to stages[s], unless null, the pairs that stage s decided.
  void decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, unsigned long long* stages,
              cudaStream_t stream);

 private:
  DeviceArray<std::uint32_t> places_[3], counts_;
};

// Starts the kernels of a CUDA lane, which write as DeviceExact::decide does.
void launch_lane(const Lane& lane, DeviceExact& exact, DevicePairs pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream);

}  // namespace graze::cuda
