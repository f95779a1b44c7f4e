// SPDX-License-Identifier: Apache-2.0
// A pair: two float32 triangles, 18 floats, 72 bytes. Its stored bits are the input; nothing rounds them again.
#pragma once

#include <bit>
#include <cstdint>

#include "core/vec3.h"

namespace graze {

// Vertices a[0..2] of the first triangle and b[0..2] of the second, in the order of the text format.
struct Pair {
  Vec3<float> a[3];
  Vec3<float> b[3];
};
static_assert(sizeof(Pair) == 72);

inline constexpr int kCoordinates = 18;

// The 18 coordinates of a pair as one array: ax0 ay0 az0 ax1 … bz2.
inline const float* coordinates(const Pair& pair) { return &pair.a[0].x; }
inline float* coordinates(Pair& pair) { return &pair.a[0].x; }

inline bool is_finite(const Pair& pair) {
  unsigned others = 0;  // no branch for each coordinate, so that this becomes vector instructions
  for (int i = 0; i < kCoordinates; ++i)
    others |= unsigned{(std::bit_cast<std::uint32_t>(coordinates(pair)[i]) & 0x7f800000u) == 0x7f800000u};
  return others == 0;
}

}  // namespace graze
