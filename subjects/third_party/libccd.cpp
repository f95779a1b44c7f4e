// SPDX-License-Identifier: Apache-2.0
// libccd's two tests for convex sets, GJK and MPR, on triangles.
#include <ccd/ccd.h>
#include <graze/subject.h>

namespace {

void support(const void* triangle, const ccd_vec3_t* direction, ccd_vec3_t* farthest) {
  const double* v = static_cast<const double*>(triangle);
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    ccd_vec3_t vertex;
    ccdVec3Set(&vertex, v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    const double along = ccdVec3Dot(&vertex, direction);
    if (i > 0 && along <= most) continue;
    most = along;
    *farthest = vertex;
  }
}

void center(const void* triangle, ccd_vec3_t* out) {
  const double* v = static_cast<const double*>(triangle);
  ccdVec3Set(out, (v[0] + v[3] + v[6]) / 3, (v[1] + v[4] + v[7]) / 3, (v[2] + v[5] + v[8]) / 3);
}

template <int (*kTest)(const void*, const void*, const ccd_t*)>
int intersects(const double a[9], const double b[9]) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = support;
  ccd.center1 = ccd.center2 = center;
  ccd.max_iterations = 100;  // as in the library's own example; by default, iterations are not limited
  return kTest(a, b, &ccd);
}

}  // namespace

// The library has no version macro; scripts/league passes the package's version.
GRAZE_SUBJECT(gjk) = {GRAZE_SUBJECT_ABI,
                      0,
                      DEBIAN_VERSION,
                      "libccd ccdGJKIntersect, BSD-3-Clause, https://github.com/danfis/libccd",
                      "ccd/ccd.h: \"Returns true if two given objects interest.\"; nothing else stated",
                      nullptr,
                      intersects<ccdGJKIntersect>};
GRAZE_SUBJECT(mpr) = {GRAZE_SUBJECT_ABI,
                      0,
                      DEBIAN_VERSION,
                      "libccd ccdMPRIntersect, BSD-3-Clause, https://github.com/danfis/libccd",
                      "ccd/ccd.h: \"Returns true if two given objects intersect\"; nothing else stated",
                      nullptr,
                      intersects<ccdMPRIntersect>};
