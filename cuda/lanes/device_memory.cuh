// SPDX-License-Identifier: Apache-2.0
// Owner types for memory, streams and events, and the check of every CUDA call. Device code only.
#pragma once

#include <cuda_runtime.h>

#include <source_location>
#include <string>

#include "cuda/lanes/device_failure.h"

namespace graze::cuda {

// Throws: DeviceFailure with CUDA's message and the source location of the call.
inline void check(cudaError_t error, std::source_location where = std::source_location::current()) {
  if (error != cudaSuccess) {
    throw DeviceFailure(std::string("CUDA: ") + cudaGetErrorString(error) + " (" + where.file_name() + ":" +
                            std::to_string(where.line()) + ")",
                        error == cudaErrorMemoryAllocation);
  }
}

// The number of CUDA devices; 0 without a driver.
inline int count_devices() {
  int count = 0;
  if (cudaGetDeviceCount(&count) == cudaSuccess) return count;
  cudaGetLastError();  // clears the error
  return 0;
}

// Memory that can grow, and that the destructor frees: device memory, or pinned host memory.
template <class T, bool pinned>
class GrowingArray {
 public:
  GrowingArray() = default;
  GrowingArray(const GrowingArray&) = delete;
  GrowingArray& operator=(const GrowingArray&) = delete;
  ~GrowingArray() { release(); }

  T* at_least(std::size_t count) {
    if (count > count_) {
      check(release());
      data_ = nullptr;
      count_ = 0;
      check(pinned ? cudaMallocHost(&data_, count * sizeof(T)) : cudaMalloc(&data_, count * sizeof(T)));
      count_ = count;
    }
    return data_;
  }

 private:
  cudaError_t release() { return pinned ? cudaFreeHost(data_) : cudaFree(data_); }

  T* data_ = nullptr;
  std::size_t count_ = 0;
};

template <class T>
using DeviceArray = GrowingArray<T, false>;
template <class T>
using PinnedArray = GrowingArray<T, true>;

class Stream {
 public:
  explicit Stream(unsigned flags = cudaStreamDefault) { check(cudaStreamCreateWithFlags(&stream_, flags)); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { cudaStreamDestroy(stream_); }
  operator cudaStream_t() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

class Event {
 public:
  explicit Event(unsigned flags = cudaEventDefault) { check(cudaEventCreateWithFlags(&event_, flags)); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { cudaEventDestroy(event_); }
  operator cudaEvent_t() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

// Milliseconds from the start to the end of the work that `work` submits to the stream.
template <class Work>
double timed(cudaStream_t stream, const Work& work) {
  const Event start, stop;
  check(cudaEventRecord(start, stream));
  work();
  check(cudaEventRecord(stop, stream));
  check(cudaEventSynchronize(stop));
  float milliseconds = 0;
  check(cudaEventElapsedTime(&milliseconds, start, stop));
  return double{milliseconds};
}

}  // namespace graze::cuda
