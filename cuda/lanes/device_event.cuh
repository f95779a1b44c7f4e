// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cuda/lanes/device_memory.cuh"

namespace graze::cuda {

// A CUDA event, destroyed with its owner. Device code only.
class Event {
 public:
  Event() { check(cudaEventCreate(&event_)); }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { cudaEventDestroy(event_); }
  operator cudaEvent_t() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace graze::cuda
