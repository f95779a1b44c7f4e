// SPDX-License-Identifier: Apache-2.0
// Pairs in vectors must get the same verdicts as each pair alone, with every instruction set of this processor.
// analysis/truth_over_strata.test.cpp compares them in every stratum.
#include "core/lanes/vector_blocks.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include "core/algorithms/algorithms.h"
#include "core/every_target_testing.h"

namespace graze {
namespace {

class VectorBlocks : public testing::TestWithParam<Scalar> {
 protected:
  static Verdict alone(const Pair& pair) {
    return GetParam() == Scalar::f32 ? decide_widened<SeparatingAxes, float>(pair)
                                     : decide_widened<SeparatingAxes, double>(pair);
  }

  // Checks every pair, and the bits and words after the last pair.
  static void expect_as_each_alone(const std::vector<Pair>& pairs) {
    const std::size_t words = (pairs.size() + 63) / 64;
    std::vector<std::uint64_t> yes(words + 1, ~0ull), declined(words + 1, ~0ull);
    vector_block("separating_axes", GetParam())(pairs.data(), pairs.size(), yes.data(), declined.data());
    for (std::size_t i = 0; i < words * 64; ++i) {
      const bool meet = i < pairs.size() && alone(pairs[i]) == Verdict::intersects;
      ASSERT_EQ(yes[i / 64] >> i % 64 & 1, meet) << "pair " << i << " of " << pairs.size();
      ASSERT_EQ(declined[i / 64] >> i % 64 & 1, 0u) << "pair " << i << " of " << pairs.size();
    }
    EXPECT_EQ(yes[words] & declined[words], ~0ull) << "wrote past the end";
  }

  template <class Coordinate>
  static std::vector<Pair> drawn(std::size_t count, const Coordinate& coordinate) {
    std::vector<Pair> pairs(count);
    for (Pair& pair : pairs) {
      for (int v = 0; v < 3; ++v) {
        pair.a[v] = {coordinate(), coordinate(), coordinate()};
        pair.b[v] = {coordinate(), coordinate(), coordinate()};
      }
    }
    return pairs;
  }
};

TEST_P(VectorBlocks, AreDecidedAsEachPairAloneOnEveryTarget) {
  std::mt19937 random(5);
  const auto near_one = [&] { return std::ldexp(static_cast<float>(random()), -32); };
  const auto small_whole = [&] { return static_cast<float>(random() % 3) - 1; };
  const auto any_scale = [&] { return std::ldexp(near_one() - 0.5f, static_cast<int>(random() % 250) - 130); };
  const auto any_bits = [&] { return std::bit_cast<float>(static_cast<std::uint32_t>(random())); };
  on_every_target([&] {
    expect_as_each_alone(drawn(20'000, near_one));
    expect_as_each_alone(drawn(20'000, small_whole));
    expect_as_each_alone(drawn(20'000, any_scale));
    expect_as_each_alone(drawn(20'000, any_bits));  // including NaN and infinity
  });
}

TEST_P(VectorBlocks, AreOfAnySize) {
  std::mt19937 random(6);
  for (std::size_t count = 0; count <= 140; ++count)
    on_every_target([&] { expect_as_each_alone(drawn(count, [&] { return static_cast<float>(random() % 9); })); });
}

INSTANTIATE_TEST_SUITE_P(Scalars, VectorBlocks, testing::Values(Scalar::f32, Scalar::f64),
                         [](const auto& row) { return std::string(name(row.param)); });

TEST(VectorBlocksTable, OnlyWrittenOnesAreThere) {
  EXPECT_EQ(vector_block("moller_1997", Scalar::f32), nullptr);
  EXPECT_NE(vector_block("separating_axes", Scalar::f64), nullptr);
}

}  // namespace
}  // namespace graze
