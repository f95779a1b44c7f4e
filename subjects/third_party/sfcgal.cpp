// SPDX-License-Identifier: Apache-2.0
// SFCGAL's intersects3D. It refuses invalid geometries, such as triangles without area, which the adapter declines.
#include <SFCGAL/Exception.h>
#include <SFCGAL/Point.h>
#include <SFCGAL/Triangle.h>
#include <SFCGAL/algorithm/intersects.h>
#include <SFCGAL/version.h>
#include <graze/subject.h>

namespace {

SFCGAL::Triangle triangle(const double v[9]) {
  using SFCGAL::Point;
  return {Point(v[0], v[1], v[2]), Point(v[3], v[4], v[5]), Point(v[6], v[7], v[8])};
}

int intersects(const double a[9], const double b[9]) {
  try {
    return SFCGAL::algorithm::intersects3D(triangle(a), triangle(b));
  } catch (const SFCGAL::Exception&) {
    return GRAZE_DECLINED;
  }
}

}  // namespace

GRAZE_SUBJECT(intersects3d) = {GRAZE_SUBJECT_ABI,
                               GRAZE_OUTSIDE_DEGENERATE,
                               SFCGAL_VERSION,
                               "SFCGAL algorithm::intersects3D, LGPL-2.0-or-later, https://sfcgal.org",
                               "SFCGAL/algorithm/intersects.h: \"Robust intersection test on 3D geometries.\" \"@pre "
                               "ga and gb are valid geometries\"",
                               nullptr,
                               intersects};
