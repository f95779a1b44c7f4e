// SPDX-License-Identifier: Apache-2.0
// Device memory for benchmarks and tests that do not include CUDA. Also measures what limits a query: copies within the
// device, copies from the host, and the resources of its kernel.
#pragma once

#include <cstddef>
#include <memory>

#include "cuda/lanes/device_costs.h"
#include "cuda/lanes/device_failure.h"

namespace graze::cuda {

class DeviceMemory {
 public:
  virtual ~DeviceMemory() = default;
  // Copies `bytes` bytes to the start of the memory, then repeats them up to its end.   Throws: DeviceFailure.
  virtual void fill(const void* from, std::size_t bytes) = 0;
  // Copies the first `bytes` bytes back to the host.   Throws: DeviceFailure.
  virtual void fetch(void* to, std::size_t bytes) const = 0;
  void* data = nullptr;
  std::size_t bytes = 0;
};

// Throws: DeviceFailure.
std::unique_ptr<DeviceMemory> device_memory(int device, std::size_t bytes);

struct DeviceSpeeds {
  double copy = 0;       // bytes read plus bytes written, per second
  double to_device = 0;  // bytes from pinned host memory, per second
};

// The best of a few copies of `bytes` bytes.   Throws: DeviceFailure.
DeviceSpeeds measure_speeds(int device, std::size_t bytes);

// The resources of the kernel that sees every triangle of an exact query.   Throws: DeviceFailure.
KernelNeeds needs_of_exact_query(int device);

}  // namespace graze::cuda
