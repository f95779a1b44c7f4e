/* SPDX-License-Identifier: Apache-2.0
 * GTS's search for intersecting pairs of faces, on a surface of two triangles. */
#include <graze/subject.h>
#include <gts.h>

#define TEXT(x) #x
#define VERSION(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

static GtsFace* face(const double v[9]) {
  GtsVertex* p[3];
  GtsEdge* e[3];
  for (int i = 0; i < 3; ++i) p[i] = gts_vertex_new(gts_vertex_class(), v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  for (int i = 0; i < 3; ++i) e[i] = gts_edge_new(gts_edge_class(), p[i], p[(i + 1) % 3]);
  return gts_face_new(gts_face_class(), e[0], e[1], e[2]);
}

static void found(GtsBBox* a, GtsBBox* b, gpointer data) { (void)a, (void)b, (void)data; }

static int intersects(const double a[9], const double b[9]) {
  GtsSurface* surface = gts_surface_new(gts_surface_class(), gts_face_class(), gts_edge_class(), gts_vertex_class());
  gts_surface_add_face(surface, face(a));
  gts_surface_add_face(surface, face(b));
  const int any = gts_surface_foreach_intersecting_face(surface, found, NULL);
  gts_object_destroy(GTS_OBJECT(surface)); /* destroys its faces, edges and vertices too */
  return any;
}

GRAZE_SUBJECT(foreach_intersecting_face) = {
    .abi = GRAZE_SUBJECT_ABI,
    .version = VERSION(GTS_MAJOR_VERSION, GTS_MINOR_VERSION, GTS_MICRO_VERSION),
    .source = "GTS gts_surface_foreach_intersecting_face, LGPL-2.0-or-later, https://gts.sourceforge.net",
    .convention = "boolean.c: \"Calls func for each intersecting pair of faces of s.\"; nothing else stated",
    .f64 = intersects};
