// SPDX-License-Identifier: Apache-2.0
// What the viewer draws besides the two triangles, constructed with 113 bits and rounded to double.
#pragma once

#include <cstdint>

#include "core/pair.h"

namespace graze::reports::wasm {

struct Drawing {
  static constexpr int kMost = 9;  // extreme points of a common set
  std::int32_t contact_count, line_count, section_a_count, section_b_count;
  Vec3<double> contact[kMost];   // the common set's extreme points, in order around it
  Vec3<double> line[2];          // the line of both planes, as far as the box around the pair, wider by half
  Vec3<double> section_a[2], section_b[2];  // of that line by each triangle
};

// Requires: finite coordinates.
Drawing drawing_of(const Pair& pair);

}  // namespace graze::reports::wasm
