// SPDX-License-Identifier: Apache-2.0
// Where two triangles meet, as points for a drawing: constructed exactly on rationals, and rounded at the end.
#pragma once

#include <vector>

#include "core/pair.h"

namespace graze::oracle {

// The extreme points of the common set of the two closed hulls, in order around it: none, one, two, or a convex
// polygon's.   Requires: finite coordinates.   Exact: but for the rounding to double.
std::vector<Vec3<double>> common_set(const Pair& pair);

// The part of the line in both triangles' planes that lies in the box around the pair, a tenth wider on each side: two
// points. None where a triangle is flat, the planes are parallel, or the line passes the box by.
// Requires: finite coordinates.   Exact: as common_set.
std::vector<Vec3<double>> planes_line(const Pair& pair);

}  // namespace graze::oracle
