// SPDX-License-Identifier: Apache-2.0
// Tests of near, exact, coplanar and parallel contacts. Exact properties are tested in 128-bit integers, and other
// properties by the share of pairs that have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "strata/strata.h"
#include "strata/testing.h"

namespace graze::strata::testing {
namespace {

TEST(NearContacts, HaveBothVerdicts) {
  for (const Stratum stratum : {Stratum::near_vertex_face, Stratum::near_edge_edge, Stratum::near_vertex_edge,
                                Stratum::near_vertex_vertex, Stratum::sliver, Stratum::far_from_origin}) {
    SCOPED_TRACE(kStrata[static_cast<int>(stratum)].id);
    expect_between(0.3, 0.9, share(draw(stratum), disjoint_pair));
  }
}

// The smallest distance of a vertex of `t` from the other triangle's plane: positive if `t` lies on one side of that
// plane, otherwise negative.
long double closest_vertex(const Triangle<long double>& plane, const Triangle<long double>& t) {
  const Vec3<long double> n = normal(plane);
  const long double size = std::sqrt(dot(n, n));
  std::array<long double, 3> d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = dot(n, t[i] - plane[0]) / size;
  std::sort(d.begin(), d.end());
  const long double least = std::min({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
  return d[0] > 0 || d[2] < 0 ? least : -least;
}

TEST(NearContacts, VerticesLieCloseToFacesOnEitherSide) {
  int outside = 0, inside = 0;
  std::vector<int> decades(13);
  for (const Pair& pair : draw(Stratum::near_vertex_face)) {
    const auto a = converted<long double>(pair.a), b = converted<long double>(pair.b);
    const long double d = closest_vertex(a, b), e = closest_vertex(b, a);
    const long double gap = std::fabs(d) < std::fabs(e) ? d : e;
    (gap > 0 ? outside : inside) += 1;
    if (gap != 0) ++decades[static_cast<std::size_t>(std::clamp(-std::log10(std::fabs(gap)), 0.0L, 12.0L))];
  }
  EXPECT_GT(outside, 3000);
  EXPECT_GT(inside, 3000);
  for (std::size_t d = 0; d < 9; ++d) EXPECT_GT(decades[d], 100) << "gaps of about 1e-" << d;
}

TEST(CoplanarLattice, IsExactAndSmall) {
  const std::vector<Pair> pairs = draw(Stratum::coplanar_lattice);
  for (const Pair& pair : pairs) {
    ASSERT_TRUE(is_24_bit_integer(pair));
    ASSERT_LE(largest(pair), 40);
    ASSERT_TRUE(is_coplanar(converted<Int>(pair.a), converted<Int>(pair.b)));
  }
  const auto axis_aligned = [](const Pair& pair) {
    const Vec3<Int> n = normal(converted<Int>(pair.a));
    return (n.x != 0) + (n.y != 0) + (n.z != 0) == 1;
  };
  expect_between(0.4, 0.7, share(pairs, axis_aligned));
  expect_between(0.2, 0.5, share(pairs, disjoint_pair));
}

TEST(CoplanarWide, IsExactAndWide) {
  const std::vector<Pair> pairs = draw(Stratum::coplanar_wide);
  for (const Pair& pair : pairs) {
    ASSERT_TRUE(is_24_bit_integer(pair));
    ASSERT_TRUE(is_coplanar(converted<Int>(pair.a), converted<Int>(pair.b)));
  }
  EXPECT_GT(share(pairs, [](const Pair& pair) { return largest(pair) > 0x1p22; }), 0.9);
  const auto defeats_double = [](const Pair& pair) {
    const Triangle<double> a = converted<double>(pair.a);
    return dot(normal(a), converted<double>(pair.b[0]) - a[0]) != 0;
  };
  EXPECT_GT(share(pairs, defeats_double), 0.2);
  const auto exactly_disjoint = [](const Pair& pair) {
    return disjoint(converted<Int>(pair.a), converted<Int>(pair.b));
  };
  expect_between(0.2, 0.5, share(pairs, exactly_disjoint));
}

bool vertex_on_face(const Vec3<Int>& p, const Triangle<Int>& t) {
  return dot(normal(t), p - t[0]) == 0 && side_of(p, t) > 0;
}

bool vertex_on_edge(const Vec3<Int>& p, const Vec3<Int>& start, const Vec3<Int>& e) {
  const Int along = dot(e, p - start);
  return is_zero(cross(e, p - start)) && 0 < along && along < dot(e, e);
}

bool edges_cross(const Vec3<Int>& p, const Vec3<Int>& e, const Vec3<Int>& q, const Vec3<Int>& f) {
  const Vec3<Int> m = cross(e, f);
  const Int s = dot(m, cross(q - p, f)), t = dot(m, cross(q - p, e)), whole = dot(m, m);
  return dot(m, q - p) == 0 && 0 < s && s < whole && 0 < t && t < whole;
}

TEST(ExactContact, HasThreeKindsAndBothSides) {
  int face = 0, edge_edge = 0, vertex_edge = 0, apart = 0, into = 0, defeats_double = 0;
  for (const Pair& pair : draw(Stratum::exact_contact)) {
    ASSERT_TRUE(is_24_bit_integer(pair));
    const Triangle<Int> a = converted<Int>(pair.a), b = converted<Int>(pair.b);
    bool on_face = false, on_edge = false, crossing = false;
    for (std::size_t i = 0; i < 3; ++i) {
      on_face |= vertex_on_face(a[i], b) || vertex_on_face(b[i], a);
      for (std::size_t j = 0; j < 3; ++j) {
        on_edge |= vertex_on_edge(a[i], b[j], edge(b, j)) || vertex_on_edge(b[i], a[j], edge(a, j));
        crossing |= edges_cross(a[i], edge(a, i), b[j], edge(b, j));
      }
    }
    const bool touches = on_face || on_edge || crossing;
    face += on_face;
    vertex_edge += on_edge;
    edge_edge += crossing;
    if (touches) {
      EXPECT_FALSE(disjoint(a, b));
      defeats_double += disjoint(converted<double>(pair.a), converted<double>(pair.b));
    } else {
      (disjoint(a, b) ? apart : into) += 1;
    }
  }
  EXPECT_GT(face, 1000);
  EXPECT_GT(edge_edge, 1000);
  EXPECT_GT(vertex_edge, 1000);
  EXPECT_GT(apart, 1500);
  EXPECT_GT(into, 1500);
  EXPECT_GT(defeats_double, 500);
}

TEST(CoplanarRounded, IsCoplanarUpToRounding) {
  const auto is_close = [](const Pair& pair) {
    const auto a = converted<double>(pair.a), b = converted<double>(pair.b);
    double volume = 0;
    for (const Vec3<double>& v : b) volume = std::max(volume, std::fabs(dot(normal(a), v - a[0])));
    return volume <= 1e-6 * (1 + length(normal(a)));
  };
  const std::vector<Pair> pairs = draw(Stratum::coplanar_rounded);
  EXPECT_EQ(share(pairs, is_close), 1);
}

TEST(Parallel, NormalsAreParallelAndPlanesNot) {
  const std::vector<Pair> pairs = draw(Stratum::parallel);
  const auto exactly = [](const Pair& pair) {
    if (is_24_bit_integer(pair)) return is_zero(cross(normal(converted<Int>(pair.a)), normal(converted<Int>(pair.b))));
    return is_zero(cross(normal(converted<double>(pair.a)), normal(converted<double>(pair.b))));
  };
  const auto nearly = [](const Pair& pair) {
    const auto n = normal(converted<double>(pair.a)), m = normal(converted<double>(pair.b));
    return length(cross(n, m)) <= 1e-4 * length(n) * length(m);
  };
  EXPECT_GT(share(pairs, exactly), 0.5);
  EXPECT_GT(share(pairs, nearly), 0.95);
  expect_between(0.5, 0.95, share(pairs, disjoint_pair));
}

}  // namespace
}  // namespace graze::strata::testing
