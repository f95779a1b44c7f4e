// SPDX-License-Identifier: Apache-2.0
// What lanes cost on a device, in nanoseconds and in what the compiler gave their kernels.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/lanes/lanes.h"

namespace graze::cuda {

// What one thread of a lane's kernel needs; of the exact lane, and of `filtered` what its filter needs: the kernel that
// every pair goes through.
struct KernelNeeds {
  int registers = 0;
  int local_bytes = 0;     // registers that did not fit, and arrays
  int active_threads = 0;  // of a multiprocessor, at most
};

// Nanoseconds a pair, of each pass; all lanes take turns in a pass.
struct DeviceCost {
  std::vector<double> resident;     // pairs that lie on the device, and verdicts that stay there
  std::vector<double> with_copies;  // pairs from pinned memory of the host, and verdicts back
  KernelNeeds needs;
};

struct DeviceCosts {
  std::string device;          // "NVIDIA H100 80GB HBM3"
  int threads_at_once = 0;     // of a multiprocessor
  std::vector<DeviceCost> of;  // each lane
};

// Requires: CUDA lanes, pairs.   Throws: std::runtime_error on any CUDA error, and without a device.
DeviceCosts measure_on_device(std::span<const Lane* const> lanes, const std::vector<Pair>& pairs, int passes);

}  // namespace graze::cuda
