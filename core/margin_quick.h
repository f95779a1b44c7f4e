// SPDX-License-Identifier: Apache-2.0
// A first attempt at a pair's margin bucket: certified as core/margin.h is, at a fraction of its cost, and undecided
// more often. Written for GPUs, where double-precision roots and quotients are dear: the nearest features of disjoint
// triangles are guessed with reciprocals in single precision, and only the guess is certified; the depth of
// intersecting ones is bounded with one error for all axes, and with lengths in single precision.
#pragma once

#include "core/margin.h"

namespace graze {
inline namespace GRAZE_FP {
namespace margin_quick {

// The pair scaled by 2^-exponent, so that its extent is in [1, 2); exact, and differences carry one rounding.
struct Frame {
  Vec3<double> a[3], b[3], extent;
  int exponent;
};

GRAZE_HD inline void widen_extent(const Vec3<float>& v, Vec3<float>& low, Vec3<float>& high) {
  low = {v.x < low.x ? v.x : low.x, v.y < low.y ? v.y : low.y, v.z < low.z ? v.z : low.z};
  high = {v.x > high.x ? v.x : high.x, v.y > high.y ? v.y : high.y, v.z > high.z ? v.z : high.z};
}

GRAZE_HD inline double power_of_two(int exponent) {
  const std::uint64_t bits = static_cast<std::uint64_t>(exponent + 1023) << 52;
  double power;
  memcpy(&power, &bits, sizeof power);
  return power;
}

// Returns: false when all six points are equal.
GRAZE_HD inline bool make_frame(const Pair& pair, Frame& f) {
  Vec3<float> low = pair.a[0], high = pair.a[0];
  for (int i = 0; i < 3; ++i) {
    widen_extent(pair.a[i], low, high);
    widen_extent(pair.b[i], low, high);
  }
  const Vec3<double> extent = widen(high) - widen(low);
  const double largest = greater(extent.x, greater(extent.y, extent.z));
  if (!(largest > 0)) return false;
  f.exponent = floor_log2(largest);
  const double scale = power_of_two(-f.exponent);
  f.extent = extent * scale;
  for (int i = 0; i < 3; ++i) {
    f.a[i] = widen(pair.a[i]) * scale;
    f.b[i] = widen(pair.b[i]) * scale;
  }
  return true;
}

using Vec = Vec3<double>;

GRAZE_HD inline void consider(double squared, bool valid, int direction, double& best, int& found) {
  const bool better = valid && squared < best;
  best = better ? squared : best;
  found = better ? direction : found;
}

// 1 / x to 22 bits; infinite or NaN for what is too small, which then is never nearest.
GRAZE_HD inline double reciprocal(double x) { return static_cast<double>(1 / static_cast<float>(x)); }

// The direction (of core/margin.h) of the features that are nearest, up to the error of a reciprocal: a guess.
GRAZE_HD inline int seems_nearest(const Frame& f) {
  Vec edge_a[3], edge_b[3];
  double length_a[3], length_b[3], per_a[3], per_b[3];  // squares, and their reciprocals
  for (int i = 0; i < 3; ++i) {
    edge_a[i] = f.a[i == 2 ? 0 : i + 1] - f.a[i];
    edge_b[i] = f.b[i == 2 ? 0 : i + 1] - f.b[i];
    length_a[i] = dot(edge_a[i], edge_a[i]);
    length_b[i] = dot(edge_b[i], edge_b[i]);
    per_a[i] = reciprocal(length_a[i]);
    per_b[i] = reciprocal(length_b[i]);
  }
  const Vec normal_a = cross(edge_a[0], edge_a[1]), normal_b = cross(edge_b[0], edge_b[1]);
  const double n2_a = dot(normal_a, normal_a), n2_b = dot(normal_b, normal_b);
  const double per_normal_a = reciprocal(n2_a), per_normal_b = reciprocal(n2_b);
  double best = INFINITY;
  int found = kFromVertex;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec w = f.b[j] - f.a[i], across_a = cross(w, edge_a[i]), across_b = cross(w, edge_b[j]);
      const int feature = 3 * i + j;
      consider(dot(w, w), true, kFromVertex + feature, best, found);
      const double at_a = dot(w, edge_a[i]), at_b = -dot(w, edge_b[j]);
      consider(dot(across_a, across_a) * per_a[i], at_a > 0 && at_a < length_a[i], kFromEdgeA + feature, best, found);
      consider(dot(across_b, across_b) * per_b[j], at_b > 0 && at_b < length_b[j], kFromEdgeB + feature, best, found);
      const Vec n = cross(edge_a[i], edge_b[j]);
      const double n2 = dot(n, n), s = dot(across_b, n), t = dot(across_a, n), gap = dot(w, n);
      consider(gap * gap * reciprocal(n2), s > 0 && t > 0 && s < n2 && t < n2, feature, best, found);
      if (i == 0) {  // a vertex of b over a
        const double u = -dot(cross(w, edge_a[2]), normal_a), v = dot(cross(edge_a[0], w), normal_a);
        const double height = dot(w, normal_a);
        consider(height * height * per_normal_a, u >= 0 && v >= 0 && u + v <= n2_a, kNormalA, best, found);
      }
      if (j == 0) {  // a vertex of a over b; w points away from it
        const double u = dot(cross(w, edge_b[2]), normal_b), v = -dot(cross(edge_b[0], w), normal_b);
        const double height = dot(w, normal_b);
        consider(height * height * per_normal_b, u >= 0 && v >= 0 && u + v <= n2_b, kNormalB, best, found);
      }
    }
  }
  return found;
}

// The connection in direction d: of the features that d stands for, but all three vertices of the other for a normal.
GRAZE_HD inline Connection connection(const MarginFrame& f, int d) {
  Connection best = {INFINITY, 0, 0};
  if (d == kNormalA || d == kNormalB) {
    const bool of_a = d == kNormalA;
    const Vec3<double>(&u)[3] = of_a ? f.edge_a : f.edge_b;
    const Vec3<double> normal = cross(u[0], u[1]);
    const double n2 = dot(normal, normal);
    for (int i = 0; i < 3; ++i) {
      const Vec3<double> at = of_a ? f.b[i] - f.a[0] : f.a[i] - f.b[0];
      connect_to_face(best, at, u[0], u[2] * -1.0, normal, n2, d);
    }
    return best;
  }
  const int feature = d < kSeparatingAxes ? d : (d - kFromEdgeA) % 9, i = feature / 3, j = feature % 3;
  const Vec3<double> between = f.b[j] - f.a[i];
  if (d >= kFromVertex) shorten(best, between, {0, 0, 0}, {0, 0, 0}, d);
  if (d >= kFromEdgeB && d < kFromVertex) connect_to_edge(best, between * -1.0, f.edge_b[j], d);
  if (d >= kFromEdgeA && d < kFromEdgeB) connect_to_edge(best, between, f.edge_a[i], d);
  if (d < kSeparatingAxes) connect_edges(best, between, f.edge_a[i], f.edge_b[j], d);
  return best;
}

// lo <= depth <= hi, in units of 2^exponent. A projection on an axis is a determinant of three differences, so the
// error of core/exact.h's first attempt bounds them all; of a component of an axis, (3 + 1) kHalfUlp times two
// products.
GRAZE_HD inline void depth_bounds(const Frame& f, float& lo, float& hi) {
  const Vec3<double>& r = f.extent;
  // Two determinants an overlap, and its own rounding: 2 * 6 * 8 + 2 half ulps.
  const double error = 98 * kHalfUlp * r.x * r.y * r.z;
  const float length_error = static_cast<float>(8 * kHalfUlp * (r.y * r.z + r.z * r.x + r.x * r.y)) * 1.0001f;
  constexpr float kUp = 1 + 0x1p-19f, kDown = 1 - 0x1p-19f;  // for all roundings in single precision
  lo = INFINITY;
  hi = INFINITY;
  for (int axis = 0; axis < kSeparatingAxes; ++axis) {
    const int i = axis / 3 % 3, j = axis % 3;
    const Vec3<double> n = axis == kNormalA   ? cross(f.a[1] - f.a[0], f.a[2] - f.a[0])
                           : axis == kNormalB ? cross(f.b[1] - f.b[0], f.b[2] - f.b[0])
                                              : cross(f.a[i == 2 ? 0 : i + 1] - f.a[i], f.b[(j + 1) % 3] - f.b[j]);
    const Vec3<double> from = axis == kNormalB ? f.b[0] : axis == kNormalA ? f.a[0] : f.a[i];
    // The feature itself is at zero; see seen_from_axis.
    double own_least = 0, own_most = 0;
    if (axis < kNormalA) {
      const double third = dot(n, f.a[(i + 2) % 3] - from);
      own_least = lesser(0, third);
      own_most = greater(0, third);
    }
    double p, q;
    if (axis < kNormalA) {
      p = dot(n, f.b[j] - from);
      q = dot(n, f.b[(j + 2) % 3] - from);
    } else {
      p = dot(n, (axis == kNormalA ? f.b[1] : f.a[1]) - from);
      q = dot(n, (axis == kNormalA ? f.b[2] : f.a[2]) - from);
    }
    double least = lesser(p, q), most = greater(p, q);
    if (axis >= kNormalA) {
      const double first = dot(n, (axis == kNormalA ? f.b[0] : f.a[0]) - from);
      least = lesser(least, first);
      most = greater(most, first);
    }
    const double overlap = lesser(own_most - least, most - own_least);
    const float n2 = static_cast<float>(dot(n, n));
    const bool tiny = !(n2 > 0x1p-100f);
    const float length = tiny ? 0x1p-49f : sqrtf(n2);
    lo = fminf(lo, static_cast<float>(overlap - error) / (length * kUp + length_error));
    const float least_length = length * kDown - length_error;
    if (!tiny && least_length > 0) hi = fminf(hi, static_cast<float>(overlap + error) / least_length);
  }
  lo *= kDown;
  hi *= kUp;
}

}  // namespace margin_quick

// The bucket, if bounds decide it.
// Requires: finite coordinates; verdict is the pair's true verdict, not declined.
GRAZE_HD inline bool quick_bucket(const Pair& pair, Verdict verdict, Bucket& bucket) {
  using namespace margin_quick;
  Frame f;
  if (!make_frame(pair, f)) return false;
  MarginBounds bounds;
  if (verdict == Verdict::disjoint) {
    MarginFrame frame;
    frame.exact = false;
    for (int i = 0; i < 3; ++i) {
      frame.a[i] = f.a[i];
      frame.b[i] = f.b[i];
    }
    const int d = seems_nearest(f);
    for (int i = 0; i < 3; ++i) {
      frame.edge_a[i] = f.a[i == 2 ? 0 : i + 1] - f.a[i];
      frame.edge_b[i] = f.b[i == 2 ? 0 : i + 1] - f.b[i];
    }
    const Connection best = connection(frame, d);
    bounds = {separation(frame, d), sqrt(best.squared) * (1 + 8 * kHalfUlp) + 8 * kHalfUlp * best.terms, d, 0};
    if (!(bounds.lo > 0) || !(bounds.hi < INFINITY)) return false;
  } else {
    float lo, hi;
    depth_bounds(f, lo, hi);
    if (!(lo > 0) || !(hi < INFINITY)) return false;
    bounds = {lo, hi, 0, 0};
  }
  return bucket_from_bounds(bounds, verdict, log2_ulp(pair) - f.exponent, bucket);
}

}  // namespace GRAZE_FP
}  // namespace graze
