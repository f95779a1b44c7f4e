// SPDX-License-Identifier: Apache-2.0
#include "cuda/query/device_rows.h"

#include <cuda_runtime.h>

#include <algorithm>

#include "cuda/lanes/device_memory.cuh"

namespace graze::cuda {
namespace {

class Memory final : public DeviceMemory {
 public:
  Memory(int device, std::size_t wanted) : device_(device) {
    check(cudaSetDevice(device_));
    try {
      data = memory_.at_least(wanted);
    } catch (const DeviceFailure&) {
      cudaGetLastError();  // otherwise the next check would report it
      throw;
    }
    bytes = wanted;
  }

  void fill(const void* from, std::size_t block) override {
    check(cudaSetDevice(device_));
    if (block == 0) return;
    std::size_t done = std::min(block, bytes);
    char* to = static_cast<char*>(data);
    check(cudaMemcpy(to, from, done, cudaMemcpyHostToDevice));
    for (; done < bytes; done += std::min(done, bytes - done))  // copies whole blocks except at the end
      check(cudaMemcpy(to + done, to, std::min(done, bytes - done), cudaMemcpyDeviceToDevice));
    check(cudaDeviceSynchronize());  // cudaMemcpy from pageable memory returns before the data has arrived
  }

  void fetch(void* to, std::size_t count) const override {
    check(cudaSetDevice(device_));
    check(cudaDeviceSynchronize());
    check(cudaMemcpy(to, data, count, cudaMemcpyDeviceToHost));
  }

 private:
  int device_;
  DeviceArray<char> memory_;
};

template <class Copy>
double best_seconds(const Copy& copy) {
  double best = 1e9;
  for (int k = 0; k < 6; ++k) best = std::min(best, timed(nullptr, copy));
  return best / 1000;
}

}  // namespace

std::unique_ptr<DeviceMemory> device_memory(int device, std::size_t bytes) {
  return std::make_unique<Memory>(device, bytes);
}

DeviceSpeeds measure_speeds(int device, std::size_t bytes) {
  Memory from(device, bytes), to(device, bytes);
  DeviceSpeeds speeds;
  speeds.copy = 2 * static_cast<double>(bytes) /
                best_seconds([&] { check(cudaMemcpyAsync(to.data, from.data, bytes, cudaMemcpyDeviceToDevice)); });
  PinnedArray<char> pinned;
  const std::size_t some = std::min<std::size_t>(bytes, std::size_t{1} << 28);
  const char* host = pinned.at_least(some);
  speeds.to_device = static_cast<double>(some) /
                     best_seconds([&] { check(cudaMemcpyAsync(to.data, host, some, cudaMemcpyHostToDevice)); });
  return speeds;
}

}  // namespace graze::cuda
