// SPDX-License-Identifier: Apache-2.0
// OpenCASCADE's test for two triangles of its surface meshes.
#include <graze/subject.h>
#include <IntPolyh_Couple.hxx>
#include <IntPolyh_Edge.hxx>
#include <IntPolyh_MaillageAffinage.hxx>
#include <IntPolyh_Triangle.hxx>
#include <Standard_Version.hxx>

namespace {

int touches(const double a[9], const double b[9]) {
  // TriContact uses neither the surfaces nor the parameters u and v.
  static const IntPolyh_MaillageAffinage kMeshes(Handle(Adaptor3d_Surface)(), 1, 1, Handle(Adaptor3d_Surface)(), 1, 1,
                                                 0);
  const auto point = [](const double* v) { return IntPolyh_Point(v[0], v[1], v[2], 0, 0); };
  double angle = 0;
  return kMeshes.TriContact(point(a), point(a + 3), point(a + 6), point(b), point(b + 3), point(b + 6), angle);
}

}  // namespace

GRAZE_SUBJECT(tri_contact) = {
    GRAZE_SUBJECT_ABI,
    0,
    OCC_VERSION_COMPLETE,
    "OpenCASCADE IntPolyh_MaillageAffinage::TriContact, LGPL-2.1 with exception, https://dev.opencascade.org",
    "IntPolyh_MaillageAffinage.hxx: \"checks if two triangles are in contact or not, return 1 if yes\"",
    nullptr,
    touches};
