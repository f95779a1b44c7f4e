// SPDX-License-Identifier: Apache-2.0
// Netgen's test for two triangles of a mesh, which may share vertices.
#include <graze/subject.h>
#include <mystdlib.h>
#include <gprim.hpp>
#include <myadt.hpp>

namespace {

int intersects(const double a[9], const double b[9]) {
  using Point = netgen::Point<3>;
  const Point v[6] = {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, {a[6], a[7], a[8]},
                      {b[0], b[1], b[2]}, {b[3], b[4], b[5]}, {b[6], b[7], b[8]}};
  const Point* first[3] = {v, v + 1, v + 2};
  const Point* second[3] = {v + 3, v + 4, v + 5};
  return netgen::IntersectTriangleTriangle(first, second);
}

}  // namespace

// The library has no version macro; scripts/league passes the package's version.
GRAZE_SUBJECT(intersect_triangle_triangle) = {GRAZE_SUBJECT_ABI,
                                              GRAZE_OUTSIDE_SHARED,
                                              DEBIAN_VERSION,
                                              "Netgen IntersectTriangleTriangle, LGPL-2.1, https://ngsolve.org",
                                              "gprim/geomtest3d.hpp: \"1, iff not regular triangulation\"",
                                              nullptr,
                                              intersects};
