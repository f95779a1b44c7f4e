// SPDX-License-Identifier: Apache-2.0
// Computes the dimensions of a pair's hulls, and whether they are coplanar, from exact ranks of integer vectors.
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

template <class Integer>
int dimension(const Vec3<Integer> (&p)[3]) {
  const Vec3<Integer> u = p[1] - p[0], v = p[2] - p[0];
  if (is_zero(u) && is_zero(v)) return 0;
  return is_zero(cross(u, v)) ? 1 : 2;
}

template <class Integer>
Hulls hulls_of(const BasicPair<Integer>& pair) {
  const auto& [a, b] = pair;
  const Vec3<Integer> from_a0[5] = {a[1] - a[0], a[2] - a[0], b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  // The first two independent vectors span the plane; all others must lie in it.
  const Vec3<Integer>* first = nullptr;
  Vec3<Integer> normal{0, 0, 0};
  bool coplanar = true;
  for (const Vec3<Integer>& v : from_a0) {
    if (!first) {
      if (!is_zero(v)) first = &v;
    } else if (is_zero(normal)) {
      normal = cross(*first, v);
    } else if (dot(normal, v) != 0) {
      coplanar = false;
    }
  }
  return {dimension(a), dimension(b), coplanar};
}

}  // namespace

Hulls hulls(const DoublePair& pair) {
  const Grid grid = grid_of(pair);
  return grid.is_small() ? hulls_of(widened(small_integers(pair, grid))) : hulls_of(large_integers(pair, grid));
}

Hulls hulls(const LargePair& pair) { return hulls_of(pair); }

}  // namespace graze::oracle
