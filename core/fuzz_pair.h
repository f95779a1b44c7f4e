// SPDX-License-Identifier: Apache-2.0
// Makes a pair from the bytes of a fuzz input.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/pair.h"

namespace graze {

// First byte even: the next 72 bytes are the coordinates' bits. First byte odd: the second byte is an exponent and the
// next 18 are small whole numbers, scaled by that power of two so that contacts are common. Missing bytes are zeros.
inline Pair pair_of(std::string_view bytes) {
  unsigned char all[1 + sizeof(Pair)] = {};
  std::copy_n(bytes.begin(), std::min(bytes.size(), sizeof all), all);
  Pair pair;
  std::memcpy(&pair, all + 1, sizeof pair);
  if (all[0] % 2 == 0) return pair;
  for (int i = 0; i < kCoordinates; ++i)
    coordinates(pair)[i] =
        std::ldexp(static_cast<float>(static_cast<signed char>(all[i + 2])), static_cast<signed char>(all[1]));
  return pair;
}

// Like pair_of, but the exponent of a coordinate that is not finite is one less, which makes it finite.
inline Pair finite_pair_of(std::string_view bytes) {
  Pair pair = pair_of(bytes);
  for (int i = 0; i < kCoordinates; ++i) {
    float& x = coordinates(pair)[i];
    if (!std::isfinite(x)) x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ 0x800000u);
  }
  return pair;
}

}  // namespace graze
