// SPDX-License-Identifier: Apache-2.0
// Bounds of margins are as far apart as the errors that their comments derive, alone and in vectors of every instruction
// set: one that left out a rounding would be right on all pairs that a test can draw, and one too many shows nowhere.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/margin/margin.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/margin_blocks/bounds.test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/exact/exact.h"

HWY_BEFORE_NAMESPACE();
namespace graze::bounds_test {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace detail = exact::detail;

#if HWY_MAX_BYTES >= 32 && !HWY_HAVE_SCALABLE
#include "core/exact_blocks/vectors-inl.h"
#include "core/margin_blocks/bounds-inl.h"

HWY_ATTR bool in_vectors(const Pair& pair, Verdict verdict, double& lo, double& hi) {
  const float* where[kAtOnce];
  for (const float*& at : where) at = &pair.a[0].x;
  const Frame frame{Coordinates(where)};
  const Bounds bounds = verdict == Verdict::disjoint ? distance_bounds(frame) : squared_depth_bounds(frame);
  lo = hn::GetLane(bounds.lo);
  hi = hn::GetLane(bounds.hi);
  return true;
}

#else

bool in_vectors(const Pair&, Verdict, double&, double&) { return false; }

#endif

}  // namespace HWY_NAMESPACE
}  // namespace graze::bounds_test
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace graze {
namespace bounds_test {
namespace {

HWY_EXPORT(in_vectors);

// A margin of 1. How large the terms are that the connection of disjoint triangles is summed from: see distance_bounds.
struct Unit {
  const char* what;
  Verdict verdict;
  Pair pair;
  double terms;
};

constexpr Verdict kApart = Verdict::disjoint, kMeet = Verdict::intersects;
const Unit kUnits[] = {
    {"vertices", kApart, {{{0, 0, 0}, {-1, 2, 0}, {-1, 0, 2}}, {{1, 0, 0}, {2, 2, 0}, {2, 0, 2}}}, 1},
    {"a's edge", kApart, {{{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}, {{0, 0, 1}, {1, 3, 4}, {-1, 2, 4}}}, 2 + 1},
    {"b's edge", kApart, {{{0, 0, 1}, {1, 3, 4}, {-1, 2, 4}}, {{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}}, 2 + 1},
    {"edges", kApart, {{{-1, 0, 0}, {1, 0, 0}, {0, 2, -2}}, {{0, -1, 1}, {0, 1, 1}, {0, 0, 4}}}, 3 + 1 + 1},
    {"a's face", kApart, {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 1}, {2, 3, 4}, {3, 2, 4}}}, 3 + 1 + 1},
    {"b's face", kApart, {{{1, 1, 1}, {2, 3, 4}, {3, 2, 4}}, {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, 3 + 1 + 1},
    {"depth by a's face", kMeet, {{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {{0, 0, -1}, {2, 1, 7}, {-1, 2, 8}}}, 0},
    {"depth by b's face", kMeet, {{{0, 0, -1}, {2, 1, 7}, {-1, 2, 8}}, {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}}, 0},
    {"depth by edges", kMeet, {{{-9, 0, 0}, {9, 0, 0}, {0, 0, -9}}, {{0, -9, -1}, {0, 9, -1}, {0, 0, 9}}}, 0},
};

// In units of kHalfUlp; bounds above 1 are even numbers of it.
void expect_distance_bounds(double lo, double hi, double terms) {
  EXPECT_EQ((1 - lo) / kHalfUlp, 6 + 8);
  EXPECT_EQ((hi - 1) / kHalfUlp, 8 + 8 * terms);
}

TEST(MarginBounds, AreAsFarApartAsTheErrorsDerived) {
  for (const Unit& unit : kUnits) {
    SCOPED_TRACE(unit.what);
    const auto [lo, hi, direction, axes] = margin_bounds(unit.pair, unit.verdict);
    if (unit.verdict == kApart) {
      expect_distance_bounds(lo, hi, unit.terms);
    } else {  // an overlap and a length, and a last rounding
      EXPECT_EQ((1 - lo) / kHalfUlp, 12 + 12 + 8 + 1);
      EXPECT_EQ((hi - 1) / kHalfUlp, 12 + 12 + 8 + 2);
    }
  }
}

TEST(MarginBounds, AreAsFarApartInVectors) {
  hwy::SetSupportedTargetsForTest(0);
  for (std::int64_t all = hwy::SupportedTargets() & HWY_TARGETS; all != 0; all &= all - 1) {
    hwy::SetSupportedTargetsForTest(all & -all);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    for (const Unit& unit : kUnits) {
      SCOPED_TRACE(std::string(unit.what) + " by " + hwy::TargetName(all & -all));
      double lo, hi;
      if (!HWY_DYNAMIC_DISPATCH(in_vectors)(unit.pair, unit.verdict, lo, hi)) continue;
      if (unit.verdict == kApart) {
        expect_distance_bounds(lo, hi, unit.terms);
      } else {  // squares
        EXPECT_EQ((1 - lo) / kHalfUlp, 2 * 12 + 32 + 1);
        EXPECT_EQ((hi - 1) / kHalfUlp, 2 * 12 + 32 + 2);
      }
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

}  // namespace
}  // namespace bounds_test
}  // namespace graze
#endif
