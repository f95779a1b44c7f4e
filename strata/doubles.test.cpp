// SPDX-License-Identifier: Apache-2.0
// Tests the strata of doubles: their bits, and each stratum's promised property. These tests use the exact decision,
// which analysis/truth_over_double_strata.test.cpp compares with the oracle.
#include "strata/doubles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "core/relation_of.h"
#include "strata/double_golden.h"
#include "strata/groups.h"
#include "strata/strata.h"
#include "strata/testing.h"

namespace graze::strata {
namespace {

using testing::largest;
using testing::share;
using testing::shared_vertices;

constexpr int kPairs = 10'000;

std::vector<DoublePair> drawn(Stratum stratum) {
  std::vector<DoublePair> pairs;
  for (std::uint64_t i = 0; i < kPairs; ++i) pairs.push_back(generate_doubles(1, stratum, i));
  return pairs;
}

bool every(const DoublePair& pair, const std::function<bool(double)>& holds) {
  return std::all_of(coordinates(pair), coordinates(pair) + kCoordinates, holds);
}

bool is_integer(double x) { return x == std::trunc(x); }

bool intersects(const DoublePair& pair) { return relation_of(pair).intersects(); }

bool changes_in_float32(const DoublePair& pair) {
  return relation_of(stored_in_float32(pair)).verdict != relation_of(pair).verdict;
}

double longest_edge(const DoublePair& pair) {
  double longest = 0;
  for (const auto& t : {pair.a, pair.b}) {
    for (int i = 0; i < 3; ++i) {
      const Vec3<double> e = t[(i + 1) % 3] - t[i];
      longest = std::max(longest, std::sqrt(dot(e, e)));
    }
  }
  return longest;
}

TEST(DoubleStrata, BeginWithThoseOfFloat32AndAreNamedOnce) {
  std::set<std::string_view> names;
  for (int s = 0; s < kDoubleStrataCount; ++s) {
    names.insert(kDoubleStrata[s].id);
    if (s < kStrataCount) {
      EXPECT_EQ(kDoubleStrata[s].id, kStrata[s].id);
    }
  }
  EXPECT_EQ(names.size(), std::size_t{kDoubleStrataCount});
  EXPECT_GT(kDoubleStrataCount, kStrataCount);
  EXPECT_EQ(group_of_name("large_offset"), Group::extreme);
  EXPECT_EQ(static_cast<int>(Stratum::lattice_15), 64);
}

TEST(DoubleStrata, GoldenBits) {
  for (int s = 0; s < kDoubleStrataCount; ++s) {
    std::uint64_t hash = kHashStart;
    for (std::uint64_t i = 0; i < kGoldenPairs; ++i)
      hash = hash_bits(generate_doubles(kGoldenSeed, kDoubleStrata[s].stratum, i), hash);
    EXPECT_EQ(hash, kDoubleGoldenHashes[s]) << kDoubleStrata[s].id << std::hex << " is now 0x" << hash;
  }
}

TEST(DoubleStrata, AreFiniteAndPure) {
  for (const StratumInfo& info : kDoubleStrata) {
    std::vector<std::uint64_t> hashes, again(500);
    for (std::uint64_t i = 0; i < 20'000; ++i) {
      const DoublePair pair = generate_doubles(2, info.stratum, i);
      ASSERT_TRUE(is_finite(pair)) << info.id << ' ' << i;
      if (i < 500) hashes.push_back(hash_bits(pair));
    }
    for (std::uint64_t i = 500; i-- > 0;) again[i] = hash_bits(generate_doubles(2, info.stratum, i));
    EXPECT_EQ(hashes, again) << info.id;
    EXPECT_NE(hash_bits(generate_doubles(3, info.stratum, 0)), hashes[0]) << info.id;
  }
}

TEST(DoubleStrata, UseAllBitsOfADouble) {
  for (const StratumInfo& info : kDoubleStrata) {
    if (info.stratum == Stratum::lattice || info.stratum == Stratum::lattice_15 ||
        info.stratum == Stratum::coplanar_lattice)
      continue;
    std::size_t fine = 0;  // coordinates that float32 cannot hold
    for (std::uint64_t i = 0; i < 2'000; ++i) {
      const DoublePair pair = generate_doubles(1, info.stratum, i);
      for (int k = 0; k < kCoordinates; ++k)
        fine += static_cast<double>(static_cast<float>(coordinates(pair)[k])) != coordinates(pair)[k];
    }
    EXPECT_GT(fine, std::size_t{2'000}) << info.id;
  }
}

TEST(DoubleStrata, BothVerdictsOccurExceptAmongNeighbours) {
  for (const StratumInfo& info : kDoubleStrata) {
    const double meet = share(drawn(info.stratum), intersects);
    const bool shared = info.stratum == Stratum::shared_vertex || info.stratum == Stratum::shared_edge;
    EXPECT_EQ(meet == 1, shared) << info.id;
    EXPECT_GT(meet, 0.05) << info.id;
  }
}

// Exact contacts and coplanar pairs on integers of 16 to 53 bits stay exact.
TEST(DoubleStrata, WideIntegersAreExact) {
  for (const Stratum stratum : {Stratum::exact_contact, Stratum::coplanar_wide}) {
    const std::vector<DoublePair> pairs = drawn(stratum);
    std::array<int, 54> by_bits{};
    for (const DoublePair& pair : pairs) {
      ASSERT_TRUE(every(pair, is_integer));
      ASSERT_LE(largest(pair), 0x1p53);
      ++by_bits[std::min<std::size_t>(53, std::bit_width(static_cast<std::uint64_t>(largest(pair))))];
    }
    for (std::size_t bits = 17; bits < 53; ++bits) EXPECT_GT(by_bits[bits], 50) << bits;
  }
  const std::vector<DoublePair> contacts = drawn(Stratum::exact_contact);
  EXPECT_GT(share(contacts, [](const DoublePair& p) { return relation_of(p).touches(); }), 0.45);
  for (const DoublePair& pair : drawn(Stratum::coplanar_wide)) ASSERT_TRUE(relation_of(pair).hulls.coplanar);
}

TEST(DoubleStrata, DegeneratePairsAreSo) {
  for (const DoublePair& pair : drawn(Stratum::degenerate)) {
    const Hulls hulls = relation_of(pair).hulls;
    ASSERT_TRUE(hulls.dimension_a < 2 || hulls.dimension_b < 2);
  }
}

TEST(DoubleStrata, NeighboursStoreTheSameVertices) {
  for (const DoublePair& pair : drawn(Stratum::shared_vertex)) ASSERT_GE(shared_vertices(pair), 1);
  for (const DoublePair& pair : drawn(Stratum::shared_edge)) ASSERT_GE(shared_vertices(pair), 2);
}

// A push by double-precision ulps is far smaller than a push by float32 ulps.
TEST(DoubleStrata, NearContactsDifferFromTheContactByUlpsOfADouble) {
  for (const Stratum stratum : {Stratum::near_vertex_face, Stratum::near_edge_edge, Stratum::near_vertex_edge}) {
    const std::vector<DoublePair> pairs = drawn(stratum);
    EXPECT_GT(share(pairs, changes_in_float32), 0.3);
    EXPECT_GT(share(pairs, [](const DoublePair& p) { return !intersects(p); }), 0.3);
  }
}

TEST(DoubleStrata, ExtremeScalesReachTheLimitsOfADouble) {
  std::array<int, 15> bins{};  // each bin spans 2^140; the first starts at 2^-1075
  for (const DoublePair& pair : drawn(Stratum::extreme_scale)) {
    const int exponent = largest(pair) == 0 ? -1075 : std::ilogb(largest(pair));
    ++bins[static_cast<std::size_t>((exponent + 1075) / 140)];
  }
  for (std::size_t i = 0; i < bins.size(); ++i) EXPECT_GT(bins[i], 400) << i;
}

TEST(Lattice15, DoubleArithmeticIsExact) {
  const std::vector<DoublePair> pairs = drawn(Stratum::lattice_15);
  for (const DoublePair& pair : pairs) {
    ASSERT_TRUE(every(pair, is_integer));
    ASSERT_LE(largest(pair), 0x1p15);
  }
  EXPECT_GT(share(pairs, [](const DoublePair& p) { return relation_of(p).touches(); }), 0.45);
  EXPECT_GT(share(pairs, [](const DoublePair& p) { return largest(p) > 0x1p13; }), 0.1);
}

TEST(LargeOffset, IsFarAndFine) {
  const std::vector<DoublePair> pairs = drawn(Stratum::large_offset);
  std::array<int, 3> far{};
  for (const DoublePair& pair : pairs) {
    ASSERT_LT(longest_edge(pair), 1);
    ++far[static_cast<std::size_t>(std::lround(std::log10(largest(pair)))) - 5];
  }
  for (const int count : far) EXPECT_GT(count, 3'000);
  EXPECT_GT(share(pairs, changes_in_float32), 0.3);
}

// After the rotation and the move, contacts remain contacts up to rounding, and edges keep their lengths.
TEST(FloatBorn, IsMovedRigidly) {
  const std::vector<DoublePair> pairs = drawn(Stratum::float_born);
  for (std::uint64_t i = 0; i < 1'000; ++i) {
    DoubleDraws draws(1, static_cast<std::uint32_t>(Stratum::float_born), i);
    Draws of_floats = draws;
    const std::uint32_t kind = of_floats.below(3);
    const Pair born = kind == 0   ? near_contact(of_floats, draw_touch(of_floats))
                      : kind == 1 ? exact_contact(of_floats)
                                  : coplanar_wide(of_floats);
    const DoublePair from = in_doubles(born), &to = pairs[i];
    const Vec3<double> before = from.a[1] - from.b[0], after = to.a[1] - to.b[0];
    EXPECT_NEAR(std::sqrt(dot(after, after)), std::sqrt(dot(before, before)), 1e-14 * (largest(from) + 1024));
  }
  EXPECT_LT(share(pairs, [](const DoublePair& p) { return relation_of(p).touches(); }), 0.2);
}

TEST(DecimalBorn, HasThreeToSixPlaces) {
  std::array<int, 4> places{};
  for (const DoublePair& pair : drawn(Stratum::decimal_born)) {
    int needed = 0;
    for (int p = 3; p <= 6 && needed == 0; ++p) {
      const double unit = std::pow(10, p);
      if (every(pair, [unit](double x) { return std::round(x * unit) / unit == x; })) needed = p;
    }
    ASSERT_GE(needed, 3);
    ++places[static_cast<std::size_t>(needed - 3)];
  }
  for (const int count : places) EXPECT_GT(count, 1'500);
}

TEST(ConstructionBorn, TwoWaysToComputeAPointDifferNowAndThen) {
  const std::vector<DoublePair> pairs = drawn(Stratum::construction_born);
  const double equal = share(pairs, [](const DoublePair& p) { return shared_vertices(p) > 0; });
  EXPECT_GT(equal, 0.1);
  EXPECT_LT(equal, 0.6);
  const auto nearly_shared = [](const DoublePair& p) {
    for (const Vec3<double>& u : p.a) {
      for (const Vec3<double>& v : p.b) {
        const Vec3<double> between = u - v;
        if (u != v && dot(between, between) < 1e-28) return true;
      }
    }
    return false;
  };
  EXPECT_GT(share(pairs, nearly_shared), 0.05);
}

TEST(Stored, Float32ChangesTheVerdictOfAll) {
  const std::vector<DoublePair> pairs = drawn(Stratum::stored);
  EXPECT_GT(share(pairs, changes_in_float32), 0.999);
  EXPECT_GT(share(pairs, [](const DoublePair& p) { return largest(p) > 256; }), 0.15);
  EXPECT_GT(share(pairs, [](const DoublePair& p) { return largest(p) < 4; }), 0.3);
}

TEST(Radians, HasSquaredEdgesBelow1em8) {
  for (const DoublePair& pair : drawn(Stratum::radians)) {
    ASSERT_LT(longest_edge(pair), 1e-4);
    ASSERT_LT(std::fabs(pair.a[0].x), 3.142);
    ASSERT_LT(std::fabs(pair.a[0].y), 1.571);
  }
}

}  // namespace
}  // namespace graze::strata
