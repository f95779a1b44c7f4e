// SPDX-License-Identifier: Apache-2.0
// The kernels that record values, for pairs of both coordinate types. Each device variant has a table in its own
// namespace. Device code only; see core/lanes/records.h.
#pragma once

#include <array>

#include "core/lanes/lanes.h"
#include "cuda/lanes/kernels.cuh"

namespace graze::cuda {

// As LaunchValues, for pairs of doubles.
using LaunchValuesOfDoubles = void (*)(DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths,
                                       cudaStream_t stream);

struct RecordKernels {
  DeviceKernels<LaunchValues> floats;
  std::array<LaunchValuesOfDoubles, kAlgorithmCount> doubles;  // in double
};

// As launch_record in exact_kernels.cuh, for pairs of doubles.   Requires: a lane in double.
void launch_record(const Lane& lane, DeviceDoubles pairs, void* values, std::uint64_t stride, RecordedPath* paths);

}  // namespace graze::cuda
