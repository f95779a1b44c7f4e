// SPDX-License-Identifier: Apache-2.0
// The points that the viewer draws besides the two triangles. They are computed with 113 bits and rounded to double.
#pragma once

#include <cstdint>

#include "core/exact/relation.h"
#include "core/pair.h"

namespace graze::wasm {

struct Drawing {
  static constexpr int kMost = 9;  // the most extreme points of a common set
  std::int32_t contact_count, line_count, section_a_count, section_b_count;
  Vec3<double> contact[kMost];  // the common set's extreme points, in order around it
  Vec3<double> line[2];         // the line in which the planes meet, clipped to the pair's box enlarged by half
  Vec3<double> section_a[2], section_b[2];  // the parts of that line in the triangles a and b
  // The segment whose length the margin measures. For a disjoint pair, it joins the nearest points of a and b. For an
  // intersecting pair, it is the shortest translation of b that separates the pair, drawn from the middle of the
  // contact. There is no witness if an arbitrarily short translation separates the pair, or if 113 bits show no gap.
  Vec3<double> witness[2];
  // The extents of a and b along the witness, measured from the end of a: high_a is 0, and low_b is the gap or minus
  // the depth.
  double low_a, high_a, low_b, high_b;
  std::int32_t witness_count;
  // The nearest features of a and b, or the features that determine the push's direction. 0 to 2: vertices; 3 to 5:
  // edges (3 is edge 01); 6: the face; -1: none.
  std::int32_t feature_a, feature_b;
};

// The drawing of a pair with this relation.   Requires: finite coordinates.
Drawing drawing_of(const DoublePair& pair, const Relation& relation);

}  // namespace graze::wasm
