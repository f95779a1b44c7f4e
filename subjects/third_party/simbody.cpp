// SPDX-License-Identifier: Apache-2.0
// Simbody's two triangle tests, derived from Guigue and Devillers' code.
#include <SimTKmath.h>
#include <graze/subject.h>

namespace {

template <class Real>
SimTK::Geo::Triangle_<Real> triangle(const Real v[9]) {
  using Vector = SimTK::Vec<3, Real>;
  return {Vector(v[0], v[1], v[2]), Vector(v[3], v[4], v[5]), Vector(v[6], v[7], v[8])};
}

template <class Real>
int overlaps(const Real a[9], const Real b[9]) {
  return triangle(a).overlapsTriangle(triangle(b));
}

template <class Real>
int intersects(const Real a[9], const Real b[9]) {
  SimTK::Geo::LineSeg_<Real> segment;
  bool coplanar = false;
  return triangle(a).intersectsTriangle(triangle(b), segment, coplanar);
}

}  // namespace

// The library has no version macro; scripts/league passes the package's version.
GRAZE_SUBJECT(overlaps_triangle) = {
    GRAZE_SUBJECT_ABI,
    GRAZE_OUTSIDE_TOUCHING,
    DEBIAN_VERSION,
    "Simbody Geo::Triangle_<P>::overlapsTriangle, Apache-2.0, https://github.com/simbody/simbody",
    "simmath/internal/Geo_Triangle.h: \"Note that exactly touching is not overlapping.\"",
    overlaps<float>,
    overlaps<double>};
GRAZE_SUBJECT(intersects_triangle) = {
    GRAZE_SUBJECT_ABI,
    0,
    DEBIAN_VERSION,
    "Simbody Geo::Triangle_<P>::intersectsTriangle, Apache-2.0, https://github.com/simbody/simbody",
    "simmath/internal/Geo_Triangle.h: \"If the triangles are coplanar and intersect we'll return true\"; \"the "
    "triangles "
    "may meet at a point\"",
    intersects<float>,
    intersects<double>};
