// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/exact/exact.h"

namespace graze::exact {

// As decide (decide.h), one pair after the other.
inline void one_by_one(const float* pairs, std::size_t count, std::uint64_t* intersects, std::uint64_t* declined) {
  for (std::size_t word = 0; word * 64 < count; ++word) {
    intersects[word] = declined[word] = 0;
    for (std::size_t bit = 0; bit < 64 && word * 64 + bit < count; ++bit) {
      const float* const pair = pairs + (word * 64 + bit) * 18;
      const bool finite = std::all_of(pair, pair + 18, [](float x) { return std::isfinite(x); });
      declined[word] |= std::uint64_t{!finite} << bit;
      if (finite) intersects[word] |= std::uint64_t{exact::intersects(pair, pair + 9)} << bit;
    }
  }
}

}  // namespace graze::exact
