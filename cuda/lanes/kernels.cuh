// SPDX-License-Identifier: Apache-2.0
// The device lanes' kernels, in tables [algorithm][scalar], one for each device variant in a namespace of its own.
// Device code only; see cuda/lanes/device.h.
#pragma once

#include <cuda_runtime.h>

#include <array>
#include <cstdint>

#include "core/algorithms/algorithms.h"
#include "core/lanes/tolerances.h"
#include "core/variants.h"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {

inline constexpr int kThreads = 256;

// Starts a kernel that writes bit i % 32 of word i / 32: intersects, declined. Words of whole thread blocks are
// written.
using LaunchDecide = void (*)(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                              cudaStream_t stream);
// Starts a kernel that writes each pair's trace hash; see cuda/lanes/trace.h.
using LaunchTrace = void (*)(DevicePairs pairs, std::uint64_t* hashes, cudaStream_t stream);

// As LaunchDecide, of lanes under tolerances.
using LaunchWithin = void (*)(const Epsilons& epsilons, DevicePairs pairs, std::uint32_t* intersects,
                              std::uint32_t* declined, cudaStream_t stream);

template <class Launch>
using DeviceKernels = std::array<std::array<Launch, 2>, kAlgorithmCount>;

struct VariantKernels {
  DeviceKernels<LaunchDecide> decide;
  DeviceKernels<LaunchTrace> trace;
};

constexpr std::uint32_t thread_blocks(const DevicePairs& pairs) { return (pairs.count + kThreads - 1) / kThreads; }

// Throws: std::logic_error for a variant that no kernel is built in.
const VariantKernels& kernels_of(Variant variant);

}  // namespace graze::cuda
