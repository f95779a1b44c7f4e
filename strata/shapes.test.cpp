// SPDX-License-Identifier: Apache-2.0
// Tests slivers, degenerate triangles, mesh neighbours, and the strata with unusual scales.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "strata/strata.h"
#include "strata/testing.h"

namespace graze::strata::testing {
namespace {

double aspect(const Vec3<float> (&v)[3]) {
  const Triangle<double> t = converted<double>(v);
  const double longest = std::max({length(edge(t, 0)), length(edge(t, 1)), length(edge(t, 2))});
  return longest * longest / length(normal(t));
}

TEST(Sliver, AspectsCoverTheirDecades) {
  std::array<int, 12> decades{};
  for (const Pair& pair : draw(Stratum::sliver)) {
    const double value = std::max(aspect(pair.a), aspect(pair.b));
    ++decades[static_cast<std::size_t>(std::clamp(std::log10(value), 0.0, 11.0))];
  }
  for (std::size_t d = 3; d <= 6; ++d) EXPECT_GT(decades[d], 1500) << "aspects of about 1e" << d;
  EXPECT_LT(decades[0] + decades[1] + decades[2], 500);
  EXPECT_LT(decades[9] + decades[10] + decades[11], 100);
}

TEST(Degenerate, OneIsASegmentOrPointExactly) {
  int points = 0, segments = 0, both = 0, share_a_vertex = 0;
  for (const Pair& pair : draw(Stratum::degenerate)) {
    // Exact, because coordinates are 24-bit integers times one power of two: differences need 25 bits, the normal 51.
    const auto a = converted<double>(pair.a), b = converted<double>(pair.b);
    const bool a_flat = is_zero(normal(a)), b_flat = is_zero(normal(b));
    ASSERT_TRUE(a_flat || b_flat);
    both += a_flat && b_flat;
    const auto& t = a_flat ? a : b;
    (t[0] == t[1] && t[1] == t[2] ? points : segments) += 1;
    share_a_vertex += shared_vertices(pair) > 0;
  }
  EXPECT_GT(points, 2000);
  EXPECT_GT(segments, 4000);
  EXPECT_GT(both, 3000);
  EXPECT_GT(share_a_vertex, 1000);
}

bool exactly_coplanar(const Pair& pair) {
  return is_24_bit_integer(pair) && is_coplanar(converted<Int>(pair.a), converted<Int>(pair.b));
}

TEST(Shared, NeighboursStoreTheSameVertices) {
  for (const Pair& pair : draw(Stratum::shared_vertex)) ASSERT_GE(shared_vertices(pair), 1);
  for (const Pair& pair : draw(Stratum::shared_edge)) ASSERT_GE(shared_vertices(pair), 2);
}

TEST(Shared, DihedralAnglesAreAnythingFromFlatToFolded) {
  for (const Stratum stratum : {Stratum::shared_vertex, Stratum::shared_edge}) {
    const std::vector<Pair> pairs = draw(stratum);
    expect_between(0.2, 0.3, share(pairs, exactly_coplanar));
    int wide = 0, narrow = 0, tiny = 0;
    for (const Pair& pair : pairs) {
      const auto n = normal(converted<double>(pair.a)), m = normal(converted<double>(pair.b));
      const double sine = length(cross(n, m)) / (length(n) * length(m));
      (sine > 0.1 ? wide : sine > 1e-6 ? narrow : tiny) += 1;
    }
    EXPECT_GT(wide, 300);
    EXPECT_GT(narrow, 1500);
    EXPECT_GT(tiny, 2500);
  }
}

TEST(FarFromOrigin, OffsetsAreLogUniform) {
  std::array<int, 12> decades{};
  for (const Pair& pair : draw(Stratum::far_from_origin)) {
    const double size = std::max({extent(pair.a), extent(pair.b), 0.5});  // 0.5: rounding may collapse both triangles
    ++decades[static_cast<std::size_t>(std::clamp(std::log10(largest(pair) / size), 0.0, 11.0))];
  }
  for (std::size_t d = 2; d <= 5; ++d) EXPECT_GT(decades[d], 1500) << "offsets of about 1e" << d;
  EXPECT_EQ(decades[0], 0);
  EXPECT_EQ(decades[8], 0);
}

TEST(ExtremeScale, CoversAllExponents) {
  std::array<int, 10> bins{};  // each bin spans 2^28; the first starts at 2^-150
  for (const Pair& pair : draw(Stratum::extreme_scale)) {
    const int exponent = largest(pair) == 0 ? -150 : std::ilogb(largest(pair));
    ++bins[static_cast<std::size_t>((exponent + 150) / 28)];
  }
  for (std::size_t i = 0; i < bins.size(); ++i) EXPECT_GT(bins[i], 800) << "2^" << static_cast<int>(i) * 28 - 150;
}

TEST(MixedScale, SizesDifferByUpTo2To40) {
  int small = 0, tiny = 0, axes = 0;
  for (const Pair& pair : draw(Stratum::mixed_scale)) {
    const double ratio = extent(pair.a) / extent(pair.b);
    const double magnitude_of_log = std::fabs(std::log2(ratio));
    small += magnitude_of_log > 10;
    tiny += magnitude_of_log > 25 && std::isfinite(magnitude_of_log);
    EXPECT_LT(std::isfinite(magnitude_of_log) ? magnitude_of_log : 0, 48);
    const Vec3<double> box = {extent_along(pair, 0), extent_along(pair, 1), extent_along(pair, 2)};
    axes += std::max({box.x, box.y, box.z}) > 0x1p12 * std::min({box.x, box.y, box.z});
  }
  EXPECT_GT(small, 3000);
  EXPECT_GT(tiny, 1000);
  EXPECT_GT(axes, 3000);
}

}  // namespace
}  // namespace graze::strata::testing
