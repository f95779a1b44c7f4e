// SPDX-License-Identifier: Apache-2.0
// The bounding boxes of triangles, in the form that CGAL's box intersection takes.
#pragma once

#include <CGAL/Box_intersection_d/Box_with_info_d.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.h"

namespace graze::strata {

using Box = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::uint32_t>;  // info() is the triangle's index

// The boxes of triangles [begin, end).
inline std::vector<Box> boxes_of(std::span<const std::array<Vec3<float>, 3>> triangles, std::size_t begin,
                                 std::size_t end) {
  std::vector<Box> boxes;
  boxes.reserve(end - begin);
  for (std::size_t i = begin; i < end; ++i) {
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax(
          {component(triangles[i][0], axis), component(triangles[i][1], axis), component(triangles[i][2], axis)});
      low[axis] = least;
      high[axis] = most;
    }
    boxes.emplace_back(low, high, static_cast<std::uint32_t>(i));
  }
  return boxes;
}

}  // namespace graze::strata
