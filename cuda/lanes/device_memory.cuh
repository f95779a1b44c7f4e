// SPDX-License-Identifier: Apache-2.0
// Owners of device memory, and the check of every CUDA call. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <source_location>
#include <string>

#include "cuda/lanes/device_failure.h"

namespace graze::cuda {

// Throws: DeviceFailure with CUDA's message and the place of the call.
inline void check(cudaError_t error, std::source_location where = std::source_location::current()) {
  if (error != cudaSuccess) {
    throw DeviceFailure(std::string("CUDA: ") + cudaGetErrorString(error) + " (" + where.file_name() + ":" +
                            std::to_string(where.line()) + ")",
                        error == cudaErrorMemoryAllocation);
  }
}

// Device memory that grows and is freed with its owner.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
  ~DeviceArray() { cudaFree(data_); }

  T* at_least(std::size_t count) {
    if (count > count_) {
      check(cudaFree(data_));
      data_ = nullptr;
      count_ = 0;
      check(cudaMalloc(&data_, count * sizeof(T)));
      count_ = count;
    }
    return data_;
  }

 private:
  T* data_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace graze::cuda
