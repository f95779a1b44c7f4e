// SPDX-License-Identifier: Apache-2.0
// Clips one hull, a polygon, by the half-spaces whose intersection is the other hull: Sutherland and Hodgman 1974.
#include "oracle/common_set.h"

#include <algorithm>
#include <cstdlib>

#include "oracle/integer_pair.h"

namespace graze::oracle {
namespace {

using Point = Vec3<mpq_class>;
using Polygon = std::vector<Point>;  // in order; two points are a segment

// The points x with dot(normal, x - at) >= 0.
struct HalfSpace {
  Point normal, at;
  mpq_class height(const Point& x) const { return dot(normal, Point(x - at)); }
};

bool before(const Point& p, const Point& q) { return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z; }
Point negative(const Point& v) { return {-v.x, -v.y, -v.z}; }

// The hull's extreme points.
Polygon hull_of(const Point (&p)[3]) {
  if (!is_zero(cross(Point(p[1] - p[0]), Point(p[2] - p[0])))) return {p[0], p[1], p[2]};
  const auto [low, high] = std::minmax_element(p, p + 3, before);
  return *low == *high ? Polygon{*low} : Polygon{*low, *high};
}

void add_plane(std::vector<HalfSpace>& all, const Point& normal, const Point& at) {
  all.push_back({normal, at});
  all.push_back({negative(normal), at});
}

// Half-spaces whose intersection is the hull with these extreme points.
std::vector<HalfSpace> half_spaces(const Polygon& hull) {
  std::vector<HalfSpace> all;
  if (hull.size() == 3) {
    const Point normal = cross(Point(hull[1] - hull[0]), Point(hull[2] - hull[0]));
    add_plane(all, normal, hull[0]);
    for (std::size_t i = 0; i < 3; ++i) all.push_back({cross(normal, Point(hull[(i + 1) % 3] - hull[i])), hull[i]});
    return all;
  }
  const Point axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (hull.size() == 1) {
    for (const Point& axis : axes) add_plane(all, axis, hull[0]);
    return all;
  }
  const Point along = hull[1] - hull[0];
  for (const Point& axis : axes) add_plane(all, cross(axis, along), hull[0]);  // a zero normal excludes nothing
  all.push_back({along, hull[0]});
  all.push_back({negative(along), hull[1]});
  return all;
}

Polygon clipped(const Polygon& polygon, const HalfSpace& half) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const mpq_class at_p = half.height(p), at_q = half.height(q);
    if (at_p >= 0) kept.push_back(p);
    if (at_p * at_q < 0) kept.push_back(p + Point(q - p) * mpq_class(at_p / (at_p - at_q)));
  }
  // A segment is traversed in both directions, which finds the same crossing twice.
  Polygon distinct;
  for (const Point& p : kept) {
    if (std::find(distinct.begin(), distinct.end(), p) == distinct.end()) distinct.push_back(p);
  }
  return distinct;
}

struct Hulls : BasicPair<mpq_class> {
  int exponent = 0;
};

Hulls hulls_of(const AnyPair& pair) {
  const Grid grid = grid_of(pair.doubles);
  const LargePair whole = large_integers(pair.doubles, grid);
  Hulls hulls;
  hulls.exponent = grid.exponent;
  for (int i = 0; i < kCoordinates; ++i) coordinates(hulls)[i] = coordinates(whole)[i];
  return hulls;
}

std::vector<Vec3<double>> rounded(const Polygon& points, int exponent) {
  // Integers on the grid may exceed the range of double.
  const auto round = [exponent](const mpq_class& x) {
    const auto shift = static_cast<mp_bitcnt_t>(std::abs(exponent));
    return (exponent < 0 ? mpq_class(x >> shift) : mpq_class(x << shift)).get_d();
  };
  std::vector<Vec3<double>> result;
  for (const Point& p : points) result.push_back({round(p.x), round(p.y), round(p.z)});
  return result;
}

}  // namespace

std::vector<Vec3<double>> common_set(const AnyPair& pair) {
  const Hulls hulls = hulls_of(pair);
  Polygon common = hull_of(hulls.a);
  for (const HalfSpace& half : half_spaces(hull_of(hulls.b))) common = clipped(common, half);
  return rounded(common, hulls.exponent);
}

std::vector<Vec3<double>> planes_line(const AnyPair& pair) {
  const Hulls hulls = hulls_of(pair);
  const auto normal_of = [](const Point(&p)[3]) { return cross(Point(p[1] - p[0]), Point(p[2] - p[0])); };
  const Point na = normal_of(hulls.a), nb = normal_of(hulls.b), along = cross(na, nb);
  if (is_zero(along)) return {};
  // The point in both planes that is nearest to the origin.
  const mpq_class da = dot(na, hulls.a[0]), db = dot(nb, hulls.b[0]);
  const Point at = (cross(nb, along) * da + cross(along, na) * db) * mpq_class(1 / dot(along, along));

  // The line consists of the points at + t * along. It is in the box for t from low to high.
  mpq_class low, high;
  bool bounded = false;
  for (int axis = 0; axis < 3; ++axis) {
    mpq_class least = component(hulls.a[0], axis), most = least;
    for (int i = 0; i < 3; ++i) {
      for (const Point& p : {hulls.a[i], hulls.b[i]}) {
        least = std::min(least, component(p, axis));
        most = std::max(most, component(p, axis));
      }
    }
    const mpq_class margin = (most - least) / 10, speed = component(along, axis), start = component(at, axis);
    least -= margin;
    most += margin;
    if (speed == 0) {
      if (start < least || most < start) return {};
      continue;
    }
    mpq_class in = (least - start) / speed, out = (most - start) / speed;
    if (out < in) std::swap(in, out);
    low = bounded ? std::max(low, in) : in;
    high = bounded ? std::min(high, out) : out;
    bounded = true;
  }
  if (high <= low) return {};
  return rounded({at + along * low, at + along * high}, hulls.exponent);
}

}  // namespace graze::oracle
