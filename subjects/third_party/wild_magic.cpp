// SPDX-License-Identifier: Apache-2.0
// Wild Magic 5's two tests for two triangles: the separating axis test, and the query that also finds the intersection.
#include <Wm5IntrTriangle3Triangle3.h>
#include <graze/subject.h>

namespace {

template <class Real>
Wm5::Triangle3<Real> triangle(const Real v[9]) {
  using Vector = Wm5::Vector3<Real>;
  return {Vector(v[0], v[1], v[2]), Vector(v[3], v[4], v[5]), Vector(v[6], v[7], v[8])};
}

template <class Real>
int decide_by_test(const Real a[9], const Real b[9]) {
  const auto first = triangle(a), second = triangle(b);
  return Wm5::IntrTriangle3Triangle3<Real>(first, second).Test();
}

template <class Real>
int decide_by_find(const Real a[9], const Real b[9]) {
  const auto first = triangle(a), second = triangle(b);
  return Wm5::IntrTriangle3Triangle3<Real>(first, second).Find();
}

}  // namespace

// The library has no version macro; scripts/league passes the package's version.
GRAZE_SUBJECT(test) = {
    GRAZE_SUBJECT_ABI,     0,
    DEBIAN_VERSION,        "Wild Magic 5 IntrTriangle3Triangle3<Real>::Test, BSL-1.0, https://www.geometrictools.com",
    "nothing stated",      decide_by_test<float>,
    decide_by_test<double>};
GRAZE_SUBJECT(find) = {GRAZE_SUBJECT_ABI,
                       0,
                       DEBIAN_VERSION,
                       "Wild Magic 5 IntrTriangle3Triangle3<Real>::Find, BSL-1.0, https://www.geometrictools.com",
                       "Wm5IntrTriangle3Triangle3.h: mReportCoplanarIntersections, default 'true'; nothing else stated",
                       decide_by_find<float>,
                       decide_by_find<double>};
