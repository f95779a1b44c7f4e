// SPDX-License-Identifier: Apache-2.0
// Axes: quantities that a few strata vary besides the margin, namely the coordinates' scale or their distance from the
// origin. Pairs are counted by their place on the axis, a small integer, just as they are counted by margin bucket.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/margin/bucket.h"
#include "core/pair.h"

namespace graze {

// wide_scale is the scale axis for pairs of doubles.
enum class Axis : std::uint8_t { none, scale, offset, wide_scale };

inline std::string_view name(Axis axis) {
  return axis == Axis::none ? "none" : axis == Axis::offset ? "offset" : "scale";
}

// log2 of the width of a place on a scale axis. On the float32 axis, the place at -152 covers 2^-152 to 2^-148.
GRAZE_HD constexpr int width_of_place(Axis axis) { return axis == Axis::scale ? 4 : axis == Axis::wide_scale ? 32 : 1; }

// log2 of the lower end of place `extreme`.
GRAZE_HD constexpr int exponent_of(Axis axis, std::int8_t extreme) { return width_of_place(axis) * extreme; }

inline namespace GRAZE_FP {

// The pair's place on the axis, in [-kBucketMost, kBucketMost]. scale: floor(log2(m) / 4), where m is the largest
// magnitude of a coordinate (2^-149 if all are zero); for doubles floor(log2(m) / 32), with 2^-1023 for all smaller m.
// offset: floor(log2(m / s)), where s is the longest side of the box around both triangles. kBucketMost stands for all
// larger offsets, and for s = 0.
// Requires: finite coordinates; compiled without contraction, on host and device alike.
template <class Real>
GRAZE_HD std::int8_t place_on_axis(const BasicPair<Real>& pair, Axis axis) {
  if (axis == Axis::none) return 0;
  const Real* c = &pair.a[0].x;
  double largest = 0, extent = 0;
  for (int i = 0; i < 3; ++i) {
    double low = c[i], high = c[i];
    for (int k = i + 3; k < kCoordinates; k += 3) {
      if (c[k] < low) low = c[k];
      if (c[k] > high) high = c[k];
    }
    if (-low > largest) largest = -low;
    if (high > largest) largest = high;
    if (high - low > extent) extent = high - low;
  }
  if (axis == Axis::scale) return static_cast<std::int8_t>((largest > 0 ? floor_log2(largest) : -149) >> 2);
  if (axis == Axis::wide_scale) return static_cast<std::int8_t>(floor_log2(largest) >> 5);
  const int offset = extent > 0 ? floor_log2(largest / extent) : kBucketMost;
  return static_cast<std::int8_t>(offset < -kBucketMost ? -kBucketMost : offset < kBucketMost ? offset : kBucketMost);
}

}  // namespace GRAZE_FP
}  // namespace graze
