// SPDX-License-Identifier: Apache-2.0
// FCL's separating axis test for two triangles. FCL instantiates it for double; this file instantiates it for float.
#include <fcl/config.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>
#include <graze/subject.h>

namespace {

template <class Real>
int intersects(const Real a[9], const Real b[9]) {
  using Vector = fcl::Vector3<Real>;
  return fcl::detail::Intersect<Real>::intersect_Triangle(Vector(a[0], a[1], a[2]), Vector(a[3], a[4], a[5]),
                                                          Vector(a[6], a[7], a[8]), Vector(b[0], b[1], b[2]),
                                                          Vector(b[3], b[4], b[5]), Vector(b[6], b[7], b[8]));
}

}  // namespace

GRAZE_SUBJECT(intersect_triangle) = {
    GRAZE_SUBJECT_ABI,
    0,
    FCL_VERSION,
    "FCL detail::Intersect<S>::intersect_Triangle, BSD-3-Clause, https://github.com/flexible-collision-library/fcl",
    "nothing stated",
    intersects<float>,
    intersects<double>};
