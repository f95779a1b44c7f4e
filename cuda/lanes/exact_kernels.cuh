// SPDX-License-Identifier: Apache-2.0
// The exact lane on the device. Device code only; see cuda/lanes/device.h.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>

#include "core/exact/exact.h"
#include "core/lanes.h"
#include "cuda/lanes/device_memory.cuh"
#include "cuda/lanes/places.h"

namespace graze::cuda {

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
