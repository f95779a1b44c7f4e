// SPDX-License-Identifier: Apache-2.0
// A pair of doubles on the grid of floats, where bounds on margins neither over- nor underflow.
#pragma once

#include "core/exact/grid.h"
#include "core/exact/numbers.h"
#include "core/margin/bucket.h"
#include "core/margin/frame.h"
#include "core/pair.h"

namespace graze {

// The pair times a power of two, which scales its margin by the same factor. Nothing is rounded.
struct ScaledPair {
  DoublePair pair;
  int ulp;    // log2 of the original pair's ulp after scaling
  bool fits;  // if false, the pair is unchanged

  GRAZE_HD explicit ScaledPair(const DoublePair& unscaled)
      : pair(unscaled), ulp(log2_ulp(pair)), fits(on_grid_of_floats(pair)) {
    if (fits) return;
    const exact::detail::Grid grid = exact::detail::grid_of(&pair.a[0].x, &pair.b[0].x);
    fits = grid.bits <= exact::detail::kFloatBits;
    if (!fits) return;
    const int shift = -149 - grid.exponent, half = shift / 2;  // 2^shift may exceed the range of a double
    ulp += shift;
    double* c = &pair.a[0].x;
    for (int i = 0; i < kCoordinates; ++i)
      c[i] = c[i] * exact::detail::power_of_two(half) * exact::detail::power_of_two(shift - half);
  }
};

}  // namespace graze
