/* SPDX-License-Identifier: Apache-2.0
 * ODE's collision of two triangle meshes. They intersect if there is a contact. Each mesh has its triangle twice: a
 * mesh of one triangle has no tree, and dCollide would dereference the null pointer to it. */
#include <graze/subject.h>
#include <ode/ode.h>

static dGeomID mesh(const double v[9]) {
  static const dTriIndex kIndices[6] = {0, 1, 2, 0, 1, 2};
  const dTriMeshDataID data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(data, v, 3 * sizeof(double), 3, kIndices, 6, 3 * sizeof(dTriIndex));
  return dCreateTriMesh(0, data, 0, 0, 0);
}

static void destroy(dGeomID geom) {
  const dTriMeshDataID data = dGeomTriMeshGetData(geom);
  dGeomDestroy(geom);
  dGeomTriMeshDataDestroy(data);
}

static int collides(const double a[9], const double b[9]) {
  static _Thread_local int ready = 0;
  if (!ready) {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    ready = 1;
  }
  dGeomID first = mesh(a), second = mesh(b);
  dContactGeom contacts[8];
  const int count = dCollide(first, second, 8, contacts, sizeof(dContactGeom));
  destroy(first);
  destroy(second);
  return count > 0;
}

/* The library has no version macro; scripts/league passes the package's version. */
GRAZE_SUBJECT(trimesh_trimesh) = {
    .abi = GRAZE_SUBJECT_ABI,
    .version = DEBIAN_VERSION,
    .source = "ODE dCollide, trimesh against trimesh, BSD-3-Clause or LGPL-2.1-or-later, https://ode.org",
    .convention =
        "ode/collision.h: \"If the geoms intersect, this function returns the number of contact points "
        "generated\"; nothing else stated",
    .f64 = collides};
