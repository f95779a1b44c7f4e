// SPDX-License-Identifier: Apache-2.0
// The verdict of CGAL's do_intersect. A degenerate triangle is tested as a segment or a point, because
// CGAL's triangle test (Guigue and Devillers 2003) requires triangles that are not flat.
#include <algorithm>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/gmpxx.h>
#include <CGAL/intersections.h>
#include <CGAL/long_long.h>

#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

// Plain arithmetic on 128-bit integers. Every do_intersect below between points, segments and triangles uses only
// comparisons of coordinates and signs of determinants of degree three at most, never a quotient. (In CGAL 5.5, these
// tests use orientation, coplanar_orientation, collinear and, for two segments, points p + v of a line.)
using SmallKernel = CGAL::Simple_cartesian<boost::int128_type>;

// Filtered double arithmetic, for pairs with more bits, if all coordinates are multiples of 2^-300 and below 2^300, as
// in all float32 pairs. A product of three differences is then zero or lies between 2^-900 and 2^903, so nothing
// overflows or underflows, and the filters' error bounds hold.
using WideKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr int kWideExponents = 300;

// Rationals, for all other pairs.
using LargeKernel = CGAL::Simple_cartesian<mpq_class>;

// The closed convex hull of three points: its dimension (0, 1 or 2) and its dimension + 1 vertices.
template <class Kernel>
struct Hull {
  using Point = typename Kernel::Point_3;
  int dimension;
  Point vertex[3];

  Hull(const Point& p, const Point& q, const Point& r) : dimension(2), vertex{p, q, r} {
    if (!CGAL::collinear(p, q, r)) return;
    std::sort(vertex, vertex + 3, CGAL::Less<Point, Point>());
    dimension = vertex[0] == vertex[2] ? 0 : 1;
    vertex[1] = vertex[2];
  }
  Point point() const { return vertex[0]; }
  typename Kernel::Segment_3 segment() const { return {vertex[0], vertex[1]}; }
  typename Kernel::Triangle_3 triangle() const { return {vertex[0], vertex[1], vertex[2]}; }
};

template <class Kernel>
bool hulls_intersect(const Hull<Kernel>& a, const Hull<Kernel>& b) {
  if (a.dimension < b.dimension) return hulls_intersect(b, a);
  switch (3 * a.dimension + b.dimension) {
    case 3 * 2 + 2:
      return CGAL::do_intersect(a.triangle(), b.triangle());
    case 3 * 2 + 1:
      return CGAL::do_intersect(a.triangle(), b.segment());
    case 3 * 2 + 0:
      return CGAL::do_intersect(a.triangle(), b.point());
    case 3 * 1 + 1:
      return CGAL::do_intersect(a.segment(), b.segment());
    case 3 * 1 + 0:
      return CGAL::do_intersect(a.segment(), b.point());
    default:
      return a.point() == b.point();
  }
}

template <class Kernel, class Real>
Hull<Kernel> hull(const Vec3<Real> (&p)[3]) {
  const auto point = [](const Vec3<Real>& v) {
    using Number = typename Kernel::FT;
    return typename Kernel::Point_3(Number(v.x), Number(v.y), Number(v.z));
  };
  return {point(p[0]), point(p[1]), point(p[2])};
}

template <class Kernel, class Triangles>
Verdict verdict_in(const Triangles& pair) {
  return hulls_intersect(hull<Kernel>(pair.a), hull<Kernel>(pair.b)) ? Verdict::intersects : Verdict::disjoint;
}

}  // namespace

Verdict cgal_verdict(const DoublePair& pair) {
  const Grid grid = grid_of(pair);
  if (grid.is_small()) return verdict_in<SmallKernel>(small_integers(pair, grid));
  if (grid.exponent < -kWideExponents || grid.exponent + grid.bits > kWideExponents)
    return cgal_verdict(large_integers(pair, grid));
  return verdict_in<WideKernel>(pair);
}

Verdict cgal_verdict(const LargePair& pair) { return verdict_in<LargeKernel>(pair); }

}  // namespace graze::oracle
