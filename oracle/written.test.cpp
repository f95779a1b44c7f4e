// SPDX-License-Identifier: Apache-2.0
// Tests the truth of pairs as written, both where float32 changes the pair and where it does not.
#include <gtest/gtest.h>

#include <random>
#include <sstream>
#include <vector>

#include "core/text.h"
#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

Pair stored(const std::vector<std::string>& numbers) {
  Pair pair{};
  for (std::size_t i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = parse_float32(numbers.at(i)).value();
  return pair;
}

TEST(TruthAsWritten, SeesWhatFloat32RoundsAway) {
  // Two faces in the plane z = 1, or nearly in it.
  const auto numbers = words_of("0 0 1 1 0 1 0 1 1  0 0 1.00000000001 1 0 1.00000000001 0 1 1.00000000001");
  const Pair pair = stored(numbers);
  EXPECT_EQ(truth(pair).contact, Contact::area);
  const auto written = truth_as_written(numbers, pair);
  ASSERT_TRUE(written);
  EXPECT_EQ(written->verdict, Verdict::disjoint);
  EXPECT_EQ(written->contact, Contact::none);
  EXPECT_EQ(written->margin, 1e-11);
  EXPECT_EQ(oracle::rounded(numbers, pair), (std::vector<std::size_t>{11, 14, 17}));
  // A double that float32 cannot hold, in hex.
  const auto hex =
      words_of("0 0 1 1 0 1 0 1 1  0 0 0x1.0000000000001p0 1 0 0x1.0000000000001p+0 0 1 0x10000000000001p-52");
  EXPECT_EQ(truth_as_written(hex, stored(hex)).value().margin, 0x1p-52);
}

TEST(TruthAsWritten, IsNothingWhereEveryNumberIsStored) {
  for (const char* text :
       {"0 0 1 1 0 1 0 1 1  0 0 2 1 0 2 0 1 2", "0.5 -0 1e0 1 0 1 0 1 .25  0x.8p1 +1 2 1 0 2 0 1 1.5E2",
        "1e-46 0 0 nan 0 0 0 0 0 0 0 0 0 0 0 0 0 0", "inf 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0"}) {
    const auto numbers = words_of(text);
    EXPECT_FALSE(truth_as_written(numbers, stored(numbers))) << text;
  }
  const auto rounded = words_of("0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1e-46");
  EXPECT_EQ(oracle::rounded(rounded, stored(rounded)), std::vector<std::size_t>{17});
  EXPECT_THROW(oracle::rounded(words_of("1e-999999 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"), Pair{}), std::runtime_error);
}

// Moving both triangles by a distance that float32 cannot represent keeps their truth; scaling both scales the margin.
TEST(TruthAsWritten, IsTheStoredTruthUnderExactMotions) {
  std::mt19937 random(12);
  int contacts[4] = {};
  for (int round = 0; round < 500; ++round) {
    std::vector<std::string> numbers, moved, scaled;
    for (int i = 0; i < kCoordinates; ++i) {
      const int x = static_cast<int>(random() % 5);
      numbers.push_back(std::to_string(x));
      moved.push_back(std::to_string(x) + ".0000000000000000000001");
      scaled.push_back(std::to_string(3 * x) + "e-1");
    }
    const Truth expected = truth(stored(numbers));
    const auto other = truth_as_written(moved, stored(moved));
    ASSERT_TRUE(other);
    EXPECT_EQ(other->verdict, expected.verdict);
    EXPECT_EQ(other->contact, expected.contact);
    EXPECT_EQ(other->margin, expected.margin);
    ++contacts[static_cast<int>(expected.contact)];
    if (const auto smaller = truth_as_written(scaled, stored(scaled))) {
      EXPECT_EQ(smaller->contact, expected.contact);
      EXPECT_NEAR(smaller->margin, 0.3 * expected.margin, 1e-15);
    }
  }
  for (int c = 0; c < 3; ++c) EXPECT_GT(contacts[c], 5) << c;
}

}  // namespace
}  // namespace graze::oracle
