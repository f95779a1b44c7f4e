// SPDX-License-Identifier: Apache-2.0
// A scene: the envelope that pairs are drawn from, so that sizes, places and ulps are those of a user's own data.
// The strata of strata.h within it, by the same rules: pure functions, the same bits on host and device.
#pragma once

#include <cstdint>

#include "strata/strata.h"

namespace graze::strata {

// Numbers that do not fall, at fractions 0, 1/32 … 1; linear between.
inline constexpr int kQuantiles = 33;
struct Quantiles {
  double at[kQuantiles];
};

// Numbered points of an axis: number n is at n * scale, or, for decimals, at n / scale, rounded to float32.
struct Grid {
  double scale = 1;
  bool decimal = false;
};

// Made by resolved() of strata/scene/envelope.h from what a scene's file says.
struct Scene {
  Vec3<double> low, high;  // the least and the greatest coordinate by axis; float32 numbers, on the grid
  Quantiles edges;         // longest edge of a triangle
  Quantiles aspect;        // longest edge over the height on it, from 2 / sqrt(3)
  bool on_grid = false;    // whether all coordinates are on `grid`
  Grid grid;
  Grid exact;                // grid of the exact constructions: `grid`, or ulps of the largest coordinate
  Vec3<double> first, last;  // its first and last number in the extent, by axis
};

inline namespace GRAZE_FP {

// The pair with this index: within the extent, on the grid, no edge longer than the longest (but for rounding). Where a
// pair does not fit the extent along an axis, it is flattened along it.
// Requires: the stratum is one that the scene can contain, see left_out(); compiled without contraction.
GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, const Scene& scene, std::uint64_t index);

}  // namespace GRAZE_FP
}  // namespace graze::strata

#include "strata/scene/scene.inl"
