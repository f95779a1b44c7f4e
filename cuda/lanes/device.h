// SPDX-License-Identifier: Apache-2.0
// The host's interface to the device lanes. This header includes no CUDA headers and compiles without nvcc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/lanes/verdicts.h"

namespace graze::cuda {

// A CUDA device with memory for blocks of pairs. Not thread-safe.
class Device {
 public:
  virtual ~Device() = default;

  // Decides the pairs with each lane; bits[k] has the verdicts of cuda_lanes[k]. If `doubles` is not empty, lanes in
  // double decide `doubles`, and `pairs` has the same pairs rounded to float32, or is empty if all lanes are in
  // double. Requires: CUDA lanes. Throws: std::runtime_error on any CUDA error.
  virtual void decide(std::span<const Pair> pairs, std::span<const Lane* const> cuda_lanes,
                      std::vector<VerdictBits>& bits, std::span<const DoublePair> doubles = {}) = 0;

  std::string name;     // "NVIDIA H100 80GB HBM3"
  std::string driver;   // CUDA version of the driver, "13.0"
  std::string toolkit;  // version of nvcc, "13.0.88"
};

// The first CUDA device; null without a device, with the reason in `why_not` ("no device", "built without CUDA").
std::unique_ptr<Device> open_device(std::string& why_not);

}  // namespace graze::cuda
