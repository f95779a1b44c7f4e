// SPDX-License-Identifier: Apache-2.0
// The cost of lanes on a device: nanoseconds, and the resources that the compiler gave their kernels.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"
#include "strata/pair_source.h"

namespace graze::cuda {

// Resources of a lane's kernel. For the exact lane and `filtered` this is the filter, the kernel that decides every
// pair first.
struct KernelNeeds {
  int threads = 0;  // of a block
  int registers = 0;
  int local_bytes = 0;     // bytes of local memory for each thread: spilled registers and arrays
  int active_threads = 0;  // most threads that a multiprocessor runs at once
};

// Nanoseconds per pair, one value for each pass. In a pass all lanes take turns.
struct DeviceCost {
  std::vector<double> resident;     // pairs and verdicts stay in device memory
  std::vector<double> with_copies;  // pairs come from pinned host memory, verdicts go back
  KernelNeeds needs;
};

struct DeviceCosts {
  std::string device;          // "NVIDIA H100 80GB HBM3"
  int threads_at_once = 0;     // most threads that a multiprocessor can run at once
  std::vector<DeviceCost> of;  // for each lane
};

// Lanes in double decide pairs of doubles as they are; other lanes decide them as float32 stores them.
// Requires: CUDA lanes, pairs.   Throws: std::runtime_error on any CUDA error, or without a device.
DeviceCosts measure_on_device(std::span<const Lane* const> lanes, const strata::PairBlock& pairs, int passes);

}  // namespace graze::cuda
