// SPDX-License-Identifier: Apache-2.0
// A scene: an envelope for pairs, which gives them the sizes, places and ulps of a user's data. The strata of strata.h
// are drawn within a scene under the same rules: as pure functions, with the same bits on host and device.
#pragma once

#include <cstdint>

#include "strata/strata.h"

namespace graze::strata {

// Quantiles at the fractions 0, 1/32 … 1, nondecreasing, with linear interpolation in between.
inline constexpr int kQuantiles = 33;
struct Quantiles {
  double at[kQuantiles];
};

// Numbered points on an axis. Point n is n * scale, or n / scale on a decimal grid, rounded to the coordinates' type.
struct Grid {
  double scale = 1;
  bool decimal = false;
};

// A scene's numbers, for pairs of float32 or doubles. resolved() in strata/scene/envelope.h computes them.
struct Scene {
  Vec3<double> low, high;  // least and greatest coordinate on each axis: representable, and on the grid
  Quantiles edges;         // longest edge of a triangle
  Quantiles aspect;        // longest edge divided by the height on it, at least 2 / sqrt(3)
  bool on_grid = false;    // whether all coordinates are on `grid`
  Grid grid;
  Grid exact;                // grid of the exact constructions: `grid`, or the ulps of the largest coordinate
  Vec3<double> first, last;  // first and last number of `exact` in the extent, by axis
};

inline namespace GRAZE_FP {

// The pair with this index, which lies within the extent and on the grid. Up to rounding, no edge is longer than the
// scene's longest edge. A pair that does not fit into the extent along an axis is flattened along that axis.
// Requires: a float32 scene that can contain the stratum (see left_out); compiled without contraction.
GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, const Scene& scene, std::uint64_t index);

// Like generate, but in doubles, in a scene of doubles.
GRAZE_HD inline DoublePair generate_doubles(std::uint64_t seed, Stratum stratum, const Scene& scene,
                                            std::uint64_t index);

}  // namespace GRAZE_FP
}  // namespace graze::strata

#include "strata/scene/scene.inl"
