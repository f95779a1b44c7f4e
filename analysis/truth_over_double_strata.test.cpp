// SPDX-License-Identifier: Apache-2.0
// Over the strata of doubles, the oracle's two decisions and the exact decision must always agree. The exact decision
// is tested on single pairs and on blocks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/exact_blocks/decide.h"
#include "core/lanes/lanes.h"
#include "core/relation_of.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze::analysis {
namespace {

constexpr std::uint64_t kSeed = 20261127;

// The number of pairs of each stratum. GRAZE_PAIRS overrides it; 3,600,000 makes 10^8 pairs in all.
std::uint64_t pairs_wanted() {
  const char* text = std::getenv("GRAZE_PAIRS");
  return text ? std::stoull(text) : 100'000;
}

class EveryDoubleStratum : public testing::TestWithParam<strata::StratumInfo> {};

TEST_P(EveryDoubleStratum, ThreeDecisionsAgree) {
  const strata::Stratum stratum = GetParam().stratum;
  const std::uint64_t pairs = pairs_wanted();
  constexpr std::size_t kTogether = 1000;
  std::vector<DoublePair> drawn(kTogether);
  std::vector<std::uint64_t> in_blocks((kTogether + 63) / 64), declined(in_blocks.size());
  std::uint64_t intersecting = 0;
  for (std::uint64_t index = 0; index < pairs; ++index) {
    const std::size_t i = index % kTogether;
    if (i == 0) {
      for (std::size_t k = 0; k < kTogether; ++k) drawn[k] = strata::generate_doubles(kSeed, stratum, index + k);
      exact::decide(coordinates(drawn[0]), kTogether, in_blocks.data(), declined.data());
    }
    const DoublePair& pair = drawn[i];
    const Verdict verdict = oracle::cgal_verdict(pair);
    const Contact contact = oracle::gmp_contact(pair);
    ASSERT_EQ(verdict == Verdict::intersects, contact != Contact::none) << index;
    ASSERT_EQ(exact::intersects(&pair.a[0].x, &pair.b[0].x), verdict == Verdict::intersects) << index;
    ASSERT_EQ(verdict_of_bits(in_blocks[i / 64] >> i % 64 & 1, declined[i / 64] >> i % 64 & 1), verdict) << index;
    const Relation r = relation_of(pair);
    ASSERT_EQ(r.verdict, verdict) << index;
    ASSERT_EQ(r.contact, contact) << index;
    ASSERT_EQ(r.hulls, oracle::hulls(pair)) << index;
    intersecting += verdict == Verdict::intersects;
  }
  EXPECT_GT(intersecting, 0u);
  const bool shared = stratum == strata::Stratum::shared_vertex || stratum == strata::Stratum::shared_edge;
  EXPECT_EQ(intersecting == pairs, shared);
}

TEST_P(EveryDoubleStratum, TheMarginsSignIsTheOracles) {
  for (std::uint64_t index = 0; index < 3'000; ++index) {
    const DoublePair pair = strata::generate_doubles(kSeed + 1, GetParam().stratum, index);
    const oracle::Truth t = oracle::truth(pair);
    ASSERT_EQ(relation_of(pair), static_cast<const Relation&>(t)) << index;
    ASSERT_FALSE(t.margin * t.margin_sign < 0) << index;
    ASSERT_TRUE(t.margin_sign != 0 || t.margin == 0) << index;
    if (t.margin != 0 && std::isnormal(t.margin) && std::isfinite(t.margin_ulps)) {
      ASSERT_EQ(std::ldexp(t.margin, -log2_ulp(pair)), t.margin_ulps) << index;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Strata, EveryDoubleStratum, testing::ValuesIn(strata::kDoubleStrata),
                         [](const auto& row) { return std::string(row.param.id); });

// A pair of float32 that is stored as doubles has the same truth.
TEST(Doubles, OfFloat32HaveItsTruth) {
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::uint64_t index = 0; index < 1'000; ++index) {
      const Pair pair = strata::generate(kSeed, row.stratum, index);
      const DoublePair same = in_doubles(pair);
      const oracle::Truth of_floats = oracle::truth(pair), of_doubles = oracle::truth(same);
      ASSERT_EQ(static_cast<const Relation&>(of_floats), static_cast<const Relation&>(of_doubles)) << row.id << index;
      ASSERT_EQ(of_floats.margin, of_doubles.margin) << row.id << index;
      ASSERT_EQ(relation_of(same), relation_of(pair)) << row.id << index;
      const Pair back = stored_in_float32(same);
      ASSERT_TRUE(std::equal(coordinates(back), coordinates(back) + kCoordinates, coordinates(pair)));
    }
  }
}

// A user reported this pair. Stored as float32, both triangles lie in one plane.
TEST(Doubles, ParallelTrianglesAHundredthApartAtAMillionAreDisjoint) {
  const DoublePair pair{{{1000000.01, 0, 0}, {1000000.01, 1, 0}, {1000000.01, 0, 1}},
                        {{1000000.02, 0, 0}, {1000000.02, 1, 0}, {1000000.02, 0, 1}}};
  const oracle::Truth t = oracle::truth(pair);
  EXPECT_EQ(t.verdict, Verdict::disjoint);
  EXPECT_DOUBLE_EQ(t.margin, 1000000.02 - 1000000.01);
  EXPECT_EQ(oracle::truth(stored_in_float32(pair)).contact, Contact::area);
}

}  // namespace
}  // namespace graze::analysis
