// SPDX-License-Identifier: Apache-2.0
// A scene: the envelope from which pairs are drawn, so that their sizes, places and ulps are those of a user's data.
// It draws the strata of strata.h under the same rules: pure functions, with the same bits on host and device.
#pragma once

#include <cstdint>

#include "strata/strata.h"

namespace graze::strata {

// Nondecreasing numbers at the fractions 0, 1/32 … 1; linear interpolation in between.
inline constexpr int kQuantiles = 33;
struct Quantiles {
  double at[kQuantiles];
};

// Numbered points on an axis. Point n is n * scale, or n / scale on a decimal grid, rounded to the coordinates' type.
struct Grid {
  double scale = 1;
  bool decimal = false;
};

// The numbers of a scene, for pairs of float32 or of doubles. resolved() in strata/scene/envelope.h makes them.
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

// The pair with this index. It lies within the extent and on the grid. Up to rounding, no edge is longer than the
// scene's longest edge. A pair that does not fit into the extent along an axis is flattened along that axis.
// Requires: a scene of float32 that can contain the stratum, see left_out(); compiled without contraction.
GRAZE_HD inline Pair generate(std::uint64_t seed, Stratum stratum, const Scene& scene, std::uint64_t index);

// Like generate, but in doubles, in a scene of doubles.
GRAZE_HD inline DoublePair generate_doubles(std::uint64_t seed, Stratum stratum, const Scene& scene,
                                            std::uint64_t index);

}  // namespace GRAZE_FP
}  // namespace graze::strata

#include "strata/scene/scene.inl"
