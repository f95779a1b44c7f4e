// SPDX-License-Identifier: Apache-2.0
#include <graze/test.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/relation_of.h"
#include "oracle/truth.h"
#include "strata/strata.h"

namespace graze {
namespace {

bool same_bits(const Pair& l, const Pair& r) { return std::memcmp(&l, &r, sizeof l) == 0; }

std::vector<Pair> pairs_of(std::string_view strata, std::uint64_t seed, std::uint64_t count) {
  std::vector<Pair> pairs;
  for_each_pair(strata, seed, count, [&](const Pair& pair) { pairs.push_back(pair); });
  return pairs;
}

bool right(const float a[9], const float b[9]) { return exact::intersects(a, b); }
bool never(const float[9], const float[9]) { return false; }
bool boxes_meet(const double a[9], const double b[9]) {  // correct whenever it returns false
  for (int c = 0; c < 3; ++c) {
    const auto range = [c](const double* t) { return std::minmax({t[c], t[c + 3], t[c + 6]}); };
    if (range(a).second < range(b).first || range(b).second < range(a).first) return false;
  }
  return true;
}
int declines(const float[9], const float[9]) { return -1; }
int throws(const float a[9], const float b[9]) {
  if (exact::intersects(a, b)) throw std::runtime_error("no");
  return 0;
}
bool by_reference(const float (&a)[9], const float (&b)[9]) { return exact::intersects(a, b); }
// Wrong on touching triangles, because it calls them disjoint.
bool touching_is_apart(const float a[9], const float b[9]) {
  const Relation relation = exact::relation(a, b);
  return relation.intersects() && (relation.margin_sign != 0 || relation.contact == Contact::area);
}

TEST(ForEachPair, DrawsTheStrataInOrder) {
  const std::vector<Pair> pairs = pairs_of("near_edge_edge,lattice", 7, 101);
  ASSERT_EQ(pairs.size(), 101u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair expected = i < 51 ? strata::generate(7, strata::Stratum::near_edge_edge, i)
                                 : strata::generate(7, strata::Stratum::lattice, i - 51);
    EXPECT_TRUE(same_bits(pairs[i], expected)) << i;
  }
  EXPECT_EQ(pairs_of("*", 1, 1000).size(), 1000u);
  EXPECT_EQ(pairs_of("*,!near_*", 1, 1000).size(), 1000u);
  EXPECT_THROW(pairs_of("near_edge_edge,nonesuch", 1, 10), std::invalid_argument);
  EXPECT_THROW(pairs_of("lattice,!nonesuch", 1, 10), std::invalid_argument);
  EXPECT_THROW(pairs_of("lattice,!lattice", 1, 10), std::invalid_argument);
}

TEST(Truth, IsTheOracles) {
  int intersect = 0;
  for (const Pair& pair : pairs_of("*", 3, 21'000)) {
    const Relation found = truth(pair);
    EXPECT_EQ(found, static_cast<const Relation&>(oracle::truth(pair)));
    intersect += found.intersects();
  }
  EXPECT_GT(intersect, 5000);
  Pair pair{};
  pair.b[2].z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(truth(pair).verdict, Verdict::declined);
  pair.b[2].z = std::numeric_limits<float>::infinity();
  EXPECT_EQ(truth(pair).verdict, Verdict::declined);
}

TEST(TestOverlap, PassesARightFunction) {
  for (const auto& overlap : {overlap_of(right), overlap_of(by_reference)}) {
    const TestResult result = test_overlap("right", overlap);
    EXPECT_TRUE(result.passed) << result.message;
    EXPECT_EQ(result.pairs, 100'000u);
    EXPECT_EQ(result.counts, Counts{});
    EXPECT_FALSE(result.smallest);
  }
}

TEST(TestOverlap, CountsWhatIsWrongAndShrinksIt) {
  const TestOptions options{.strata = "near_*,coplanar_*", .pairs = 7001, .seed = 5};
  const TestResult result = test_overlap("boxes_meet", overlap_of(boxes_meet), options);
  EXPECT_FALSE(result.passed);
  Counts expected;
  const auto wide = overlap_of(boxes_meet);
  for (const Pair& pair : pairs_of(options.strata, options.seed, options.pairs))
    expected.false_positive += wide(&pair.a[0].x, &pair.b[0].x) != 0 && !oracle::truth(pair).intersects();
  EXPECT_GT(expected.false_positive, 1000u);
  EXPECT_EQ(result.counts, expected);
  ASSERT_TRUE(result.smallest);
  const Pair& small = *result.smallest;
  EXPECT_EQ(oracle::truth(small).verdict, Verdict::disjoint);
  EXPECT_EQ(wide(&small.a[0].x, &small.b[0].x), 1);
  int zeros = 0;
  for (int i = 0; i < kCoordinates; ++i) zeros += coordinates(small)[i] == 0;
  EXPECT_GE(zeros, 10) << result.message;

  // The message has the pair, which can become a test, and the command that explains the pair.
  const std::string& text = result.message;
  EXPECT_NE(text.find(std::to_string(expected.false_positive / 1000) + ","), text.npos) << text;
  EXPECT_NE(text.find("near_edge_edge"), text.npos) << text;
  EXPECT_NE(text.find(":boxes_meet\n"), text.npos) << text;
  const std::size_t echo = text.find("echo '") + 6;
  const char* at = text.c_str() + echo;
  for (int i = 0; i < kCoordinates; ++i) {
    char* end = nullptr;
    EXPECT_EQ(std::strtof(at, &end), coordinates(small)[i]) << text;
    at = end;
  }
  EXPECT_EQ(*at, '\'');
  const TestResult again = test_overlap("boxes_meet", overlap_of(boxes_meet), options);
  EXPECT_EQ(again.message, text);
}

TEST(TestOverlap, ShrinksEveryKindOfFailure) {
  for (const auto& overlap : {overlap_of(never), overlap_of(throws), overlap_of(touching_is_apart)}) {
    const TestResult result = test_overlap("f", overlap, {.strata = "near_*,sliver,extreme_scale", .pairs = 3000});
    EXPECT_FALSE(result.passed);
    ASSERT_TRUE(result.smallest);
    EXPECT_TRUE(oracle::truth(*result.smallest).intersects());
    int magnitudes_above_one = 0;
    for (int i = 0; i < kCoordinates; ++i) {
      const float value = std::fabs(coordinates(*result.smallest)[i]);
      magnitudes_above_one += value != 0 && value != 1;
    }
    EXPECT_LE(magnitudes_above_one, 2) << result.message;
  }
}

TEST(TestOverlap, AcceptsWhatIsAllowed) {
  const auto passes = [](const auto& f, const TestOptions& options) {
    return test_overlap("f", overlap_of(f), options).passed;
  };
  const std::string_view strata = "near_*,exact_contact,lattice";
  EXPECT_FALSE(passes(touching_is_apart, {.strata = strata, .pairs = 5000}));
  EXPECT_TRUE(passes(touching_is_apart, {.strata = strata, .pairs = 5000, .touching = either}));
  EXPECT_TRUE(passes(never, {.strata = "coplanar_lattice", .pairs = 500, .coplanar = either}));
  EXPECT_FALSE(passes(never, {.strata = "coplanar_lattice", .pairs = 500, .degenerate = either}));
  EXPECT_TRUE(passes(never, {.strata = "degenerate", .pairs = 500, .degenerate = either}));
  EXPECT_TRUE(passes(never, {.strata = "shared_*", .pairs = 500, .shared = either}));
  EXPECT_FALSE(passes(never, {.strata = "shared_*", .pairs = 500, .touching = required}));

  // The limit is exact: one wrong answer in ten thousand passes at 1e-4 and fails at 0.9e-4.
  int calls = 0;
  const auto once_wrong = [&calls](const float* a, const float* b) {
    return exact::intersects(a, b) != (++calls == 77);
  };
  EXPECT_TRUE(passes(once_wrong, {.pairs = 10'000, .max_wrong = 1e-4}));
  calls = 0;
  EXPECT_FALSE(passes(once_wrong, {.pairs = 10'000, .max_wrong = 0.9e-4}));
}

TEST(TestOverlap, TellsWhatItCannotTest) {
  const auto message = [](const auto& f, const TestOptions& options) {
    const TestResult result = test_overlap("f", overlap_of(f), options);
    EXPECT_FALSE(result.passed);
    return result.message;
  };
  EXPECT_EQ(message(declines, {.pairs = 100}), "f declines every pair\n");
  EXPECT_EQ(message(right, {.pairs = 0}), "f: no pairs requested\n");
  EXPECT_NE(message(right, {.strata = "nonesuch"}).find("nonesuch"), std::string::npos);
  EXPECT_NE(message(right, {.max_wrong = -1}).find("max_wrong"), std::string::npos);
  EXPECT_NE(message(right, {.max_wrong = std::nan("")}).find("max_wrong"), std::string::npos);
  EXPECT_NE(message(throws, {.strata = "uniform", .pairs = 500}).find("it throws, but the triangles meet"),
            std::string::npos);
  setenv("GRAZE_PAIRS", "ten", 1);
  EXPECT_NE(message(right, {}).find("GRAZE_PAIRS: 'ten'"), std::string::npos);
  setenv("GRAZE_PAIRS", "1234", 1);
  setenv("GRAZE_SEED", "9", 1);
  std::vector<Pair> asked;
  const auto keeps = [&asked](const float* a, const float* b) {
    Pair& pair = asked.emplace_back();
    std::memcpy(&pair.a, a, sizeof pair.a);
    std::memcpy(&pair.b, b, sizeof pair.b);
    return exact::intersects(a, b);
  };
  EXPECT_TRUE(test_overlap("f", overlap_of(std::ref(keeps)), {.strata = "thesis"}).passed);
  unsetenv("GRAZE_PAIRS");
  unsetenv("GRAZE_SEED");
  const std::vector<Pair> expected = pairs_of("thesis", 9, 1234);
  ASSERT_EQ(asked.size(), expected.size());
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_TRUE(same_bits(asked[i], expected[i])) << i;
}

}  // namespace
}  // namespace graze
