// SPDX-License-Identifier: Apache-2.0
// How a block of pairs lies in a device's memory; the kernels' first parameter, on the device and in its twin.
#pragma once

#include <cstdint>

namespace graze::cuda {

// A block of pairs: 18 arrays of `stride` floats, ax0[] ay0[] … bz2[], of which `count` are in use.
struct DevicePairs {
  const float* coordinates;
  std::uint32_t stride;
  std::uint32_t count;
};

}  // namespace graze::cuda
