// SPDX-License-Identifier: Apache-2.0
// The device lanes' kernels, a table a build variant: [algorithm][scalar]. Device code only; see cuda/device.h.
#pragma once

#include <cuda_runtime.h>

#include <array>
#include <cstdint>

#include "core/algorithms.h"

namespace graze {

// A block of pairs on the device: 18 arrays of `stride` floats, ax0[] ay0[] … bz2[], of which `count` are in use.
struct DevicePairs {
  const float* coordinates;
  std::uint32_t stride;
  std::uint32_t count;
};

inline constexpr int kThreads = 256;

// Starts a kernel that writes bit i % 32 of word i / 32: intersects, declined. Words of whole thread blocks are written.
using LaunchDecide = void (*)(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined, cudaStream_t stream);
using DeviceKernels = std::array<std::array<LaunchDecide, 2>, kAlgorithmCount>;
extern const DeviceKernels kKernelsNofma;
extern const DeviceKernels kKernelsFma;

}  // namespace graze
