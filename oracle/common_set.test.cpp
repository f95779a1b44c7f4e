// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::PairSource;
using Points = std::vector<Vec3<double>>;

Points sorted(Points points) {
  std::sort(points.begin(), points.end(),
            [](const auto& l, const auto& r) { return std::tie(l.x, l.y, l.z) < std::tie(r.x, r.y, r.z); });
  return points;
}

TEST(CommonSet, HasAsManyExtremePointsAsTheContactSaysInEitherOrder) {
  for (const oracle_test::Kind kind : oracle_test::kKinds) {
    PairSource source(kind, 7);
    int seen[4] = {};
    for (int n = 0; n < 1000; ++n) {
      const Pair pair = source.next();
      Pair swapped = pair;
      std::swap(swapped.a, swapped.b);
      const Points points = common_set(pair);
      const int contact = std::min<int>(static_cast<int>(points.size()), 3);
      ASSERT_EQ(static_cast<Contact>(contact), gmp_contact(pair)) << hex(pair);
      ASSERT_EQ(sorted(points), sorted(common_set(swapped))) << hex(pair);
      ++seen[contact];
    }
    EXPECT_GT(1000 - seen[0], 20) << "kind " << static_cast<int>(kind);
  }
}

TEST(CommonSet, OfCrossingTrianglesIsASegmentOfThePlanesLine) {
  const Pair pair{{{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}, {{1, 1, -5}, {1, 1, 5}, {1, 5, -5}}};
  EXPECT_EQ(sorted(common_set(pair)), (Points{{1, 1, 0}, {1, 3, 0}}));
  // The box is [0, 10] x [0, 10] x [-5, 5].
  EXPECT_EQ(sorted(planes_line(pair)), (Points{{1, -1, 0}, {1, 11, 0}}));
}

TEST(CommonSet, OfCoplanarTrianglesIsAPolygonInOrder) {
  const Pair pair{{{0, 0, 5}, {3, 0, 5}, {0, 3, 5}}, {{2, 2, 5}, {-1, 2, 5}, {2, -1, 5}}};
  const Points star = common_set(pair);
  ASSERT_EQ(star.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {  // every corner turns in the same direction
    const auto &p = star[i], &q = star[(i + 1) % 6], &r = star[(i + 2) % 6];
    EXPECT_GT((q.x - p.x) * (r.y - q.y) - (q.y - p.y) * (r.x - q.x), 0);
  }
  EXPECT_TRUE(planes_line(pair).empty());
}

TEST(CommonSet, HoldsForTheSmallestNumbers) {
  const float tiny = 0x1p-149f;
  const Pair pair{{{0, 0, 0}, {2 * tiny, 0, 0}, {0, 2 * tiny, 0}}, {{tiny, tiny, 0}, {tiny, tiny, tiny}, {0, 0, tiny}}};
  EXPECT_EQ(common_set(pair), (Points{{tiny, tiny, 0}}));
}

TEST(CommonSet, HoldsAtBothEndsOfTheDoubles) {
  const double tiny = 0x1p-1074, big = 0x1p1023;
  const DoublePair pair{{{0, 0, 0}, {big, 0, 0}, {0, big, 0}}, {{tiny, tiny, 0}, {tiny, tiny, big}, {0, 0, big}}};
  EXPECT_EQ(common_set(pair), (Points{{tiny, tiny, 0}}));
}

}  // namespace
}  // namespace graze::oracle
