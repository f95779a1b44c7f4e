// SPDX-License-Identifier: Apache-2.0
// Certified double-precision bounds of a pair's margin, given its verdict; they decide its bucket nearly always.
// The depth of two intersecting triangles is the least overlap along 11 axes (the faces of their Minkowski
// difference); the distance of two disjoint ones lies between any separation and the length of any connection.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/margin/bucket.h"
#include "core/pair.h"
#include "core/vec3.h"
#include "core/verdict.h"

namespace graze {

// Directions along which two triangles are compared. i and j run over 0..2; edge i goes from vertex i to i + 1.
//   3i + j: a's edge i x b's edge j     9, 10: normal of a, of b     (these 11 are the separating axes)
//   11 + 3i + j: from a's edge i square to it towards b[j]     20 + 3i + j: from b's edge j towards a[i]
//   29 + 3i + j: from a[i] to b[j]
inline constexpr int kNormalA = 9, kNormalB = 10, kSeparatingAxes = 11;
inline constexpr int kFromEdgeA = 11, kFromEdgeB = 20, kFromVertex = 29, kDirections = 38;

// lo <= |margin| <= hi.
struct MarginBounds {
  double lo, hi;
  int direction;       // disjoint: the direction whose separation is lo
  std::uint32_t axes;  // intersecting: bit i is set when axis i may be the one of least overlap
};

inline namespace GRAZE_FP {

// What an axis sees of the triangles beyond the feature it is square to, where its projections are all equal: of an
// edge, seen[0] is the third vertex of the same triangle, and seen[1] and [2] stand for the other triangle; of a face,
// all three are the other triangle's vertices.   Returns: how many are of the feature's own triangle.
template <class Real>
GRAZE_HD int seen_from_axis(const Vec3<Real> (&a)[3], const Vec3<Real> (&b)[3], int axis, Vec3<Real> (&seen)[3]) {
  if (axis >= kNormalA) {
    for (int k = 0; k < 3; ++k) seen[k] = axis == kNormalA ? b[k] - a[0] : a[k] - b[0];
    return 0;
  }
  const int i = axis / 3, j = axis % 3;
  seen[0] = a[(i + 2) % 3] - a[i];
  seen[1] = b[j] - a[i];
  seen[2] = b[(j + 2) % 3] - a[i];
  return 1;
}

// Unit roundoff of double. The bounds below hold with and without contraction: it only removes roundings.
inline constexpr double kHalfUlp = 0x1p-53;

// The pair in double. Every difference of coordinates carries one relative error of at most
// kHalfUlp, or none at all when `exact`. No product of up to six of them over- or underflows: 2^-894 to 2^780.
struct MarginFrame {
  Vec3<double> a[3], b[3], edge_a[3], edge_b[3];
  bool exact;
};

GRAZE_HD inline Vec3<double> magnitudes(const Vec3<double>& v) { return {fabs(v.x), fabs(v.y), fabs(v.z)}; }

// One instruction each, which fmin and fmax with their care for NaN are not.
GRAZE_HD inline double lesser(double x, double y) { return x < y ? x : y; }
GRAZE_HD inline double greater(double x, double y) { return x > y ? x : y; }

GRAZE_HD inline Vec3<double> widen(const Vec3<float>& v) { return {double(v.x), double(v.y), double(v.z)}; }

// Whether the difference of any two coordinates is exact in double: they are multiples of 2^(low - 150) below
// 2^(high - 126), so differences are integers of high - low + 25 bits, and 53 are at hand.
GRAZE_HD inline bool differences_are_exact(const Pair& pair) {
  std::uint32_t low = 255, high = 0;
  const float* c = &pair.a[0].x;
  for (int i = 0; i < kCoordinates; ++i) {
    std::uint32_t bits;
    memcpy(&bits, &c[i], sizeof bits);
    bits &= 0x7fffffffu;
    if (bits == 0) continue;
    const std::uint32_t exponent = bits < 0x800000u ? 1u : bits >> 23;
    low = exponent < low ? exponent : low;
    high = exponent > high ? exponent : high;
  }
  return high <= low + 28;
}

GRAZE_HD inline MarginFrame make_margin_frame(const Pair& pair) {
  MarginFrame f;
  f.exact = differences_are_exact(pair);
  for (int i = 0; i < 3; ++i) {
    f.a[i] = widen(pair.a[i]);
    f.b[i] = widen(pair.b[i]);
  }
  for (int i = 0; i < 3; ++i) {
    f.edge_a[i] = f.a[(i + 1) % 3] - f.a[i];
    f.edge_b[i] = f.b[(i + 1) % 3] - f.b[i];
  }
  return f;
}

// a*b - c*d by Kahan: relative error at most 2 kHalfUlp, and zero exactly when the products are equal.
// Reference: Jeannerod, Louvet and Muller 2013, theorem 1.1.
GRAZE_HD inline double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  const double error = fma(-c, d, cd);
  return fma(a, b, -cd) + error;
}

GRAZE_HD inline Vec3<double> accurate_cross(const Vec3<double>& u, const Vec3<double>& v) {
  return {difference_of_products(u.y, v.z, u.z, v.y), difference_of_products(u.z, v.x, u.x, v.z),
          difference_of_products(u.x, v.y, u.y, v.x)};
}

// Direction number d (see above). Its length carries no meaning.
GRAZE_HD inline Vec3<double> direction(const MarginFrame& f, int d) {
  if (d == kNormalA) return accurate_cross(f.edge_a[0], f.edge_a[1]);
  if (d == kNormalB) return accurate_cross(f.edge_b[0], f.edge_b[1]);
  if (d < kSeparatingAxes) return accurate_cross(f.edge_a[d / 3], f.edge_b[d % 3]);
  const int first = d < kFromEdgeB ? kFromEdgeA : d < kFromVertex ? kFromEdgeB : kFromVertex;
  const int i = (d - first) / 3, j = (d - first) % 3;
  const Vec3<double> between = f.b[j] - f.a[i];
  if (first == kFromVertex) return between;
  const Vec3<double>& edge = first == kFromEdgeA ? f.edge_a[i] : f.edge_b[j];
  return accurate_cross(accurate_cross(edge, between), edge);
}

// An upper bound, up to rounding, of |axis - exact| / (5 kHalfUlp) per component: with exact edges the accurate
// cross product is itself relatively exact; otherwise each product carries the errors of its two factors.
GRAZE_HD inline Vec3<double> axis_weight(const MarginFrame& f, int axis, const Vec3<double>& n) {
  if (f.exact) return magnitudes(n);
  const Vec3<double> u = magnitudes(axis == kNormalB ? f.edge_b[0] : f.edge_a[axis == kNormalA ? 0 : axis / 3]);
  const Vec3<double> v = magnitudes(axis == kNormalA ? f.edge_a[1] : f.edge_b[axis == kNormalB ? 1 : axis % 3]);
  return {u.y * v.z + u.z * v.y, u.z * v.x + u.x * v.z, u.x * v.y + u.y * v.x};
}

struct Interval {
  double lo, hi;
};

// Extends bounds of a least and a greatest value by the value `at`, known up to `error`.
GRAZE_HD inline void include(Interval& least, Interval& most, double at, double error) {
  least = {lesser(least.lo, at - error), lesser(least.hi, at + error)};
  most = {greater(most.lo, at - error), greater(most.hi, at + error)};
}

// Bounds of min(max n.a - min n.b, max n.b - min n.a) along a separating axis, which n is up to 5 kHalfUlp weight;
// |n| <= weight (1 + 5 kHalfUlp). A projection is off by at most (5 for n, 1 for the difference, 3 roundings)
// kHalfUlp sum(weight * |difference|); two roundings on the way to the overlap make that 11, and 12 has slack.
GRAZE_HD inline Interval overlap(const MarginFrame& f, int axis, const Vec3<double>& n, const Vec3<double>& weight) {
  Vec3<double> seen[3];
  const int own = seen_from_axis(f.a, f.b, axis, seen);
  double along[3], error[3];
  for (int k = 0; k < 3; ++k) {
    along[k] = dot(n, seen[k]);
    error[k] = 12 * kHalfUlp * dot(weight, magnitudes(seen[k]));
  }
  // The feature itself is at zero; the first projection belongs to either side.
  Interval least = {along[1] - error[1], along[1] + error[1]}, most = least, own_least = {0, 0}, own_most = {0, 0};
  include(least, most, along[2], error[2]);
  if (own == 1) include(own_least, own_most, along[0], error[0]);
  if (own == 0) include(least, most, along[0], error[0]);
  return {lesser(own_most.lo - least.hi, most.lo - own_least.hi),
          lesser(own_most.hi - least.lo, most.hi - own_least.lo)};
}

// Lower bound of the distance: any direction separates by no more than it. Direction d is taken exactly as computed,
// and all is seen from a vertex of the feature it belongs to: an error of (1 for the difference, 3 roundings)
// kHalfUlp sum(|n| * |difference|) for each vertex, and slack.
GRAZE_HD inline double separation(const MarginFrame& f, int d) {
  const Vec3<double> n = direction(f, d), weight = magnitudes(n) * (6 * kHalfUlp);
  const int i_of_d = d == kNormalA ? 0 : (d < kFromEdgeA ? d : (d - kFromEdgeA) % 9) / 3;
  const Vec3<double> from = d == kNormalB ? f.b[0] : f.a[i_of_d];
  Interval least_a = {INFINITY, INFINITY}, most_a = {-INFINITY, -INFINITY}, least_b = least_a, most_b = most_a;
  for (int i = 0; i < 3; ++i) {
    const Vec3<double> a = f.a[i] - from, b = f.b[i] - from;
    include(least_a, most_a, dot(n, a), dot(weight, magnitudes(a)));
    include(least_b, most_b, dot(n, b), dot(weight, magnitudes(b)));
  }
  const double gap = greater(least_b.lo - most_a.hi, least_a.lo - most_b.hi);
  return gap > 0 ? gap / sqrt(dot(n, n)) * (1 - 8 * kHalfUlp) : 0;  // 7 roundings at most
}

// floor(log2(x)) for a positive normal x; less than any such for zero.
GRAZE_HD inline int floor_log2(double x) {
  std::uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return static_cast<int>(bits >> 52) - 1023;
}

// The shortest connection found so far: its squared length and the size of the terms it was summed from, as
// computed, and the direction that should then separate.
struct Connection {
  double squared, terms;
  int direction;
};

GRAZE_HD inline void shorten(Connection& best, const Vec3<double>& w, const Vec3<double>& u, const Vec3<double>& v,
                             int towards) {
  const Vec3<double> sum = w + u + v;
  const double squared = dot(sum, sum);
  if (!(squared < best.squared)) return;
  const Vec3<double> terms = magnitudes(w) + magnitudes(u) + magnitudes(v);
  best = {squared, terms.x + terms.y + terms.z, towards};
}

// Point `at` (seen from the edge's start) to the foot of its perpendicular, if that lies in the edge.
GRAZE_HD inline void connect_to_edge(Connection& best, const Vec3<double>& at, const Vec3<double>& edge, int towards) {
  const double along = dot(at, edge), length2 = dot(edge, edge);
  if (along > 0 && along < length2) shorten(best, at, edge * (-along / length2), {0, 0, 0}, towards);
}

// Point `at` (seen from the face's vertex 0) to its projection, if that lies in the face with edges u and v.
GRAZE_HD inline void connect_to_face(Connection& best, const Vec3<double>& at, const Vec3<double>& u,
                                     const Vec3<double>& v, const Vec3<double>& n, double n2, int towards) {
  const double s = dot(cross(at, v), n), t = dot(cross(u, at), n);
  if (s >= 0 && t >= 0 && s + t <= n2 && n2 > 0) shorten(best, at, u * (-s / n2), v * (-t / n2), towards);
}

// Interior points of two edges nearest to each other; w is the start of v's edge seen from the start of u's.
GRAZE_HD inline void connect_edges(Connection& best, const Vec3<double>& w, const Vec3<double>& u,
                                   const Vec3<double>& v, int towards) {
  const Vec3<double> n = cross(u, v);
  const double n2 = dot(n, n), s = dot(cross(w, v), n), t = dot(cross(w, u), n);
  if (s > 0 && t > 0 && s < n2 && t < n2) shorten(best, w, u * (-s / n2), v * (t / n2), towards);
}

GRAZE_HD inline Connection shortest_connection(const MarginFrame& f) {
  Connection best = {INFINITY, 0, 0};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3<double> between = f.b[j] - f.a[i];
      const int feature = 3 * i + j;
      shorten(best, between, {0, 0, 0}, {0, 0, 0}, kFromVertex + feature);
      connect_to_edge(best, between, f.edge_a[i], kFromEdgeA + feature);
      connect_to_edge(best, between * -1.0, f.edge_b[j], kFromEdgeB + feature);
      connect_edges(best, between, f.edge_a[i], f.edge_b[j], feature);
    }
  }
  const Vec3<double> normal_a = cross(f.edge_a[0], f.edge_a[1]), normal_b = cross(f.edge_b[0], f.edge_b[1]);
  const double a2 = dot(normal_a, normal_a), b2 = dot(normal_b, normal_b);
  for (int i = 0; i < 3; ++i) {
    connect_to_face(best, f.b[i] - f.a[0], f.edge_a[0], f.edge_a[2] * -1.0, normal_a, a2, kNormalA);
    connect_to_face(best, f.a[i] - f.b[0], f.edge_b[0], f.edge_b[2] * -1.0, normal_b, b2, kNormalB);
  }
  return best;
}

GRAZE_HD inline MarginBounds distance_bounds(const MarginFrame& f) {
  const Connection best = shortest_connection(f);
  // A connection w + s u + t v joins two points of the triangles, whatever its parameters, if they are in [0, 1];
  // for a face they may add up to 1 + 2 kHalfUlp, and shrink by that much. Each component is off by at most
  // (2 for that, 1 for the differences, 1 for the products, 2 for the sums) kHalfUlp (|w| + |s u| + |t v|).
  const double hi = sqrt(best.squared) * (1 + 8 * kHalfUlp) + 8 * kHalfUlp * best.terms;
  MarginBounds bounds = {separation(f, best.direction), hi, best.direction, 0};
  // Where two kinds of connection tie, rounding may have named the wrong one.
  for (int d = 0; d < kDirections && floor_log2(bounds.lo) != floor_log2(hi) && bounds.lo < 0.999 * hi; ++d) {
    const double lo = separation(f, d);
    if (lo > bounds.lo) bounds = {lo, hi, d, 0};
  }
  return bounds;
}

GRAZE_HD inline MarginBounds depth_bounds(const MarginFrame& f) {
  MarginBounds bounds = {INFINITY, INFINITY, 0, 0};
  double lowest[kSeparatingAxes];
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    const Vec3<double> n = direction(f, axis), weight = axis_weight(f, axis, n);
    const double weight_length = sqrt(dot(weight, weight));
    lowest[axis] = INFINITY;
    if (weight_length == 0) continue;  // parallel edges, or a flat triangle's normal: not an axis
    const double length = sqrt(dot(n, n)), length_error = 12 * kHalfUlp * weight_length;  // 5 + 3 roundings, slack
    const Interval o = overlap(f, axis, n, weight);
    lowest[axis] = greater(0.0, o.lo / (length + length_error) * (1 - 4 * kHalfUlp));
    bounds.lo = lesser(bounds.lo, lowest[axis]);
    if (length > length_error) bounds.hi = lesser(bounds.hi, o.hi / (length - length_error) * (1 + 4 * kHalfUlp));
  }
  if (bounds.lo == INFINITY) return {0, 0, 0, 0};  // no axis: both triangles lie on one line, or on parallel ones
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    if (lowest[axis] <= bounds.hi && lowest[axis] < INFINITY) bounds.axes |= 1u << axis;
  }
  return bounds;
}

// Certified bounds of |margin|.
// Requires: finite coordinates; verdict is the pair's true verdict, not declined.
GRAZE_HD inline MarginBounds margin_bounds(const Pair& pair, Verdict verdict) {
  const MarginFrame frame = make_margin_frame(pair);
  return verdict == Verdict::disjoint ? distance_bounds(frame) : depth_bounds(frame);
}

// Whether the bounds leave one bucket only, and which. A disjoint pair's margin is known not to be zero.
GRAZE_HD inline bool bucket_from_bounds(const MarginBounds& bounds, Verdict verdict, int log2_ulp, Bucket& bucket) {
  const int sign = verdict == Verdict::disjoint ? 1 : -1;
  bucket = 0;
  if (sign < 0 && bounds.hi == 0) return true;
  if (sign < 0 && bounds.lo <= 0) return false;
  bucket = make_bucket(sign, floor_log2(bounds.hi) - log2_ulp);
  return bucket == make_bucket(sign, floor_log2(bounds.lo) - log2_ulp);
}

}  // namespace GRAZE_FP
}  // namespace graze
