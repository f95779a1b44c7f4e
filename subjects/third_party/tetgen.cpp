// SPDX-License-Identifier: Apache-2.0
// TetGen's test for two triangles, with Shewchuk's exact predicates. Throws an int in cases that it does not handle.
#define TETLIBRARY
#include <graze/subject.h>
#include <tetgen.h>
#include <algorithm>

namespace {

int intersects(const double a[9], const double b[9]) {
  // Initialises the predicates once, as TetGen does before its first test. The static filter is off, because it needs
  // the extent of the whole input.
  static const bool kReady = (exactinit(0, 0, 1, 1, 1, 1), true);
  (void)kReady;
  double v[18];
  std::copy(a, a + 9, v);
  std::copy(b, b + 9, v + 9);
  tetgenmesh mesh;
  return mesh.tri_tri_inter(v, v + 3, v + 6, v + 9, v + 12, v + 15) != tetgenmesh::DISJOINT;
}

}  // namespace

// The library has no version macro; scripts/league passes the package's version.
GRAZE_SUBJECT(tri_tri_inter) = {
    GRAZE_SUBJECT_ABI,
    0,
    DEBIAN_VERSION,
    "TetGen tetgenmesh::tri_tri_inter, AGPL-3.0, https://www.wias-berlin.de/software/tetgen",
    "tetgen.h: \"Triangle-triangle intersection test (robust)\"; nothing stated",
    nullptr,
    intersects};
