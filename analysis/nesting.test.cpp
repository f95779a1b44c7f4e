// SPDX-License-Identifier: Apache-2.0
// Compares nestings with a computation in rational numbers, and with those of the pair's images.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "analysis/neighbours.h"
#include "analysis/signature.h"
#include "core/exact/find_nesting.h"
#include "core/relation_of.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

// Whether the part of p that lies in q's plane lies in q, computed in rationals. The part's ends are p[i] + d[i] /
// (d[i] - d[j]) (p[j] - p[i]).
bool reaches_plane_inside(const Vec3<float>* p, const Vec3<float>* q) {
  using Int = std::int64_t;
  struct Point {
    Int x, y, z;
  };
  const auto point = [](const Vec3<float>& v) { return Point{Int(v.x), Int(v.y), Int(v.z)}; };
  const auto cross = [](Point u, Point v) {
    return Point{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  };
  const auto dot = [](Point u, Point v) { return u.x * v.x + u.y * v.y + u.z * v.z; };
  const auto less = [](Point u, Point v) { return Point{u.x - v.x, u.y - v.y, u.z - v.z}; };
  const auto times = [](Int f, Point v) { return Point{f * v.x, f * v.y, f * v.z}; };
  const Point q0 = point(q[0]), n = cross(less(point(q[1]), q0), less(point(q[2]), q0));
  const auto inside = [&](Point at, Int weight) {  // the point at / weight in q's plane; weight > 0
    bool in = true;
    for (int k = 0; k < 3; ++k) {
      const Point from = point(q[k]), to = point(q[(k + 1) % 3]);
      in = in && dot(n, cross(less(to, from), less(at, times(weight, from)))) >= 0;
    }
    return in;
  };
  for (int i = 0; i < 3; ++i) {
    const Point u = point(p[i]), v = point(p[(i + 1) % 3]);
    const Int d = dot(n, less(u, q0)), e = dot(n, less(v, q0));
    if (d == 0 && !inside(u, 1)) return false;
    if ((d > 0 && e < 0) || (d < 0 && e > 0)) {
      const Int weight = d > e ? d - e : e - d, sign = d > e ? 1 : -1;
      const Point at{sign * (d * v.x - e * u.x), sign * (d * v.y - e * u.y), sign * (d * v.z - e * u.z)};
      if (!inside(at, weight)) return false;
    }
  }
  return true;
}

TEST(Nesting, IsThatOfRationalNumbers) {
  std::map<std::pair<bool, Nesting>, int> seen;  // by coplanar
  std::uint32_t state = 1;
  for (int k = 0; k < 60000; ++k) {
    Pair pair;
    for (int i = 0; i < kCoordinates; ++i) {
      state = state * 1664525u + 1013904223u;
      coordinates(pair)[i] = i % 3 == 2 && k % 2 == 0 ? 0 : static_cast<float>(state >> 24) / 32 - 4;
      coordinates(pair)[i] = std::floor(coordinates(pair)[i]);
    }
    const Relation r = relation_of(pair);
    const Nesting nesting = nesting_of(pair, r);
    if (!r.intersects() || (r.hulls.dimension_a < 2 || r.hulls.dimension_b < 2)) continue;
    const bool a = reaches_plane_inside(pair.a, pair.b), b = reaches_plane_inside(pair.b, pair.a);
    const bool in_space = !r.hulls.coplanar, nested = !in_space || r.contact == Contact::segment;
    const Nesting expected = !nested || (in_space && a == b) ? Nesting::none
                             : a && b                        ? Nesting::same
                             : a                             ? Nesting::a_in_b
                             : b                             ? Nesting::b_in_a
                                                             : Nesting::none;
    ASSERT_EQ(nesting, expected) << k;
    ++seen[{r.hulls.coplanar, nesting}];
  }
  for (const bool coplanar : {false, true}) {
    for (const Nesting nesting : {Nesting::none, Nesting::a_in_b, Nesting::b_in_a})
      EXPECT_GT((seen[{coplanar, nesting}]), 100) << coplanar << name(nesting);
  }
}

// The nesting does not depend on the number type that decides it, on scale, or on the order of vertices. Swapping the
// triangles swaps a_in_b and b_in_a.
TEST(Nesting, IsThatOfTheImages) {
  std::map<Nesting, int> seen;
  for (const strata::StratumInfo& stratum : strata::kStrata) {
    for (std::uint64_t index = 0; index < 300; ++index) {
      const Pair pair = strata::generate(7, stratum.stratum, index);
      const Relation r = relation_of(pair);
      const Nesting nesting = nesting_of(pair, r);
      ++seen[nesting];
      if (nesting == Nesting::none && index % 8 != 0) continue;
      ASSERT_EQ(exact::detail::nesting(
                    exact::detail::triangles<exact::detail::WideNumbers>(coordinates(pair), coordinates(pair) + 9), r),
                nesting)
          << stratum.id << ' ' << index;
      std::vector<Pair> images = orders(pair);
      for (std::size_t k = 0; k < images.size(); ++k) {
        const Nesting swapped = nesting == Nesting::a_in_b   ? Nesting::b_in_a
                                : nesting == Nesting::b_in_a ? Nesting::a_in_b
                                                             : nesting;
        ASSERT_EQ(nesting_of(images[k], r), k < 36 ? nesting : swapped) << stratum.id << ' ' << index << ' ' << k;
      }
      for (const Pair& image : scalings(pair)) ASSERT_EQ(nesting_of(image, r), nesting) << stratum.id << ' ' << index;
    }
  }
  EXPECT_GT(seen[Nesting::a_in_b], 100);
  EXPECT_GT(seen[Nesting::b_in_a], 100);
  EXPECT_GT(seen[Nesting::same], 3);
}

// Segments and points can lie in triangles too. Only shapes in one plane can cover the same points.
TEST(Nesting, OfDegenerateTriangles) {
  const auto of = [](const Pair& pair) { return nesting_of(pair, relation_of(pair)); };
  const Vec3<float> o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0}, p{1, 1, 0}, q{2, 1, 0}, out{1, 1, 3}, under{1, 1, -1};
  EXPECT_EQ(of({{o, x, y}, {p, q, p}}), Nesting::b_in_a);  // a segment in a triangle
  EXPECT_EQ(of({{o, x, y}, {p, p, p}}), Nesting::b_in_a);  // a point in a triangle
  EXPECT_EQ(of({{p, p, p}, {p, p, p}}), Nesting::same);    // the same point
  EXPECT_EQ(of({{p, q, p}, {o, x, y}}), Nesting::a_in_b);
  EXPECT_EQ(of({{o, x, y}, {y, o, x}}), Nesting::same);
  EXPECT_EQ(of({{o, x, y}, {p, out, under}}), Nesting::none);    // a segment that pierces the triangle
  EXPECT_EQ(of({{o, x, y}, {q, out, under}}), Nesting::b_in_a);  // a triangle that pierces the other inside
  EXPECT_EQ(of({{o, x, y}, {{5, 5, 0}, {6, 5, 0}, {5, 6, 0}}}), Nesting::none);  // disjoint
}

}  // namespace
}  // namespace graze::analysis
