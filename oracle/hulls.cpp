// SPDX-License-Identifier: Apache-2.0
// The dimensions of a pair's hulls and whether they are coplanar, by exact ranks of integer vectors.
#include <cstdint>
#include <type_traits>

#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

template <class Integer>
struct Vector {
  Integer x, y, z;
  bool is_zero() const { return x == 0 && y == 0 && z == 0; }
};

// The type of products of differences: a wider one if the differences are 64-bit integers.
template <class Difference>
using Wide = std::conditional_t<std::is_same_v<Difference, std::int64_t>, __int128, Difference>;

template <class Integer, class From>
Vector<Integer> difference(const Vec3<From>& p, const Vec3<From>& q) {
  return {Integer(p.x) - Integer(q.x), Integer(p.y) - Integer(q.y), Integer(p.z) - Integer(q.z)};
}

template <class Integer>
Vector<Wide<Integer>> cross_product(const Vector<Integer>& u, const Vector<Integer>& v) {
  const auto minor = [](const Integer& p, const Integer& q, const Integer& r, const Integer& s) {
    return Wide<Integer>(Wide<Integer>(p) * q - Wide<Integer>(r) * s);
  };
  return {minor(u.y, v.z, u.z, v.y), minor(u.z, v.x, u.x, v.z), minor(u.x, v.y, u.y, v.x)};
}

template <class Integer, class From>
int dimension(const Vec3<From> (&p)[3]) {
  const auto u = difference<Integer>(p[1], p[0]), v = difference<Integer>(p[2], p[0]);
  if (u.is_zero() && v.is_zero()) return 0;
  return cross_product(u, v).is_zero() ? 1 : 2;
}

template <class Integer, class Integers>
Hulls hulls_of(const Integers& pair) {
  Vector<Integer> from_a0[5] = {difference<Integer>(pair.a[1], pair.a[0]), difference<Integer>(pair.a[2], pair.a[0]),
                                difference<Integer>(pair.b[0], pair.a[0]), difference<Integer>(pair.b[1], pair.a[0]),
                                difference<Integer>(pair.b[2], pair.a[0])};
  // The first two independent vectors span the plane; all others must lie in it.
  const Vector<Integer>* first = nullptr;
  Vector<Wide<Integer>> normal{0, 0, 0};
  bool coplanar = true;
  for (const auto& v : from_a0) {
    if (!first) {
      if (!v.is_zero()) first = &v;
    } else if (normal.is_zero()) {
      normal = cross_product(*first, v);
    } else if (Wide<Integer>(normal.x * v.x + normal.y * v.y + normal.z * v.z) != 0) {
      coplanar = false;
    }
  }
  return {dimension<Integer>(pair.a), dimension<Integer>(pair.b), coplanar};
}

template <class Real>
Hulls hulls_of_pair(const BasicPair<Real>& pair) {
  const Grid grid = grid_of(pair);
  return grid.is_small() ? hulls_of<std::int64_t>(small_integers(pair, grid))
                         : hulls_of<mpz_class>(large_integers(pair, grid));
}

}  // namespace

Hulls hulls(const Pair& pair) { return hulls_of_pair(pair); }
Hulls hulls(const DoublePair& pair) { return hulls_of_pair(pair); }
Hulls hulls(const LargePair& pair) { return hulls_of<mpz_class>(pair); }

}  // namespace graze::oracle
