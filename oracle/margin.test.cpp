// SPDX-License-Identifier: Apache-2.0
// Compares certified bounds and buckets with the exact margin, and the exact margin with an independent search.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/margin/margin.h"
#include "core/margin/single_precision.h"
#include "core/margin/stored_margin.h"
#include "core/margin/tie_proof.h"
#include "oracle/exact_margin.h"
#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::Kind;
using oracle_test::PairSource;

constexpr std::uint64_t kSeed = 20240502;

template <class Real>
SquaredMargin exact_margin(const BasicPair<Real>& pair, Verdict verdict) {
  const Grid grid = grid_of(pair);
  const LargePair large = large_integers(pair, grid);
  return verdict == Verdict::disjoint ? exact_distance(large, grid.exponent)
                                      : exact_depth(large, grid.exponent, kAllAxes);
}

// Checks that the bounds allow the expected bucket.   Returns: whether the bounds allow only one bucket.
template <class Real>
bool expect_bounds(const Pair& pair, Verdict verdict, double exact, Bucket expected) {
  const MarginBounds bounds = margin_bounds<Real>(pair, verdict);
  EXPECT_LE(bounds.lo, exact) << hex(pair);
  EXPECT_GE(bounds.hi, exact) << hex(pair);
  Bucket bucket;
  if (!bucket_from_bounds(bounds, verdict, log2_ulp(pair), bucket)) return false;
  EXPECT_EQ(bucket, expected) << hex(pair);
  return true;
}

template <class Real>
Bucket exact_bucket(const BasicPair<Real>& pair, Verdict verdict) {
  const SquaredMargin exact = exact_margin(pair, verdict);
  return exact.numerator == 0 ? Bucket{0}
                              : make_bucket(verdict == Verdict::disjoint ? 1 : -1, floor_log2(exact) - log2_ulp(pair));
}

TEST(MarginBucket, IsTheExactMarginsBucket) {
  for (const Kind kind : oracle_test::kKinds) {
    PairSource source(kind, kSeed);
    int certain = 0, more = 0;
    constexpr int kPairs = 10000;
    for (int n = 0; n < kPairs; ++n) {
      const Pair pair = source.next();
      const Verdict verdict = cgal_verdict(pair);
      const SquaredMargin exact = exact_margin(pair, verdict);
      const Bucket expected = exact_bucket(pair, verdict);
      ASSERT_EQ(margin_bucket(pair, verdict), expected) << hex(pair);

      const bool by_double = expect_bounds<double>(pair, verdict, rounded(exact), expected);
      const bool by_two = expect_bounds<DoubleDouble>(pair, verdict, rounded(exact), expected);
      ASSERT_FALSE(HasFailure());
      certain += by_double;
      more += by_two && !by_double;
    }
    RecordProperty("more_by_two_doubles_kind_" + std::to_string(static_cast<int>(kind)), more);
    RecordProperty("certain_percent_kind_" + std::to_string(static_cast<int>(kind)), 100 * certain / kPairs);
  }
}

// Tests pairs of doubles near 1, over the whole range, and with subnormal or huge coordinates.
TEST(MarginBucket, OfDoublesIsTheExactMarginsBucket) {
  for (const Kind kind : oracle_test::kKinds) {
    oracle_test::BasicPairSource<double> source(kind, kSeed + 7);
    for (int n = 0; n < 3000; ++n) {
      DoublePair pair = source.next();
      const int shift[] = {0, 0, -1000, 900};
      double* c = &pair.a[0].x;
      for (int i = 0; i < kCoordinates; ++i) c[i] = std::ldexp(c[i], shift[n % 4]);
      if (!is_finite(pair)) continue;
      const Verdict verdict = cgal_verdict(pair);
      ASSERT_EQ(margin_bucket(pair, verdict), exact_bucket(pair, verdict)) << hex(pair);
    }
  }
}

// Compares each operation with rationals: the error must not exceed the proven bound. Half of the sums cancel.
TEST(DoubleDouble, OperationsKeepTheirErrorBounds) {
  std::mt19937_64 random(7);
  const auto value = [&](int spread) {
    const double hi =
        std::ldexp(1.0 + static_cast<double>(random() >> 12) * 0x1p-52, static_cast<int>(random() % 64) / spread);
    const double lo = std::ldexp(static_cast<double>(random() >> 11) * 0x1p-53 - 0.5, std::ilogb(hi) - 53);
    return random() % 2 ? DoubleDouble{hi, lo} : DoubleDouble{-hi, -lo};
  };
  const auto exact = [](const DoubleDouble& x) { return mpq_class(mpq_class(x.hi) + mpq_class(x.lo)); };
  const mpq_class u(0x1p-53);
  mpq_class largest[4];
  for (int n = 0; n < 100'000; ++n) {
    const DoubleDouble x = value(1);
    DoubleDouble y = value(n % 3 == 0 ? 64 : 1);
    if (n % 2) y = {-x.hi * (1 + static_cast<double>(random() % 5) * 0x1p-52), y.lo * 0x1p-40};
    if (std::fabs(y.lo) > std::fabs(y.hi) * 0x1p-54) y.lo = 0;
    ASSERT_TRUE(x.hi + x.lo == x.hi && y.hi + y.lo == y.hi);
    const DoubleDouble found[] = {x + y, x - y, x * y, x / y};
    const mpq_class a = exact(x), b = exact(y), expected[] = {a + b, a - b, a * b, a / b};
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(found[k].hi + found[k].lo, found[k].hi) << k;
      const mpq_class error = abs(exact(found[k]) - expected[k]);
      if (error == 0) continue;
      ASSERT_NE(expected[k], 0) << k;
      largest[k] = std::max(largest[k], mpq_class(error / abs(expected[k]) / (u * u)));
    }
    ASSERT_EQ(x < y, a < b);
    ASSERT_EQ(x <= y, a <= b);
    ASSERT_EQ(x == y, a == b);
    ASSERT_EQ(x > y, a > b);
    ASSERT_EQ(x >= y, a >= b);
  }
  const double bounds[] = {3.001, 3.001, 5, 15.001};
  for (int k = 0; k < 4; ++k) {
    EXPECT_LE(largest[k].get_d(), bounds[k]) << k;
    EXPECT_GE(largest[k].get_d(), 0.5) << k;  // otherwise hardly any result was rounded
    EXPECT_LE(largest[k].get_d() * 0x1p-106, kRoundoff<DoubleDouble>) << k;
  }
}

TEST(MarginBounds, AreTightOnPairsInGeneralPosition) {
  PairSource source(Kind::uniform, kSeed + 1);
  for (int n = 0; n < 10000; ++n) {
    const Pair pair = source.next();
    const MarginBounds bounds = margin_bounds(pair, cgal_verdict(pair));
    if (bounds.hi < 1e-6) continue;
    ASSERT_GT(bounds.lo, bounds.hi * (1 - 1e-8)) << hex(pair);
  }
}

using Long = Vec3<long double>;

// Computes the distance in another way: as the origin's distance from the Minkowski difference, which is the convex
// hull of the nine points b[j] - a[i]. The hull's point nearest to the origin is on a simplex of one, two or three of
// them. Tries all 129 simplices in long double.
long double distance_of_difference(const Pair& pair) {
  std::vector<Long> points;
  for (const auto& a : pair.a) {
    for (const auto& b : pair.b) {
      points.push_back({static_cast<long double>(b.x) - a.x, static_cast<long double>(b.y) - a.y,
                        static_cast<long double>(b.z) - a.z});
    }
  }
  long double least = INFINITY;
  const auto keep = [&least](const Long& x) { least = std::min(least, std::sqrt(dot(x, x))); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Long& p = points[i];
    keep(p);
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const Long u = points[j] - p;
      const long double along = -dot(p, u) / dot(u, u);
      if (along >= 0 && along <= 1) keep(p + u * along);
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Long v = points[k] - p, n = cross(u, v);
        const long double n2 = dot(n, n), s = -dot(cross(p, v), n) / n2, t = -dot(cross(u, p), n) / n2;
        if (s >= 0 && t >= 0 && s + t <= 1) keep(p + u * s + v * t);
      }
    }
  }
  return least;
}

TEST(ExactDistance, IsThatOfTheMinkowskiDifferenceFromTheOrigin) {
  for (const Kind kind : {Kind::lattice3, Kind::uniform, Kind::coplanar, Kind::degenerate, Kind::flat}) {
    PairSource source(kind, kSeed + 2);
    int compared = 0;
    for (int n = 0; n < 2000; ++n) {
      const Pair pair = source.next();
      if (cgal_verdict(pair) != Verdict::disjoint) continue;
      const double exact = rounded(exact_margin(pair, Verdict::disjoint));
      if (exact < 1e-3) continue;
      ++compared;
      ASSERT_NEAR(exact, static_cast<double>(distance_of_difference(pair)), 1e-11 * exact) << hex(pair);
    }
    EXPECT_GT(compared, 500);
  }
}

Pair moved(const Pair& pair, const Vec3<double>& by) {
  Pair result = pair;
  for (auto& b : result.b) {
    b = {static_cast<float>(b.x + by.x), static_cast<float>(b.y + by.y), static_cast<float>(b.z + by.z)};
  }
  return result;
}

// Checks a depth d by its definition: no translation shorter than d separates the pair, and one slightly longer does.
TEST(ExactDepth, IsTheShortestPartingPush) {
  for (const Kind kind : {Kind::uniform, Kind::lattice3, Kind::degenerate}) {
    PairSource source(kind, kSeed + 3);
    int tried = 0;
    for (int n = 0; n < 4000 && tried < 150; ++n) {
      const Pair pair = source.next();
      if (cgal_verdict(pair) != Verdict::intersects) continue;
      const double depth = rounded(exact_margin(pair, Verdict::intersects));
      if (depth < 1e-3) continue;
      ++tried;
      for (int k = 0; k < 200; ++k) {
        Vec3<double> d = {source.below(2001) - 1000.0, source.below(2001) - 1000.0, source.below(2001) - 1000.0};
        const double length = std::sqrt(dot(d, d));
        if (length == 0) continue;
        ASSERT_EQ(cgal_verdict(moved(pair, d * (0.999 * depth / length))), Verdict::intersects) << hex(pair);
      }
      bool parted = false;
      const MarginFrame<double> frame = make_margin_frame(pair);
      for (int axis = 0; axis < kSeparatingAxes; ++axis) {
        const Vec3<double> d = direction(frame, axis);
        const double length = std::sqrt(dot(d, d));
        if (length == 0) continue;
        for (const double sign : {-1.001, 1.001}) {
          parted = parted || cgal_verdict(moved(pair, d * (sign * depth / length))) == Verdict::disjoint;
        }
      }
      ASSERT_TRUE(parted) << hex(pair);
    }
    EXPECT_GT(tried, 30);
  }
}

// On small integers, the directions that the bounds use are exact, so they equal the directions computed with integers.
TEST(ExactSeparation, IsAlongTheDirectionsOfTheBounds) {
  PairSource source(Kind::lattice3, kSeed + 4);
  int reached = 0;  // how often a separation equals the distance
  for (int n = 0; n < 3000; ++n) {
    const Pair pair = source.next();
    const Grid grid = grid_of(pair);
    const LargePair large = large_integers(pair, grid);
    const MarginFrame<double> frame = make_margin_frame(pair);
    const bool disjoint = cgal_verdict(pair) == Verdict::disjoint;
    const double distance = disjoint ? rounded(exact_distance(large, grid.exponent)) : 0;
    bool is_distance = false;
    for (int d = 0; d < kDirections; ++d) {
      const Vec3<mpz_class> exact = integer_direction(large.a, large.b, d);
      const Vec3<double> expected = direction(frame, d);
      const double scale = std::ldexp(1.0, (d < kFromEdgeA ? 2 : d < kFromVertex ? 3 : 1) * grid.exponent);
      ASSERT_EQ((Vec3<double>{exact.x.get_d() * scale, exact.y.get_d() * scale, exact.z.get_d() * scale}), expected)
          << d << hex(pair);
      const SquaredMargin separation = exact_separation(large, grid.exponent, d);
      ASSERT_LE(rounded(separation), distance) << d << hex(pair);
      is_distance = is_distance || (disjoint && rounded(separation) == distance);
    }
    ASSERT_EQ(is_distance, disjoint) << hex(pair);
    reached += is_distance;
  }
  EXPECT_GT(reached, 500);
}

TEST(BucketFromBounds, IsTheOneThatBoundsLeave) {
  const auto bucket = [](double lo, double hi, Verdict verdict) {
    Bucket found = 99;
    return bucket_from_bounds({lo, hi, 0, 0}, verdict, -3, found) ? int{found} : 99;
  };
  constexpr Verdict yes = Verdict::intersects, no = Verdict::disjoint;
  EXPECT_EQ(bucket(0, 0, yes), 0);
  EXPECT_EQ(bucket(0, 1, yes), 99);
  EXPECT_EQ(bucket(-1, 1, yes), 99);
  EXPECT_EQ(bucket(1, 1, yes), make_bucket(-1, 3));
  EXPECT_EQ(bucket(1, 1.999, yes), make_bucket(-1, 3));
  EXPECT_EQ(bucket(1, 2, yes), 99);
  EXPECT_EQ(bucket(1, 1, no), make_bucket(1, 3));
  EXPECT_EQ(bucket(0.999, 1, no), 99);
  EXPECT_EQ(bucket(0, 1, no), 99);
  // A disjoint pair whose distance is below all buckets is in the lowest bucket, however wide its bounds.
  EXPECT_EQ(bucket(0, 0x1p-60, no), make_bucket(1, kBucketLowest));
}

// lo <= margin <= hi, tested without rounding.
bool holds(const MarginBounds& bounds, const SquaredMargin& exact) {
  const mpq_class lo(bounds.lo), hi(bounds.hi), unit(std::ldexp(1.0, exact.exponent));
  const mpq_class squared = mpq_class(exact.numerator) / mpq_class(exact.denominator) * unit * unit;
  return lo * lo <= squared && squared <= hi * hi;
}

TEST(MarginBounds, HoldTheExactMarginOfDoublesOnTheGridOfFloats) {
  int tried = 0, certain = 0, more = 0;
  for (const Kind kind : oracle_test::kKinds) {
    oracle_test::BasicPairSource<double> source(kind, kSeed + 6);
    for (int n = 0; n < 1000; ++n) {
      const DoublePair pair = source.next();
      if (!on_grid_of_floats(pair)) continue;
      ++tried;
      const Verdict verdict = cgal_verdict(pair);
      const SquaredMargin exact = exact_margin(pair, verdict);
      bool decided[2] = {};
      for (const int k : {0, 1}) {
        const MarginBounds bounds =
            k == 0 ? margin_bounds<double>(pair, verdict) : margin_bounds<DoubleDouble>(pair, verdict);
        ASSERT_TRUE(std::isfinite(bounds.hi) && holds(bounds, exact)) << hex(pair);
        Bucket bucket;
        decided[k] = bucket_from_bounds(bounds, verdict, log2_ulp(pair), bucket);
        if (decided[k]) {
          ASSERT_EQ(bucket, exact_bucket(pair, verdict)) << hex(pair);
        }
      }
      certain += decided[0];
      more += decided[1] && !decided[0];
    }
  }
  EXPECT_GT(tried, 7'000);
  EXPECT_GT(certain, tried / 2);
  EXPECT_GT(more, 500);  // pairs near a contact
}

TEST(MarginBuckets, OfWideStoredMarginsAreTheWidest) {
  constexpr Bucket kOpen = 99;
  for (const int sign : {-1, 1}) {
    EXPECT_EQ(wide_bucket(make_bucket(sign, 4), kOpen), kOpen);
    EXPECT_EQ(wide_bucket(make_bucket(sign, 5), kOpen), make_bucket(sign, kBucketHighest));
    EXPECT_EQ(wide_bucket(make_bucket(sign, kBucketHighest), kOpen), make_bucket(sign, kBucketHighest));
  }
  EXPECT_EQ(wide_bucket(0, kOpen), kOpen);
}

TEST(MarginBounds, KnowWhichDoublesAreOnTheGridOfFloats) {
  const auto is_on_it = [](double x) {
    DoublePair pair{};
    pair.b[2].z = x;
    return on_grid_of_floats(pair);
  };
  EXPECT_TRUE(is_on_it(0));
  EXPECT_TRUE(is_on_it(-0x1.fffffffffffffp127));
  EXPECT_FALSE(is_on_it(0x1p128));
  EXPECT_TRUE(is_on_it(0x1p-149));
  EXPECT_FALSE(is_on_it(0x1.8p-149));
}

TEST(GuessedDistance, BoundsHoldTheExactDistance) {
  int finite = 0;
  const auto expect_held = [&](const Pair& pair) {
    Vec3<double> a[3], b[3];
    for (int i = 0; i < 3; ++i) a[i] = widen(pair.a[i]), b[i] = widen(pair.b[i]);
    const MarginBounds bounds = first_attempt::distance_bounds(a, b, first_attempt::seem_nearest(a, b).features);
    if (!std::isfinite(bounds.hi) || bounds.lo < 0) return;
    ++finite;
    ASSERT_TRUE(holds(bounds, exact_margin(pair, Verdict::disjoint))) << hex(pair);
  };
  for (const Kind kind : {Kind::uniform, Kind::lattice3, Kind::near, Kind::coplanar, Kind::flat}) {
    PairSource source(kind, kSeed + 5);
    for (int n = 0; n < 2000; ++n) {
      const Pair pair = source.next();
      if (cgal_verdict(pair) == Verdict::disjoint) expect_held(pair);
    }
  }
  // The shortest connection joins two vertices, almost along an axis, and its computed length is rounded down.
  for (int n = 0; n < 500; ++n) {
    const float off = std::ldexp(1 + static_cast<float>(n) / 256, -26);
    expect_held(oracle_test::pair_of({0, 0, 0, -1, 0.25f, 0, -1, 0, 0.5f, 1, off, 0, 2, 0.125f, 0, 2, 0, 0.5f}));
  }
  EXPECT_GT(finite, 5000);
}

// Compares the errors with the values derived in quick_depth.h, because tests on pairs do not come near these values.
TEST(QuickDepth, ErrorsAreThoseDerivedAndNoMoreThanAPercentAbove) {
  const double u = 0x1p-24, overlap = 98 * u * (3 * 5 * 7), length = 8 * u * (5 * 7 + 7 * 3 + 3 * 5);
  const first_attempt::AxisErrors<float> errors({3, 5, 7}, u);
  EXPECT_GE(errors.overlap, overlap);
  EXPECT_LE(errors.overlap, 1.01 * overlap);
  EXPECT_GE(errors.length, length);
  EXPECT_LE(errors.length, 1.01 * length);
}

// All points are relative to a vertex of the feature that defines the axis. If the hulls touch at that feature, the
// overlap is exactly zero.
TEST(QuickDepth, OverlapsByNothingWhereItTouchesTheAxis) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto point = [&] { return Vec3<float>{any(random), any(random), any(random)}; };
  int touching = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3<float> a[3] = {point(), point(), point()};
    Vec3<float> b[3] = {point(), point(), point()};
    const bool edges = n % 2 == 0;
    const int shared = edges ? n % 4 : n % 3;  // b's edge begins at b[0]; b[2] is off the edge
    b[shared] = a[0];
    const Vec3<float> axis = cross(a[1] - a[0], edges ? b[1] - b[0] : a[2] - a[0]);
    const auto side = [&](const Vec3<float>& v) { return dot(axis, v - a[0]) > 0; };
    const bool on_one_side =
        edges ? side(a[2]) != side(b[2 - shared]) : side(b[(shared + 1) % 3]) == side(b[(shared + 2) % 3]);
    if (!on_one_side) continue;
    ++touching;
    ASSERT_EQ(first_attempt::overlap_along(a, b, edges).along, 0) << n;
  }
  EXPECT_GT(touching, 1000);
}

TEST(TieProof, ShiftsByAnyNumberOfBits) {
  const exact::detail::Wide<8> x(exact::detail::Int128{0x123456789abcdef});
  auto expected = x;
  for (int bits = 0; bits < 448; ++bits, expected = expected + expected)
    ASSERT_TRUE(tie_proof::shifted_up(x, bits) == expected) << bits;
}

// Two parallel triangles one unit apart. The unit varies; the largest coordinate is 1, or at a limit (40 or 61 bits).
TEST(TieProof, RefusesWhatIsTooLarge) {
  const auto is_proven = []<class Real>(Real largest, int exponent) {
    const Real a[9] = {0, 0, 0, largest, 0, 0, 0, 1, 0}, b[9] = {0, 0, 1, 1, 0, 1, 0, 1, 1};
    return are_apart_by(a, b, kNormalA, exponent);
  };
  EXPECT_FALSE(is_proven(1.f, 1));
  for (int exponent = 0; exponent >= -80; --exponent) EXPECT_TRUE(is_proven(1.f, exponent)) << exponent;
  EXPECT_FALSE(is_proven(1.f, -81));
  EXPECT_TRUE(is_proven(0x1p39f, 0));
  EXPECT_FALSE(is_proven(0x1p40f, 0));
  EXPECT_FALSE(is_proven(1., 1));
  for (int exponent = 0; exponent >= -200; --exponent) EXPECT_TRUE(is_proven(1., exponent)) << exponent;
  EXPECT_FALSE(is_proven(1., -201));
  EXPECT_TRUE(is_proven(0x1p60, 0));
  EXPECT_TRUE(is_proven(0x1p60, -200));
  EXPECT_FALSE(is_proven(0x1p61, 0));
}

// Square roots that lie exactly or almost exactly half-way between two doubles.
TEST(Rounded, RoundsOnceToNearestEven) {
  const mpz_class half = (mpz_class(1) << 53) + 1;  // 2^53 + 1, half-way between two doubles
  EXPECT_EQ(rounded({half * half, 1, 0}), 0x1p53);
  EXPECT_EQ(rounded({half * half + 1, 1, 0}), 0x1p53 + 2);
  EXPECT_EQ(rounded({half * half - 1, 1, 0}), 0x1p53);
  const mpz_class other = half + 2;  // 2^53 + 3
  EXPECT_EQ(rounded({other * other, 1, -3}), std::ldexp(0x1p53 + 4, -3));
  EXPECT_EQ(rounded({other * other - 1, 1, 0}), 0x1p53 + 2);
  EXPECT_EQ(rounded({2, 1, 0}), std::sqrt(2.0));
  EXPECT_EQ(rounded({1, 9, 5}), 32.0 / 3.0);
}

TEST(FloorLog2, IsExactAtPowersOfTwo) {
  EXPECT_EQ(floor_log2(SquaredMargin{16, 1, 0}), 2);
  EXPECT_EQ(floor_log2(SquaredMargin{15, 1, 0}), 1);
  EXPECT_EQ(floor_log2(SquaredMargin{17, 1, -7}), -5);
  EXPECT_EQ(floor_log2(SquaredMargin{1, 4, 0}), -1);
  EXPECT_EQ(floor_log2(SquaredMargin{1, 5, 0}), -2);
  EXPECT_EQ(floor_log2(SquaredMargin{3, 12, 0}), -1);
}

}  // namespace
}  // namespace graze::oracle
