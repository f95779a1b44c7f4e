// SPDX-License-Identifier: Apache-2.0
// Clips the hulls (oracle/clipping.h) with 113 bits. Numbers are rounded, so a point near a plane counts as on it. The
// exact decision gives the kind of the common set.
#include "wasm/drawing.h"

#include <algorithm>
#include <cmath>

#include "oracle/clipping.h"

namespace graze::wasm {
namespace {

using Real = long double;
using Point = Vec3<Real>;
using Polygon = oracle::Polygon<Real>;
using HalfSpace = oracle::HalfSpace<Real>;
using oracle::hull_of, oracle::negative, oracle::normal_of;

constexpr Real kNearly = 0x1p-90L;  // a value below kNearly times the sum of its terms' sizes counts as zero

Point widened(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
bool is_zero(const Point& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

Real height(const HalfSpace& half, const Point& p) {
  const Point& normal = half.normal;
  const Point v = p - half.at;
  const Real value = dot(normal, v);
  const Real size = std::abs(normal.x * v.x) + std::abs(normal.y * v.y) + std::abs(normal.z * v.z);
  return std::abs(value) <= size * kNearly ? 0 : value;
}

int write(const Polygon& points, Vec3<double>* out, int most) {
  const int count = std::min(most, static_cast<int>(points.size()));
  for (int i = 0; i < count; ++i) {
    const Point& p = points[static_cast<std::size_t>(i)];
    out[i] = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
  }
  return count;
}

// The intersection of the hull and the plane: empty, a point, or a segment.
Polygon section(const Point (&p)[3], const HalfSpace& plane) {
  const HalfSpace below = {negative(plane.normal), plane.at};
  Polygon ends = oracle::clipped(oracle::clipped(hull_of(p), plane, height), below, height);
  return ends.size() > 2 ? Polygon{} : ends;  // the whole hull lies in the plane
}

// The line in which the planes meet, clipped to the points' bounding box enlarged by half.
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

struct Connection {
  Real squared = INFINITY;
  Point p, q;  // a point of a, a point of b
  int feature_a = -1, feature_b = -1;
};

void shorten(Connection& best, const Connection& other) {
  if (other.squared < best.squared) best = other;
}

Real clamped(Real x) { return x < 0 ? 0 : x > 1 ? 1 : x; }
Real square(const Point& v) { return dot(v, v); }
int feature_at(Real along, int edge) { return along == 0 ? edge : along == 1 ? (edge + 1) % 3 : 3 + edge; }

// Reference: Ericson, Real-Time Collision Detection, section 5.1.9.
Connection of_edges(const Point (&a)[3], int i, const Point (&b)[3], int j) {
  const Point d = a[(i + 1) % 3] - a[i], e = b[(j + 1) % 3] - b[j], r = a[i] - b[j];
  const Real dd = square(d), ee = square(e), de = dot(d, e), dr = dot(d, r), er = dot(e, r), det = dd * ee - de * de;
  Real s = 0, t = 0;
  if (dd > 0 && ee > 0) {
    s = det > 0 ? clamped((de * er - dr * ee) / det) : 0;
    t = (de * s + er) / ee;
    if (t < 0 || t > 1) {
      t = clamped(t);
      s = clamped((de * t - dr) / dd);
    }
  } else if (dd > 0) {
    s = clamped(-dr / dd);
  } else if (ee > 0) {
    t = clamped(er / ee);
  }
  const Point p = a[i] + d * s, q = b[j] + e * t;
  return {square(q - p), p, q, feature_at(s, i), feature_at(t, j)};
}

// Connects the vertex to the foot of its perpendicular on the face's plane, if the foot is in the face.
Connection to_face(const Point& vertex, const Point (&face)[3]) {
  const Point normal = normal_of(face);
  if (is_zero(normal)) return {};
  const Point foot = vertex - normal * (dot(normal, vertex - face[0]) / square(normal));
  for (int i = 0; i < 3; ++i) {
    if (dot(cross(normal, face[(i + 1) % 3] - face[i]), foot - face[i]) < 0) return {};
  }
  return {square(vertex - foot), vertex, foot, 0, 6};
}

Connection nearest(const Point (&a)[3], const Point (&b)[3]) {
  Connection best;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) shorten(best, of_edges(a, i, b, j));
    Connection of_a = to_face(a[i], b), of_b = to_face(b[i], a);
    of_a.feature_a = i;
    shorten(best, of_a);
    shorten(best, {of_b.squared, of_b.q, of_b.p, 6, i});
  }
  return best;
}

// The shortest translation that separates the triangles, along a normal or a cross product of edges. `p` is the origin.
Connection push(const Point (&a)[3], const Point (&b)[3]) {
  Connection best;
  const auto along = [&](const Point& axis, int feature_a, int feature_b) {
    if (is_zero(axis)) return;
    Real low_a = INFINITY, high_a = -INFINITY, low_b = INFINITY, high_b = -INFINITY;
    for (int i = 0; i < 3; ++i) {
      const Real of_a = dot(axis, a[i] - a[0]), of_b = dot(axis, b[i] - a[0]);
      low_a = std::min(low_a, of_a), high_a = std::max(high_a, of_a);
      low_b = std::min(low_b, of_b), high_b = std::max(high_b, of_b);
    }
    const Real up = high_a - low_b, down = high_b - low_a, size = square(axis);
    const Point vector = axis * ((up < down ? up : -down) / size);
    shorten(best, {square(vector), {}, vector, feature_a, feature_b});
  };
  along(normal_of(a), 6, -1);
  along(normal_of(b), -1, 6);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) along(cross(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j]), 3 + i, 3 + j);
  }
  return best;
}

// Writes the connection as the witness. sign: 1 for a gap, -1 for a push.
void add_witness(Drawing& result, const Connection& found, int sign, const Point& from, const Point (&a)[3],
                 const Point (&b)[3]) {
  if (!(found.squared > 0) || !std::isfinite(found.squared)) return;
  const Real length = std::sqrt(found.squared);
  const Point axis = (found.q - found.p) * (1 / length);
  Real low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int i = 0; i < 3; ++i) {
    const Real along[2] = {dot(axis, a[i] - a[0]), dot(axis, b[i] - a[0])};
    for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], along[k]), high[k] = std::max(high[k], along[k]);
  }
  result.low_a = static_cast<double>(low[0] - high[0]);
  result.high_a = 0;
  // For a tiny gap, the axis is too imprecise to compute low_b as low[1] - high[0].
  result.low_b = static_cast<double>(sign * length);
  result.high_b = static_cast<double>(sign * length + (high[1] - low[1]));
  result.witness_count = write({found.p + from, found.q + from}, result.witness, 2);
  result.feature_a = found.feature_a;
  result.feature_b = found.feature_b;
}

}  // namespace

Drawing drawing_of(const DoublePair& pair, const Relation& relation) {
  Point a[3], b[3];
  for (int i = 0; i < 3; ++i) {
    a[i] = widened(pair.a[i]);
    b[i] = widened(pair.b[i]);
  }
  Drawing result{};
  if (!relation.intersects()) {
    add_witness(result, nearest(a, b), 1, {}, a, b);
  } else {
    Polygon common = oracle::common_polygon(a, b, height);
    const auto points = static_cast<std::size_t>(relation.contact);  // a point has one vertex, a segment has two
    if (relation.contact != Contact::area && common.size() > points) common.resize(points);
    result.contact_count = write(common, result.contact, Drawing::kMost);
    if (relation.margin_sign < 0) {
      if (common.empty()) common = hull_of(a);  // rounding lost the common points
      Point middle{};
      for (const Point& p : common) middle = middle + p * (Real(1) / static_cast<Real>(common.size()));
      add_witness(result, push(a, b), -1, middle, a, b);
    }
  }
  const Point na = normal_of(a), nb = normal_of(b);
  if (is_zero(na) || is_zero(nb) || is_zero(cross(na, nb))) return result;
  result.line_count = write(line_of(a, b, na, nb), result.line, 2);
  result.section_a_count = write(section(a, {nb, b[0]}), result.section_a, 2);
  result.section_b_count = write(section(b, {na, a[0]}), result.section_b, 2);
  return result;
}

}  // namespace graze::wasm
