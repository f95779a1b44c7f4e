// SPDX-License-Identifier: Apache-2.0
// CGAL's do_intersect with four kernels: two round, one has exact predicates, and one also has exact constructions.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>
#include <CGAL/version.h>
#include <graze/subject.h>

namespace {

template <class Kernel, class Real>
int intersects(const Real a[9], const Real b[9]) {
  using Point = typename Kernel::Point_3;
  using Triangle = typename Kernel::Triangle_3;
  const Triangle first(Point(a[0], a[1], a[2]), Point(a[3], a[4], a[5]), Point(a[6], a[7], a[8]));
  const Triangle second(Point(b[0], b[1], b[2]), Point(b[3], b[4], b[5]), Point(b[6], b[7], b[8]));
  return CGAL::do_intersect(first, second);
}

using Float = CGAL::Simple_cartesian<float>;
using Double = CGAL::Simple_cartesian<double>;
using Epick = CGAL::Exact_predicates_inexact_constructions_kernel;
using Epeck = CGAL::Exact_predicates_exact_constructions_kernel;

const char kVersion[] = CGAL_STR(CGAL_VERSION);
const char kSource[] = "CGAL do_intersect(Triangle_3, Triangle_3), LGPL-3.0-or-later, https://www.cgal.org";
const char kConvention[] =
    "CGAL/Intersections_3/internal/Triangle_3_Triangle_3_do_intersect.h: "
    "CGAL_kernel_precondition(! k.is_degenerate_3_object() (t1)), and of t2";

}  // namespace

GRAZE_SUBJECT(simple_cartesian) = {GRAZE_SUBJECT_ABI, GRAZE_OUTSIDE_DEGENERATE, kVersion,          kSource,
                                   kConvention,       intersects<Float>,        intersects<Double>};
GRAZE_SUBJECT(epick) = {GRAZE_SUBJECT_ABI, GRAZE_OUTSIDE_DEGENERATE, kVersion, kSource, kConvention,
                        nullptr,           intersects<Epick>};
GRAZE_SUBJECT(epeck) = {GRAZE_SUBJECT_ABI, GRAZE_OUTSIDE_DEGENERATE, kVersion, kSource, kConvention,
                        nullptr,           intersects<Epeck>};
