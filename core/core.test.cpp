// SPDX-License-Identifier: Apache-2.0
// Tests all host lanes on hand-made examples and invariants. Also tests the algorithms with other scalars and policies.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <set>

#include "core/algorithms/algorithms.h"
#include "core/counts.h"
#include "core/judged_bits.h"
#include "core/lanes/lanes.h"
#include "core/margin/axis.h"
#include "core/margin/bucket.h"

namespace graze {
namespace {

std::vector<const Lane*> host_lanes() {
  std::vector<const Lane*> host;
  for (const Lane& lane : lanes()) {
    if (!lane.is_cuda() && runs_on_this_cpu(lane)) host.push_back(&lane);
  }
  return host;
}

struct Example {
  const char* what;
  Pair pair;
  Verdict truth;
  bool projection_overlaps = false;  // the projections along some normal overlap, so projected_sat is wrong
};

constexpr Verdict kYes = Verdict::intersects, kNo = Verdict::disjoint;

// Proper triangles with small integers. Every algorithm must be right in any arithmetic (see also projection_overlaps).
const Example kExamples[] = {
    {"apart, all of b above a", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 1}, {4, 0, 2}, {0, 4, 3}}}, kNo},
    {"apart, all of a beside b's plane", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{5, 0, -1}, {6, 0, 1}, {6, 4, 1}}}, kNo},
    {"parallel planes", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 2}, {4, 0, 2}, {0, 4, 2}}}, kNo},
    {"b pierces a", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}}, kYes},
    {"a pierces b", {{{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}, {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, kYes},
    {"edges hook into each other", {{{0, 0, 0}, {4, 0, 0}, {2, 4, 0}}, {{2, -2, -2}, {2, 2, 2}, {2, -2, 4}}}, kYes},
    {"a vertex touches the face", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 2, 4}, {2, 1, 4}}}, kYes},
    {"a vertex touches a vertex", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 0}, {-1, -1, 4}, {-2, -1, 4}}}, kYes},
    {"an edge lies in the face", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {2, 1, 0}, {1, 1, 4}}}, kYes},
    {"an edge in the plane, beside", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{4, 4, 0}, {5, 4, 0}, {4, 4, 4}}}, kNo, true},
    {"coplanar, overlapping", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}}, kYes},
    {"coplanar, b inside a", {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}}, kYes},
    {"coplanar, a inside b", {{{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}, {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}}, kYes},
    {"coplanar, apart", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{5, 5, 0}, {9, 5, 0}, {5, 9, 0}}}, kNo},
    {"coplanar, apart by the hypotenuse", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{3, 3, 0}, {4, 3, 0}, {3, 4, 0}}}, kNo},
    {"coplanar, equal", {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}}, kYes},
    {"coplanar in x = 1", {{{1, 0, 0}, {1, 4, 0}, {1, 0, 4}}, {{1, 1, 1}, {1, 5, 1}, {1, 1, 5}}}, kYes},
    {"coplanar in y = 1, apart", {{{0, 1, 0}, {4, 1, 0}, {0, 1, 4}}, {{5, 1, 5}, {9, 1, 5}, {5, 1, 9}}}, kNo},
};

class EveryHostLane : public testing::TestWithParam<const Lane*> {};

TEST_P(EveryHostLane, IsRightOnHandExamplesInAllOrders) {
  // -ffast-math assumes that no value is NaN, so interval_overlap is wrong on pairs for which it divides 0 by 0.
  if (info_of(GetParam()->variant).arithmetic == Arithmetic::fast) GTEST_SKIP() << "fast math promises nothing";
  for (const Example& example : kExamples) {
    if (example.projection_overlaps && GetParam()->info->id == "projected_sat") continue;
    for (int order = 0; order < 72; ++order) {
      constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
      const int* p = kOrders[order % 6];
      const int* q = kOrders[order / 6 % 6];
      const auto& first = order < 36 ? example.pair.a : example.pair.b;
      const auto& second = order < 36 ? example.pair.b : example.pair.a;
      const Pair pair{{first[p[0]], first[p[1]], first[p[2]]}, {second[q[0]], second[q[1]], second[q[2]]}};
      EXPECT_EQ(name(decide_one(GetParam()->decide, pair)), name(example.truth)) << example.what << ", order " << order;
    }
  }
}

// Multiplication by a power of two is exact, so no verdict may change. (No value over- or underflows here.)
TEST_P(EveryHostLane, DoesNotSeePowersOfTwo) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    Pair pair, scaled;
    for (int c = 0; c < kCoordinates; ++c) {
      coordinates(pair)[c] = uniform(random) * (c % 3 == 2 ? 0x1p-20f : 1.0f);
      coordinates(scaled)[c] = coordinates(pair)[c] * 4;
    }
    EXPECT_EQ(decide_one(GetParam()->decide, pair), decide_one(GetParam()->decide, scaled)) << "pair " << i;
  }
}

TEST_P(EveryHostLane, WritesOneBitAPairAndZeroesTheRest) {
  const Pair yes = kExamples[3].pair, no = kExamples[0].pair;
  std::vector<Pair> pairs(70, no);
  pairs[2] = pairs[69] = yes;
  std::uint64_t intersects[2] = {~0ull, ~0ull}, declined[2] = {~0ull, ~0ull};
  GetParam()->decide(pairs.data(), pairs.size(), intersects, declined);
  EXPECT_EQ(intersects[0], 4u);
  EXPECT_EQ(intersects[1], 32u);
  EXPECT_EQ(declined[0] | declined[1], 0u);
}

INSTANTIATE_TEST_SUITE_P(Lanes, EveryHostLane, testing::ValuesIn(host_lanes()), [](const auto& row) {
  std::string id = row.param->id;
  for (char& c : id) c = c == '/' || c == '-' ? '_' : c;
  return id;
});

// Converts to float32 and back in one function, as callers do; GCC 12 may miscompile that (see stored_in_float32).
TEST(Pair, StoringInFloat32RoundsEveryNumber) {
  for (int n = 1; n < 100; ++n) {
    DoublePair pair;
    for (int i = 0; i < kCoordinates; ++i) coordinates(pair)[i] = 0.1 * (i + n);
    const DoublePair stored = in_doubles(stored_in_float32(pair));
    for (int i = 0; i < kCoordinates; ++i)
      ASSERT_EQ(coordinates(stored)[i], static_cast<double>(static_cast<float>(coordinates(pair)[i]))) << n << ' ' << i;
  }
}

TEST(LaneTable, IsTheProductOfAlgorithmsScalarsAndVariantsAndTheExactLanes) {
  std::set<std::string> ids;
  for (const Lane& lane : lanes()) {
    ids.insert(lane.id);
    EXPECT_EQ(find_lane(lane.id), &lane);
    EXPECT_EQ(id_of(lane.lane_name()), lane.id);
    EXPECT_EQ(parse_lane_name(lane.id), lane.lane_name());
    EXPECT_NE(static_cast<bool>(lane.decide), lane.is_cuda()) << lane.id;
  }
  const auto built = std::count_if(std::begin(kVariants), std::end(kVariants), builds_published);
  EXPECT_EQ(built, 6);
  EXPECT_EQ(ids.size(), static_cast<std::size_t>(kAlgorithmCount * 2 * built) + 4);
  EXPECT_TRUE(ids.contains("exact/f32/cuda"));
  EXPECT_TRUE(ids.contains("exact/f64/cuda"));
  EXPECT_TRUE(ids.contains("moller_1997/f32/cuda-fma"));
  EXPECT_TRUE(matches_any({"*/f32/*", "x"}, "moller_1997/f32/cpu"));
  EXPECT_FALSE(matches_any({"*/f64/*"}, "moller_1997/f32/cpu"));
  EXPECT_FALSE(matches_any({"*/f32/*", "!moller*"}, "moller_1997/f32/cpu"));
  EXPECT_FALSE(matches_any({"!*/cpu"}, "moller_1997/f32/cpu"));
  EXPECT_TRUE(matches_any({"!*/cuda"}, "moller_1997/f32/cpu"));
}

TEST(LaneNames, AreReadBackWithTheirPolicies) {
  for (const char* id :
       {"moller_1997/f32/cpu", "mine/f64/cuda-fma/plane_distance=abs:1e-6,orientation=rel:16", "a/b/c/d/e"}) {
    const std::optional<LaneName> name = parse_lane_name(id);
    ASSERT_TRUE(name) << id;
    EXPECT_EQ(id_of(*name), id);
  }
  EXPECT_EQ(parse_lane_name("a/b/c/d/e")->policy, "d/e");
  for (const char* id : {"", "a", "a/b", "a//c", "/b/c", "a/b/", "a/b/c/"}) EXPECT_FALSE(parse_lane_name(id)) << id;
}

TEST(LaneTable, CounterpartsDifferInTheVariantAlone) {
  const Lane& lane = *find_lane("moller_1997/f64/cuda-fma");
  EXPECT_EQ(counterpart(lane, Variant::cpu)->id, "moller_1997/f64/cpu");
  EXPECT_EQ(counterpart(lane, rounded_variant(lane.variant))->id, "moller_1997/f64/cuda-nofma");
  EXPECT_EQ(counterpart(*find_lane("exact/f32/cpu"), Variant::cpu_fma), nullptr);
}

// -ffast-math must not reach the linker: it would make the whole process flush subnormal numbers to zero.
TEST(Variants, NoneSwitchesAModeOfTheProcess) {
  volatile float least = std::numeric_limits<float>::denorm_min();
  const Pair pair = kExamples[0].pair;
  for (const Lane& lane : lanes()) {
    if (runs_on_this_cpu(lane)) decide_one(lane.decide, pair);
    ASSERT_GT(least * 1.0f, 0.0f) << lane.id;
  }
}

TEST(Algorithms, IncludeNoOtherAlgorithm) {
  for (const Lane& lane : published_lanes()) {
    std::ifstream in(std::string(GRAZE_SOURCE_DIR "/core/algorithms/") + std::string(lane.info->id) + ".h");
    const std::string header{std::istreambuf_iterator<char>(in), {}};
    ASSERT_NE(header.find("#include \"core/algorithms/algorithm.h\""), header.npos) << lane.info->id;
    for (const Lane& other : published_lanes())
      EXPECT_EQ(header.find("algorithms/" + std::string(other.info->id) + ".h"), header.npos)
          << other.info->id << " in " << lane.info->id;
  }
}

// Figure 3.4 of the thesis: no plane test rejects the pair and the projections overlap, but the pair is disjoint.
TEST(ProjectedSat, HasTheFalsePositiveOfTheThesis) {
  const Pair pair{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{1, 1, 4}, {6, 6, 4}, {6, 6, -1}}};
  EXPECT_EQ((decide_widened<ProjectedSat, double>(pair)), kYes);
  EXPECT_EQ((decide_widened<IntervalOverlap, double>(pair)), kNo);
  EXPECT_EQ((decide_widened<Moller1997, double>(pair)), kNo);
}

// If any one coordinate is NaN, Moller's test returns `intersects`, because no comparison rejects the pair.
TEST(Moller1997, SaysIntersectsOfNaN) {
  for (int c = 0; c < kCoordinates; ++c) {
    Pair pair = kExamples[0].pair;
    coordinates(pair)[c] = std::nanf("");
    EXPECT_EQ((decide_widened<Moller1997, float>(pair)), kYes) << "coordinate " << c;
  }
}

template <class Real, class Algorithm>
void expect_right_in(const char* scalar) {
  for (const Example& example : kExamples) {
    EXPECT_EQ((decide_widened<Algorithm, Real>(example.pair)), example.truth)
        << example.what << " in " << scalar << " by " << Algorithm::kInfo.id;
  }
}

TEST(Scalars, TheSameSourceRunsOnRationalsAndMultiprecision) {
  namespace mp = boost::multiprecision;
  using Rational = mp::number<mp::cpp_rational_backend, mp::et_off>;
  using Multiprecision = mp::number<mp::mpfr_float_backend<60>, mp::et_off>;
  expect_right_in<Rational, Moller1997>("rationals");
  expect_right_in<Rational, GuigueDevillers2003>("rationals");
  expect_right_in<Rational, SeparatingAxes>("rationals");
  expect_right_in<Multiprecision, ProjectedSat>("MPFR numbers");
  expect_right_in<Multiprecision, IntervalOverlap>("MPFR numbers");
  expect_right_in<Multiprecision, Moller1997>("MPFR numbers");
}

// Counts the comparisons at each site, and treats small plane distances as zero.
struct CountingEpsilon {
  double epsilon;
  int* counts;

  double snap(Site site, double x) const {
    ++counts[static_cast<int>(site)];
    return site == Site::plane_distance && std::abs(x) < epsilon ? 0 : x;
  }
  bool less(Site site, double l, double r) const {
    ++counts[static_cast<int>(site)];
    return l < r;
  }
  bool at_most(Site site, double l, double r) const {
    ++counts[static_cast<int>(site)];
    return l <= r;
  }
};

template <class Algorithm>
void expect_policy_decides(std::initializer_list<Site> sites) {
  const Vec3<double> a[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, b[3] = {{1, 1, 1e-9}, {1, 2, 4}, {2, 1, 4}};
  int counts[4] = {};
  EXPECT_EQ(Algorithm::decide(a, b, CountingEpsilon{0, counts}), kNo) << Algorithm::kInfo.id;
  EXPECT_EQ(Algorithm::decide(a, b, CountingEpsilon{1e-6, counts}), kYes) << Algorithm::kInfo.id;
  for (const Site site : sites)
    EXPECT_GT(counts[static_cast<int>(site)], 0) << Algorithm::kInfo.id << ", site " << static_cast<int>(site);
}

// For every combination of bits, counting a word of pairs at once gives the same as counting verdicts one by one.
TEST(JudgedBits, AreTheCountsOfVerdicts) {
  for (const bool foreign : {false, true}) {
    std::uint32_t bits[4] = {};  // intersects, declined, truth, judged; bit i of word b is bit b of i
    for (std::uint32_t i = 0; i < 32; ++i) {
      for (std::uint32_t b = 0; b < 4; ++b) bits[b] |= (i >> b & 1) << i;
    }
    const auto judged = judge(bits[0], bits[1], bits[2], bits[3], foreign);
    for (std::uint32_t i = 0; i < 32; ++i) {
      const bool intersects = i & 1, declined = i & 2, counted = i & 8;
      const Verdict truth = i & 4 ? Verdict::intersects : Verdict::disjoint;
      const Verdict verdict =
          foreign && intersects && declined ? Verdict::crashed : verdict_of_bits(intersects, declined);
      Counts expected, found;
      if (counted && verdict != truth) ++expected.of(verdict);
      found.false_positive = judged.false_positive >> i & 1;
      found.false_negative = judged.false_negative >> i & 1;
      found.declined = judged.declined >> i & 1;
      found.crashed = judged.failed >> i & 1;
      EXPECT_EQ(found, expected) << i;
      EXPECT_EQ(judged.wrong() >> i & 1, counted && is_wrong(verdict, truth)) << i;
      EXPECT_EQ(judged.not_right() >> i & 1, counted && verdict != truth) << i;
    }
  }
}

TEST(Policy, AnEpsilonAtASiteChangesTheVerdict) {
  expect_policy_decides<ProjectedSat>({Site::plane_distance, Site::separation});
  expect_policy_decides<IntervalOverlap>({Site::plane_distance, Site::parallel, Site::separation});
  expect_policy_decides<Moller1997>({Site::plane_distance, Site::separation});
  expect_policy_decides<GuigueDevillers2003>({Site::plane_distance, Site::orientation});
}

TEST(Bucket, IsTheSignAndTheBinaryLogarithm) {
  EXPECT_EQ(name_of_bucket(0), "0");
  EXPECT_EQ(name_of_bucket(make_bucket(1, 5)), "+2^5");
  EXPECT_EQ(name_of_bucket(make_bucket(-1, -3)), "-2^-3");
  EXPECT_EQ(make_bucket(1, -400), make_bucket(1, kBucketLowest));
  EXPECT_EQ(make_bucket(-1, 400), -kBucketMost);
  Pair pair{};
  EXPECT_EQ(log2_ulp(pair), -149);
  pair.b[1].y = -1.5f;
  EXPECT_EQ(log2_ulp(pair), -23);
  pair.a[0].x = 0x1.fffffep127f;
  EXPECT_EQ(log2_ulp(pair), 104);
}

TEST(Extreme, OfDoublesIsTheScaleInStepsOf32) {
  DoublePair pair{};
  const auto exponent = [&] { return exponent_of(Axis::wide_scale, place_on_axis(pair, Axis::wide_scale)); };
  EXPECT_EQ(exponent(), -1024);
  pair.a[1].z = -0x1p-1074;
  EXPECT_EQ(exponent(), -1024);
  for (const int k : {-992, -32, 0, 32, 992}) {
    pair.a[1].z = std::ldexp(-1.5, k);
    EXPECT_EQ(exponent(), k);
    pair.a[1].z = std::ldexp(0.75, k);
    EXPECT_EQ(exponent(), k - 32);
  }
  pair.a[1].z = 0x1.fffffffffffffp1023;
  EXPECT_EQ(exponent(), 992);
  EXPECT_EQ(place_on_axis(pair, Axis::offset), 0);
  pair.b[1].z = -0x1.fffffffffffffp1023;  // the box is larger than the largest double
  EXPECT_EQ(place_on_axis(pair, Axis::offset), -kBucketMost);
}

TEST(Extreme, IsTheScaleInStepsOfFourOrTheOffsetInSizes) {
  Pair pair{};
  EXPECT_EQ(exponent_of(Axis::scale, place_on_axis(pair, Axis::scale)), -152);
  EXPECT_EQ(place_on_axis(pair, Axis::offset), kBucketMost);  // a point has no size
  pair.b[1].y = -0x1p-149f;
  EXPECT_EQ(exponent_of(Axis::scale, place_on_axis(pair, Axis::scale)), -152);
  EXPECT_EQ(place_on_axis(pair, Axis::offset), 0);
  pair.a[2].y = 0x1p-149f;
  EXPECT_EQ(place_on_axis(pair, Axis::offset), -1);
  pair.b[1].y = -0x1p-148f;
  EXPECT_EQ(exponent_of(Axis::scale, place_on_axis(pair, Axis::scale)), -148);
  pair.a[0].x = 0x1.fffffep127f;
  EXPECT_EQ(exponent_of(Axis::scale, place_on_axis(pair, Axis::scale)), 124);
  for (int i = 0; i < kCoordinates; i += 3) coordinates(pair)[i] = 1000;
  coordinates(pair)[0] = 1001;
  EXPECT_EQ(place_on_axis(pair, Axis::offset), 9);
  EXPECT_EQ(exponent_of(Axis::scale, place_on_axis(pair, Axis::scale)), 8);
  for (int i = 0; i < kCoordinates; i += 3) coordinates(pair)[i] = 0x1p100f;
  EXPECT_EQ(place_on_axis(pair, Axis::offset), kBucketMost);  // the box has a size of 1.5 * 2^-148
  EXPECT_EQ(place_on_axis(pair, Axis::none), 0);
}

}  // namespace
}  // namespace graze
