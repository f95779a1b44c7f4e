// SPDX-License-Identifier: Apache-2.0
// Tests golden hashes, purity and finiteness of all strata, and the strata that draw coordinates without a
// construction. contact.test.cpp and shapes.test.cpp test the geometric guarantees of the other strata.
#include "strata/strata.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "core/relation_of.h"
#include "strata/golden.h"
#include "strata/groups.h"

namespace graze::strata {
namespace {

TEST(Strata, RowsAreInTheOrderOfTheEnumeration) {
  for (int s = 0; s < kStrataCount; ++s) EXPECT_EQ(static_cast<int>(kStrata[s].stratum), s) << kStrata[s].id;
}

// Checks the description of the group `general`: most pairs have usual shapes, and some are coplanar or degenerate.
TEST(Groups, GeneralHasSomeCoplanarAndSomeDegeneratePairs) {
  constexpr std::uint64_t kPairs = 3000;  // per stratum
  std::uint64_t pairs = 0, coplanar = 0, degenerate = 0;
  for (const StratumInfo& row : kStrata) {
    if (row.group != Group::general) continue;
    for (std::uint64_t i = 0; i < kPairs; ++i) {
      const Pair pair = generate(1, row.stratum, i);
      const Relation r = relation_of(pair);
      const bool is_degenerate = r.hulls.dimension_a < 2 || r.hulls.dimension_b < 2;
      degenerate += is_degenerate;
      coplanar += !is_degenerate && r.hulls.coplanar;
    }
    pairs += kPairs;
  }
  EXPECT_EQ(pairs, 10 * kPairs);
  EXPECT_GT(coplanar, 0u);
  EXPECT_GT(degenerate, 0u);
  EXPECT_LT(coplanar + degenerate, pairs / 10);
}

TEST(Strata, GoldenBits) {
  for (int s = 0; s < kStrataCount; ++s) {
    std::uint64_t hash = kHashStart;
    for (std::uint64_t i = 0; i < kGoldenPairs; ++i) {
      hash = hash_bits(generate(kGoldenSeed, kStrata[s].stratum, i), hash);
    }
    EXPECT_EQ(hash, kGoldenHashes[s]) << kStrata[s].id << std::hex << " is now 0x" << hash;
  }
}

TEST(Strata, DoNotDependOnTheOrderOfCalls) {
  constexpr std::uint64_t kCount = 500;
  std::vector<std::uint64_t> forward;
  for (const StratumInfo& info : kStrata) {
    for (std::uint64_t i = 0; i < kCount; ++i) forward.push_back(hash_bits(generate(1, info.stratum, i)));
  }
  for (std::uint64_t i = kCount; i-- > 0;) {
    for (std::size_t s = 0; s < kStrataCount; ++s) {
      ASSERT_EQ(hash_bits(generate(1, kStrata[s].stratum, i)), forward[s * kCount + i]) << kStrata[s].id << " " << i;
    }
  }
}

TEST(Strata, AreFinite) {
  for (const StratumInfo& info : kStrata) {
    for (std::uint64_t i = 0; i < 100'000; ++i) {
      ASSERT_TRUE(is_finite(generate(2, info.stratum, i))) << info.id << " " << i;
    }
  }
}

TEST(Strata, DifferBySeedAndStratumAndIndex) {
  std::set<std::uint64_t> hashes;
  std::size_t pairs = 0;
  for (const StratumInfo& info : kStrata) {
    for (const int bit : {0, 1, 31, 32, 63}) {
      hashes.insert(hash_bits(generate(std::uint64_t{1} << bit, info.stratum, 0)));
      hashes.insert(hash_bits(generate(0, info.stratum, std::uint64_t{1} << bit)));
      pairs += 2;
    }
  }
  EXPECT_EQ(hashes.size(), pairs);
}

TEST(Draws, ShuffledReachesAll72Orders) {
  Pair pair;
  for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = static_cast<float>(i);
  std::set<std::uint64_t> orders;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    strata::Draws draws(1, 0, i);
    const Pair order = strata::shuffled(draws, pair);
    orders.insert(hash_bits(order));
    const std::set<float> values(coordinates(order), coordinates(order) + kCoordinates);
    ASSERT_EQ(values.size(), std::size_t{kCoordinates});
    ASSERT_EQ(order.a[0].x < 9, order.a[1].x < 9);
    ASSERT_EQ(order.a[0].x < 9, order.a[2].x < 9);
  }
  EXPECT_EQ(orders.size(), 72u);
}

TEST(Draws, NudgedIsTheNextFloat) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float x : {0.0f, 1.0f, -1.0f, 0x1p-149f, -0x1p-149f, 0x1.fffffcp-127f, -3.5f}) {
    EXPECT_EQ(strata::nudged(x, 1), std::nextafter(x, infinity));
    EXPECT_EQ(strata::nudged(x, -1), std::nextafter(x, -infinity));
    EXPECT_EQ(strata::nudged(strata::nudged(x, -8), 8), x);
  }
}

TEST(Draws, PowersOfTwoAreExact) {
  for (int e = -1022; e <= 1023; ++e) ASSERT_EQ(strata::power_of_two(e), std::ldexp(1.0, e));
}

TEST(Uniform, FillsTheCube) {
  constexpr int kPairs = 10'000;
  double sum = 0, squares = 0;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const Pair pair = generate(1, Stratum::uniform, i);
    for (int k = 0; k < kCoordinates; ++k) {
      const double x = coordinates(pair)[k];
      ASSERT_TRUE(-1 <= x && x < 1) << x;
      sum += x;
      squares += x * x;
    }
  }
  EXPECT_NEAR(sum / (kPairs * kCoordinates), 0, 0.01);
  EXPECT_NEAR(squares / (kPairs * kCoordinates), 1.0 / 3, 0.01);
}

TEST(Lattice, TakesThreeValues) {
  std::set<float> values;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Pair pair = generate(1, Stratum::lattice, i);
    values.insert(coordinates(pair), coordinates(pair) + kCoordinates);
  }
  EXPECT_EQ(values, (std::set<float>{-1, 0, 1}));
}

// Whether the thesis's listing can produce these three coordinates on one axis.
bool is_of_the_listing(float x, float y, float z) {
  for (int k = 0; k < 80; ++k) {
    const float base = static_cast<float>(k - 40) / 10.0f;
    const std::set<float> values{base, base + 1, base + 2, base + 3, base + 4};
    if (values.count(x) && values.count(y) && values.count(z)) return true;
  }
  return false;
}

TEST(Thesis, IsTheReferenceAgainstTheListingsTriangles) {
  const std::array<Vec3<float>, 3> listed{{{2, -2, 4}, {1, 5, -2}, {1, -3, -3}}};
  const std::array<Vec3<float>, 3> of_special_cases{{{0, -2, 6}, {0, 5, 0}, {0, -3, 0}}};
  for (const auto& [stratum, reference] :
       {std::pair{Stratum::thesis, listed}, std::pair{Stratum::thesis_special, of_special_cases}}) {
    std::set<float> values;
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const Pair pair = generate(1, stratum, i);
      EXPECT_EQ(std::to_array(pair.a), reference);
      for (int axis = 0; axis < 3; ++axis) {
        const float x[3] = {component(pair.b[0], axis), component(pair.b[1], axis), component(pair.b[2], axis)};
        EXPECT_TRUE(is_of_the_listing(x[0], x[1], x[2])) << x[0] << " " << x[1] << " " << x[2];
        values.insert(x, x + 3);
      }
    }
    EXPECT_EQ(*values.begin(), -4.0f);
    EXPECT_EQ(*values.rbegin(), 39 / 10.0f + 4);
  }
}

}  // namespace
}  // namespace graze::strata
