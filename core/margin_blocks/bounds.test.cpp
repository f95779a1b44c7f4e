// SPDX-License-Identifier: Apache-2.0
// The bounds on margins must be exactly as wide as their comments derive, in scalar code and for every instruction set.
// Random pairs would not reveal a bound that counts one rounding too few or too many.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/margin/margin.h"
#include "core/margin_blocks/buckets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/margin_blocks/bounds.test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/every_target_testing.h"
#include "core/exact/exact.h"

HWY_BEFORE_NAMESPACE();
namespace graze::bounds_test {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace detail = exact::detail;

#if HWY_MAX_BYTES >= 32 && !HWY_HAVE_SCALABLE
#include "core/exact_blocks/vectors-inl.h"
#include "core/margin_blocks/bounds-inl.h"

// Bounds on a distance or on a squared depth, and whether all differences of coordinates are exact.
HWY_ATTR bool in_vectors(const Pair& pair, Verdict verdict, MarginBounds& found, bool& exact) {
  const float* where[kAtOnce];
  for (const float*& at : where) at = &pair.a[0].x;
  const Frame frame{Coordinates(where)};
  const Bounds bounds = verdict == Verdict::disjoint ? distance_bounds(frame) : squared_depth_bounds(frame);
  found = {hn::GetLane(bounds.lo), hn::GetLane(bounds.hi), 0, 0};
  exact = (bits(frame.exact) & 1) != 0;
  return true;
}

#else

bool in_vectors(const Pair&, Verdict, MarginBounds&, bool&) { return false; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace graze::bounds_test
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graze {
namespace bounds_test {
namespace {

HWY_EXPORT(in_vectors);

// Calls check(bounds, exact) with the bounds from each instruction set of this processor that supports these vectors.
template <class Check>
void on_every_target(const Pair& pair, Verdict verdict, const Check& check) {
  graze::on_every_target([&] {
    MarginBounds bounds;
    bool exact;
    if (HWY_DYNAMIC_DISPATCH(in_vectors)(pair, verdict, bounds, exact)) check(bounds, exact);
  });
}

constexpr Verdict kApart = Verdict::disjoint, kMeet = Verdict::intersects;

// A pair with margin 1, and the sum of its terms' magnitudes as distance.h and depth.h define it.
struct Unit {
  const char* what;
  Verdict verdict;
  Pair pair;
  double terms;
};

const Unit kUnits[] = {
    {"vertices", kApart, {{{0, 0, 0}, {-1, 2, 0}, {-1, 0, 2}}, {{1, 0, 0}, {2, 2, 0}, {2, 0, 2}}}, 1},
    {"a's edge", kApart, {{{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}, {{0, 0, 1}, {1, 3, 4}, {-1, 2, 4}}}, 2 + 1},
    {"b's edge", kApart, {{{0, 0, 1}, {1, 3, 4}, {-1, 2, 4}}, {{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}}, 2 + 1},
    {"edges", kApart, {{{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}, {{0, -1, 1}, {0, 1, 1}, {0, 0, 4}}}, 3 + 1 + 1},
    {"a's face", kApart, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 1}, {2, 3, 4}, {3, 2, 4}}}, 3 + 1 + 1},
    {"b's face", kApart, {{{1, 1, 1}, {2, 3, 4}, {3, 2, 4}}, {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, 3 + 1 + 1},
    {"depth by a's face", kMeet, {{{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}, {{0, 0, -1}, {2, 1, 7}, {-1, 2, 8}}}, 1},
    {"depth by b's face", kMeet, {{{0, 0, -1}, {2, 1, 7}, {-1, 2, 8}}, {{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}}, 1},
    {"depth by edges", kMeet, {{{-8, 0, 0}, {8, 0, 0}, {0, 0, -8}}, {{0, -8, -1}, {0, 8, -1}, {0, 0, 7}}}, 1},
};

// below and above: distances from 1 in units of kHalfUlp. For a depth, both the overlap (or its square) and the axis
// have an error.
void expect_bounds(double lo, double hi, double below, double above) {
  EXPECT_EQ((1 - lo) / kHalfUlp, below);
  EXPECT_EQ((hi - 1) / kHalfUlp, above);
}

TEST(MarginBounds, AreAsFarApartAsTheErrorsDerived) {
  for (const Unit& unit : kUnits) {
    SCOPED_TRACE(unit.what);
    const bool apart = unit.verdict == kApart;
    const MarginBounds bounds = margin_bounds(unit.pair, unit.verdict);
    expect_bounds(bounds.lo, bounds.hi, apart ? 6 + 8 : 12 + 12 + 8, apart ? 8 + 8 * unit.terms : 12 + 12 + 8);
    on_every_target(unit.pair, unit.verdict, [&](const MarginBounds& found, bool) {
      expect_bounds(found.lo, found.hi, apart ? 6 + 8 : 2 * 12 + 32, apart ? 8 + 8 * unit.terms : 2 * 12 + 32);
    });
  }
}

// A depth of 3 along (1, 2, 2): a vertex of b under a's face. The error comes from a's first vertex and b's lowest
// vertex.
TEST(MarginBounds, OfADepthAreSeenFromTheFirstVertexOfAFace) {
  const Vec3<float> face[3] = {{0, 0, 0}, {18, 9, -18}, {18, -18, 9}},
                    over[3] = {{7, -4, -4}, {49, 80, -10}, {48, -12, 78}};
  const double terms = (7 * 1 + 4 * 2 + 4 * 2) / 3.0 / 3;
  for (int first = 0; first < 3; ++first) {
    Pair pair, exchanged;
    for (int i = 0; i < 3; ++i)
      exchanged.b[i] = pair.a[i] = face[i], exchanged.a[i] = pair.b[i] = over[(first + i) % 3];
    for (const Pair& either : {pair, exchanged}) {
      SCOPED_TRACE(first);
      EXPECT_NEAR((1 - margin_bounds(either, kMeet).lo / 3) / kHalfUlp, 12 * terms + 12 + 8, 3);
      on_every_target(either, kMeet, [&](const MarginBounds& found, bool) {
        EXPECT_NEAR((1 - found.lo / 9) / kHalfUlp, 2 * 12 * terms + 32, 3);
      });
    }
  }
}

// The cross product of an edge of a with any edge of b points along z, like b's normal. The depth along z is 1, and
// is computed as 4 - 3.
TEST(MarginBounds, OfADepthCountTheErrorOfTheThirdVertex) {
  const Pair pair{{{-8, 0, -3}, {8, 0, -3}, {0, 0, 1}}, {{-8, -8, 0}, {8, -8, 0}, {0, 8, 0}}};
  const MarginBounds bounds = margin_bounds(pair, kMeet);
  expect_bounds(bounds.lo, bounds.hi, 12 * (4 + 3) + 12 + 8, 12 + 12 + 8);
  on_every_target(pair, kMeet, [](const MarginBounds& found, bool) {
    expect_bounds(found.lo, found.hi, 2 * 12 * (4 + 3) + 32, 2 * 12 + 32);
  });
}

TEST(MarginBounds, InVectorsKnowWhichDifferencesAreExact) {
  const auto expect_exact = [](float largest, float least, bool expected) {
    const Pair pair{{{0, 0, 0}, {largest, 0, 0}, {0, least, 0}}, {{0, 0, least}, {least, 0, least}, {0, least, least}}};
    on_every_target(pair, kApart,
                    [&](const MarginBounds&, bool exact) { EXPECT_EQ(exact, expected) << largest << least; });
  };
  expect_exact(0x1p27f, 1, true);
  expect_exact(0x1.000002p27f, 1, false);
  expect_exact(0x1p-99f, 0x1p-149f, true);
  expect_exact(0x1.000002p-99f, 0x1p-149f, false);
}

// The disjoint pair is coplanar; if it got the other pair's verdict, it would count as touching.
TEST(MarginBounds, InVectorsLeaveOtherPairsAlone) {
  const Pair pairs[] = {{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{5, 0, 0}, {9, 0, 0}, {5, 4, 0}}}, kUnits[6].pair};
  const std::uint64_t intersects = 2;
  Bucket buckets[2];
  margin_buckets(coordinates(pairs[0]), 2, &intersects, buckets);
  EXPECT_TRUE(buckets[0] == kOpenBucket || buckets[0] == make_bucket(1, -log2_ulp(pairs[0]))) << int{buckets[0]};
}

}  // namespace
}  // namespace bounds_test
}  // namespace graze
#endif
