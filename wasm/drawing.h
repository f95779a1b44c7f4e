// SPDX-License-Identifier: Apache-2.0
// What the viewer draws besides the two triangles, constructed with 113 bits and rounded to double.
#pragma once

#include <cstdint>

#include "core/exact/relation.h"
#include "core/pair.h"

namespace graze::wasm {

struct Drawing {
  static constexpr int kMost = 9;  // extreme points of a common set
  std::int32_t contact_count, line_count, section_a_count, section_b_count;
  Vec3<double> contact[kMost];  // the common set's extreme points, in order around it
  Vec3<double> line[2];         // the line where the planes meet, within the box around the pair, enlarged by half
  Vec3<double> section_a[2], section_b[2];  // the part of that line in each triangle
  // What the margin measures. For a disjoint pair, the nearest points of a and b. For an intersecting pair, the
  // shortest translation of b that separates it, drawn from the middle of the contact. None if an arbitrarily short
  // translation separates the pair, or if 113 bits show no gap.
  Vec3<double> witness[2];
  // The extents of a and b along the witness, measured from the end of a: high_a is 0, and low_b is the gap or minus
  // the depth.
  double low_a, high_a, low_b, high_b;
  std::int32_t witness_count;
  std::int32_t feature_a,
      feature_b;  // the nearest ones, or those that give the push its direction: 0 vertex 0, 3 edge 01, 6 face, -1 none
};

// relation: the pair's own.   Requires: finite coordinates.
Drawing drawing_of(const DoublePair& pair, const Relation& relation);

}  // namespace graze::wasm
