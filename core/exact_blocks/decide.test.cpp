// SPDX-License-Identifier: Apache-2.0
// Pairs in a block must get the same verdicts as each pair alone, with every instruction set of this processor.
// analysis/truth_over_strata.test.cpp compares the decision with the oracle in every stratum.
#include "core/exact_blocks/decide.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/every_target_testing.h"
#include "core/exact/exact.h"

namespace graze::exact {
namespace {

// Checks both bits of every pair, and zeros after the last pair.
template <class Real>
void expect_as_each_alone(const std::vector<Real>& pairs, const std::string& what = "") {
  const std::size_t count = pairs.size() / 18, words = (count + 63) / 64;
  std::vector<std::uint64_t> yes(words + 1, ~0ull), declined(words + 1, ~0ull);
  decide(pairs.data(), count, yes.data(), declined.data());
  for (std::size_t i = 0; i < words * 64; ++i) {
    bool finite = i < count, meet = false;
    for (std::size_t c = 0; finite && c < 18; ++c) finite = std::isfinite(pairs[18 * i + c]);
    if (finite) meet = intersects(&pairs[18 * i], &pairs[18 * i + 9]);
    ASSERT_EQ(yes[i / 64] >> i % 64 & 1, meet) << what << ", pair " << i << " of " << count;
    ASSERT_EQ(declined[i / 64] >> i % 64 & 1, i < count && !finite) << what << ", pair " << i << " of " << count;
  }
  EXPECT_EQ(yes[words] & declined[words], ~0ull) << "wrote past the end";
}

template <class Real = float>
std::vector<Real> drawn(std::size_t pairs, auto coordinate) {
  std::vector<Real> all(18 * pairs);
  for (Real& x : all) x = coordinate();
  return all;
}

// Near contacts of a vertex and a face, of two edges, and of coplanar triangles. Gaps and depths get smaller and
// smaller, so pairs need grids of all sizes.
template <class Real>
std::vector<Real> near_contacts() {
  std::vector<Real> all;
  for (int exponent = 0; exponent >= -90; --exponent) {
    for (const Real sign : {Real(1), Real(0), Real(-1)}) {
      const Real h = std::ldexp(sign, exponent);
      for (const auto& pair : {std::array<Real, 18>{-1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 0, h, 1, 0, 1, 0, 1, 1},
                               std::array<Real, 18>{-1, 0, 0, 1, 0, 0, 0, 0, -1, 0, -1, h, 0, 1, h, 0, 0, 1},
                               std::array<Real, 18>{-1, -1, 0, 0, -1, 0, 0, 1, 0, h, 0, 0, 1, 1, 0, 1, -1, 0}})
        all.insert(all.end(), pair.begin(), pair.end());
    }
  }
  return all;
}

// 1,024 pairs with a vertex on a face and one coordinate of the given size: all pairs of a chunk wait for the same
// step.
std::vector<float> contacts(int exponent) {
  const float pair[18] = {-1, -1, 0, 1, -1, 0, 0, 1, 0, 0, 0, 0, 1, 0, std::ldexp(1.0f, exponent), 0, 1, 1};
  std::size_t next = 0;
  return drawn(1024, [&] { return pair[next++ % 18]; });
}

TEST(ExactBlocks, AreDecidedAsEachPairAloneOnEveryTarget) {
  std::mt19937_64 random(7);
  const auto whole = [&](int bits) {
    return static_cast<float>(static_cast<std::int64_t>(random() >> (63 - bits)) - (std::int64_t{1} << bits));
  };
  const auto vertices_again = [&](auto all) {  // makes some vertices of b equal to vertices of a
    for (std::size_t pair = 0; pair < all.size(); pair += 18) {
      for (std::size_t v = 9; v < 18; v += 3) {
        if (random() % 3 == 0) std::copy_n(&all[pair + random() % 3 * 3], 3, &all[pair + v]);
      }
      if (random() % 4 == 0) {
        for (std::size_t v = 2; v < 18; v += 3) all[pair + v] = all[pair + 2];  // both triangles in one plane
      }
      if (random() % 8 == 0) std::copy_n(&all[pair + 3], 3, &all[pair + 6]);  // a segment
    }
    return all;
  };
  const std::vector<std::pair<std::string, std::vector<float>>> kinds = {
      {"general", drawn(5000, [&] { return static_cast<float>(random() % 2000) / 7; })},
      {"small lattice", drawn(20000, [&] { return whole(2); })},
      {"lattice that doubles hold", vertices_again(drawn(5000, [&] { return whole(13); }))},
      {"24 bits", vertices_again(drawn(5000, [&] { return whole(23); }))},
      {"about 34 bits",
       vertices_again(drawn(5000, [&] { return std::ldexp(whole(23), static_cast<int>(random() % 12)); }))},
      {"wider", vertices_again(drawn(2000, [&] { return std::ldexp(whole(23), static_cast<int>(random() % 60)); }))},
      {"near the smallest", vertices_again(drawn(2000, [&] { return std::ldexp(whole(5), -149); }))},
      {"near the largest", vertices_again(drawn(2000, [&] { return std::ldexp(whole(20), 106); }))},
      {"near contacts", near_contacts<float>()},
      {"contacts alone, in few bits", contacts(0)},
      {"contacts alone, in 31 bits", contacts(-30)},
      {"contacts alone, in 61 bits", contacts(-60)},
      {"any bits", drawn(5000,
                         [&] {
                           const auto bits = static_cast<std::uint32_t>(random());
                           float x;
                           std::memcpy(&x, &bits, sizeof x);
                           return x;
                         })},
  };
  const auto of_bits = [&](int bits) {
    return static_cast<double>(static_cast<std::int64_t>(random() >> (64 - bits)));
  };
  const auto scaled = [&](int bits, int exponent) {
    return vertices_again(drawn<double>(3000, [&] { return std::ldexp(of_bits(bits), exponent); }));
  };
  const std::vector<std::pair<std::string, std::vector<double>>> of_doubles = {
      {"general", drawn<double>(5000, [&] { return static_cast<double>(random() % 2000) / 7; })},
      {"small lattice", drawn<double>(20000, [&] { return of_bits(2); })},
      {"14 bits", scaled(14, 0)},
      {"33 bits", scaled(33, -20)},
      {"53 bits", scaled(53, 3)},
      {"the smallest", scaled(12, -1074)},
      {"below 2^-900", scaled(12, -1000)},
      {"beyond 2^300", scaled(20, 320)},
      {"the largest", scaled(20, 1003)},
      {"small beside large",
       vertices_again(drawn<double>(3000, [&] { return std::ldexp(of_bits(3), random() % 2 ? 900 : -1060); }))},
      {"near contacts", near_contacts<double>()},
      {"any bits", drawn<double>(5000,
                                 [&] {
                                   const std::uint64_t bits = random();
                                   double x;
                                   std::memcpy(&x, &bits, sizeof x);
                                   return x;
                                 })},
  };
  std::set<std::string> names;
  on_every_target([&] {
    names.insert(decide_target());
    for (const auto& [kind, pairs] : kinds) expect_as_each_alone(pairs, kind);
    for (const auto& [kind, pairs] : of_doubles) expect_as_each_alone(pairs, "doubles, " + kind);
  });
  EXPECT_TRUE(names.contains("scalar") || names.size() > 1) << "only one way of computing was tested";
  std::string all;
  for (const std::string& name : names) all += name + ' ';
  RecordProperty("targets", all);
}

TEST(ExactBlocks, AreOfAnySizeAndDeclineWhatIsNotFinite) {
  std::mt19937 random(8);
  const auto with_some_not_finite = [&]<class Real>(std::vector<Real> all) {
    for (std::size_t i = 0; i < all.size(); i += 18 * 5 + 7)
      all[i] = i % 2 == 0 ? std::numeric_limits<Real>::infinity() : std::numeric_limits<Real>::quiet_NaN();
    return all;
  };
  const auto digit = [&] { return static_cast<float>(random() % 9); };
  const std::vector<float> pairs = with_some_not_finite(drawn(1100, digit));
  const std::vector<double> doubles = with_some_not_finite(drawn<double>(600, digit));
  on_every_target([&] {
    for (std::ptrdiff_t count = 0; count <= 140; ++count)
      expect_as_each_alone<float>({pairs.begin(), pairs.begin() + 18 * count});
    for (const std::ptrdiff_t count : {1, 3, 8, 9, 64, 255, 256, 257, 511, 512, 513, 600})
      expect_as_each_alone<double>({doubles.begin(), doubles.begin() + 18 * count});
    for (const std::ptrdiff_t count : {511, 512, 513, 1023, 1100})
      expect_as_each_alone<float>({pairs.begin(), pairs.begin() + 18 * count});
  });
}

}  // namespace
}  // namespace graze::exact
