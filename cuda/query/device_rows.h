// SPDX-License-Identifier: Apache-2.0
// Device memory for benchmarks and tests that do not include CUDA headers. Also measures the limits of a query: the
// speed of copies within the device and from the host, and the resources of the query's kernel.
#pragma once

#include <cstddef>
#include <memory>

#include "cuda/lanes/device_costs.h"
#include "cuda/lanes/device_failure.h"

namespace graze::cuda {

class DeviceMemory {
 public:
  virtual ~DeviceMemory() = default;
  // Fills the memory with copies of these `bytes` bytes; the last copy may be incomplete.   Throws: DeviceFailure.
  virtual void fill(const void* from, std::size_t bytes) = 0;
  // Copies the first `bytes` bytes back to the host.   Throws: DeviceFailure.
  virtual void fetch(void* to, std::size_t bytes) const = 0;
  void* data = nullptr;
  std::size_t bytes = 0;
};

// Throws: DeviceFailure.
std::unique_ptr<DeviceMemory> device_memory(int device, std::size_t bytes);

struct DeviceSpeeds {
  double copy = 0;       // bytes read plus bytes written per second, within the device
  double to_device = 0;  // bytes per second from pinned host memory to the device
};

// The speeds of the fastest of six copies of `bytes` bytes, from the host at most 2^28.   Throws: DeviceFailure.
DeviceSpeeds measure_speeds(int device, std::size_t bytes);

// The resources of the kernel that reads every triangle in an exact query.   Throws: DeviceFailure.
KernelNeeds needs_of_exact_query(int device);

}  // namespace graze::cuda
