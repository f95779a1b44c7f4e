// SPDX-License-Identifier: Apache-2.0
// Pairs for a device that cannot draw them itself.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/pair.h"

namespace graze::cuda {

// Draws pair(first), …, pair(first + count - 1) on all CPU cores, as 18 arrays of `count`.
template <class Real, class Draw>
void draw_on_cores(const Draw& pair, std::uint64_t first, std::uint32_t count, std::vector<Real>& to) {
  to.resize(std::size_t{count} * kCoordinates);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& part) {
    for (std::uint32_t i = part.begin(); i != part.end(); ++i) {
      const BasicPair<Real> drawn = pair(first + i);
      for (std::size_t c = 0; c < kCoordinates; ++c) to[c * count + i] = coordinates(drawn)[c];
    }
  });
}

}  // namespace graze::cuda
