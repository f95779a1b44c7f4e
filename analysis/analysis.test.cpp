// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "analysis/convention.h"
#include "analysis/signature.h"
#include "analysis/tally.h"
#include "core/algorithms/algorithms.h"

namespace graze::analysis {
namespace {

// 70 pairs, so that the second word is only partly used. Lane 0 is right; lane 1 is wrong on pairs 3 and 65, and
// declines 66.
struct Example {
  Bits truth{0xf0, 0x2}, right{0xf0, 0x2}, wrong{0xf8, 0x0}, none{0, 0}, declines{0, 0x4};
  std::vector<Bucket> buckets = std::vector<Bucket>(70, make_bucket(1, 5));
  std::vector<LaneVerdicts> verdicts{{right, none}, {wrong, declines}};
  JudgedBlock block{70, truth, buckets, verdicts};
  Example() {
    buckets[65] = 0;
    block.buckets = buckets;
  }
};

TEST(Tally, CountsErrorsByKindLaneAndBucket) {
  const Example example;
  Tally tally({-1, 0});
  tally.add(example.block);
  const Bucket far = make_bucket(1, 5);
  EXPECT_EQ(tally.pairs(far), 69u);
  EXPECT_EQ(tally.pairs(0), 1u);
  EXPECT_EQ(tally.intersects(far), 4u);
  EXPECT_EQ(tally.intersects(0), 1u);
  EXPECT_FALSE(tally.lane(0, far).any());
  EXPECT_EQ(tally.lane(1, far).false_positive, 1u);
  EXPECT_EQ(tally.lane(1, far).declined, 1u);
  EXPECT_EQ(tally.lane(1, 0).false_negative, 1u);
  EXPECT_EQ(tally.lane(1, far).differs_from_cpu, 2u);
  EXPECT_EQ(tally.lane(1, 0).differs_from_cpu, 1u);
}

TEST(Tally, SumsAreTheTallyOfTheUnion) {
  const Example example;
  Tally twice({-1, 0}), sum({-1, 0}), once({-1, 0});
  twice.add(example.block);
  twice.add(example.block);
  once.add(example.block);
  sum.add(once);
  sum.add(once);
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    EXPECT_EQ(sum.pairs(static_cast<Bucket>(b)), twice.pairs(static_cast<Bucket>(b)));
    EXPECT_EQ(sum.lane(1, static_cast<Bucket>(b)).false_positive, twice.lane(1, static_cast<Bucket>(b)).false_positive);
  }
}

// Tests block lengths for which the last word is full, partly used, or absent.
TEST(Tally, CountsEveryPairOfABlockOfAnyLength) {
  for (const std::size_t count :
       {std::size_t{1}, std::size_t{63}, std::size_t{64}, std::size_t{65}, std::size_t{128}, std::size_t{130}}) {
    Bits truth((count + 63) / 64), wrong = truth;
    for (std::size_t i = 0; i < count; ++i) wrong[i / 64] |= std::uint64_t{1} << i % 64;
    const Bits none(truth.size());
    const std::vector<Bucket> buckets(count, Bucket{0});
    const std::vector<LaneVerdicts> verdicts{{wrong, none}};
    Tally tally({-1});
    tally.add(JudgedBlock{count, truth, buckets, verdicts});
    EXPECT_EQ(tally.pairs(0), count);
    EXPECT_EQ(tally.lane(0, 0).false_positive, count);
  }
}

// If both bits of a pair are set (intersects and declined), foreign code failed on it. One bit alone is a verdict.
TEST(Tally, FailuresOfForeignCodeAreCountedAsWhatTheyAre) {
  struct Code : ForeignCode {
    void decide(const Pair*, std::size_t, std::uint64_t*, std::uint64_t*) override {}
    Verdict failure(const Pair&) override { return Verdict::timed_out; }
  } code;
  const DecideBlock decide(code);
  const std::vector<Pair> pairs(4);
  const Bits truth{0x0}, yes{0x3}, none{0x6};  // intersects, fails, declines, disjoint
  const std::vector<Bucket> buckets(4, Bucket{0});
  const std::vector<LaneVerdicts> verdicts{{yes, none, &decide, pairs.data()}};
  Tally tally({-1});
  tally.add(JudgedBlock{4, truth, buckets, verdicts});
  const LaneCounts& counts = tally.lane(0, 0);
  EXPECT_EQ(counts.false_positive, 1u);
  EXPECT_EQ(counts.timed_out, 1u);
  EXPECT_EQ(counts.declined, 1u);
  EXPECT_EQ(counts.wrong(), 2u);
}

TEST(Tally, AddsEveryLaneInEveryBucket) {
  Tally one({-1, 0}), sum({-1, 0});
  std::uint64_t n = 0;
  for (int l = 0; l < 2; ++l) {
    for (int b = -kBucketMost; b <= kBucketMost; ++b) one.add(static_cast<Bucket>(b), l, LaneCounts{{++n}, 0});
  }
  for (int b = -kBucketMost; b <= kBucketMost; ++b)
    one.add(static_cast<Bucket>(b), static_cast<std::uint64_t>(b + kBucketMost + 1), 1);
  sum.add(one);
  sum.add(one);
  n = 0;
  for (int l = 0; l < 2; ++l) {
    for (int b = -kBucketMost; b <= kBucketMost; ++b)
      EXPECT_EQ(sum.lane(l, static_cast<Bucket>(b)).false_positive, 2 * ++n);
  }
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    EXPECT_EQ(sum.pairs(static_cast<Bucket>(b)), 2 * static_cast<std::uint64_t>(b + kBucketMost + 1));
    EXPECT_EQ(sum.intersects(static_cast<Bucket>(b)), 2u);
  }
}

TEST(Signature, EachVerdictHasItsMark) {
  const std::pair<Verdict, char> wrong[] = {{Verdict::disjoint, '-'}, {Verdict::declined, '?'},
                                            {Verdict::crashed, '!'},  {Verdict::timed_out, '@'},
                                            {Verdict::unstable, '%'}, {Verdict::intersects, '.'}};
  for (const auto& [verdict, expected] : wrong) EXPECT_EQ(mark(verdict, Verdict::intersects), expected);
  EXPECT_EQ(mark(Verdict::intersects, Verdict::disjoint), '+');
  EXPECT_EQ(mark(Verdict::declined, Verdict::declined), '.');
}

std::vector<std::uint64_t> fields(const LaneCounts& c) {
  return {c.false_positive, c.false_negative, c.declined,      c.crashed,
          c.timed_out,      c.unstable,       c.by_convention, c.differs_from_cpu};
}

TEST(LaneCounts, EachAddsToItself) {
  const LaneCounts one{{1, 2, 4, 8, 16, 32, 64}, 128};
  LaneCounts sum = one;
  (sum += one) += one;
  EXPECT_EQ(fields(sum), (std::vector<std::uint64_t>{3, 6, 12, 24, 48, 96, 192, 384}));
  EXPECT_EQ(one.failed(), 8u + 16 + 32);
  EXPECT_EQ(one.wrong(), 1u + 2 + 8 + 16 + 32);
  EXPECT_EQ(one.not_right(), 1u + 2 + 4 + 8 + 16 + 32);
  for (std::size_t i = 0; i < 8; ++i) {
    std::uint64_t f[8] = {};
    f[i] = 1;
    const LaneCounts single{{f[0], f[1], f[2], f[3], f[4], f[5], f[6]}, f[7]};
    EXPECT_TRUE(single.any()) << i;
    EXPECT_EQ(single.any_foreign(), i >= 3 && i < 7) << i;
  }
  EXPECT_FALSE(LaneCounts{}.any() || LaneCounts{}.any_foreign());
}

TEST(LaneCounts, AVerdictThatIsNotTheTruthCountsByWhatItIs) {
  constexpr std::size_t kField[] = {1, 0, 2,
                                    3, 4, 5};  // counts of disjoint, intersects, declined, crashed, timed out, unstable
  for (int verdict = 0; verdict < 6; ++verdict) {
    LaneCounts counts;
    counts.of(static_cast<Verdict>(verdict)) += 3;
    EXPECT_EQ(counts.wrong(), verdict == static_cast<int>(Verdict::declined) ? 0u : 3u);
    EXPECT_EQ(counts.not_right(), 3u);
    std::vector<std::uint64_t> expected(8);
    expected[kField[verdict]] = 3;
    EXPECT_EQ(fields(counts), expected) << verdict;
  }
}

TEST(Tally, StoredCountsGoToTheirBucketAndLane) {
  Tally tally({-1, 0, 0});
  const Bucket bucket = make_bucket(-1, 3);
  tally.add(bucket, 5, 2);
  tally.add(bucket, 1, LaneCounts{{1, 2, 4, 16, 32, 64, 0}, 8});
  tally.excuse(bucket, 1, Verdict::disjoint);
  for (int l = 0; l < 3; ++l) {
    for (int b = -kBucketMost; b <= kBucketMost; ++b) {
      const bool here = l == 1 && b == bucket;
      EXPECT_EQ(fields(tally.lane(l, static_cast<Bucket>(b))),
                here ? (std::vector<std::uint64_t>{1, 1, 4, 16, 32, 64, 1, 8}) : std::vector<std::uint64_t>(8));
    }
  }
  Tally sum({-1, 0, 0});
  sum.add(tally);
  sum.add(tally);
  EXPECT_EQ(sum.pairs(bucket), 10u);
  EXPECT_EQ(sum.intersects(bucket), 4u);
  EXPECT_EQ(fields(sum.lane(1, bucket)), (std::vector<std::uint64_t>{2, 2, 8, 32, 64, 128, 2, 16}));
  EXPECT_EQ(sum.pairs(make_bucket(-1, 2)), 0u);
}

// Each kind has its own bit: pairs that touch in a point, are coplanar, share a vertex, or are degenerate.
TEST(Convention, LeavesOpenWhatItNames) {
  const Pair touching{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {1, 2, 4}, {2, 1, 4}}};
  const Pair coplanar{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{5, 5, 0}, {9, 5, 0}, {5, 9, 0}}};
  const Pair overlapping{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, 0}, {5, 1, 0}, {1, 5, 0}}};
  const Pair shared{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 0, 0}, {1, 1, -4}, {1, 1, 4}}};
  const Pair thin_a{{{0, 0, 1}, {4, 0, 1}, {2, 0, 1}}, {{0, 1, 0}, {4, 1, 0}, {0, 9, 2}}};
  Pair thin_b = thin_a;
  std::swap(thin_b.a, thin_b.b);
  const Pair plain{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{1, 1, -1}, {1, 1, 1}, {3, 3, 1}}};
  const std::pair<const Pair*, unsigned> open[] = {{&touching, kOutsideTouching},
                                                   {&coplanar, kOutsideCoplanar},
                                                   {&overlapping, kOutsideCoplanar},
                                                   {&shared, kOutsideShared},
                                                   {&thin_a, kOutsideDegenerate},
                                                   {&thin_b, kOutsideDegenerate},
                                                   {&plain, 0}};
  Lane lane = *find_lane("moller_1997/f32/cpu");
  for (const auto& [pair, bits] : open) {
    const oracle::Truth truth = oracle::truth(*pair);
    const Verdict wrong = truth.verdict == Verdict::intersects ? Verdict::disjoint : Verdict::intersects;
    for (const unsigned bit : {0u, 1u, 2u, 4u, 8u}) {
      lane.outside = bit;
      EXPECT_EQ(by_convention(lane, wrong, *pair, truth), bit != 0 && bit == bits) << bits << " " << bit;
      EXPECT_FALSE(by_convention(lane, truth.verdict, *pair, truth));
      EXPECT_FALSE(by_convention(lane, Verdict::crashed, *pair, truth));
    }
  }
  lane.outside = kOutsideTouching;
  const Lane* two[] = {&lane, find_lane("moller_1997/f64/cpu")};
  EXPECT_EQ(excused(two, {Verdict::disjoint, Verdict::disjoint}, touching, oracle::truth(touching)),
            (std::vector{Verdict::intersects, Verdict::disjoint}));
  const Lane* others[] = {two[1], two[0], two[0]};
  EXPECT_EQ(
      excused(others, {Verdict::disjoint, Verdict::disjoint, Verdict::disjoint}, touching, oracle::truth(touching)),
      (std::vector{Verdict::disjoint, Verdict::intersects, Verdict::intersects}));
  EXPECT_EQ(outside_in_words(0), "");
  EXPECT_EQ(outside_in_words(kOutsideTouching | kOutsideShared), "touching pairs, pairs that share a vertex");
  EXPECT_EQ(outside_in_words(kOutsideCoplanar | kOutsideDegenerate), "coplanar pairs, degenerate triangles");
}

TEST(Bits, AreOfThePairsInTheirOrder) {
  for (std::size_t set = 0; set < 200; ++set) {
    Bits bits(4);
    bits[set / 64] = std::uint64_t{1} << set % 64;
    for (std::size_t i = 0; i < 256; ++i) ASSERT_EQ(test_bit(bits, i), i == set) << i << ' ' << set;
  }
}

TEST(NotRight, AreThePairsOnWhichSomeLaneIsWrongOrDeclines) {
  const Bits wrong = not_right(Example().block);
  ASSERT_EQ(wrong.size(), 2u);
  EXPECT_EQ(wrong[0], 0x8u);
  EXPECT_EQ(wrong[1], 0x6u);
}

TEST(CpuTwins, PointToTheCpuLaneOfTheSameAlgorithmAndScalar) {
  std::vector<const Lane*> some;
  for (const Lane& lane : lanes()) {
    if (lane.variant != Variant::cuda_nofma) some.push_back(&lane);
  }
  const std::vector<int> twins = cpu_twins(some);
  for (std::size_t l = 0; l < some.size(); ++l) {
    ASSERT_GE(twins[l], 0);
    const Lane& twin = *some[static_cast<std::size_t>(twins[l])];
    EXPECT_EQ(twin.variant, Variant::cpu);
    EXPECT_EQ(twin.info, some[l]->info);
    EXPECT_EQ(twin.scalar, some[l]->scalar);
  }
  EXPECT_EQ(cpu_twins(std::vector<const Lane*>{some[1]}), std::vector<int>{-1});
}

TEST(Signature, NamesTheWrongLanesAndHowCloseTheCallWas) {
  std::vector<const Lane*> run;
  for (const Lane& lane : lanes()) {
    if (lane.id == "moller_1997/f32/cpu" || lane.id == "moller_1997/f64/cpu-fma") run.push_back(&lane);
  }
  const std::vector wrong{Verdict::intersects, Verdict::declined}, right{Verdict::disjoint, Verdict::disjoint};
  const Relation truth{Verdict::disjoint, Contact::none, 1, {2, 1, true}};
  const Signature failure = signature(truth, Nesting::none, make_bucket(1, -3), run, wrong);
  EXPECT_TRUE(failure.wrong());
  EXPECT_EQ(key(failure), "none/21/coplanar/+2^-3/moller_1997:+f32/cpu;?f64/cpu-fma");
  EXPECT_FALSE(signature(truth, Nesting::none, make_bucket(1, -3), run, right).wrong());
  const std::vector declined{Verdict::declined, Verdict::disjoint};
  EXPECT_FALSE(signature(truth, Nesting::none, make_bucket(1, -3), run, declined).wrong());
  EXPECT_EQ(mark(Verdict::disjoint, Verdict::intersects), '-');
  EXPECT_EQ(mark(Verdict::intersects, Verdict::intersects), '.');
}

TEST(Signature, AKeyIsReadBack) {
  for (const char* text : {"none/21/coplanar/+2^-3/moller_1997:+f32/cpu;?f64/cpu-fma",
                           "area/00/skew/0/mine:", "area/22/coplanar_a_in_b/0/mine:-f32/cpu",
                           "segment/22/skew_b_in_a/-2^3/mine:", "area/22/coplanar_same/0/mine:",
                           "point/22/skew/-2^5/mine:-f32/cpu/plane_distance=abs:1e-6,orientation=rel:16;+f64/cpu"}) {
    const std::optional<Signature> read = parse_signature(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(key(*read), text);
  }
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const std::string text = "point/22/skew/" + name_of_bucket(static_cast<Bucket>(b)) + "/mine:";
    const std::optional<Signature> read = parse_signature(text);
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(key(*read), text);
  }
  const std::optional<Signature> read = parse_signature("point/22/skew/0/mine:-f32/cpu/a=abs:1,b=rel:2;+f64/cpu");
  ASSERT_EQ(read->wrong_lanes.size(), 2u);
  EXPECT_EQ(read->mark_of("f32/cpu/a=abs:1,b=rel:2"), '-');
  EXPECT_EQ(read->mark_of("f64/cpu"), '+');
  EXPECT_EQ(read->mark_of("f32/cpu"), '.');
  for (const char* text :
       {"", "point", "point/22", "point/22/skew", "point/22/skew/mine:", "point/22/skew/0/mine", "dot/22/skew/0/mine:",
        "point/23/skew/0/mine:", "point/22/flat/0/mine:", "point/22/skew/2^3/mine:", "point/22/skew/0/mine:f32/cpu",
        "point/22/skew/+2^32/mine:", "point/22/skew/0/:+f32/cpu", "point/22/skew_/0/mine:",
        "point/22/skew_c_in_a/0/mine:", "point/22/skew/0/mine:+", "executors/moller_1997/f32/cuda-fma"})
    EXPECT_FALSE(parse_signature(text)) << text;
}

TEST(ForEachSubject, VisitsRunsOfLanes) {
  std::vector<const Lane*> some;
  for (const Lane& lane : lanes()) {
    if (lane.scalar == Scalar::f32) some.push_back(&lane);
  }
  std::size_t visits = 0, lanes_visited = 0;
  for_each_subject(some, [&](std::size_t first, std::size_t count) {
    for (std::size_t l = first; l < first + count; ++l) EXPECT_EQ(some[l]->info, some[first]->info);
    visits += 1;
    lanes_visited += count;
  });
  EXPECT_EQ(visits, std::size_t{kAlgorithmCount} + 1);  // and exact
  EXPECT_EQ(lanes_visited, some.size());
}

}  // namespace
}  // namespace graze::analysis
