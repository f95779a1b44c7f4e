// SPDX-License-Identifier: Apache-2.0
// Tests truths that can be checked by hand: every contact, degeneracy and kind of margin, and the limits of float32.
#include <cfloat>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "oracle/test_pairs.h"
#include "oracle/truth.h"

namespace graze::oracle {
namespace {

using oracle_test::Kind;
using oracle_test::pair_of;
using oracle_test::PairSource;

struct Example {
  const char* name;
  Pair pair;
  Contact contact;
  double margin;
};

const double kRoot2 = std::sqrt(2.0), kRoot3 = std::sqrt(3.0);

// A is usually the right triangle (0,0,0) (4,0,0) (0,4,0).
const Example kExamples[] = {
    // Two triangles.
    {"parallel_apart", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 3, 4, 0, 3, 0, 4, 3}), Contact::none, 3},
    {"coplanar_apart", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 4, 0, 6, 4, 0, 4, 6, 0}), Contact::none, 2 * kRoot2},
    {"coplanar_vertex_on_vertex", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 0, 0, 6, 0, 0, 6, 2, 0}), Contact::point, 0},
    {"coplanar_vertex_on_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 2, 2, 0, 4, 3, 0, 3, 4, 0}), Contact::point, 0},
    {"coplanar_shared_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 0, 0, 0, 4, 0, 4, 4, 0}), Contact::segment, 0},
    {"coplanar_part_of_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 0, 0, 2, 0, 0, 1, -2, 0}), Contact::segment, 0},
    {"coplanar_overlap", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 5, 1, 0, 1, 5, 0}), Contact::area, 0},
    {"coplanar_inside", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 2, 1, 0, 1, 2, 0}), Contact::area, 0},
    {"coplanar_star", pair_of({0, 0, 0, 6, 0, 0, 3, 6, 0, 0, 4, 0, 6, 4, 0, 3, -2, 0}), Contact::area, 0},
    {"same_triangle", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0}), Contact::area, 0},
    {"vertex_on_face", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 1, 1, 5, 2, 1, 5}), Contact::point, 0},
    {"vertex_on_vertex", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, -1, 0, 1, 0, -1, 2}), Contact::point, 0},
    {"vertex_on_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 2, 0, 0, 2, -1, 1, 1, -1, 2}), Contact::point, 0},
    {"edge_across_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 2, 0, 1, 2, 0, -1, 2, -3, 0}), Contact::point, 0},
    {"edge_in_face", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 2, 1, 0, 1, 1, 3}), Contact::segment, 0},
    {"edge_through_face_ends_in_plane", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, -1, 1, 0, 9, 1, 0, 1, 1, 3}),
     Contact::segment, 0},
    {"folded_over_shared_edge", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4}), Contact::segment, 0},
    {"pierced_by_one", pair_of({-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, -1, 3, 0, 4, -3, 0, 4}), Contact::segment, -1},
    {"pierced_by_a_thin_needle", pair_of({-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, -0.25f, 1, 0, 8, -1, 0, 8}),
     Contact::segment, -0.25},
    {"interlocked", pair_of({-4, 0, 0, 4, 0, 0, 0, 8, 0, 0, 1, -4, 0, 1, 4, 0, -7, 0}), Contact::segment, -1},
    {"above_face", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0.5f, 0, 0, 5, 2, 2, 7}), Contact::none, 0.5},
    {"edge_past_edge", pair_of({0, 0, 0, 4, 0, 0, 0, -4, 0, 2, 1, 1, 2, 1, -1, 2, 6, 0}), Contact::none, 1},
    {"skew_edges", pair_of({-4, 0, 0, 4, 0, 0, 0, 0, -4, 0, -4, 3, 0, 4, 3, 0, 0, 9}), Contact::none, 3},
    {"corner_to_corner", pair_of({0, 0, 0, -1, 0, 0, 0, -1, 0, 1, 1, 1, 2, 1, 1, 1, 2, 1}), Contact::none, kRoot3},

    // A segment or a point.
    {"segment_through_triangle", pair_of({-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, -1, 0, 0, 2, 0, 0, 1}), Contact::point,
     -1},
    {"segment_ends_on_triangle", pair_of({-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, 0, 0, 0, 2, 0, 0, 1}), Contact::point, 0},
    {"segment_above_triangle", pair_of({-9, -9, 0, 9, -9, 0, 0, 9, 0, 0, 0, 1, 0, 0, 2, 0, 0, 2}), Contact::none, 1},
    {"segment_past_triangle", pair_of({0, 0, 0, 4, 0, 0, 0, 4, 0, 3, 3, -1, 3, 3, 0, 3, 3, 1}), Contact::none, kRoot2},
    {"segment_in_triangle", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 2, 1, 0, 3, 1, 0}), Contact::segment, 0},
    {"segment_across_triangle", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, -1, 1, 0, 9, 1, 0, 3, 1, 0}), Contact::segment, 0},
    {"segment_along_edge", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, -1, 0, 0, 2, 0, 0, 3, 0, 0}), Contact::segment, 0},
    {"segment_touches_corner", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, -1, 1, 0, 1, -1, 0, 0, 0, 0}), Contact::point, 0},
    {"point_in_triangle", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 0, 1, 1, 0, 1, 1, 0}), Contact::point, 0},
    {"point_above_triangle", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, 1, 1, 5, 1, 1, 5, 1, 1, 5}), Contact::none, 5},
    {"point_beside_triangle", pair_of({0, 0, 0, 8, 0, 0, 0, 8, 0, 5, 5, 0, 5, 5, 0, 5, 5, 0}), Contact::none, kRoot2},
    {"segments_cross", pair_of({-1, 0, 0, 0, 0, 0, 1, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0}), Contact::point, 0},
    {"segments_skew", pair_of({-1, 0, 0, 0, 0, 0, 1, 0, 0, 0, -1, 2, 0, 0, 2, 0, 1, 2}), Contact::none, 2},
    {"segments_overlap", pair_of({0, 0, 0, 1, 1, 1, 3, 3, 3, 2, 2, 2, 5, 5, 5, 4, 4, 4}), Contact::segment, 0},
    {"segments_end_to_end", pair_of({0, 0, 0, 1, 1, 1, 3, 3, 3, 3, 3, 3, 5, 5, 5, 4, 4, 4}), Contact::point, 0},
    {"segments_on_one_line", pair_of({0, 0, 0, 1, 1, 1, 3, 3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6}), Contact::none, kRoot3},
    {"segments_parallel", pair_of({0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 2, 0, 1, 2, 0, 3, 2, 0}), Contact::none, 2},
    {"point_on_segment", pair_of({0, 0, 0, 1, 1, 1, 3, 3, 3, 2, 2, 2, 2, 2, 2, 2, 2, 2}), Contact::point, 0},
    {"point_off_segment", pair_of({0, 0, 0, 2, 0, 0, 4, 0, 0, 3, 1, 0, 3, 1, 0, 3, 1, 0}), Contact::none, 1},
    {"points_same", pair_of({1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}), Contact::point, 0},
    {"points_apart", pair_of({0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 3, 6, 2, 3, 6, 2, 3, 6}), Contact::none, 7},
    {"points_at_zero", pair_of({0, 0, 0, 0, -0.0f, 0, 0, 0, 0, 0, 0, 0, -0.0f, 0, 0, 0, 0, 0}), Contact::point, 0},

    // The limits of float32.
    {"subnormal_apart",
     pair_of({0, 0, 0, 0x4p-149f, 0, 0, 0, 0x4p-149f, 0, 0, 0, 0x1p-149f, 0x4p-149f, 0, 0x1p-149f, 0, 0x4p-149f,
              0x1p-149f}),
     Contact::none, 0x1p-149},
    {"subnormal_pierced",
     pair_of({-0x9p-149f, -0x9p-149f, 0, 0x9p-149f, -0x9p-149f, 0, 0, 0x9p-149f, 0, 0, 0, -0x1p-149f, 0x3p-149f, 0,
              0x4p-149f, -0x3p-149f, 0, 0x4p-149f}),
     Contact::segment, -0x1p-149},
    {"largest_apart",
     pair_of({FLT_MAX, 0, 0, FLT_MAX, 1, 0, FLT_MAX, 0, 1, -FLT_MAX, 0, 0, -FLT_MAX, 1, 0, -FLT_MAX, 0, 1}),
     Contact::none, 2.0 * FLT_MAX},
    {"huge_face_tiny_gap",
     pair_of({-FLT_MAX, -FLT_MAX, 0, FLT_MAX, -FLT_MAX, 0, 0, FLT_MAX, 0, 0, 0, 0x1p-149f, 1, 0, 1, 0, 1, 1}),
     Contact::none, 0x1p-149},
    {"huge_face_tiny_depth",
     pair_of({-FLT_MAX, -FLT_MAX, 0, FLT_MAX, -FLT_MAX, 0, 0, FLT_MAX, 0, 0, 0, -0x1p-149f, 1, 0, 1, 0, 1, 1}),
     Contact::segment, -0x1p-149},
};

class TruthByHand : public testing::TestWithParam<Example> {};

TEST_P(TruthByHand, InAllOrders) {
  const Example& example = GetParam();
  for (int order = 0; order < 72; ++order) {
    const Pair pair = oracle_test::turned(oracle_test::reordered(example.pair, order), order % 48);
    const Truth found = truth(pair);
    ASSERT_EQ(found.contact, example.contact) << hex(pair);
    ASSERT_EQ(found.verdict, example.contact == Contact::none ? Verdict::disjoint : Verdict::intersects) << hex(pair);
    ASSERT_DOUBLE_EQ(found.margin, example.margin) << hex(pair);
    ASSERT_DOUBLE_EQ(found.margin_ulps, std::ldexp(example.margin, -log2_ulp(pair)));
    ASSERT_FALSE(std::signbit(found.margin) && found.margin == 0);
    const Bucket bucket = margin_bucket(pair, found.verdict);
    if (found.margin == 0) {
      ASSERT_EQ(bucket, 0);
    } else {
      ASSERT_EQ(bucket, make_bucket(found.margin > 0 ? 1 : -1, std::ilogb(std::fabs(found.margin_ulps)))) << hex(pair);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, TruthByHand, testing::ValuesIn(kExamples),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(Shape, NamesDimensionsAndCommonPlane) {
  struct Group {
    const char* prefix;
    int dimension_a, dimension_b;
    bool coplanar;
  };
  // The first matching prefix decides.
  const Group kGroups[] = {
      {"coplanar", 2, 2, true},       {"same_triangle", 2, 2, true},  {"segment_in", 2, 1, true},
      {"segment_across", 2, 1, true}, {"segment_along", 2, 1, true},  {"segment_touches", 2, 1, true},
      {"segment_", 2, 1, false},      {"segments_skew", 1, 1, false}, {"segments_", 1, 1, true},
      {"point_in", 2, 0, true},       {"point_beside", 2, 0, true},   {"point_above", 2, 0, false},
      {"point_", 1, 0, true},         {"points_", 0, 0, true},        {"", 2, 2, false}};
  for (const Example& example : kExamples) {
    const std::string name = example.name;
    const Group* group = kGroups;
    while (name.rfind(group->prefix, 0) != 0) ++group;
    for (const Pair& pair : {example.pair, oracle_test::reordered(example.pair, 17)}) {
      const Hulls found = hulls(pair);
      EXPECT_EQ(found.dimension_a, group->dimension_a) << name;
      EXPECT_EQ(found.dimension_b, group->dimension_b) << name;
      EXPECT_EQ(found.coplanar, group->coplanar) << name;
    }
  }
}

TEST(Truth, DeclinesWhatIsNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    for (int i = 0; i < kCoordinates; ++i) {
      Pair pair = kExamples[0].pair;
      coordinates(pair)[i] = bad;
      const Truth found = truth(pair);
      EXPECT_EQ(found.verdict, Verdict::declined);
      EXPECT_EQ(found.contact, Contact::unknown);
      EXPECT_TRUE(std::isnan(found.margin) && std::isnan(found.margin_ulps));
    }
  }
}

TEST(Truth, IgnoresOrderAxesAndSigns) {
  for (const Kind kind : oracle_test::kKinds) {
    PairSource source(kind, 20240503);
    for (int n = 0; n < 6; ++n) {
      const Pair pair = source.next();
      const Truth first = truth(pair);
      const Bucket bucket = margin_bucket(pair, first.verdict);
      for (int order = 0; order < 72; ++order) {
        const Pair other = oracle_test::turned(oracle_test::reordered(pair, order), source.below(48));
        const Truth found = truth(other);
        ASSERT_EQ(found.verdict, first.verdict) << hex(other);
        ASSERT_EQ(found.contact, first.contact) << hex(other);
        ASSERT_EQ(found.margin, first.margin) << hex(other);
        ASSERT_EQ(margin_bucket(other, found.verdict), bucket) << hex(other);
      }
    }
  }
}

TEST(Truth, ScalesByPowersOfTwo) {
  PairSource source(Kind::near, 20240504);
  for (int n = 0; n < 300; ++n) {
    const Pair pair = source.next();
    const Truth found = truth(pair);
    for (const int power : {-60, 100}) {
      Pair scaled = pair;
      for (int i = 0; i < kCoordinates; ++i) coordinates(scaled)[i] = std::ldexp(coordinates(pair)[i], power);
      const Truth other = truth(scaled);
      ASSERT_EQ(other.contact, found.contact);
      ASSERT_EQ(other.margin, std::ldexp(found.margin, power));
      ASSERT_EQ(other.margin_ulps, found.margin_ulps);
      ASSERT_EQ(margin_bucket(scaled, found.verdict), margin_bucket(pair, found.verdict));
    }
  }
}

}  // namespace
}  // namespace graze::oracle
