// SPDX-License-Identifier: Apache-2.0
// Helpers for tests of the strata's geometry: triangles over any scalar, exact if it is a 128-bit integer, and the
// share of pairs that have a property.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "strata/strata.h"

namespace graze::strata::testing {

using Int = __int128;  // holds products of five coordinates of 24 bits

template <class Real>
using Triangle = std::array<Vec3<Real>, 3>;

template <class Real>
Vec3<Real> converted(const Vec3<float>& v) {
  return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

template <class Real>
Triangle<Real> converted(const Vec3<float> (&v)[3]) {
  return {converted<Real>(v[0]), converted<Real>(v[1]), converted<Real>(v[2])};
}

template <class Real>
Vec3<Real> edge(const Triangle<Real>& t, std::size_t i) {
  return t[(i + 1) % 3] - t[i];
}

template <class Real>
Vec3<Real> normal(const Triangle<Real>& t) {
  return cross(edge(t, 0), edge(t, 1));
}

template <class Real>
bool separated_along(const Vec3<Real>& axis, const Triangle<Real>& a, const Triangle<Real>& b) {
  const auto [a_low, a_high] = std::minmax({dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])});
  const auto [b_low, b_high] = std::minmax({dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])});
  return a_high < b_low || b_high < a_low;
}

// Whether a separating axis exists.   Requires: neither triangle is degenerate; they may be coplanar.
template <class Real>
bool disjoint(const Triangle<Real>& a, const Triangle<Real>& b) {
  const Vec3<Real> n = normal(a), m = normal(b);
  if (separated_along(n, a, b) || separated_along(m, a, b)) return true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (separated_along(cross(n, edge(a, i)), a, b) || separated_along(cross(m, edge(b, i)), a, b)) return true;
    for (std::size_t j = 0; j < 3; ++j) {
      if (separated_along(cross(edge(a, i), edge(b, j)), a, b)) return true;
    }
  }
  return false;
}

template <class Real>
bool is_zero(const Vec3<Real>& v) {
  return v == Vec3<Real>{0, 0, 0};
}

inline bool is_coplanar(const Triangle<Int>& a, const Triangle<Int>& b) {
  const Vec3<Int> n = is_zero(normal(a)) ? normal(b) : normal(a);
  return !separated_along(n, a, b) && dot(n, edge(a, 0)) == 0 && dot(n, edge(a, 1)) == 0 && dot(n, edge(b, 0)) == 0 &&
         dot(n, edge(b, 1)) == 0;
}

// The sign of the least signed area that p spans with an edge of t: positive inside t, 0 on an edge or a vertex.
// Requires: p lies in the plane of t.
inline int side_of(const Vec3<Int>& p, const Triangle<Int>& t) {
  const Vec3<Int> n = normal(t);
  int least = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const Int area = dot(n, cross(edge(t, i), p - t[i]));
    least = std::min(least, area > 0 ? 1 : area < 0 ? -1 : 0);
  }
  return least;
}

inline double length(const Vec3<double>& v) { return std::sqrt(dot(v, v)); }

template <class Real>
double largest(const BasicPair<Real>& pair) {
  double largest = 0;
  for (int i = 0; i < kCoordinates; ++i) largest = std::max(largest, std::fabs(double{coordinates(pair)[i]}));
  return largest;
}

template <class Real>
int shared_vertices(const BasicPair<Real>& pair) {
  int shared = 0;
  for (const Vec3<Real>& v : pair.a) shared += std::count(pair.b, pair.b + 3, v) != 0;
  return shared;
}

// Whether the closed boxes of two triangles overlap; false if a box has a NaN.
inline bool boxes_overlap(const Triangle<float>& a, const Triangle<float>& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto ends = [&](const Triangle<float>& t) {
      return std::minmax({component(t[0], axis), component(t[1], axis), component(t[2], axis)});
    };
    if (!(ends(a).second >= ends(b).first && ends(b).second >= ends(a).first)) return false;
  }
  return true;
}

// The longest side of the box around a triangle.
inline double extent(const Vec3<float> (&v)[3]) {
  const Triangle<double> t = converted<double>(v);
  double extent = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3<double> e = edge(t, i);
    extent = std::max(extent, magnitude(component(e, dominant_axis(e))));
  }
  return extent;
}

inline double extent_along(const Pair& pair, int axis) {
  const auto& [a, b] = pair;
  const auto [low, high] = std::minmax({component(a[0], axis), component(a[1], axis), component(a[2], axis),
                                        component(b[0], axis), component(b[1], axis), component(b[2], axis)});
  return double{high} - double{low};
}

// Whether Int can hold the coordinates without rounding.
inline bool is_24_bit_integer(const Pair& pair) {
  const float* x = coordinates(pair);
  return largest(pair) <= 0x1p24 && std::all_of(x, x + kCoordinates, [](float c) { return c == std::trunc(c); });
}

inline std::vector<Pair> draw(Stratum stratum) {
  std::vector<Pair> pairs;
  for (std::uint64_t i = 0; i < 10'000; ++i) pairs.push_back(generate(1, stratum, i));
  return pairs;
}

template <class Real, class Predicate>
double share(const std::vector<BasicPair<Real>>& pairs, Predicate holds) {
  return static_cast<double>(std::count_if(pairs.begin(), pairs.end(), holds)) / static_cast<double>(pairs.size());
}

inline void expect_between(double low, double high, double value) {
  EXPECT_LE(low, value);
  EXPECT_LE(value, high);
}

inline bool disjoint_pair(const Pair& pair) {
  return disjoint(converted<long double>(pair.a), converted<long double>(pair.b));
}

}  // namespace graze::strata::testing
