// SPDX-License-Identifier: Apache-2.0
// The same construction as oracle/common_set.cpp, one polygon clipped by the half-spaces of the other's hull, on numbers
// that round: what is nearly on a plane counts as on it, and the exact decision says what kind of set it is.
#include "reports/wasm/drawing.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/exact/exact.h"

namespace graze::reports::wasm {
namespace {

using Real = long double;
using Point = Vec3<Real>;
using Polygon = std::vector<Point>;

constexpr Real kNearly = 0x1p-90L;  // of the sum of a value's terms: below that it is taken for zero

Point widened(const Vec3<float>& v) { return {v.x, v.y, v.z}; }
bool is_zero(const Point& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

struct HalfSpace {
  Point normal, at;
  Real height(const Point& p) const {
    const Point v = p - at;
    const Real value = dot(normal, v);
    const Real size = std::abs(normal.x * v.x) + std::abs(normal.y * v.y) + std::abs(normal.z * v.z);
    return std::abs(value) <= size * kNearly ? 0 : value;
  }
};

Point normal_of(const Point (&p)[3]) { return cross(p[1] - p[0], p[2] - p[0]); }

Polygon hull_of(const Point (&p)[3]) {
  if (!is_zero(normal_of(p))) return {p[0], p[1], p[2]};
  const auto before = [](const Point& u, const Point& v) {
    return u.x != v.x ? u.x < v.x : u.y != v.y ? u.y < v.y : u.z < v.z;
  };
  const auto [low, high] = std::minmax_element(p, p + 3, before);
  return *low == *high ? Polygon{*low} : Polygon{*low, *high};
}

std::vector<HalfSpace> half_spaces(const Polygon& hull) {
  const Point axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  std::vector<HalfSpace> all;
  const auto add_plane = [&](const Point& normal) {
    all.push_back({normal, hull[0]});
    all.push_back({{-normal.x, -normal.y, -normal.z}, hull[0]});
  };
  if (hull.size() == 3) {
    const Point normal = cross(hull[1] - hull[0], hull[2] - hull[0]);
    add_plane(normal);
    for (int i = 0; i < 3; ++i) all.push_back({cross(normal, hull[(i + 1) % 3] - hull[i]), hull[i]});
  } else if (hull.size() == 2) {
    const Point along = hull[1] - hull[0];
    for (const Point& axis : axes) add_plane(cross(axis, along));  // a zero normal excludes nothing
    all.push_back({along, hull[0]});
    all.push_back({{-along.x, -along.y, -along.z}, hull[1]});
  } else {
    for (const Point& axis : axes) add_plane(axis);
  }
  return all;
}

Polygon clipped(const Polygon& polygon, const HalfSpace& half) {
  Polygon kept;
  const auto keep = [&](const Point& p) {
    if (std::find(kept.begin(), kept.end(), p) == kept.end()) kept.push_back(p);
  };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Real at_p = half.height(p), at_q = half.height(q);
    if (at_p >= 0) keep(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) keep(p + (q - p) * (at_p / (at_p - at_q)));
  }
  return kept;
}

int write(const Polygon& points, Vec3<double>* out, int most) {
  const int count = std::min(most, static_cast<int>(points.size()));
  for (int i = 0; i < count; ++i) {
    const Point& p = points[static_cast<std::size_t>(i)];
    out[i] = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }
  return count;
}

// Where the hull meets the plane: nothing, a point, or a segment.
Polygon section(const Point (&p)[3], const HalfSpace& plane) {
  Polygon ends = clipped(clipped(hull_of(p), plane), {{-plane.normal.x, -plane.normal.y, -plane.normal.z}, plane.at});
  return ends.size() > 2 ? Polygon{} : ends;  // all of it lies in the plane
}

// The part of the line of both planes within the box around the points, wider by half.
Polygon line_of(const Point (&a)[3], const Point (&b)[3], const Point& na, const Point& nb) {
  const Point along = cross(na, nb);
  const Point at = (cross(nb, along) * dot(na, a[0]) + cross(along, na) * dot(nb, b[0])) * (1 / dot(along, along));
  Real low = -INFINITY, high = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    Real least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 3; ++i) {
      for (const Point& p : {a[i], b[i]}) {
        least = std::min(least, component(p, axis));
        most = std::max(most, component(p, axis));
      }
    }
    const Real wider = (most - least) / 2, speed = component(along, axis), start = component(at, axis);
    if (speed == 0) continue;
    const Real in = (least - wider - start) / speed, out = (most + wider - start) / speed;
    low = std::max(low, std::min(in, out));
    high = std::min(high, std::max(in, out));
  }
  return high > low && std::isfinite(high - low) ? Polygon{at + along * low, at + along * high} : Polygon{};
}

}  // namespace

Drawing drawing_of(const Pair& pair) {
  Point a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = widened(pair.a[i]);
    b[i] = widened(pair.b[i]);
  }
  Drawing result{};
  const int contact = exact::relation(&pair.a[0].x, &pair.b[0].x).contact;
  if (contact >= 0) {
    Polygon common = hull_of(a);
    for (const HalfSpace& half : half_spaces(hull_of(b))) common = clipped(common, half);
    if (contact < 2 && common.size() > static_cast<std::size_t>(contact) + 1)
      common.resize(static_cast<std::size_t>(contact) + 1);
    result.contact_count = write(common, result.contact, Drawing::kMost);
  }
  const Point na = normal_of(a), nb = normal_of(b);
  if (is_zero(na) || is_zero(nb) || is_zero(cross(na, nb))) return result;
  result.line_count = write(line_of(a, b, na, nb), result.line, 2);
  result.section_a_count = write(section(a, {nb, b[0]}), result.section_a, 2);
  result.section_b_count = write(section(b, {na, a[0]}), result.section_b, 2);
  return result;
}

}  // namespace graze::reports::wasm
