// SPDX-License-Identifier: Apache-2.0
// The common set of two triangles as points for a drawing: constructed exactly with rationals, and rounded at the end.
#pragma once

#include <vector>

#include "core/any_pair.h"

namespace graze::oracle {

// The extreme points of the two closed hulls' common set: none, one, two, or a convex polygon's vertices in order.
// Requires: finite coordinates.   Exact: except for the rounding to double.
std::vector<Vec3<double>> common_set(const AnyPair& pair);

// The line where the triangles' planes meet: the two ends of its part within the pair's box, enlarged by a tenth on
// each side. No points if a triangle is flat, the planes are parallel, or the line misses the box.
// Requires: finite coordinates.   Exact: like common_set.
std::vector<Vec3<double>> planes_line(const AnyPair& pair);

}  // namespace graze::oracle
