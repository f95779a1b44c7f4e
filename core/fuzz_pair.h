// SPDX-License-Identifier: Apache-2.0
// The pair that a fuzz target's bytes stand for.
#pragma once

#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

#include "core/pair.h"

namespace graze {

// First byte even: the 72 bytes that follow, whatever they are. Odd: small whole numbers, 18 bytes, times the power of
// two that the second byte says, so that contacts are common.   Returns: none of too few bytes.
inline std::optional<Pair> pair_of(std::string_view bytes) {
  Pair pair;
  if (bytes.empty()) return std::nullopt;
  const bool raw = bytes[0] % 2 == 0;
  bytes.remove_prefix(1);
  if (bytes.size() < (raw ? sizeof pair : 19)) return std::nullopt;
  if (raw) {
    std::memcpy(&pair, bytes.data(), sizeof pair);
  } else {
    for (int i = 0; i < kCoordinates; ++i)
      coordinates(pair)[i] = std::ldexp(static_cast<float>(static_cast<signed char>(bytes[static_cast<std::size_t>(i) + 1])),
                                        static_cast<signed char>(bytes[0]));
  }
  return pair;
}

}  // namespace graze
