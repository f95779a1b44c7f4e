// SPDX-License-Identifier: Apache-2.0
// Clips the hulls (clipping.h) with rational arithmetic, starting from the pair's integer coordinates on its grid.
#include <algorithm>
#include <cstdlib>

#include "oracle/clipping.h"
#include "oracle/integer_pair.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using Point = Vec3<mpq_class>;

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

std::vector<Vec3<double>> rounded(const Polygon<mpq_class>& points, int exponent) {
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
  const auto height = [](const HalfSpace<mpq_class>& half, const Point& x) { return dot(half.normal, x - half.at); };
  return rounded(common_polygon(hulls.a, hulls.b, height), hulls.exponent);
}

std::vector<Vec3<double>> planes_line(const AnyPair& pair) {
  const Hulls hulls = hulls_of(pair);
  const Point na = normal_of(hulls.a), nb = normal_of(hulls.b), along = cross(na, nb);
  if (is_zero(along)) return {};
  // The point in both planes that is nearest to the origin.
  const mpq_class da = dot(na, hulls.a[0]), db = dot(nb, hulls.b[0]);
  const Point at = (cross(nb, along) * da + cross(along, na) * db) * mpq_class(1 / dot(along, along));

  // The line consists of the points at + t * along. Within the box, t runs from low to high.
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
