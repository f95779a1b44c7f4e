// SPDX-License-Identifier: Apache-2.0
// Two first attempts at a pair's margin bucket: certified as core/margin/margin.h is, at a fraction of its cost, and undecided
// more often. Written for GPUs, where double precision, roots and quotients are dear. The nearest features of disjoint
// triangles are guessed, and only the guess is certified. Of intersecting ones single precision finds which axes may be
// those of least overlap, and only these are looked at in double.
#pragma once

#include "core/exact/exact.h"
#include "core/margin/margin.h"

// Loops over registers, which have no indices.
#ifdef __CUDA_ARCH__
#define GRAZE_UNROLL _Pragma("unroll")
#else
#define GRAZE_UNROLL
#endif

namespace graze {
inline namespace GRAZE_FP {
namespace margin_quick {

using Vec = Vec3<double>;
template <class Real>
using Corners = Vec3<Real>[3];

// 1 / x and 1 / sqrt(x) to 22 bits; for guesses, and for bounds with kUp and kDown.
GRAZE_HD inline float reciprocal(float x) {
#ifdef __CUDA_ARCH__
  return __fdividef(1, x);
#else
  return 1 / x;
#endif
}
GRAZE_HD inline double reciprocal(double x) { return static_cast<double>(reciprocal(static_cast<float>(x))); }
GRAZE_HD inline float reciprocal_root(float x) {
#ifdef __CUDA_ARCH__
  return rsqrtf(x);
#else
  return 1 / sqrtf(x);
#endif
}

// Two features: an edge of each, a face and a vertex of the other, an edge and such a vertex, or two vertices. i is a
// vertex of a or the edge that begins there, or 0 for its face; j is so of b.
enum class Kind { edges, face_a, face_b, edge_a, edge_b, vertices };
struct Features {
  Kind kind;
  int i, j;
};

// The nearest features so far, the square of their distance, and of the next nearest.
template <class Real>
struct Nearest {
  Features features = {Kind::vertices, 0, 0};
  Real squared = INFINITY, next = INFINITY;

  GRAZE_HD void consider(Real at, bool valid, const Features& candidate) {
    const bool better = valid && at < squared;
    next = better ? squared : valid && at < next ? at : next;
    squared = better ? at : squared;
    features.kind = better ? candidate.kind : features.kind;
    features.i = better ? candidate.i : features.i;
    features.j = better ? candidate.j : features.j;
  }
};

// The features that are nearest, up to rounding and the error of a reciprocal: a guess.
template <class Real>
GRAZE_HD Nearest<Real> seem_nearest(const Corners<Real>& a, const Corners<Real>& b) {
  Corners<Real> edge_a, edge_b;
  Real length_a[3], length_b[3], per_a[3], per_b[3];  // squares, and their reciprocals
  for (int i = 0; i < 3; ++i) {
    edge_a[i] = a[i == 2 ? 0 : i + 1] - a[i];
    edge_b[i] = b[i == 2 ? 0 : i + 1] - b[i];
    length_a[i] = dot(edge_a[i], edge_a[i]);
    length_b[i] = dot(edge_b[i], edge_b[i]);
    per_a[i] = reciprocal(length_a[i]);
    per_b[i] = reciprocal(length_b[i]);
  }
  const Vec3<Real> normal_a = cross(edge_a[0], edge_a[1]), normal_b = cross(edge_b[0], edge_b[1]);
  const Real n2_a = dot(normal_a, normal_a), n2_b = dot(normal_b, normal_b);
  const Real per_normal_a = reciprocal(n2_a), per_normal_b = reciprocal(n2_b);
  Nearest<Real> nearest;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3<Real> w = b[j] - a[i], across_a = cross(w, edge_a[i]), across_b = cross(w, edge_b[j]);
      nearest.consider(dot(w, w), true, {Kind::vertices, i, j});
      const Real at_a = dot(w, edge_a[i]), at_b = -dot(w, edge_b[j]);
      nearest.consider(dot(across_a, across_a) * per_a[i], at_a > 0 && at_a < length_a[i], {Kind::edge_a, i, j});
      nearest.consider(dot(across_b, across_b) * per_b[j], at_b > 0 && at_b < length_b[j], {Kind::edge_b, i, j});
      const Vec3<Real> n = cross(edge_a[i], edge_b[j]);
      const Real n2 = dot(n, n), s = dot(across_b, n), t = dot(across_a, n), gap = dot(w, n);
      nearest.consider(gap * gap * reciprocal(n2), s > 0 && t > 0 && s < n2 && t < n2, {Kind::edges, i, j});
      if (i == 0) {  // a vertex of b over a
        const Real u = -dot(cross(w, edge_a[2]), normal_a), v = dot(cross(edge_a[0], w), normal_a);
        const Real height = dot(w, normal_a);
        nearest.consider(height * height * per_normal_a, u >= 0 && v >= 0 && u + v <= n2_a, {Kind::face_a, 0, j});
      }
      if (j == 0) {  // a vertex of a over b; w points away from it
        const Real u = dot(cross(w, edge_b[2]), normal_b), v = -dot(cross(edge_b[0], w), normal_b);
        const Real height = dot(w, normal_b);
        nearest.consider(height * height * per_normal_b, u >= 0 && v >= 0 && u + v <= n2_b, {Kind::face_b, i, 0});
      }
    }
  }
  return nearest;
}

// One of two triangles, or below one from another vertex on: without branches or indexing, which on a device would move
// registers to memory.
template <class Real>
GRAZE_HD void choose(bool first, const Corners<Real>& u, const Corners<Real>& v, Corners<Real>& chosen) {
  for (int k = 0; k < 3; ++k) chosen[k] = {first ? u[k].x : v[k].x, first ? u[k].y : v[k].y, first ? u[k].z : v[k].z};
}

// The triangle from vertex number `first` on.
template <class Real>
GRAZE_HD void turn(const Corners<Real>& v, int first, Corners<double>& turned) {
  const auto at = [&](int k) -> Vec {
    return {double(k == 0   ? v[0].x
                   : k == 1 ? v[1].x
                            : v[2].x),
            double(k == 0   ? v[0].y
                   : k == 1 ? v[1].y
                            : v[2].y),
            double(k == 0   ? v[0].z
                   : k == 1 ? v[1].z
                            : v[2].z)};
  };
  turned[0] = at(first);
  turned[1] = at(first == 2 ? 0 : first + 1);
  turned[2] = at(first == 0 ? 2 : first - 1);
}

// Whether the first vertices are the nearest points of the triangles because a coordinate axis joins them and parts the
// triangles between them, and their distance, which is then exact: a tie with a power of two is no doubt.
GRAZE_HD inline bool joined_by_axis(const MarginFrame& f, const Vec& between, double& distance) {
  const bool x = between.x != 0, y = between.y != 0, z = between.z != 0;
  if (x + y + z != 1) return false;
  const int axis = x ? 0 : y ? 1 : 2;
  const double length = component(between, axis), a0 = component(f.a[0], axis), b0 = component(f.b[0], axis);
  if (!(a0 + length == b0 && b0 - length == a0)) return false;  // the difference was rounded
  distance = fabs(length);
  const double sign = length < 0 ? -1 : 1;
  return sign * component(f.a[1], axis) <= sign * a0 && sign * component(f.a[2], axis) <= sign * a0 &&
         sign * component(f.b[1], axis) >= sign * b0 && sign * component(f.b[2], axis) >= sign * b0;
}

// Bounds from direction d of core/margin/margin.h, where d is 0, kNormalA, kFromEdgeA or kFromVertex: the separation along it,
// and the length of the connection if it ends inside the features, else infinity.
template <int d>
GRAZE_HD MarginBounds bounds_of_first(const MarginFrame& f) {
  Connection best = {INFINITY, 0, 0};
  const Vec between = f.b[0] - f.a[0];
  if constexpr (d == 0) connect_edges(best, between, f.edge_a[0], f.edge_b[0], d);
  if constexpr (d == kFromEdgeA) connect_to_edge(best, between, f.edge_a[0], d);
  if constexpr (d == kNormalA) {
    const Vec normal = cross(f.edge_a[0], f.edge_a[1]);
    connect_to_face(best, between, f.edge_a[0], f.edge_a[2] * -1.0, normal, dot(normal, normal), d);
  }
  if constexpr (d == kFromVertex) {
    double distance;
    if (joined_by_axis(f, between, distance)) return {distance, distance, d, 0};
    shorten(best, between, {0, 0, 0}, {0, 0, 0}, d);
  }
  return {separation(f, d), sqrt(best.squared) * (1 + 8 * kHalfUlp) + 8 * kHalfUlp * best.terms, d, 0};
}

// Bounds of the distance of disjoint triangles, if these are their nearest features; true in any case.
template <class Real>
GRAZE_HD MarginBounds distance_bounds(const Corners<Real>& a, const Corners<Real>& b, const Features& nearest) {
  const bool exchange = nearest.kind == Kind::face_b || nearest.kind == Kind::edge_b;
  Corners<Real> first, second;
  choose(exchange, b, a, first);
  choose(exchange, a, b, second);
  MarginFrame f;
  f.exact = false;
  turn(first, exchange ? nearest.j : nearest.i, f.a);
  turn(second, exchange ? nearest.i : nearest.j, f.b);
  for (int k = 0; k < 3; ++k) {
    f.edge_a[k] = f.a[k == 2 ? 0 : k + 1] - f.a[k];
    f.edge_b[k] = f.b[k == 2 ? 0 : k + 1] - f.b[k];
  }
  switch (nearest.kind) {
    case Kind::edges:
      return bounds_of_first<0>(f);
    case Kind::face_a:
    case Kind::face_b:
      return bounds_of_first<kNormalA>(f);
    case Kind::edge_a:
    case Kind::edge_b:
      return bounds_of_first<kFromEdgeA>(f);
    default:
      return bounds_of_first<kFromVertex>(f);
  }
}

// What an axis sees: how much the triangles' projections overlap, in units of its length, and its square.
template <class Real>
struct Overlap {
  Real along, n2;
};

// Square to the first edges of a and b, or to a. Of an edge axis, the edges' own projections are at zero.
template <class Real>
GRAZE_HD Overlap<Real> overlap_along(const Corners<Real>& a, const Corners<Real>& b, bool edges) {
  const Vec3<Real> u = a[1] - a[0], v = a[2] - a[0], w = b[1] - b[0];
  const Vec3<Real> n = cross(u, {edges ? w.x : v.x, edges ? w.y : v.y, edges ? w.z : v.z});
  const Real third = edges ? dot(n, v) : Real(0);
  const Real p = dot(n, b[0] - a[0]), q = dot(n, b[2] - a[0]), r = edges ? p : dot(n, b[1] - a[0]);
  const Real own_least = third < 0 ? third : Real(0), own_most = third > 0 ? third : Real(0);
  Real least = p < q ? p : q, most = p < q ? q : p;
  least = r < least ? r : least;
  most = r > most ? r : most;
  const Real over = own_most - least, under = most - own_least;
  return {over < under ? over : under, dot(n, n)};
}

// For all roundings in single precision of a bound, each way.
constexpr float kUp = 1 + 0x1p-19f, kDown = 1 - 0x1p-19f;

// With unit roundoff u: a projection on an axis is a determinant of three differences, so the error of core/exact/exact.h's
// first attempt bounds them all; two of them and a rounding make an overlap: 2 * 6 * 8 + 2. A component of an axis has
// (3 + 1) u times two products.
template <class Real>
struct AxisErrors {
  Real overlap;
  float length;
  GRAZE_HD AxisErrors(const Vec3<Real>& r, double u)
      : overlap(static_cast<Real>(98 * u) * r.x * r.y * r.z),
        length(static_cast<float>(static_cast<Real>(8 * u) * (r.y * r.z + r.z * r.x + r.x * r.y)) * 1.0001f) {}
};

// lo <= depth along the axis <= hi; 0 and infinity where nothing is known.
template <class Real>
GRAZE_HD void depth_bounds(const Overlap<Real>& seen, const AxisErrors<Real>& errors, float& lo, float& hi) {
  const float n2 = static_cast<float>(seen.n2);
  const float least = static_cast<float>(seen.along - errors.overlap),
              most = static_cast<float>(seen.along + errors.overlap);
  const bool tiny = !(n2 > 0x1p-100f), subnormal = !(least > 0x1p-100f);
  const float length = tiny ? 0x1p-49f : n2 * reciprocal_root(n2);
  lo = subnormal ? 0 : least * reciprocal(length * kUp + errors.length) * kDown;
  const float least_length = length * kDown - errors.length;
  hi = tiny || subnormal || !(least_length > 0) ? INFINITY : most * reciprocal(least_length) * kUp;
}

// Axis number `axis` of core/margin/margin.h, in double.
template <class Real>
GRAZE_HD void depth_along(const Corners<Real>& a, const Corners<Real>& b, int axis, const AxisErrors<double>& errors,
                          float& lo, float& hi) {
  const bool edges = axis < kNormalA, exchange = axis == kNormalB;
  Corners<Real> first, second;
  choose(exchange, b, a, first);
  choose(exchange, a, b, second);
  Corners<double> turned_a, turned_b;
  turn(first, edges ? axis / 3 : 0, turned_a);
  turn(second, edges ? axis % 3 : 0, turned_b);
  depth_bounds(overlap_along(turned_a, turned_b, edges), errors, lo, hi);
}

// Calls visit(k, overlap along axis k), for all axes of core/margin/margin.h.
template <class Real, class Visit>
GRAZE_HD void for_each_axis(const Corners<Real>& a, const Corners<Real>& b, const Visit& visit) {
  GRAZE_UNROLL
  for (int k = 0; k < kNormalA; ++k) {
    const int i = k / 3, j = k % 3;
    visit(k, overlap_along({a[i], a[(i + 1) % 3], a[(i + 2) % 3]}, {b[j], b[(j + 1) % 3], b[(j + 2) % 3]}, true));
  }
  visit(kNormalA, overlap_along(a, b, false));
  visit(kNormalB, overlap_along(b, a, false));
}

// lo <= depth <= hi, in single precision but for the axes that it leaves; of many, none is looked at, and lo is 0.
GRAZE_HD inline void depth_in_single(const Corners<float>& a, const Corners<float>& b, const Vec3<float>& extent,
                                     float& lo, float& hi) {
  const AxisErrors<float> errors(extent * 1.0001f, 0x1p-24);
  const AxisErrors<double> errors_in_double(widen(extent) * 1.0001, kHalfUlp);
  float lowest[kSeparatingAxes], least = INFINITY;
  int first = 0;
  for_each_axis(a, b, [&](int k, const Overlap<float>& seen) {
    float ignored;
    depth_bounds(seen, errors, lowest[k], ignored);
    first = lowest[k] < least ? k : first;
    least = lowest[k] < least ? lowest[k] : least;
  });
  depth_along(a, b, first, errors_in_double, lo, hi);
  unsigned left = 0;
  int count = 0;
  GRAZE_UNROLL
  for (int k = 0; k < kSeparatingAxes; ++k) {
    const bool open = k != first && !(lowest[k] >= lo);
    left |= (open ? 1u : 0u) << k;
    count += open;
  }
  if (count > 3) lo = 0;
  while (left != 0 && lo > 0) {
    const int k = exact::detail::trailing_zeros(left);
    left &= left - 1;
    float lo_k, hi_k;
    depth_along(a, b, k, errors_in_double, lo_k, hi_k);
    lo = lo_k < lo ? lo_k : lo;
    hi = hi_k < hi ? hi_k : hi;
  }
}

GRAZE_HD inline void depth_in_double(const Corners<double>& a, const Corners<double>& b, const Vec& extent, float& lo,
                                     float& hi) {
  const AxisErrors<double> errors(extent, kHalfUlp);
  lo = INFINITY;
  hi = INFINITY;
  for_each_axis(a, b, [&](int, const Overlap<double>& seen) {
    float lo_k, hi_k;
    depth_bounds(seen, errors, lo_k, hi_k);
    lo = lo_k < lo ? lo_k : lo;
    hi = hi_k < hi ? hi_k : hi;
  });
}

GRAZE_HD inline Vec extent_of(const Pair& pair) {
  const auto extent = exact::detail::extent_of(&pair.a[0].x, &pair.b[0].x);
  return {extent.x, extent.y, extent.z};
}

// Whether single precision has the range: determinants, products of six differences, and the errors of determinants,
// beside which underflow is nothing.
GRAZE_HD inline bool fits_single(const Vec& extent) {
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  const auto sensible = [](double r) { return r == 0 || r >= 0x1p-30; };
  return largest >= 0x1p-15 && largest <= 0x1p15 && sensible(extent.x) && sensible(extent.y) && sensible(extent.z);
}

GRAZE_HD inline bool bucket_of(const MarginBounds& bounds, Verdict verdict, int log2_ulp, Bucket& bucket) {
  // Differences of scaled coordinates may be as small as 2^-277: the squares of lengths do not underflow, but products
  // of more may, and then a separation is no bound. It does not lie between 0 and the connection's length either.
  return bounds.lo > 0 && bounds.lo <= bounds.hi && bounds.hi < INFINITY &&
         bucket_from_bounds(bounds, verdict, log2_ulp, bucket);
}

}  // namespace margin_quick

// The bucket, if bounds decide it; single precision finds what to look at in double.
// Requires: finite coordinates; verdict is the pair's true verdict, not declined.
GRAZE_HD inline bool bucket_by_single(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace margin_quick;
  const Vec extent = extent_of(pair);
  if (!fits_single(extent)) return false;
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    const Nearest<float> nearest = seem_nearest(pair.a, pair.b);
    const auto largest = static_cast<float>(greater(extent.x, greater(extent.y, extent.z)));
    if (nearest.next < 0x1p-44f * largest * largest) return false;  // rounding may have chosen
    bounds = distance_bounds(pair.a, pair.b, nearest.features);
  } else {
    float lo, hi;
    depth_in_single(pair.a, pair.b, {float(extent.x), float(extent.y), float(extent.z)}, lo, hi);
    bounds = {lo, hi, 0, 0};
  }
  return bucket_of(bounds, verdict, log2_ulp(pair), bucket);
}

// The same, all in double.
GRAZE_HD inline bool bucket_by_double(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace margin_quick;
  const Vec extent = extent_of(pair);
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  if (!(largest > 0)) return false;
  // Scaled, so that the extent is in [1, 2); exact, and differences carry one rounding.
  const int exponent = floor_log2(largest);
  const double scale = exact::detail::power_of_two(-exponent);
  Corners<double> a, b;
  for (int i = 0; i < 3; ++i) {
    a[i] = widen(pair.a[i]) * scale;
    b[i] = widen(pair.b[i]) * scale;
  }
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    bounds = distance_bounds(a, b, seem_nearest(a, b).features);
  } else {
    float lo, hi;
    depth_in_double(a, b, extent * scale, lo, hi);
    bounds = {lo, hi, 0, 0};
  }
  return bucket_of(bounds, verdict, log2_ulp(pair) - exponent, bucket);
}

}  // namespace GRAZE_FP
}  // namespace graze
