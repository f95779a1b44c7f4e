// SPDX-License-Identifier: Apache-2.0
// The cost of lanes on a device: nanoseconds per pair, and the kernels' resources.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// Resources of a lane's kernel. The exact lane and lanes under the policy `filtered` have several kernels; for them,
// the numbers are those of the first kernel, which sees every pair.
struct KernelNeeds {
  int threads = 0;  // threads of a block
  int registers = 0;
  int local_bytes = 0;     // bytes of local memory for each thread: spilled registers and arrays
  int active_threads = 0;  // the most threads of this kernel that a multiprocessor runs at once
};

// Nanoseconds per pair, one value for each pass. Each pass measures all lanes, one after another.
struct DeviceCost {
  std::vector<double> resident;     // pairs and verdicts stay in device memory
  std::vector<double> with_copies;  // includes copies of the pairs from pinned host memory, and of the verdicts back
  KernelNeeds needs;
};

struct DeviceCosts {
  std::string device;          // "NVIDIA H100 80GB HBM3"
  int threads_at_once = 0;     // the most threads that a multiprocessor can run at once
  std::vector<DeviceCost> of;  // the cost of each lane
};

// Measures the lanes on the first device. Lanes in float decide pairs of doubles after rounding them to float32.
// Requires: CUDA lanes; at least one pair.   Throws: std::runtime_error on any CUDA error, or without a device.
DeviceCosts measure_on_device(std::span<const Lane* const> lanes, const strata::PairBlock& pairs, int passes);

}  // namespace graze::cuda
