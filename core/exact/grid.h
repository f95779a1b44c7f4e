// SPDX-License-Identifier: Apache-2.0
// The grid of a pair: its coordinates are integers of a certain number of bits, times one power of two.
#pragma once

#include <cstdint>
#include <cstring>

#include "core/exact/host_device.h"

namespace graze::exact::detail {

// The coordinates are integers of `bits` bits times 2^exponent.
struct Grid {
  int exponent, bits;
};

GRAZE_HD inline std::uint32_t bits_of(float x) {
  std::uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

GRAZE_HD inline int trailing_zeros(std::uint32_t x) {
#ifdef __CUDA_ARCH__
  return __ffs(static_cast<int>(x)) - 1;
#else
  return __builtin_ctz(x);
#endif
}

GRAZE_HD inline Grid grid_of(const float* a, const float* b) {
  int lowest = 1 << 10, highest = -(1 << 10);
  for (int i = 0; i < 18; ++i) {
    const std::uint32_t bits = bits_of(i < 9 ? a[i] : b[i - 9]) & 0x7fffffffu;
    if (bits == 0) continue;
    const int exponent = bits < 0x800000u ? 1 : static_cast<int>(bits >> 23);
    const std::uint32_t mantissa = bits < 0x800000u ? bits : (bits & 0x7fffffu) | 0x800000u;
    const int low = exponent - 150 + trailing_zeros(mantissa), high = exponent - 126;
    lowest = low < lowest ? low : lowest;
    highest = high > highest ? high : highest;
  }
  return highest < lowest ? Grid{0, 0} : Grid{lowest, highest - lowest};
}

GRAZE_HD inline double power_of_two(int exponent) {
  const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

}  // namespace graze::exact::detail
