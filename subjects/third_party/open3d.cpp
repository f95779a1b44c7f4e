// SPDX-License-Identifier: Apache-2.0
// Open3D's test for two triangles, derived from Moeller's code.
#include <graze/subject.h>
#include <open3d/Open3DConfig.h>
#include <open3d/geometry/IntersectionTest.h>

namespace {

int triangle_triangle(const double a[9], const double b[9]) {
  using Vector = Eigen::Vector3d;
  return open3d::geometry::IntersectionTest::TriangleTriangle3d(Vector(a[0], a[1], a[2]), Vector(a[3], a[4], a[5]),
                                                                Vector(a[6], a[7], a[8]), Vector(b[0], b[1], b[2]),
                                                                Vector(b[3], b[4], b[5]), Vector(b[6], b[7], b[8]));
}

}  // namespace

GRAZE_SUBJECT(triangle_triangle_3d) = {
    GRAZE_SUBJECT_ABI, 0,
    OPEN3D_VERSION,    "Open3D geometry::IntersectionTest::TriangleTriangle3d, MIT, https://www.open3d.org",
    "nothing stated",  nullptr,
    triangle_triangle};
