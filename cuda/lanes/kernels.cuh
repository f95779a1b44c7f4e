// SPDX-License-Identifier: Apache-2.0
// Tables [algorithm][scalar] of the device lanes' kernels. Each device variant has its tables in its own namespace.
// Device code only; see cuda/lanes/device.h.
#pragma once

#include <cuda_runtime.h>

#include <array>
#include <cstdint>

#include "core/algorithms/algorithms.h"
#include "core/algorithms/recording.h"
#include "core/lanes/tolerances.h"
#include "core/variants.h"
#include "cuda/lanes/device_pairs.h"

namespace graze::cuda {

inline constexpr int kThreads = 256;

// Starts a kernel that writes bit i % 32 of word i / 32 of `intersects` and `declined` for pair i. The kernel writes
// words for whole thread blocks.
using LaunchDecide = void (*)(DevicePairs pairs, std::uint32_t* intersects, std::uint32_t* declined,
                              cudaStream_t stream);
// Starts a kernel that writes each pair's trace hash; see cuda/lanes/trace.h.
using LaunchTrace = void (*)(DevicePairs pairs, std::uint64_t* hashes, cudaStream_t stream);

// Starts a kernel like LaunchDecide, but for lanes with tolerances.
using LaunchWithin = void (*)(const Epsilons& epsilons, DevicePairs pairs, std::uint32_t* intersects,
                              std::uint32_t* declined, cudaStream_t stream);

// The launchers for pairs of doubles.
using LaunchDecideDoubles = void (*)(DeviceDoubles pairs, std::uint32_t* intersects, std::uint32_t* declined,
                                     cudaStream_t stream);
using LaunchTraceDoubles = void (*)(DeviceDoubles pairs, std::uint64_t* hashes, cudaStream_t stream);
using LaunchWithinDoubles = void (*)(const Epsilons& epsilons, DeviceDoubles pairs, std::uint32_t* intersects,
                                     std::uint32_t* declined, cudaStream_t stream);

// Starts a kernel that records the values of each pair; see core/lanes/records.h. The values have the lane's scalar
// type.
using LaunchValues = void (*)(DevicePairs pairs, void* values, std::uint64_t stride, RecordedPath* paths,
                              cudaStream_t stream);
using LaunchValuesDoubles = void (*)(DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths,
                                     cudaStream_t stream);

template <class Launch>
using DeviceKernels = std::array<std::array<Launch, 2>, kAlgorithmCount>;

// The kernels of lanes in double, for pairs of doubles.
template <class Launch>
using DoubleKernels = std::array<Launch, kAlgorithmCount>;

struct VariantKernels {
  DeviceKernels<LaunchDecide> decide;
  DeviceKernels<LaunchTrace> trace;
  DoubleKernels<LaunchDecideDoubles> decide_doubles;
  DoubleKernels<LaunchTraceDoubles> trace_doubles;
};

// The kernels for pairs of both coordinate types.
template <class Launch, class LaunchDoubles>
struct KernelsOfBoth {
  DeviceKernels<Launch> floats;
  DoubleKernels<LaunchDoubles> doubles;
};
using WithinKernels = KernelsOfBoth<LaunchWithin, LaunchWithinDoubles>;  // lanes with tolerances
using BoundKernels = KernelsOfBoth<LaunchDecide, LaunchDecideDoubles>;   // lanes under certified bounds
using RecordKernels = KernelsOfBoth<LaunchValues, LaunchValuesDoubles>;

template <class Pairs>
constexpr std::uint32_t thread_blocks(const Pairs& pairs) {
  return (pairs.count + kThreads - 1) / kThreads;
}

// Throws: std::logic_error for a variant without kernels.
const VariantKernels& kernels_of(Variant variant);

}  // namespace graze::cuda
