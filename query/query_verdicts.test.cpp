// SPDX-License-Identifier: Apache-2.0
// Every exact verdict equals the verdicts of both oracle decisions. Every verdict of another lane equals the verdict
// that this lane gives outside a query.
#include <gtest/gtest.h>

#include "core/exact/prepared_triangle.h"
#include "core/lanes/lanes.h"
#include "oracle/truth.h"
#include "query/testing.h"

namespace graze::query {
namespace {

constexpr std::size_t kPairs = 6'000;  // pairs in each stratum

std::vector<std::uint8_t> bytes_of(graze_query query, std::size_t count) {
  std::vector<std::uint8_t> bytes(count, 9);
  query.bytes = bytes.data();
  const Answer answer = Context().run(query);
  EXPECT_TRUE(answer) << answer.what();
  return bytes;
}

// Eight pairs: their first triangles are the references, their second triangles the array.
template <class Real>
struct Eight {
  static constexpr std::size_t kTogether = 8;
  std::vector<std::array<Real, 9>> references, triangles;
  std::vector<std::uint8_t> bytes;  // the answer for each pair

  template <class Draw>
  Eight(const Draw& draw, std::size_t begin) {
    for (std::size_t i = begin; i < begin + kTogether; ++i) {
      const BasicPair<Real> pair = draw(i);
      references.push_back(triangle(pair.a));
      triangles.push_back(triangle(pair.b));
    }
    const graze_triangles part = rows_of(std::span<const std::array<Real, 9>>(triangles));
    graze_query query = query_of(references[0], part);
    query.reference_count = kTogether;
    query.executor = GRAZE_ONE_CORE;
    bytes = bytes_of(query, kTogether * kTogether);
  }
};

// The slabs must not lose a hit, on any side of any triangle.
TEST(QueryVerdicts, AreTheOraclesOverAllStrata) {
  constexpr std::size_t kTogether = Eight<float>::kTogether;
  std::size_t looked_past = 0, filtered = 0, hits = 0;
  for (const strata::StratumInfo& row : strata::kStrata) {
    for (std::size_t begin = 0; begin < kPairs; begin += kTogether) {
      const Eight<float> eight([&](std::size_t i) { return strata::generate(7, row.stratum, i); }, begin);
      const auto& [references, triangles, bytes] = eight;
      for (std::size_t r = 0; r < kTogether; ++r) {
        const exact::PreparedTriangle prepared = exact::prepare(references[r].data());
        for (std::size_t t = 0; t < kTogether; ++t) {
          const Pair pair = pair_of(references[r], triangles[t]);
          const bool meets = oracle::cgal_verdict(pair) == Verdict::intersects;
          ASSERT_EQ(meets, oracle::gmp_contact(pair) != Contact::none);
          ASSERT_EQ(bytes[r * kTogether + t], meets) << row.id << " 7 " << begin + r << ' ' << begin + t;
          const bool beyond = exact::is_beyond(prepared, triangles[t].data());
          ASSERT_FALSE(meets && beyond) << row.id << " 7 " << begin + r << ' ' << begin + t;
          const exact::detail::Finding found = exact::detail::filter_in_floats(prepared, triangles[t].data());
          ASSERT_FALSE(found == exact::detail::Finding::disjoint && meets) << row.id << " 7 " << begin + r;
          ASSERT_FALSE(found == exact::detail::Finding::crosses && !meets) << row.id << " 7 " << begin + r;
          filtered += found != exact::detail::Finding::unsure;
          looked_past += beyond;
          hits += meets;
        }
      }
    }
  }
  EXPECT_GT(hits, 100'000u);
  EXPECT_GT(looked_past, 300'000u);
  EXPECT_GT(filtered, 300'000u);
}

// On doubles, exact verdicts equal the oracle's too. Rounded slabs must lose no hit and reject most disjoint triangles.
TEST(QueryVerdicts, OfDoublesAreTheOraclesOverAllStrata) {
  constexpr std::size_t kTogether = Eight<double>::kTogether, kPairsOfDoubles = 1'200;
  std::size_t looked_past = 0, hits = 0, apart = 0;
  for (const strata::StratumInfo& row : strata::kDoubleStrata) {
    for (std::size_t begin = 0; begin < kPairsOfDoubles; begin += kTogether) {
      const Eight<double> eight([&](std::size_t i) { return strata::generate_doubles(7, row.stratum, i); }, begin);
      const auto& [references, triangles, bytes] = eight;
      for (std::size_t r = 0; r < kTogether; ++r) {
        const auto seen_from = [&](const DoubleTriangle& t) {
          Triangle seen;
          for (std::size_t k = 0; k < 9; ++k) seen[k] = static_cast<float>(t[k] - references[r][k % 3]);
          return seen;
        };
        const exact::PreparedTriangle prepared = exact::prepare(seen_from(references[r]).data(), true);
        for (std::size_t t = 0; t < kTogether; ++t) {
          const DoublePair pair = pair_of(references[r], triangles[t]);
          const bool meets = oracle::cgal_verdict(pair) == Verdict::intersects;
          ASSERT_EQ(meets, oracle::gmp_contact(pair) != Contact::none);
          ASSERT_EQ(bytes[r * kTogether + t], meets) << row.id << " 7 " << begin + r << ' ' << begin + t;
          const bool beyond = exact::is_beyond(prepared, seen_from(triangles[t]).data());
          ASSERT_FALSE(meets && beyond) << row.id << " 7 " << begin + r << ' ' << begin + t;
          looked_past += beyond;
          hits += meets;
          apart += !meets;
        }
      }
    }
  }
  EXPECT_GT(hits, 30'000u);
  EXPECT_GT(looked_past, apart / 2);
}

// Pairs whose triangles become coplanar when they are rounded to float32.
TEST(QueryVerdicts, OfDoublesAreNotThoseOfFloats) {
  const auto at = [](double x) { return DoubleTriangle{x, 0, 0, x, 1, 0, x, 0, 1}; };
  const std::vector<DoubleTriangle> triangles = {at(1000000.02), at(1000000.01)};
  const graze_triangles part = rows_of(std::span<const DoubleTriangle>(triangles));
  const std::vector<std::uint8_t> bytes = bytes_of(query_of(at(1000000.01), part), 2);
  EXPECT_EQ(bytes[0], 0);
  EXPECT_EQ(bytes[1], 1);
}

// Differences of coordinates overflow, round to zero as floats, or are not finite.
TEST(QueryVerdicts, HoldAtTheEndsOfTheDoubles) {
  constexpr double kMost = 0x1.fffffffffffffp+1023;
  for (const double unit : {0x1p-1074, 0x1p-1022, 0x1p-160, 0x1p-149, 1.0, 0x1p127, 0x1p128, 0x1p1022}) {
    const DoubleTriangle reference = {0, 0, 0, unit, 0, 0, 0, unit, 0};
    const std::vector<DoubleTriangle> triangles = {{0, 0, 0, 0, 0, unit, unit, 0, unit},
                                                   {unit, unit, 0, 0, unit, 0, unit, unit, unit},
                                                   {0, 0, unit, unit, 0, unit, 0, unit, unit},
                                                   {0, 0, -kMost, unit, 0, kMost, 0, unit, kMost},
                                                   {0, NAN, 0, 0, 0, 0, 0, 0, 0},
                                                   {0, 0, 0, 0, 0, 0, 0, 0, INFINITY}};
    const graze_triangles part = rows_of(std::span<const DoubleTriangle>(triangles));
    EXPECT_EQ(bytes_of(query_of(reference, part), 6), (std::vector<std::uint8_t>{1, 1, 0, 1, 2, 2})) << unit;
  }
  const std::vector<DoubleTriangle> corners = {{kMost, -kMost, kMost, -kMost, kMost, kMost, kMost, kMost, -kMost},
                                               {-kMost, -kMost, -kMost, -kMost, -kMost, kMost, kMost, -kMost, -kMost}};
  const graze_triangles part = rows_of(std::span<const DoubleTriangle>(corners));
  for (const DoubleTriangle& reference : corners) {
    const std::vector<std::uint8_t> bytes = bytes_of(query_of(reference, part), 2);
    for (std::size_t t = 0; t < 2; ++t)
      EXPECT_EQ(bytes[t], oracle::cgal_verdict(pair_of(reference, corners[t])) == Verdict::intersects);
  }
}

TEST(QueryVerdicts, AreTheOraclesOnTheThesissTriangles) {
  const std::vector<Triangle> triangles = thesis_triangles(300'000);
  const graze_triangles part = part_of(triangles);
  const std::vector<std::uint8_t> bytes = bytes_of(query_of(kThesisReference, part), triangles.size());
  const exact::PreparedTriangle prepared = exact::prepare(kThesisReference.data());
  std::size_t beyond = 0, unsure = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Pair pair = pair_of(kThesisReference, triangles[i]);
    const bool meets = oracle::cgal_verdict(pair) == Verdict::intersects;
    ASSERT_EQ(meets, oracle::gmp_contact(pair) != Contact::none);
    ASSERT_EQ(bytes[i], meets) << i;
    const bool parted = exact::is_beyond(prepared, triangles[i].data());
    beyond += parted;
    unsure +=
        !parted && exact::detail::filter_in_floats(prepared, triangles[i].data()) == exact::detail::Finding::unsure;
  }
  EXPECT_GT(beyond, triangles.size() * 4 / 5);  // otherwise the slabs are not worth their cost
  EXPECT_LT(unsure, triangles.size() / 50);     // otherwise the filter is not worth its cost
}

TEST(QueryVerdicts, AreThoseOfTheLane) {
  const std::vector<Triangle> triangles = thesis_triangles(50'000, 3);
  const graze_triangles part = part_of(triangles);
  for (const char* id : {"interval_overlap/f32/cpu", "moller_1997/f64/cpu", "guigue_devillers_2003/f32/cpu/rel:24",
                         "interval_overlap/f32/cpu/bound", "interval_overlap/f32/cpu/filtered"}) {
    graze_query query = query_of(kThesisReference, part);
    query.lane = id;
    const std::vector<std::uint8_t> bytes = bytes_of(query, triangles.size());
    const LaneName name = *parse_lane_name(id);
    const Lane published = *find_lane(name.subject + '/' + name.scalar + '/' + name.variant);
    const Lane lane = name.policy.empty() ? published : lane_under(published, name.policy);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const Verdict verdict = decide_one(lane.decide, pair_of(kThesisReference, triangles[i]));
      ASSERT_EQ(bytes[i], verdict == Verdict::declined ? 2 : verdict == Verdict::intersects) << id << ' ' << i;
    }
  }
}

// A slab must not reject a hit: tests magnitudes at both ends of the float range, and triangles just beyond the
// reference.
TEST(QueryVerdicts, HoldAtTheEndsOfTheFloats) {
  for (const float unit : {0x1p-149f, 0x1p-126f, 0x1p-60f, 1.0f, 0x1p60f, 0x1p126f}) {
    const Triangle reference = {0, 0, 0, unit, 0, 0, 0, unit, 0};
    const exact::PreparedTriangle prepared = exact::prepare(reference.data());
    const Triangle touching = {0, 0, 0, 0, 0, unit, unit, 0, unit},
                   edge = {unit, unit, 0, 0, unit, 0, unit, unit, unit};
    for (const Triangle& t : {touching, edge}) EXPECT_FALSE(exact::is_beyond(prepared, t.data()));
    for (int k = 0; k < 9; ++k) {
      for (const float bad : {INFINITY, -INFINITY, NAN}) {
        Triangle broken = touching;
        broken[static_cast<std::size_t>(k)] = bad;
        for (const auto& [r, t] : {std::pair(reference, broken), std::pair(broken, touching)}) {
          const exact::PreparedTriangle either = exact::prepare(r.data());
          EXPECT_FALSE(exact::is_beyond(either, t.data()));
          EXPECT_EQ(exact::detail::filter_in_floats(either, t.data()), exact::detail::Finding::unsure);
        }
      }
    }
  }
  const float most = 0x1.fffffep+127f;
  const Triangle corners = {most, -most, most, -most, most, most, most, most, -most},
                 far = {-most, -most, -most, -most, -most, most, most, -most, -most};
  const exact::PreparedTriangle prepared = exact::prepare(corners.data());
  for (const Triangle& t : {corners, far}) EXPECT_FALSE(exact::is_beyond(prepared, t.data()));
  // A finite triangle whose sum of magnitudes overflows.
  const std::vector<Triangle> triangles = {corners, far, {most, NAN, 0, 0, 0, 0, 0, 0, most}};
  const graze_triangles part = part_of(triangles);
  const std::vector<std::uint8_t> bytes = bytes_of(query_of(corners, part), triangles.size());
  EXPECT_EQ(bytes[0], 1);
  EXPECT_NE(bytes[1], 2);
  EXPECT_EQ(bytes[2], 2);
}

// The two slabs are the thinnest ones along the normal and along the direction perpendicular to the normal and the
// longest edge (each of the three edges is tested as the longest). A thicker slab would cost time, but lose no hits.
TEST(PreparedTriangle, SlabsAreSquareToTheNormalAndTheLongestEdge) {
  const Vec3<double> corners[3] = {{1, 2, 3}, {9, -6, 5}, {4, 1, 2.5}};
  const Vec3<double> longest = corners[1] - corners[0];
  const Vec3<double> normal = cross(longest, corners[2] - corners[0]), across = cross(normal, longest);
  for (std::size_t first = 0; first < 3; ++first) {
    Triangle t;
    for (std::size_t i = 0; i < 9; ++i)
      t[i] = static_cast<float>(component(corners[(first + i / 3) % 3], static_cast<int>(i % 3)));
    const exact::PreparedTriangle r = exact::prepare(t.data());
    for (int k = 0; k < exact::kSlabs; ++k) {
      const exact::Slab& s = r.slabs[k];
      const Vec3<double> d{s.x, s.y, s.z}, off = cross(d, k == 0 ? normal : across);
      const double size = std::sqrt(dot(normal, normal) * (k == 0 ? 1 : dot(longest, longest)) * dot(d, d));
      EXPECT_LT(std::sqrt(dot(off, off)), 1e-6 * size) << first << ' ' << k;
      const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
      EXPECT_LE(sum, 0.25 * (1 + 0x1p-22));
      EXPECT_NEAR(s.error, 12 * 0x1p-24 * sum, 1e-5 * s.error);
      double half = 0;
      for (const Vec3<double>& v : corners) half = std::max(half, std::abs(dot(d, v) - s.middle));
      EXPECT_TRUE(s.half > half + std::abs(s.middle) * 0x1p-21 && s.half - half < 1e-5) << first << ' ' << k;
      double other = 0;  // no other middle is better
      for (const Vec3<double>& v : corners) other = std::max(other, s.middle - dot(d, v));
      EXPECT_NEAR(half, other, 1e-6);
    }
  }
  // A segment or a point has no normal, so its slabs are aligned with the axes.
  const Triangle segment = {1, 1, 1, 2, 2, 2, 3, 3, 3}, point = {5, 6, 7, 5, 6, 7, 5, 6, 7};
  for (const Triangle& t : {segment, point}) {
    const exact::PreparedTriangle r = exact::prepare(t.data());
    EXPECT_TRUE(r.slabs[0].x == 0.25f && r.slabs[0].y == 0 && r.slabs[0].z == 0);
    EXPECT_TRUE(r.slabs[1].x == 0 && r.slabs[1].y == 0.25f && r.slabs[1].z == 0);
  }
}

TEST(PreparedTriangle, LooksAtNineNumbersAndDecidesWithinItsExtents) {
  const Triangle reference = {0, 0, 0, 4, 0, 0, 0, 4, 0};
  std::vector<float> behind = {0, 0, 9, 1, 0, 9, 0, 1, 9, 3e38f};  // a triangle, and the next number in memory
  EXPECT_TRUE(exact::is_beyond(exact::prepare(reference.data()), behind.data()));
  using exact::detail::Finding;
  for (const auto& [extent, decided] :
       {std::pair{0x1p-24f, true}, {0x1p-25f, false}, {0x1p40f, true}, {0x1p41f, false}}) {
    Triangle a = {0, 0, 0.5f, 1, 0, 0.5f, 0, 1, 0.5f}, b = {0.25f, 0.25f, 0, 0.25f, 0.25f, 1, 0.5f, 0.25f, 1};
    for (float& x : a) x *= extent;
    for (float& x : b) x *= extent;
    EXPECT_EQ(exact::detail::filter_in_floats(exact::prepare(a.data()), b.data()),
              decided ? Finding::crosses : Finding::unsure)
        << extent;
  }
}

}  // namespace
}  // namespace graze::query
