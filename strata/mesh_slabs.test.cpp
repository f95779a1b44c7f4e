// SPDX-License-Identifier: Apache-2.0
// Tests that slabs of any size give exactly the pairs of a brute-force search, each once.
#include "strata/mesh_slabs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "strata/testing.h"

namespace graze::strata {
namespace {

using Triangle = std::array<Vec3<float>, 3>;
using Triangles = std::vector<Triangle>;
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Pairs by_brute_force(const Triangles& a, const Triangles& b, bool self) {
  Pairs pairs;
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    for (std::uint32_t j = self ? i + 1 : 0; j < b.size(); ++j) {
      if (testing::boxes_overlap(a[i], b[j])) pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

Pairs by_slabs(const BoxSlabs& slabs) {
  Pairs pairs;
  for (std::size_t slab = 0; slab < slabs.size(); ++slab)
    slabs.pairs(slab, [&](std::uint32_t i, std::uint32_t j) { pairs.emplace_back(i, j); });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// Triangles on a coarse lattice, so that many boxes only touch. One triangle in eight is long.
Triangles drawn(std::size_t count, unsigned seed, int longest_axis) {
  std::mt19937 random(seed);
  Triangles triangles(count);
  for (Triangle& t : triangles) {
    const int size = random() % 8 == 0 ? 40 : 3;
    float base[3];
    for (int axis = 0; axis < 3; ++axis) base[axis] = static_cast<float>(random() % (axis == longest_axis ? 60 : 12));
    const auto step = [&] { return static_cast<float>(static_cast<int>(random() % static_cast<unsigned>(size))); };
    for (Vec3<float>& v : t) v = {base[0] + step(), base[1] + step(), base[2] + step()};
  }
  return triangles;
}

TEST(BoxSlabs, FindEachPairOnce) {
  for (const int axis : {0, 1, 2}) {
    const Triangles a = drawn(300, 1, axis), b = drawn(200, 2, (axis + 1) % 3);
    const Pairs between = by_brute_force(a, b, false), within = by_brute_force(a, a, true);
    EXPECT_GT(between.size(), 100u);
    for (const std::size_t of_slab : {1, 7, 64, 299, 300, 1000}) {
      EXPECT_EQ(by_slabs(BoxSlabs(a, b, of_slab)), between) << of_slab;
      EXPECT_EQ(by_slabs(BoxSlabs(b, a, of_slab)).size(), between.size()) << of_slab;
      EXPECT_EQ(by_slabs(BoxSlabs(a, std::nullopt, of_slab)), within) << of_slab;
    }
  }
}

TEST(BoxSlabs, AreOfAnySizeWithoutTrianglesThatAreNotFinite) {
  Triangles a = drawn(30, 3, 0);
  const Triangles none;
  EXPECT_EQ(BoxSlabs(none, a).size(), 0u);
  EXPECT_TRUE(by_slabs(BoxSlabs(a, none)).empty());
  EXPECT_TRUE(by_slabs(BoxSlabs(Triangles(1, a[0]), std::nullopt)).empty());
  EXPECT_EQ(by_slabs(BoxSlabs(Triangles(2, a[0]), std::nullopt)), (Pairs{{0, 1}}));
  EXPECT_EQ(by_slabs(BoxSlabs(a, Triangles(1, a[4]))), by_brute_force(a, Triangles(1, a[4]), false));
  Triangles some = a;
  some[3][1].y = std::numeric_limits<float>::quiet_NaN();
  some[5][2].z = -std::numeric_limits<float>::infinity();
  some[9][0].x = std::numeric_limits<float>::max();
  const BoxSlabs slabs(some, std::nullopt, 4);
  EXPECT_EQ(slabs.not_finite(), 2u);
  EXPECT_EQ(slabs.triangles_before(slabs.size()), 28u);
  Pairs expected = by_brute_force(some, some, true);
  std::erase_if(expected, [](const auto& p) { return p.first == 3 || p.second == 3 || p.first == 5 || p.second == 5; });
  EXPECT_EQ(by_slabs(slabs), expected);
}

TEST(BoxSlabs, EndWithWhatIsThrown) {
  const Triangles a = drawn(100, 4, 1);
  EXPECT_THROW(BoxSlabs(a, a).pairs(0, [](std::uint32_t, std::uint32_t) { throw 7; }), int);
}

}  // namespace
}  // namespace graze::strata
