// SPDX-License-Identifier: Apache-2.0
// The exact lane on the device. Device code only; see cuda/lanes/device.h.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "core/exact/exact.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/pair_list.h"

namespace graze {
struct Lane;
}

namespace graze::cuda {

// Lists of pairs: two that the screen leaves, and what steps of the exact decision leave to others.
inline constexpr int kExactLists = 6;

// The exact decision of blocks of pairs, and the memory for what its stages leave to each other.
class DeviceExact {
 public:
  // Starts kernels that write bit i % 32 of word i / 32: intersects, declined. Words of whole thread blocks are
  // written. Adds to stages[s], unless null, the pairs that stage s decided.
  void decide(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, unsigned long long* stages,
              cudaStream_t stream);
  // Decides those pairs alone whose bit in `declined` is set: what a filter left. Those that are not finite stay so.
  void decide_declined(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream);

 private:
  void empty_lists(std::uint32_t pairs, cudaStream_t stream);
  void decide_listed(DevicePairs pairs, std::uint32_t* intersects, unsigned long long* stages, cudaStream_t stream);

  DeviceArray<std::uint32_t> places_[kExactLists], counts_;
  PairList left_[kExactLists];
};

// Starts the kernels of a CUDA lane, which write as DeviceExact::decide does.
void launch_lane(const Lane& lane, DeviceExact& exact, DevicePairs pairs, std::uint32_t* intersects,
                 std::uint32_t* declined, cudaStream_t stream);

}  // namespace graze::cuda
