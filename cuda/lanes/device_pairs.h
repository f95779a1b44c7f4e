// SPDX-License-Identifier: Apache-2.0
// How blocks of pairs are laid out in device memory. A block is the first parameter of the kernels and of their twins.
#pragma once

#include <cstdint>

namespace graze::cuda {

// A block of `count` float32 pairs: 18 arrays of `stride` floats, ax0[] ay0[] … bz2[].
struct DevicePairs {
  using Real = float;
  const float* coordinates;
  std::uint32_t stride;
  std::uint32_t count;
};

// A block of pairs of doubles, in the same layout.
struct DeviceDoubles {
  using Real = double;
  const double* coordinates;
  std::uint32_t stride;
  std::uint32_t count;
};

}  // namespace graze::cuda
