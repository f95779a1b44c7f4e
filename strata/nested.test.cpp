// SPDX-License-Identifier: Apache-2.0
// Tests of nested triangles: containment and piercing on the grid in exact integers, and other properties by the share
// of pairs that have them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/relation_of.h"
#include "strata/strata.h"
#include "strata/testing.h"

namespace graze::strata::testing {
namespace {

// How `inner` lies in `outer`. 1: strictly inside; 0: inside, touching the boundary; -1: not contained.
int contained(const Triangle<Int>& inner, const Triangle<Int>& outer) {
  return std::min({side_of(inner[0], outer), side_of(inner[1], outer), side_of(inner[2], outer)});
}

// Whether the inner triangle meets the outer one, but none of the outer one's edges.   Requires: their planes cross.
bool pierces(const Triangle<Int>& inner, const Triangle<Int>& outer) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!disjoint(Triangle<Int>{outer[i], outer[(i + 1) % 3], outer[i]}, inner)) return false;
  }
  return !disjoint(inner, outer);
}

std::vector<Pair> drawn(bool on_grid) {
  std::vector<Pair> pairs = draw(Stratum::nested);
  std::erase_if(pairs, [&](const Pair& pair) { return is_24_bit_integer(pair) != on_grid; });
  return pairs;
}

TEST(Nested, OnTheGridTrianglesAreContainedExactlyOrJustOutside) {
  int b_in_a = 0, a_in_b = 0, strictly = 0, touches = 0, touched_outside = 0, apart = 0, piercing = 0, in_space = 0;
  int small = 0;
  for (const Pair& pair : drawn(true)) {
    const Triangle<Int> a = converted<Int>(pair.a), b = converted<Int>(pair.b);
    ASSERT_FALSE(is_zero(normal(a)) || is_zero(normal(b)));
    small += largest(pair) <= 64;
    const Relation r = relation_of(pair);
    ASSERT_EQ(r.hulls.coplanar, is_coplanar(a, b));
    ASSERT_EQ(r.verdict == Verdict::disjoint, disjoint(a, b));
    if (!r.hulls.coplanar) {
      ++in_space;
      piercing += pierces(a, b) || pierces(b, a);
      continue;
    }
    const int inside_a = contained(b, a), inside_b = contained(a, b);
    b_in_a += inside_a >= 0;
    a_in_b += inside_b >= 0;
    const int depth = std::max(inside_a, inside_b);
    strictly += depth > 0;
    touches += depth == 0;
    if (depth >= 0) continue;
    // Triangles never overlap only in part: a triangle that is not contained lies outside.
    ASSERT_TRUE(r.verdict == Verdict::disjoint || r.contact != graze::Contact::area);
    (r.verdict == Verdict::disjoint ? apart : touched_outside) += 1;
  }
  EXPECT_GT(b_in_a, 1200);
  EXPECT_GT(a_in_b, 1200);
  EXPECT_GT(strictly, 600);
  EXPECT_GT(touches, 1200);
  EXPECT_GT(touched_outside, 250);
  EXPECT_GT(apart, 350);
  EXPECT_GT(in_space, 1000);
  EXPECT_GT(piercing, 500);
  EXPECT_GT(small, 300);
}

// The greatest distance of a vertex of `inner` from the plane of `outer`.
double off_plane(const Triangle<double>& inner, const Triangle<double>& outer) {
  const Vec3<double> n = normal(outer);
  double most = 0;
  for (const Vec3<double>& v : inner) most = std::max(most, std::fabs(dot(n, v - outer[0])) / length(n));
  return most;
}

TEST(Nested, OffTheGridTrianglesAreCoplanarUntilRounding) {
  int flat = 0, contained = 0, disjoint = 0;
  const std::vector<Pair> pairs = drawn(false);
  for (const Pair& pair : pairs) {
    const auto a = converted<double>(pair.a), b = converted<double>(pair.b);
    const bool a_is_larger = extent(pair.a) > extent(pair.b);
    const bool is_flat = off_plane(a_is_larger ? b : a, a_is_larger ? a : b) < 1e-6;
    flat += is_flat;
    const Relation r = relation_of(pair);
    disjoint += r.verdict == Verdict::disjoint;
    contained += is_flat && r.hulls.coplanar;
  }
  EXPECT_GT(pairs.size(), 4700u);
  EXPECT_GT(flat, 3300);
  EXPECT_GT(disjoint, 800);
  EXPECT_GT(contained, 300);  // pairs in axis-aligned planes remain coplanar after rounding
}

TEST(Nested, SizesDifferByUpTo2To20) {
  std::array<int, 6> bins{};  // each bin spans 2^4
  for (const Pair& pair : draw(Stratum::nested)) {
    const double ratio = std::fabs(std::log2(extent(pair.a) / extent(pair.b)));
    ASSERT_LT(ratio, 24);
    ++bins[static_cast<std::size_t>(ratio / 4)];
  }
  for (std::size_t i = 0; i < 5; ++i) EXPECT_GT(bins[i], 700) << "2^" << 4 * i;
}

}  // namespace
}  // namespace graze::strata::testing
