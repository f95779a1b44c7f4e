// SPDX-License-Identifier: Apache-2.0
// Points in the plane, and projection along a coordinate axis.
#pragma once

#include "core/vec3.h"

namespace graze {
inline namespace GRAZE_FP {

template <class Real>
struct Vec2 {
  Real x, y;
};

// v without its component along the axis.
template <class Real>
GRAZE_HD Vec2<Real> drop(const Vec3<Real>& v, int axis) {
  return axis == 0 ? Vec2<Real>{v.y, v.z} : axis == 1 ? Vec2<Real>{v.x, v.z} : Vec2<Real>{v.x, v.y};
}

}  // namespace GRAZE_FP
}  // namespace graze
