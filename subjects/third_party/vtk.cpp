// SPDX-License-Identifier: Apache-2.0
// VTK's two tests for two triangles.
#include <graze/subject.h>
#include <vtkIntersectionPolyDataFilter.h>
#include <vtkTriangle.h>
#include <vtkVersionMacros.h>
#include <algorithm>

namespace {

int decide_by_triangle(const double a[9], const double b[9]) {
  return vtkTriangle::TrianglesIntersect(a, a + 3, a + 6, b, b + 3, b + 6);
}

int decide_by_filter(const double a[9], const double b[9]) {
  double v[18], from[3], to[3], surfaces[2];
  std::copy(a, a + 9, v);
  std::copy(b, b + 9, v + 9);
  int coplanar = 0;
  const double tolerance = 0;
  return vtkIntersectionPolyDataFilter::TriangleTriangleIntersection(v, v + 3, v + 6, v + 9, v + 12, v + 15, coplanar,
                                                                     from, to, surfaces, tolerance);
}

}  // namespace

GRAZE_SUBJECT(triangle) = {
    GRAZE_SUBJECT_ABI, 0,       VTK_VERSION,       "VTK vtkTriangle::TrianglesIntersect, BSD-3-Clause, https://vtk.org",
    "nothing stated",  nullptr, decide_by_triangle};
GRAZE_SUBJECT(filter) = {
    GRAZE_SUBJECT_ABI,
    GRAZE_OUTSIDE_COPLANAR,
    VTK_VERSION,
    "VTK vtkIntersectionPolyDataFilter::TriangleTriangleIntersection, tolerance 0, BSD-3-Clause, https://vtk.org",
    "vtkIntersectionPolyDataFilter.h: \"relies on the inputs having no co-planar, overlapping cells\"",
    nullptr,
    decide_by_filter};
