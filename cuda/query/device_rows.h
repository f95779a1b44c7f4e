// SPDX-License-Identifier: Apache-2.0
// Memory of a device for those who need no CUDA but a device: benchmarks and tests. And what bounds a query there, the
// speeds of a copy within the device and of one from the host.
#pragma once

#include <cstddef>
#include <memory>

#include "cuda/lanes/device_failure.h"

namespace graze::cuda {

class DeviceMemory {
 public:
  virtual ~DeviceMemory() = default;
  // Copies `bytes` to its beginning, and those again and again behind them to its end.   Throws: DeviceFailure.
  virtual void fill(const void* from, std::size_t bytes) = 0;
  // The other way.   Throws: DeviceFailure.
  virtual void fetch(void* to, std::size_t bytes) const = 0;
  void* data = nullptr;
  std::size_t bytes = 0;
};

// Throws: DeviceFailure.
std::unique_ptr<DeviceMemory> device_memory(int device, std::size_t bytes);

struct DeviceSpeeds {
  double copy = 0;       // bytes read and bytes written, each second
  double to_device = 0;  // bytes from pinned memory each second
};

// The best of a few copies of so many bytes.   Throws: DeviceFailure.
DeviceSpeeds measure_speeds(int device, std::size_t bytes);

}  // namespace graze::cuda
