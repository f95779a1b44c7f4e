// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/simplicity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace graze::fuzz {

Simplicity simplicity(const Pair& pair) {
  constexpr std::uint32_t kOne = 0x3f800000u;
  Simplicity s;
  auto& [magnitudes, nonzero, unwieldy, mantissa_bits, exponents, vertices, plane, signs] = s.counts;
  std::uint32_t seen[kCoordinates];
  for (std::size_t i = 0; i < kCoordinates; ++i) {
    const float value = coordinates(pair)[i];
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t magnitude = bits & 0x7fffffffu;
    s.ranks[i] = std::rotl(bits, 1);
    signs += static_cast<int>(bits >> 31);
    if (magnitude == 0) continue;
    ++nonzero;
    unwieldy += !(std::fabs(value) < 1000 && std::trunc(value) == value);
    const std::uint32_t biased = magnitude >> 23;
    const std::uint32_t mantissa = (magnitude & 0x7fffffu) | (biased ? 0x800000u : 0u);
    const int width = std::bit_width(mantissa);
    mantissa_bits += width - std::countr_zero(mantissa);
    exponents += std::abs(static_cast<int>(std::max(biased, 1u)) - 127 - 24 + width);
    if (magnitude != kOne && std::find(seen, seen + magnitudes, magnitude) == seen + magnitudes)
      seen[magnitudes++] = magnitude;
  }
  const Vec3<float>* v = pair.a;  // the six vertices, one after the other
  for (int i = 0; i < 6; ++i) vertices += std::find(v, v + i, v[i]) == v + i;
  const auto flat = [&](int axis) {
    return std::all_of(v, v + 3, [axis](const Vec3<float>& p) { return component(p, axis) == 0; });
  };
  plane = flat(2) ? 0 : flat(0) || flat(1) ? 1 : 2;
  return s;
}

}  // namespace graze::fuzz
