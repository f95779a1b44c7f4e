// SPDX-License-Identifier: Apache-2.0
// A pair's grid: its coordinates are integers of a certain number of bits, times a common power of two.
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

GRAZE_HD inline std::uint64_t bits_of(double x) {
  std::uint64_t bits;
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

GRAZE_HD inline int trailing_zeros(std::uint64_t x) {
#ifdef __CUDA_ARCH__
  return __ffsll(static_cast<long long>(x)) - 1;
#else
  return __builtin_ctzll(x);
#endif
}

// The parts of a float or double.
template <class Real>
struct Format {
  using Bits = decltype(bits_of(Real()));
  static constexpr int kFraction = sizeof(Real) == 4 ? 23 : 52, kBias = sizeof(Real) == 4 ? 127 : 1023;
  static constexpr Bits kHidden = Bits{1} << kFraction, kSign = Bits{1} << (8 * sizeof(Real) - 1);
};

// |x| = mantissa * 2^exponent.   Requires: a finite number.
template <class Real>
GRAZE_HD typename Format<Real>::Bits mantissa_of(Real x, int& exponent) {
  using F = Format<Real>;
  const typename F::Bits bits = bits_of(x) & ~F::kSign;
  const bool is_subnormal = bits < F::kHidden;
  exponent = (is_subnormal ? 1 : static_cast<int>(bits >> F::kFraction)) - F::kBias - F::kFraction;
  return is_subnormal ? bits : (bits & (F::kHidden - 1)) | F::kHidden;
}

template <class Real>
GRAZE_HD Grid grid_of(const Real* a, const Real* b) {
  int lowest = 1 << 12, highest = -(1 << 12);
  for (int i = 0; i < 18; ++i) {
    int exponent;
    const auto mantissa = mantissa_of(i < 9 ? a[i] : b[i - 9], exponent);
    if (mantissa == 0) continue;
    const int low = exponent + trailing_zeros(mantissa), high = exponent + Format<Real>::kFraction + 1;
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
